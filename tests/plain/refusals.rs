//! What a format cannot hold is said in words, and nothing is written; following the words succeeds.

use std::fs;

use fsot::files::{Depth, ExportError, ExportOptions, Format, ImportError, ImportOptions, TableError};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{ALL, export, table};

fn refusal(error: TableError) -> ImportError {
    let text = error.to_string();
    assert!(!text.contains('\n') && text.len() < 600, "{text}");
    match error {
        TableError::Import { problem, .. } => problem,
        other => panic!("{other}"),
    }
}

#[test]
fn other_numbers_and_other_names_are_refused() {
    let table = table((Extent::still(4, 4), 2));
    let home = tempdir().unwrap();
    for (format, name, depths) in ALL {
        for depth in Depth::ALL.into_iter().filter(|depth| !depths.contains(depth) && *depth != Depth::Half) {
            let options = ExportOptions { depth: Some(depth), ..ExportOptions::new(format) };
            let error = table.export(home.path().join(name), &options).unwrap_err();
            let ExportError::Depth { holds, .. } = &error else { panic!("{error}") };
            for depth in holds.split(" or ") {
                let options = ExportOptions { depth: depth.parse().ok(), ..ExportOptions::new(format) };
                assert!(options.depth.is_some());
                let path = home.path().join(name);
                assert!(options.files(&path, table.extent(), 2).is_ok(), "{error}");
            }
        }
        let error = table.export(home.path().join("mask"), &ExportOptions::new(format)).unwrap_err();
        let ExportError::FileName { extension, .. } = error else { panic!("{error}") };
        assert!(name.ends_with(extension));
    }
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0);
}

/// A folder where the text of bare numbers should be.
#[test]
fn bare_numbers_are_not_written_without_their_text() {
    let home = tempdir().unwrap();
    fs::create_dir(home.path().join("mask.raw.txt")).unwrap();
    let table = table((Extent::still(4, 4), 2));
    let error = table.export(home.path().join("mask.raw"), &ExportOptions::new(Format::Raw)).unwrap_err();
    assert!(error.to_string().contains("mask.raw.txt: it is a directory"), "{error}");
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
}

#[test]
fn bare_numbers_without_a_word_ask_for_it() {
    let home = tempdir().unwrap();
    let path = home.path().join("mask.bin");
    let table = table((Extent::still(4, 4), 2));
    fs::write(&path, table.values().iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
        .unwrap();
    let refused = |options: &ImportOptions| refusal(SampleTable::import(&path, options).unwrap_err());
    assert_eq!(refused(&ImportOptions::default()), ImportError::NoDtype);
    let options = ImportOptions { dtype: "<f4".parse().ok(), dims: Some(2), ..ImportOptions::default() };
    assert_eq!(SampleTable::import(&path, &options).unwrap().table, table);
    // Of three numbers a sample there is no whole count.
    let options = ImportOptions { channels: Some(3), ..options };
    assert_eq!(refused(&options), ImportError::Channels { values: 32, channels: 3, dims: 2 });
    let options = ImportOptions { channels: Some(1), ..options };
    assert_eq!(refused(&options), ImportError::Channels { values: 32, channels: 1, dims: 2 });
    let beside = home.path().join("mask.bin.txt");
    for (text, line, word) in [
        ("dtype: complex", 1, "complex"),
        ("\ndtype: <f4\nshape: four", 3, "four"),
        ("dtype: <f4\nshape: 4, 4, 2\naxes: y, x, z", 3, "y, x, z"),
        ("dtype: <f4\nlevels: -1", 2, "-1"),
    ] {
        fs::write(&beside, text).unwrap();
        let expected = ImportError::Description { line, text: word.into() };
        assert_eq!(refused(&ImportOptions::default()), expected, "{text}");
    }
    for text in
        ["dtype: <f4\nshape: 4, 4", "dtype: <f8\nshape: 99999999999, 99999999999", "dtype: <u2\nshape: 3"]
    {
        fs::write(&beside, text).unwrap();
        let error = SampleTable::import(&path, &ImportOptions::default()).unwrap_err();
        assert!(matches!(error, TableError::Format { .. }), "{error}");
    }
}

#[test]
fn files_that_changed_since_their_export_are_noticed() {
    let table = table((Extent::still(4, 4), 2));
    let home = export(&table, "mask.csv", Format::Csv, Depth::F32);
    let text = fs::read_to_string(&home.path).unwrap();
    fs::write(&home.path, text.replacen("0.5", "0.25", 1)).unwrap();
    let refused = refusal(SampleTable::import(&home.path, &ImportOptions::default()).unwrap_err());
    assert_eq!(refused, ImportError::Changed);
    let home = home.without_record();
    let options = ImportOptions { dims: Some(2), ..ImportOptions::default() };
    assert_eq!(home.import(&options).table.shape(), table.shape());
}

#[test]
fn records_that_cannot_be_are_refused() {
    let table = table((Extent::animation(2, 4, 4).with_spp(2), 5));
    let home = export(&table, "mask.bin", Format::Fast, Depth::F32);
    let beside = &home.exported.record_path;
    let record = fs::read_to_string(beside).unwrap();
    let refused = |from: &str, to: &str| {
        assert!(record.contains(from), "{record}");
        fs::write(beside, record.replacen(from, to, 1)).unwrap();
        SampleTable::import(&home.path, &ImportOptions::default()).unwrap_err()
    };
    for (from, to) in [
        ("mask_s0_d0-3.bin", "../mask_s0_d0-3.bin"),
        ("mask_s0_d0-3.bin", ""),
        ("\"frames\": [\n        0,\n        2", "\"frames\": [\n        0,\n        3"),
        ("\"frames\": [\n        0,\n        2", "\"frames\": [\n        1,\n        1"),
        ("\"frames\": [\n        0,\n        2", "\"frames\": [\n        0,\n        1"),
        ("\"samples\": [\n        0,\n        1", "\"samples\": [\n        1,\n        2"),
    ] {
        let problem = refusal(refused(from, to));
        assert!(matches!(problem, ImportError::Record { .. }), "{from} {to}: {problem}");
    }
    // A file in two places, and a table that no file is as large as: before memory is asked for.
    let problem = refusal(refused("mask_s0_d4.bin", "mask_s0_d0-3.bin"));
    assert!(problem.to_string().contains("names a file twice"), "{problem}");
    let problem = refusal(refused("    4,\n    4,", "    10000,\n    10000,"));
    assert!(matches!(problem, ImportError::Lengths { .. }), "{problem}");
    let error = refused("fsot export 1", "fsot export 2");
    assert!(matches!(error, TableError::Format { .. }), "{error}");
    let error = refused("\"shape\": [\n    2", "\"shape\": [\n    0");
    assert!(matches!(error, TableError::Extent(_)), "{error}");
    let error = refused("mask_s0_d0-3.bin", "absent.bin");
    assert!(matches!(error, TableError::Io { .. }), "{error}");
    // What is not ours is passed over.
    fs::write(beside, "{\"kind\": \"camera\"}").unwrap();
    fs::write(&home.path, ".5\n").unwrap();
    assert_eq!(home.import(&ImportOptions::default()).table.values(), [0.5]);
}
