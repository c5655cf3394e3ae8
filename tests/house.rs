//! The shape of the code: data flows one way, files are short enough to read in one sitting, lines fit the
//! page.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the ground up. Each uses only those before it, and itself.
const ROOMS: [&str; 19] = [
    "error",
    "random",
    "simd",
    "named",
    "laws",
    "table",
    "targets",
    "kernel",
    "directions",
    "classes",
    "transport",
    "files",
    "config",
    "objective",
    "slices",
    "sweeps",
    "metrics",
    "optimizer",
    "method",
];

/// All sources below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let nested = entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    nested.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The first segments of all paths `crate::…` outside of comments, those in braces included.
fn imports(text: &str) -> BTreeSet<String> {
    let code: String =
        text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    let mut found = BTreeSet::new();
    for after in code.split("crate::").skip(1) {
        let listed =
            after.strip_prefix('{').and_then(|list| list.split('}').next()).map(|list| list.split(','));
        let paths: Vec<&str> = match listed {
            Some(paths) => paths.collect(),
            None => vec![after],
        };
        for path in paths {
            let is_name = |c: &char| c.is_ascii_alphanumeric() || *c == '_';
            found.insert(path.trim().chars().take_while(is_name).collect());
        }
    }
    found
}

#[test]
fn no_file_imports_upwards() {
    let level: BTreeMap<&str, usize> = ROOMS.iter().enumerate().map(|(at, room)| (*room, at)).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut upward = Vec::new();
    for path in sources(&root) {
        let inside = path.strip_prefix(&root).unwrap().with_extension("");
        let room = inside.iter().next().unwrap().to_str().unwrap();
        if room == "lib" {
            continue;
        }
        let own = *level.get(room).unwrap_or_else(|| panic!("{room} is no room: give it a level"));
        for import in imports(&fs::read_to_string(&path).unwrap()) {
            match level.get(import.as_str()) {
                Some(&other) if other <= own => {}
                Some(_) => upward.push(format!("{} imports {import}", path.display())),
                None => upward.push(format!("{} imports {import} by its name at the root", path.display())),
            }
        }
    }
    assert!(upward.is_empty(), "{}", upward.join("\n"));
}

/// All sources of the workspace.
fn all_sources() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["src", "tests", "benches", "examples", "cli", "lab", "fuzz/src", "fuzz/fuzz_targets"]
        .map(|folder| root.join(folder));
    folders.iter().filter(|folder| folder.is_dir()).flat_map(|folder| sources(folder)).collect()
}

#[test]
fn files_are_short_and_lines_fit() {
    let mut lengths = Vec::new();
    let mut complaints = Vec::new();
    for path in all_sources() {
        let text = fs::read_to_string(&path).unwrap();
        lengths.push(text.lines().count());
        if text.lines().count() > 400 {
            complaints.push(format!("{} has {} lines", path.display(), text.lines().count()));
        }
        // `max_width` of rustfmt.toml, which leaves comments and strings alone.
        for (number, line) in text.lines().enumerate().filter(|(_, line)| line.chars().count() > 110) {
            complaints.push(format!("{}:{} is {} wide", path.display(), number + 1, line.chars().count()));
        }
    }
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    println!("{} files, median {median} lines, longest {}", lengths.len(), lengths[lengths.len() - 1]);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(median <= 200, "{median}");
}

#[test]
fn the_root_has_few_names() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let modules = text.lines().filter(|line| line.starts_with("pub mod ")).count();
    let exported = text.lines().filter_map(|line| line.strip_prefix("pub use "));
    let types: usize = exported.map(|line| line.split(',').count()).sum();
    println!("{types} types and {modules} modules at the root");
    assert!(types + modules <= 20, "{types} types, {modules} modules");
}

#[test]
fn imports_are_found() {
    let text = "use crate::{table::Extent, kernel};\n// crate::optimizer\nlet x = crate::laws::f();";
    assert!(imports(text).iter().eq(["kernel", "laws", "table"]));
}
