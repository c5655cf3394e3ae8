//! What lies beside a table.

use std::fs;
use std::path::Path;

use fsot::SampleTable;
use fsot::files::{FormatError, Metadata, TableError};

use crate::{bits, metadata, names, problem_of, saved, table};

#[test]
fn metadata_come_back_whole() {
    let (home, table, _) = saved();
    let path = home.path().join("table.npy");
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
    let (back, read) = SampleTable::load_with(&path).unwrap();
    assert_eq!(bits(&back), bits(&table));
    assert_eq!(read, metadata(&table));
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
