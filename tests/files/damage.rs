//! What is no table is refused, with what to do.

use fsot::SampleTable;
use fsot::config::ExtentError;
use fsot::files::{FormatError, TableError};
use proptest::prelude::*;
use tempfile::tempdir;

use crate::{f32s, load_bytes, npy, problem, problem_of};

#[test]
fn other_files_are_recognised() {
    assert_eq!(problem(b"", &["0 bytes", "write it again"]), FormatError::Truncated { bytes: 0, needed: 10 });
    assert_eq!(problem(b"\x93NUM", &["4 bytes"]), FormatError::Truncated { bytes: 4, needed: 10 });
    let ragged = problem(b"0.25 0.5\n0.75\n", &["0.25 0", "line 2 has 1 numbers", "give --dims"]);
    assert!(matches!(ragged, FormatError::NotNpy { start, .. } if start == b"0.25 0"));
    let word = problem(b"hi", &["\"hi\"", "no numbers in it", "give a .npy file"]);
    assert!(matches!(word, FormatError::NotNpy { start, .. } if start == b"hi"));
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
    assert!(matches!(problem(empty, &["it is empty"]), FormatError::Header { .. }));

    let nested = npy(&("[".repeat(60) + &"]".repeat(60)), &[]);
    assert!(matches!(problem(&nested, &["not a dictionary"]), FormatError::Header { .. }));
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
        ("\u{7f}\u{0}\u{e9}", "unexpected"),
    ] {
        let problem = problem(&npy(dictionary, &[]), &[word, "numpy.save"]);
        assert!(matches!(problem, FormatError::Header { .. }), "{problem:?}");
    }
}

#[test]
fn other_types_and_orders_are_named() {
    let file = |dtype: &str| {
        let dictionary = format!("{{'descr': {dtype}, 'fortran_order': False, 'shape': (1, 1, 1, 1, 1), }}");
        move |size| npy(&dictionary, &vec![0; size])
    };
    for (dtype, size) in [("'<f8'", 8), ("'>f4'", 4), ("'<f2'", 2), ("float", 8)] {
        let quoted = format!("'{}'", dtype.trim_matches('\''));
        let found = problem(
            &file(&quoted)(size),
            &[dtype, "run `fsot import ", "table.npy --out ", "SampleTable::import"],
        );
        assert!(matches!(found, FormatError::Dtype { .. }), "{found:?}");
    }
    for dtype in ["'<c8'", "'|O'", "'<U4'", "'<f16'", "[('a', '<f4', (2,))]", "('<f4', (2,))"] {
        let found = problem(&file(dtype)(8), &[&dtype[..4], "no number of at most 64 bits", "numpy.save"]);
        assert!(matches!(found, FormatError::Dtype { .. }), "{found:?}");
    }
    let fortran = npy("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 1, 2, 1, 2), }", &[0; 16]);
    let found = problem(&fortran, &["[1, 1, 2, 1, 2]", "fsot import"]);
    assert!(matches!(found, FormatError::FortranOrder { shape, .. } if shape == [1, 1, 2, 1, 2]));
}

#[test]
fn other_shapes_are_named() {
    for (shape, axes) in
        [("()", vec![]), ("(1,)", vec![1]), ("(1, 1, 1, 1)", vec![1; 4]), ("(1, 1, 1, 1, 1, 1)", vec![1; 6])]
    {
        let count = format!("{} axes", axes.len());
        let problem = problem(&f32s(shape, &[0.5]), &[&count, "instead of 5", "fsot import"]);
        assert!(matches!(problem, FormatError::Axes { shape, .. } if shape == axes));
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
    let large = vec![1, 1, 32767, 65537, 1];
    assert_eq!(
        problem(&f32s("(1, 1, 32767, 65537, 1)", &[0.5]), &["4 bytes", "8589803516"]),
        FormatError::Length { given: 4, expected: 8_589_803_516, shape: large }
    );
    assert!(load_bytes(&huge).is_err());
}

#[test]
fn missing_and_trailing_data_are_counted() {
    let whole = f32s("(1, 1, 2, 1, 2)", &[0.0, 0.25, 0.5, 0.75]);
    let shape = vec![1, 1, 2, 1, 2];
    for cut in 1..=16 {
        let given = 16 - cut as u64;
        let found =
            problem(&whole[..whole.len() - cut], &[&format!("{given} bytes"), "takes 16", "write it again"]);
        assert_eq!(found, FormatError::Length { given, expected: 16, shape: shape.clone() });
    }
    let mut longer = whole;
    longer.push(0);
    assert_eq!(problem(&longer, &["17 bytes"]), FormatError::Length { given: 17, expected: 16, shape });
}

#[test]
fn values_outside_the_range_are_located() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    for (bad, word, advice) in [
        (nan, "NaN", "bring all values into [0, 1]"),
        (inf, "inf", "bring all values into [0, 1]"),
        (-inf, "-inf", "bring all values into [0, 1]"),
        (1.0, "is 1 ", "fsot import"),
        (-0.25, "-0.25", "bring all values into [0, 1]"),
        (7.5, "7.5", "bring all values into [0, 1]"),
    ] {
        let bytes = f32s("(1, 1, 2, 1, 2)", &[0.0, 0.25, 0.5, bad]);
        let found = problem(&bytes, &[word, "[frame 0, y 0, x 1, sample 0, dim 1]", advice]);
        let FormatError::Value { at: [0, 0, 1, 0, 1], value, .. } = found else { panic!("{found}") };
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
