//! Tables out of other people's files.

use std::fs;
use std::path::Path;

use fsot::files::{Axis, ImportError, ImportOptions, Imported, TableError};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::npy;

/// The largest `f32` below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

fn import_with(bytes: &[u8], options: &ImportOptions) -> Result<Imported, TableError> {
    let home = tempdir().unwrap();
    let path = home.path().join("file");
    fs::write(&path, bytes).unwrap();
    SampleTable::import(&path, options)
}

fn import(bytes: &[u8]) -> Imported {
    import_with(bytes, &ImportOptions::default()).unwrap()
}

/// Why not; the message is one line that names the file.
fn refusal(bytes: &[u8], options: &ImportOptions) -> ImportError {
    let error = import_with(bytes, options).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("file: ") && !text.contains('\n') && text.len() < 600, "{text}");
    match error {
        TableError::Import { problem, .. } => problem,
        other => panic!("{other}"),
    }
}

fn array(descr: &str, fortran: bool, shape: &[usize], values: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    npy(&format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({shape})}}"), values)
}

/// Little-endian bytes turned round, number by number.
fn turned(bytes: &[u8], size: usize) -> Vec<u8> {
    bytes.chunks_exact(size).flat_map(|number| number.iter().rev()).copied().collect()
}

/// A number type with its name, its bytes, and what 4 times 3 numbers of it become.
#[test]
fn every_type_and_byte_order_is_converted() {
    let quarters = [0.0, 0.25, 0.5, 0.75, 0.125, 1.0, 0.0, 0.25, 0.5, 0.75, 0.125, 1.0];
    let fractions: Vec<f32> = quarters.iter().map(|&value| (value as f32).min(BELOW_ONE)).collect();
    let ranks: Vec<f32> = (0..12).map(|rank| (rank as f32 + 0.5) / 12.0).collect();
    let f64s: Vec<u8> = quarters.iter().flat_map(|value: &f64| value.to_le_bytes()).collect();
    let f32s: Vec<u8> = quarters.iter().flat_map(|&value| (value as f32).to_le_bytes()).collect();
    // 0, 1/4, 1/2, 3/4, 1/8 and 1 in 16 bits: exponents 13, 14, 14, 12 and 15 over ten bits of mantissa.
    let halves = [0_u16, 0x3400, 0x3800, 0x3a00, 0x3000, 0x3c00].repeat(2);
    let f16s: Vec<u8> = halves.iter().flat_map(|value| value.to_le_bytes()).collect();
    let whole = |size: usize| -> Vec<u8> {
        (0..12_u64).flat_map(|rank| rank.to_le_bytes()[..size].to_vec()).collect()
    };
    let mut cases =
        vec![("f8", 8, f64s, &fractions), ("f4", 4, f32s, &fractions), ("f2", 2, f16s, &fractions)];
    for (name, size) in
        [("u1", 1), ("u2", 2), ("u4", 4), ("u8", 8), ("i1", 1), ("i2", 2), ("i4", 4), ("i8", 8)]
    {
        cases.push((name, size, whole(size), &ranks));
    }
    for (name, size, little, expected) in &cases {
        let shape = [3, 4];
        let axes = ImportOptions { axes: vec![Axis::Y, Axis::X], ..ImportOptions::default() };
        for (order, bytes) in [("<", little.clone()), (">", turned(little, *size)), ("=", little.clone())] {
            if order == "=" && cfg!(target_endian = "big") {
                continue;
            }
            let name = format!("{order}{name}");
            let file = array(&name, false, &shape, &bytes);
            let found = import_with(&file, &axes).unwrap();
            assert_eq!(found.table.shape(), [1, 3, 4, 1, 1], "{name}");
            assert_eq!(found.table.values(), expected.as_slice(), "{name}");
            assert_eq!(found.ones, if name.contains('f') { 2 } else { 0 }, "{name}");
            assert_eq!(found.levels, (!name.contains('f')).then_some(12), "{name}");
        }
    }
}

#[test]
fn values_of_16_and_8_bits_are_the_middles_of_their_levels() {
    let bytes: Vec<u8> = (0..64 * 64).map(|i| (i * 37 % 255 + i % 2) as u8).collect();
    let found = import(&array("|u1", false, &[64, 64], &bytes));
    assert_eq!(found.levels, Some(256));
    assert!(found.table.values().iter().zip(&bytes).all(|(v, byte)| *v == (f32::from(*byte) + 0.5) / 256.0));

    // Ranks of a mask, which would all be below 1/16 if they were taken for levels of their type.
    let ranks: Vec<u16> = (0..4096).map(|i| (i * 1001 % 4096) as u16).collect();
    let bytes: Vec<u8> = ranks.iter().flat_map(|rank| rank.to_le_bytes()).collect();
    let found = import(&array("<u2", false, &[64, 64], &bytes));
    assert_eq!((found.levels, found.first_level, found.table.shape()), (Some(4096), 0, [1, 64, 64, 1, 1]));
    assert!(found.table.values().iter().zip(&ranks).all(|(v, rank)| *v == (f32::from(*rank) + 0.5) / 4096.0));
    assert_eq!(found.to_string(), "<u2 of shape [64, 64] as y, x, 4096 levels as (v + 1/2) / 4096");

    // From 1, in doubles and in Fortran order, as from MATLAB.
    let doubles: Vec<u8> = ranks.iter().flat_map(|rank| (f64::from(*rank) + 1.0).to_le_bytes()).collect();
    let matlab = import(&array("<f8", true, &[64, 64], &doubles));
    assert_eq!((matlab.levels, matlab.first_level), (Some(4096), 1));
    for (y, x) in [(0, 0), (3, 5), (63, 1)] {
        let expected = (f32::from(ranks[x * 64 + y]) + 0.5) / 4096.0;
        assert_eq!(matlab.table.view()[[0, y, x, 0, 0]], expected);
    }

    let ten_bits: Vec<u8> = [0_u16, 17, 1000, 3].iter().flat_map(|value| value.to_le_bytes()).collect();
    let file = array("<u2", false, &[2, 2], &ten_bits);
    let options = ImportOptions { axes: vec![Axis::Y, Axis::X], ..ImportOptions::default() };
    assert_eq!(refusal(&file, &options), ImportError::Levels { greatest: 1000.0, suggested: 1024 });
    let found = import_with(&file, &ImportOptions { levels: Some(1024), ..options }).unwrap();
    assert_eq!(found.table.values(), [0.5, 17.5, 1000.5, 3.5].map(|level| level / 1024.0));
}

#[test]
fn no_double_becomes_one() {
    let below = [1.0_f64.next_down(), 1.0 - 1e-8, 1.0, 0.999_999_97];
    let bytes: Vec<u8> = below.iter().flat_map(|value| value.to_le_bytes()).collect();
    let found = import(&array("<f8", false, &[1, 1, 2, 1, 2], &bytes));
    // 2^-24 = 6e-8 below 1 is the next number; 3e-8 below is half way.
    assert_eq!(found.table.values(), [BELOW_ONE; 4]);
    assert_eq!(found.ones, 1);
}

/// All orders of three axes, in C and in Fortran order.
#[test]
fn axes_go_where_their_names_say() {
    let lengths = |axis: Axis| match axis {
        Axis::Frame => 2,
        Axis::Y => 3,
        Axis::X => 4,
        Axis::Sample => 5,
        Axis::Dim => 2,
    };
    for axes in [
        vec![Axis::Dim, Axis::Y, Axis::X],
        vec![Axis::X, Axis::Frame, Axis::Y],
        vec![Axis::Y, Axis::X, Axis::Sample, Axis::Dim, Axis::Frame],
        vec![Axis::X],
    ] {
        let shape: Vec<usize> = axes.iter().map(|&axis| lengths(axis)).collect();
        let count: usize = shape.iter().product();
        // The number at an index tells the index.
        let values: Vec<f32> = (0..count).map(|i| i as f32 / 256.0).collect();
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        for fortran in [false, true] {
            let options = ImportOptions { axes: axes.clone(), ..ImportOptions::default() };
            let found = import_with(&array("<f4", fortran, &shape, &bytes), &options).unwrap();
            for (index, value) in found.table.view().indexed_iter() {
                let index = [index.0, index.1, index.2, index.3, index.4];
                // Horner over the file's axes, from the slowest.
                let file: Vec<(usize, usize)> =
                    axes.iter().map(|&axis| (index[axis as usize], lengths(axis))).collect();
                let step = |at: usize, &(index, length): &(usize, usize)| at * length + index;
                let at = if fortran { file.iter().rev().fold(0, step) } else { file.iter().fold(0, step) };
                assert_eq!(*value, values[at], "{axes:?} {fortran} {index:?}");
            }
        }
    }
}

/// A mask of 4 × 4 ranks is 16 pixels, not four of four dimensions.
#[test]
fn small_squares_are_pictures() {
    for side in [2, 4, 8, 9, 16] {
        let ranks: Vec<u8> = (0..side * side).map(|rank| rank as u8).collect();
        let table = import(&array("|u1", false, &[side, side], &ranks)).table;
        assert_eq!(table.shape(), [1, side, side, 1, 1]);
        let [first, last] = [table.values()[0], table.values()[side * side - 1]];
        let half = 0.5 / (side * side) as f32;
        assert!(first == half && (1.0 - last - half).abs() < f32::EPSILON, "{side}: {first} {last}");
    }
}

#[test]
fn a_table_in_fortran_order_is_the_same_table() {
    let table = SampleTable::white_noise(Extent { frames: 2, height: 3, width: 4, spp: 2 }, 3, 1).unwrap();
    let reversed: Vec<u8> = table.view().t().iter().flat_map(|value| value.to_le_bytes()).collect();
    let found = import(&array("<f4", true, &[2, 3, 4, 2, 3], &reversed));
    assert_eq!(found.table, table);
    let whole: Vec<u8> = table.values().iter().flat_map(|value| value.to_le_bytes()).collect();
    assert_eq!(import(&array("<f4", false, &[1, 2, 3, 4, 2, 3], &whole)).table, table);
}

#[test]
fn text_is_read_line_by_line() {
    let shape =
        |text: &str, options: &ImportOptions| import_with(text.as_bytes(), options).unwrap().table.shape();
    let usual = ImportOptions::default();
    let lines: String = (0..16).map(|i| format!("0.{i:02} 0.5\n")).collect();
    assert_eq!(shape(&lines, &usual), [1, 4, 4, 1, 2]);
    assert_eq!(import(lines.as_bytes()).table.values()[..4], [0.0, 0.5, 0.01, 0.5]);
    // Other separators, comments, names of columns, blank lines, ends of lines, no last one.
    let decorated =
        format!("\u{feff}x,y\r\n# words\r\n\r\n{}", lines.replace(' ', " ,\t").replace('\n', "\r\n"));
    for text in [&decorated, decorated.trim_end(), &lines.replace(' ', ";"), &lines.replace('\n', " % end\n")]
    {
        assert_eq!(import(text.as_bytes()).table, import(lines.as_bytes()).table);
    }
    let options = |frames, spp| ImportOptions { frames, spp, ..ImportOptions::default() };
    assert_eq!(shape(&lines, &options(Some(4), None)), [4, 2, 2, 1, 2]);
    assert_eq!(shape(&lines, &options(None, Some(4))), [1, 2, 2, 4, 2]);
    // A picture of scalars, 20 numbers a line; all on one line, a list.
    let rows = "0.25 ".repeat(20) + "\n";
    assert_eq!(shape(&rows.repeat(3), &usual), [1, 3, 20, 1, 1]);
    assert_eq!(shape(&"0.25 ".repeat(25), &usual), [1, 5, 5, 1, 1]);
    // Broken as a terminal breaks lines.
    let broken = lines
        .split_whitespace()
        .collect::<Vec<_>>()
        .chunks(5)
        .map(|line| line.join(" ") + "\n")
        .collect::<String>();
    assert_eq!(refusal(broken.as_bytes(), &usual), ImportError::Ragged { line: 7, given: 2, expected: 5 });
    let dims = ImportOptions { dims: Some(2), ..ImportOptions::default() };
    assert_eq!(import_with(broken.as_bytes(), &dims).unwrap().table, import(lines.as_bytes()).table);

    let number = |line, text: &str| ImportError::Number { line, text: text.into() };
    assert_eq!(refusal(b"0.5\nhalf\n", &usual), number(2, "half"));
    assert_eq!(refusal(b"once upon\na time\n", &usual), number(2, "a"));
    assert_eq!(refusal(b"0.5 0.5.5\n", &usual), number(1, "0.5.5"));
    assert_eq!(refusal(b"\n \n# 1\n", &usual), ImportError::Empty);
    let error = import_with(b"", &usual).unwrap_err().to_string();
    assert!(error.contains("ends after 0 bytes"), "{error}");
    assert_eq!(refusal(&[b'1'; 1000], &usual), number(1, &"1".repeat(64)));
    assert!(matches!(refusal(b"0.5 nan\n", &usual), ImportError::Value { at: 1, .. }));
    assert_eq!(refusal(b"0.5 -0.5\n", &usual), ImportError::Value { at: 1, value: -0.5 });
    assert_eq!(refusal(b"0.5 1.5\n", &usual), ImportError::Value { at: 1, value: 1.5 });
    assert_eq!(
        refusal(b".5\n.5\n.5\n", &usual),
        ImportError::NoSquare { samples: 3, axis: "height", length: 1 }
    );
}

#[test]
fn what_import_writes_is_what_load_reads() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let table = SampleTable::white_noise(Extent::animation(3, 4, 5), 2, 1).unwrap();
    table.save(&path).unwrap();
    assert_eq!(SampleTable::import(&path, &ImportOptions::default()).unwrap().table, table);
    let error = SampleTable::import(Path::new("absent.npy"), &ImportOptions::default()).unwrap_err();
    assert!(matches!(error, TableError::Io { verb: "read", .. }), "{error}");
    let error = SampleTable::import(home.path(), &ImportOptions::default()).unwrap_err();
    assert!(matches!(error, TableError::Format { .. }), "{error}");
    fs::write(&path, &fs::read(&path).unwrap()[..200]).unwrap();
    let error = SampleTable::import(&path, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("write it again"), "{error}");
}
