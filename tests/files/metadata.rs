//! What lies beside a table.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use fsot::files::{FormatError, Metadata, TableError};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{bits, metadata, names, problem_of, saved, table};

#[test]
fn metadata_come_back_whole() {
    let (home, table, _) = saved();
    let path = home.path().join("table.npy");
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
    let (back, read) = SampleTable::load_with(&path).unwrap();
    assert_eq!(bits(&back), bits(&table));
    assert!(read.sha256.is_some());
    assert_eq!(read, Metadata { sha256: read.sha256.clone(), ..metadata(&table) });
    assert_eq!(read, Metadata::load(&path).unwrap());
    assert_eq!(read.seed, u64::MAX - 1);
    assert_eq!(read.crate_version, env!("CARGO_PKG_VERSION"));
    assert_eq!(Metadata::path_beside(Path::new("a/b.c.npy")), Path::new("a/b.c.json"));

    // As another program sees it.
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(home.path().join("table.json")).unwrap()).unwrap();
    assert_eq!(json["axes"], serde_json::json!(["frame", "y", "x", "sample", "dim"]));
    assert_eq!(json["shape"], serde_json::json!([2, 3, 4, 2, 2]));
    assert_eq!(json["dtype"], "<f4");
    assert_eq!(json["kernels"][0]["taps"][1]["dt"], -2);
    assert_eq!(json["bound"]["after"]["standard_error"], "inf");

    let mut unknown = metadata(&table);
    unknown.bound = None;
    unknown.run.seconds = f64::NAN;
    table.save_with(&path, &unknown).unwrap();
    let read = Metadata::load(&path).unwrap();
    assert!(read.bound.is_none() && read.run.seconds.is_nan());
}

#[test]
fn notes_come_back_beside_what_is_known() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let table = table();
    let mut noted = metadata(&table);
    noted.notes.insert("scene".into(), serde_json::json!({ "name": "kitchen", "spp": [1, 4.5, null] }));
    noted.notes.insert("seeds".into(), u64::MAX.into());
    table.save_with(&path, &noted).unwrap();
    let read = Metadata::load(&path).unwrap();
    assert_eq!(read.notes, noted.notes);
    assert_eq!(read, Metadata { sha256: read.sha256.clone(), ..noted });
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(path.with_extension("json")).unwrap()).unwrap();
    assert_eq!((&json["scene"]["name"], &json["notes"]), (&"kitchen".into(), &serde_json::Value::Null));
}

#[test]
fn damaged_metadata_are_located() {
    let (home, table, [_, json]) = saved();
    let path = home.path().join("table.npy");
    let beside = home.path().join("table.json");
    let text = String::from_utf8(json).unwrap();
    let load = |text: &str, words: &[&str]| {
        fs::write(&beside, text).unwrap();
        assert_eq!(SampleTable::load(&path).unwrap(), table, "the table does not depend on its metadata");
        problem_of(SampleTable::load_with(&path).unwrap_err(), "table.json", words)
    };
    // `"format"` is on line 2, the version of the crate on line 3.
    let comma = text.replacen(",\n", "\n", 1);
    assert!(matches!(load(&comma, &["line 3", "column 3"]), FormatError::Json { line: 3, column: 3, .. }));
    let no_seed = text.replace("\"seed\"", "\"sead\"");
    assert!(matches!(load(&no_seed, &["seed", "line"]), FormatError::Json { .. }));
    let negative = text.replace("18446744073709551614", "-1");
    assert!(matches!(load(&negative, &["-1", "u64", "line"]), FormatError::Json { .. }));
    let word = text.replace("12.75", "\"long\"");
    assert!(matches!(load(&word, &["long", "a number", "line"]), FormatError::Json { .. }));
    for text in ["", "[]", "\u{feff}{}", &text[..text.len() / 2], &(text.clone() + "}"), &"[".repeat(100_000)]
    {
        assert!(matches!(load(text, &["line", "save the table again"]), FormatError::Json { .. }));
    }
    let future = text.replace("sample table 1", "sample table 2");
    let expected = "fsot sample table 1".to_owned();
    assert_eq!(
        load(&future, &["fsot sample table 2", "fsot sample table 1", "version"]),
        FormatError::Field { field: "format", given: "fsot sample table 2".into(), expected }
    );
    let swapped = text.replace("\"x\",", "\"column\",");
    assert!(matches!(load(&swapped, &["axes", "column", "\"x\""]), FormatError::Field { field: "axes", .. }));

    let noted = text.replacen('{', "{ \"note\": \"by hand\",", 1);
    fs::write(&beside, noted).unwrap();
    SampleTable::load_with(&path).unwrap();

    fs::remove_file(&beside).unwrap();
    let error = SampleTable::load_with(&path).unwrap_err();
    assert!(matches!(&error, TableError::Io { verb: "read", path, .. } if *path == beside), "{error:?}");
    fs::create_dir(&beside).unwrap();
    let error = Metadata::load(&path).unwrap_err();
    assert_eq!(problem_of(error, "table.json", &["not an ordinary file"]), FormatError::NotAFile);
}

#[test]
fn metadata_of_another_table_are_refused() {
    let (home, old, bytes) = saved();
    let path = home.path().join("table.npy");
    let other = table(3);
    let expected = FormatError::OtherTable { metadata: [2, 3, 4, 2, 2], table: [2, 3, 4, 2, 3] };
    let error = other.save_with(&path, &metadata(&old)).unwrap_err();
    assert_eq!(problem_of(error, "table.json", &["[2, 3, 4, 2, 2]", "[2, 3, 4, 2, 3]"]), expected);
    let mut foreign = metadata(&old);
    foreign.range = "[0, 255]".into();
    let error = old.save_with(&path, &foreign).unwrap_err();
    assert!(matches!(
        problem_of(error, "table.json", &["[0, 255]"]),
        FormatError::Field { field: "range", .. }
    ));
    assert_eq!(["table.npy", "table.json"].map(|name| fs::read(home.path().join(name)).unwrap()), bytes);
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);

    other.save(&path).unwrap();
    assert_eq!(problem_of(SampleTable::load_with(&path).unwrap_err(), "table.json", &[]), expected);
}

/// By Python's word: `hashlib.sha256(struct.pack('<f', 0.5)).hexdigest()`.
#[test]
fn the_hash_is_everybodys() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let table = SampleTable::new(Extent::still(1, 1), 1, vec![0.5]).unwrap();
    table.save_with(&path, &Metadata::new(table.extent(), 1, 0, "half".into())).unwrap();
    let hash = Metadata::load(&path).unwrap().sha256.unwrap();
    assert_eq!(hash, "d99e58435243d9fef9c88273b8d553b4fba4d0baf8009d29eae74fa99e0d9f57");
}

/// `save` over an earlier `save_with` leaves metadata that are of other values.
#[test]
fn metadata_of_other_values_are_told() {
    let (home, old, bytes) = saved();
    let path = home.path().join("table.npy");
    let new = SampleTable::white_noise(old.extent(), old.dims(), 8).unwrap();
    new.save(&path).unwrap();
    let words = ["SHA-256", "load the table alone", "save both again"];
    let problem = problem_of(SampleTable::load_with(&path).unwrap_err(), "table.json", &words);
    assert!(matches!(problem, FormatError::OtherValues { .. }), "{problem:?}");
    // Both pieces of advice.
    assert_eq!(SampleTable::load(&path).unwrap(), new);
    new.save_with(&path, &Metadata::load(&path).unwrap()).unwrap();
    assert_eq!(SampleTable::load_with(&path).unwrap().0, new);

    // The lowest bit of one value, and another program's digits.
    let mut flipped = bytes[0].clone();
    *flipped.last_mut().unwrap() ^= 1;
    fs::write(&path, &flipped).unwrap();
    fs::write(home.path().join("table.json"), &bytes[1]).unwrap();
    assert!(SampleTable::load_with(&path).is_err());
    fs::write(&path, &bytes[0]).unwrap();
    let text = String::from_utf8(bytes[1].clone()).unwrap();
    let hash = Metadata::load(&path).unwrap().sha256.unwrap();
    fs::write(home.path().join("table.json"), text.replace(&hash, &hash.to_uppercase())).unwrap();
    SampleTable::load_with(&path).unwrap();

    // Metadata of before say nothing of values.
    let line = format!("  \"sha256\": \"{hash}\",\n");
    assert!(text.contains(&line));
    fs::write(home.path().join("table.json"), text.replace(&line, "")).unwrap();
    new.save(&path).unwrap();
    let (table, metadata) = SampleTable::load_with(&path).unwrap();
    assert_eq!((table, metadata.sha256), (new, None));
}

/// Whoever is last may have renamed one file of a pair only.
#[test]
fn two_writers_at_once_leave_a_pair_or_say_that_they_have_not() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let extent = Extent::still(16, 16);
    let tables = [1, 2].map(|seed| SampleTable::white_noise(extent, 2, seed).unwrap());
    let told = AtomicUsize::new(0);
    let tell = |path: &Path| match SampleTable::load_with(path) {
        Ok((table, metadata)) => assert_eq!(table, tables[metadata.seed as usize - 1]),
        Err(TableError::Format { problem: FormatError::OtherValues { .. }, .. }) => {
            told.fetch_add(1, Ordering::Relaxed);
        }
        Err(other) => panic!("{other}"),
    };
    for _ in 0..20 {
        thread::scope(|scope| {
            for (seed, table) in (1..).zip(&tables) {
                let path = &path;
                scope.spawn(move || {
                    table.save_with(path, &Metadata::new(extent, 2, seed, "white noise".into())).unwrap();
                });
            }
        });
        tell(&path);
    }
    println!("{} of 20 pairs were mixed, and told", told.into_inner());
}
