//! The commands of the guide, docs/choosing.md, on tables so small that they take no time.

use std::fs;
use std::path::Path;
use std::process::Command;

/// What makes a command quick and leaves all else as it is.
fn quick(verb: &str) -> &'static [&'static str] {
    match verb {
        "table" => &["--width", "8", "--height", "8", "--sweeps", "1", "--no-bound", "--quiet"],
        "inspect" | "report" => &["--integrands", "1", "--bound-slices", "16"],
        _ => &[],
    }
}

/// The arguments of all `fsot` that a shell is to run.
fn commands(guide: &str) -> Vec<Vec<String>> {
    let shell = guide.split("```").filter_map(|block| block.strip_prefix("sh\n"));
    let lines = shell.flat_map(str::lines).filter_map(|line| line.strip_prefix("fsot "));
    let words = |line: &str| line.split_whitespace().map(|word| word.trim_matches('\'').into()).collect();
    lines.map(words).collect()
}

#[test]
fn the_commands_of_the_guide_run() {
    let guide = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/choosing.md");
    let home = tempfile::tempdir().unwrap();
    let commands = commands(&fs::read_to_string(guide).unwrap());
    for verb in ["table", "inspect", "report", "export"] {
        assert!(commands.iter().any(|command| command[0] == verb), "the guide has no {verb}");
    }
    for command in commands {
        let output = Command::new(env!("CARGO_BIN_EXE_fsot"))
            .current_dir(home.path())
            .args(&command)
            .args(quick(&command[0]))
            .output()
            .unwrap();
        assert!(output.status.success(), "fsot {command:?}: {}", String::from_utf8_lossy(&output.stderr));
        if let Some(out) = command.iter().skip_while(|word| *word != "--out").nth(1) {
            let stem = Path::new(out).file_stem().unwrap().to_str().unwrap();
            let written = fs::read_dir(home.path()).unwrap();
            let mut names = written.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            assert!(names.any(|name| name.starts_with(stem)), "fsot {command:?} wrote nothing");
        }
    }
}
