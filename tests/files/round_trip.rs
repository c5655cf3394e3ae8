//! What is read is what was written.

use std::fs;

use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{EXTENT, bits, f32s, load_bytes, names};

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
