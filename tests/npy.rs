//! Tables on the disk: what is written is what is read, and a file that is not a table is told what it lacks.

use std::fs;
use std::path::Path;

use fsot::config::ExtentError;
use fsot::files::{BoundEstimate, BoundRecord, FormatError, KernelTaps, Metadata, RunRecord, TableError};
use fsot::kernel::Tap;
use fsot::{Extent, SampleTable};
use proptest::prelude::*;
use tempfile::{TempDir, tempdir};

const EXTENT: Extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };

fn table(dims: usize) -> SampleTable {
    SampleTable::white_noise(EXTENT, dims, 7).unwrap()
}

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn bits(table: &SampleTable) -> Vec<u32> {
    table.values().iter().map(|value| value.to_bits()).collect()
}

/// A `.npy` file of version 1.0, padded as numpy pads it.
fn npy(dictionary: &str, values: &[u8]) -> Vec<u8> {
    let header = (10 + dictionary.len() + 1).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header as u16).to_le_bytes());
    file.extend(dictionary.bytes());
    file.resize(10 + header - 1, b' ');
    file.push(b'\n');
    file.extend(values);
    file
}

fn f32s(shape: &str, values: &[f32]) -> Vec<u8> {
    let dictionary = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    npy(&dictionary, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
}

fn load_bytes(bytes: &[u8]) -> Result<SampleTable, TableError> {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    fs::write(&path, bytes).unwrap();
    SampleTable::load(&path)
}

/// The problem with a file of these bytes; its message must name the file and contain all of `words`.
fn problem(bytes: &[u8], words: &[&str]) -> FormatError {
    problem_of(load_bytes(bytes).unwrap_err(), "table.npy", words)
}

fn problem_of(error: TableError, file: &str, words: &[&str]) -> FormatError {
    let text = error.to_string();
    for word in [file].iter().chain(words) {
        assert!(text.contains(word), "{word:?} is missing in: {text}");
    }
    assert!(!text.contains('\n') && text.len() < 600, "{text}");
    match error {
        TableError::Format { problem, .. } => problem,
        other => panic!("{other:?}"),
    }
}

fn metadata(table: &SampleTable) -> Metadata {
    let estimate = BoundEstimate {
        value: 0.1 + 0.2,
        standard_error: f64::INFINITY,
        ratio_to_white_noise: 1.0 / 3.0,
        ratio_standard_error: 5e-324,
    };
    let configuration = serde_json::json!({ "steps": 3, "terms": [{ "sigma": 2.1 }], "none": null });
    Metadata {
        kernels: vec![KernelTaps {
            term: 1,
            taps: vec![
                Tap { dt: 0, dy: 0, dx: 0, weight: 1.0 },
                Tap { dt: -2, dy: 1, dx: -1, weight: 0.0395582850655909 },
            ],
        }],
        bound: Some(BoundRecord { before: estimate, after: estimate }),
        run: RunRecord { slices_per_class: 64, sweeps: 3, ended_early: true, steps: 4096, seconds: 12.75 },
        ..Metadata::new(table.extent(), table.dims(), u64::MAX - 1, configuration)
    }
}

#[test]
fn what_is_read_is_what_was_written_bit_for_bit() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let shapes = [
        [1, 1, 1, 1, 1],
        [1, 1, 1, 1, 16],
        [2, 3, 4, 5, 2],
        [1, 5, 1, 3, 7],
        [3, 1, 1, 1, 1],
        [1, 64, 64, 1, 2],
    ];
    for [frames, height, width, spp, dims] in shapes {
        let extent = Extent { frames, height, width, spp };
        let mut values = SampleTable::white_noise(extent, dims, 1).unwrap().into_values();
        // Zero, the smallest subnormal, the largest value below 1, and the other zero.
        let edges = [0.0, f32::from_bits(1), f32::from_bits(0x3f7f_ffff), -0.0];
        for (value, edge) in values.iter_mut().zip(edges) {
            *value = edge;
        }
        let table = SampleTable::new(extent, dims, values).unwrap();
        table.save(&path).unwrap();
        let back = SampleTable::load(&path).unwrap();
        assert_eq!(back.shape(), [frames, height, width, spp, dims]);
        assert_eq!(bits(&back), bits(&table));
        assert_eq!(names(home.path()), ["table.npy"]);
    }
}

#[test]
fn the_bytes_are_those_that_numpy_reads() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let values = (0..144).map(|i| i as f32 / 1000.0).collect();
    SampleTable::new(EXTENT, 3, values).unwrap().save(&path).unwrap();
    let bytes = fs::read(&path).unwrap();
    // Format version 1.0: magic, version, length of the rest of the header, dictionary, spaces, newline.
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!(header % 64, 0);
    let dictionary = std::str::from_utf8(&bytes[10..header]).unwrap();
    let expected = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4, 2, 3)";
    assert!(dictionary.starts_with(expected) && dictionary.ends_with('\n'), "{dictionary}");
    let rest = dictionary[expected.len()..].trim();
    assert!(rest == "}" || rest == ", }", "{dictionary}");
    assert_eq!(bytes.len(), header + 144 * 4);
    // [frame 1, y 2, x 3, sample 1, dim 2] is the last value; one sample earlier is 3 values earlier, one
    // pixel 6, one row 24, one frame 72.
    for (before, value) in [(0, 0.143_f32), (1, 0.142), (3, 0.140), (6, 0.137), (24, 0.119), (72, 0.071)] {
        let at = bytes.len() - 4 * (before + 1);
        assert_eq!(bytes[at..at + 4], value.to_le_bytes(), "{before} values before the last");
    }
}

#[test]
fn a_file_as_numpy_writes_it_is_read() {
    let read = load_bytes(&f32s("(1, 1, 2, 1, 2)", &[0.0, 0.25, 0.5, 0.75])).unwrap();
    assert_eq!(read.shape(), [1, 1, 2, 1, 2]);
    assert_eq!(read.values(), [0.0, 0.25, 0.5, 0.75]);
    // Versions 2 and 3 have four bytes of header length.
    for version in [2, 3] {
        let one = f32s("(1, 1, 1, 1, 1)", &[0.5]);
        let mut bytes = one[..8].to_vec();
        bytes[6] = version;
        bytes.extend([one[8], one[9], 0, 0]);
        bytes.extend(&one[10..]);
        assert_eq!(load_bytes(&bytes).unwrap().values(), [0.5]);
    }
}

#[test]
fn other_files_are_recognised() {
    assert_eq!(problem(b"", &["0 bytes", "write it again"]), FormatError::Truncated { bytes: 0, needed: 10 });
    assert_eq!(problem(b"\x93NUM", &["4 bytes"]), FormatError::Truncated { bytes: 4, needed: 10 });
    assert_eq!(
        problem(b"0.25 0.5\n0.75\n", &["0.25 0", "give a .npy file"]),
        FormatError::NotNpy { start: b"0.25 0".to_vec() }
    );
    assert_eq!(problem(b"hi", &["\"hi\""]), FormatError::NotNpy { start: b"hi".to_vec() });
    let mut future = f32s("(1, 1, 1, 1, 1)", &[0.5]);
    future[6] = 9;
    assert_eq!(problem(&future, &["9.0", "1.0, 2.0 or 3.0"]), FormatError::Version { major: 9, minor: 0 });
}

#[test]
fn damaged_headers_are_recognised() {
    let whole = f32s("(1, 1, 1, 1, 1)", &[0.5]);
    assert_eq!(problem(&whole[..100], &["100", "128"]), FormatError::Truncated { bytes: 100, needed: 128 });
    let absurd = b"\x93NUMPY\x02\x00\xff\xff\xff\xff{";
    let limit = 10_000;
    let announced = u64::from(u32::MAX);
    assert_eq!(
        problem(absurd, &["4294967295", "10000"]),
        FormatError::HeaderLength { bytes: announced, limit }
    );
    let short = b"\x93NUMPY\x02\x00\xff\xff\xff";
    assert_eq!(problem(short, &["11 bytes", "12"]), FormatError::Truncated { bytes: 11, needed: 12 });
    let empty = b"\x93NUMPY\x01\x00\x00\x00";
    assert!(matches!(problem(empty, &["newline"]), FormatError::Header { .. }));

    let nested = npy(&("[".repeat(60) + &"]".repeat(60)), &[]);
    assert!(matches!(problem(&nested, &["60 deep"]), FormatError::Header { .. }));
    // As deep as the parser is allowed to see, and as long: it must answer in a moment.
    let long = npy(&("[[[[".to_owned() + &"1,".repeat(4000)), &[]);
    assert!(matches!(problem(&long, &["not a dictionary"]), FormatError::Header { .. }));

    let many = f32s(&format!("({})", "1,".repeat(4000)), &[0.5]);
    assert!(matches!(problem(&many, &["4000 axes"]), FormatError::Header { .. }));

    for (dictionary, word) in [
        ("{'descr': '<f4', 'fortran_order': False}", "missing key: shape)"),
        ("{'descr': '<f4', 'fortran_order': 0, 'shape': (1,)}", "fortran_order: 0"),
        ("{'descr': '<f4', 'fortran_order': False, 'shape': [1, 2]}", "[1, 2]"),
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, -3)}", "-3"),
        (
            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999999,)}",
            "99999999999999999999999",
        ),
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (1,), 'colour': 1}", "colour"),
        ("{'descr': '<f4', 'fortran_order'", "'fortran_order'"),
        ("('<f4',)", "'<f4'"),
        ("\u{7f}\u{0}\u{e9}", "non-ascii"),
    ] {
        let problem = problem(&npy(dictionary, &[]), &[word, "numpy.save"]);
        assert!(matches!(problem, FormatError::Header { .. }), "{problem:?}");
    }
}

#[test]
fn other_types_and_orders_are_named() {
    for dtype in ["'<f8'", "'>f4'", "'|u1'", "'<f2'", "'<c8'", "'|O'", "[('a', '<f4', (2,))]"] {
        let dictionary = format!("{{'descr': {dtype}, 'fortran_order': False, 'shape': (1, 1, 1, 1, 1), }}");
        let found = problem(&npy(&dictionary, &[0; 8]), &[&dtype[..4], "astype('<f4')"]);
        assert!(matches!(found, FormatError::Dtype { .. }), "{found:?}");
    }
    let fortran = npy("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 1, 2, 1, 2), }", &[0; 16]);
    assert_eq!(
        problem(&fortran, &["[1, 1, 2, 1, 2]", "ascontiguousarray"]),
        FormatError::FortranOrder { shape: vec![1, 1, 2, 1, 2] }
    );
}

#[test]
fn other_shapes_are_named() {
    for (shape, axes) in
        [("()", vec![]), ("(1,)", vec![1]), ("(1, 1, 1, 1)", vec![1; 4]), ("(1, 1, 1, 1, 1, 1)", vec![1; 6])]
    {
        let count = format!("{} axes", axes.len());
        let problem = problem(&f32s(shape, &[0.5]), &[&count, "instead of 5", "reshape"]);
        assert_eq!(problem, FormatError::Axes { shape: axes });
    }
    assert_eq!(
        problem(&f32s("(1, 0, 4, 1, 2)", &[]), &["[1, 0, 4, 1, 2]", "height is 0", "at least 1"]),
        FormatError::Extent { shape: [1, 0, 4, 1, 2], problem: ExtentError::EmptyAxis { axis: "height" } }
    );
    // 2^64 - 1 on four axes: the product overflows any integer.
    let huge = f32s(&format!("({0}, {0}, {0}, {0}, 1)", u64::MAX), &[0.5]);
    #[cfg(target_pointer_width = "64")]
    assert_eq!(
        problem(&huge, &["18446744073709551615", "2147483647"]),
        FormatError::Extent {
            shape: [usize::MAX, usize::MAX, usize::MAX, usize::MAX, 1],
            problem: ExtentError::TooLarge { values: u64::MAX }
        }
    );
    // Just admissible, 8 GiB: refused for its length before any memory is asked for.
    let large = [1, 1, 32767, 65537, 1];
    assert_eq!(
        problem(&f32s("(1, 1, 32767, 65537, 1)", &[0.5]), &["4 bytes", "8589803516"]),
        FormatError::Length { given: 4, expected: 8_589_803_516, shape: large }
    );
    assert!(load_bytes(&huge).is_err());
}

#[test]
fn missing_and_trailing_data_are_counted() {
    let whole = f32s("(1, 1, 2, 1, 2)", &[0.0, 0.25, 0.5, 0.75]);
    let shape = [1, 1, 2, 1, 2];
    for cut in 1..=16 {
        let given = 16 - cut as u64;
        let found =
            problem(&whole[..whole.len() - cut], &[&format!("{given} bytes"), "takes 16", "write it again"]);
        assert_eq!(found, FormatError::Length { given, expected: 16, shape });
    }
    let mut longer = whole;
    longer.push(0);
    assert_eq!(problem(&longer, &["17 bytes"]), FormatError::Length { given: 17, expected: 16, shape });
}

#[test]
fn values_outside_the_range_are_located() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    for (bad, word) in
        [(nan, "NaN"), (inf, "inf"), (-inf, "-inf"), (1.0, "is 1:"), (-0.25, "-0.25"), (7.5, "7.5")]
    {
        let bytes = f32s("(1, 1, 2, 1, 2)", &[0.0, 0.25, 0.5, bad]);
        let found = problem(&bytes, &[word, "[frame 0, y 0, x 1, sample 0, dim 1]", "into [0, 1)"]);
        let FormatError::Value { at: [0, 0, 1, 0, 1], value } = found else { panic!("{found}") };
        assert_eq!(value.to_bits(), bad.to_bits());
    }
}

#[test]
fn what_is_not_a_file_is_not_read() {
    let home = tempdir().unwrap();
    let error = SampleTable::load(home.path()).unwrap_err();
    let name = home.path().file_name().unwrap().to_str().unwrap();
    assert_eq!(problem_of(error, name, &["not an ordinary file"]), FormatError::NotAFile);
    let error = SampleTable::load(home.path().join("absent.npy")).unwrap_err();
    assert!(
        error.to_string().contains("absent.npy") && error.to_string().contains("check the path"),
        "{error}"
    );
    assert!(matches!(error, TableError::Io { verb: "read", .. }), "{error:?}");
}

proptest! {
    /// Bytes overwritten, cut off and added anywhere: an error or a valid table, never a panic.
    #[test]
    fn damage_never_panics(
        edits in prop::collection::vec((0_usize..150, any::<u8>()), 0..6),
        cut in 0_usize..200,
        extra in prop::collection::vec(any::<u8>(), 0..3),
    ) {
        let mut bytes = f32s("(1, 1, 2, 1, 2)", &[0.0, 0.25, 0.5, 0.75]);
        let len = bytes.len();
        for (at, byte) in edits {
            bytes[at % len] = byte;
        }
        bytes.truncate(cut);
        bytes.extend(extra);
        match load_bytes(&bytes) {
            Ok(table) => prop_assert!(table.values().iter().all(|value| (0.0..1.0).contains(value))),
            Err(error) => prop_assert!(matches!(error, TableError::Format { .. }), "{error}"),
        }
    }

    /// The dictionary replaced by brackets, quotes, signs and digits, which exercises the parser.
    #[test]
    fn odd_dictionaries_never_panic(
        dictionary in "[\\[\\](){}'\"\\\\,:+\\-0-9jJxeEobuUN._ bTrueFalsdcf<4]{0,80}"
    ) {
        prop_assert!(load_bytes(&npy(&dictionary, &[0; 4])).is_err());
        let shape = npy(&format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {dictionary}}}"), &[]);
        prop_assert!(load_bytes(&shape).is_err());
    }
}

/// A directory with a table and its metadata, and their bytes.
fn saved() -> (TempDir, SampleTable, [Vec<u8>; 2]) {
    let home = tempdir().unwrap();
    let table = table(2);
    table.save_with(home.path().join("table.npy"), &metadata(&table)).unwrap();
    let bytes = ["table.npy", "table.json"].map(|name| fs::read(home.path().join(name)).unwrap());
    (home, table, bytes)
}

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

#[test]
fn a_table_cannot_have_the_name_of_its_metadata() {
    let home = tempdir().unwrap();
    let table = table(2);
    for name in ["table.json", "table.JSON", ".."] {
        let path = home.path().join(name);
        for error in [
            table.save(&path).unwrap_err(),
            table.save_with(&path, &metadata(&table)).unwrap_err(),
            SampleTable::load(&path).unwrap_err(),
            Metadata::load(&path).unwrap_err(),
        ] {
            let text = error.to_string();
            assert!(text.contains(name) && text.contains("ends in .npy"), "{text}");
            assert!(matches!(error, TableError::FileName { .. }), "{error:?}");
        }
    }
    assert!(matches!(table.save("").unwrap_err(), TableError::FileName { .. }));
    assert!(names(home.path()).is_empty());
}

#[test]
fn a_failed_save_leaves_everything_as_it_was() {
    let (home, old, bytes) = saved();
    let new = SampleTable::white_noise(EXTENT, 2, 8).unwrap();
    let refused = |path: &Path, word: &str| {
        for error in [new.save(path).unwrap_err(), new.save_with(path, &metadata(&new)).unwrap_err()] {
            let text = error.to_string();
            assert!(text.contains(word) && text.contains("check the path"), "{text}");
            assert!(matches!(error, TableError::Io { verb: "write", .. }), "{error:?}");
        }
    };
    refused(&home.path().join("absent/table.npy"), "there is no directory");
    // A file where a directory should be.
    refused(&home.path().join("table.npy/table.npy"), "cannot write");
    // A directory where the table should be.
    fs::create_dir(home.path().join("folder.npy")).unwrap();
    refused(&home.path().join("folder.npy"), "it is a directory");
    assert_eq!(names(home.path()), ["folder.npy", "table.json", "table.npy"]);
    fs::remove_dir(home.path().join("folder.npy")).unwrap();

    // A directory where the metadata should be: neither file is touched.
    fs::remove_file(home.path().join("table.json")).unwrap();
    fs::create_dir(home.path().join("table.json")).unwrap();
    let path = home.path().join("table.npy");
    let error = new.save_with(&path, &metadata(&new)).unwrap_err();
    assert!(error.to_string().contains("table.json: it is a directory"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), bytes[0]);
    assert_eq!(SampleTable::load(&path).unwrap(), old);
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
    assert!(names(&home.path().join("table.json")).is_empty());
}

#[cfg(unix)]
#[test]
fn saved_files_have_the_permissions_of_ordinary_files() {
    use std::os::unix::fs::PermissionsExt;
    let (home, ..) = saved();
    fs::write(home.path().join("ordinary"), "").unwrap();
    let mode = |name| fs::metadata(home.path().join(name)).unwrap().permissions().mode();
    assert_eq!([mode("table.npy"), mode("table.json")], [mode("ordinary"); 2]);
}

#[test]
fn saving_replaces_both_files() {
    let (home, ..) = saved();
    let path = home.path().join("table.npy");
    let new = table(5);
    new.save_with(&path, &metadata(&new)).unwrap();
    assert_eq!(SampleTable::load_with(&path).unwrap(), (new.clone(), metadata(&new)));
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
}
