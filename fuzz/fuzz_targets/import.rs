//! `SampleTable::import`, of arrays, of text and of C; the first bytes choose options.

#![no_main]

use fsot::SampleTable;
use fsot::files::{Axis, ImportOptions};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&[chosen, axes, levels], bytes)) = bytes.split_first_chunk() else { return };
    let length = |bit: u8| (chosen >> bit & 1 == 1).then_some(usize::from(axes & 7));
    let options = ImportOptions {
        axes: Axis::ALL.into_iter().filter(|axis| axes >> *axis as u8 & 1 == 1).collect(),
        levels: (levels > 0).then(|| 1 << (levels % 64)),
        frames: length(0),
        height: length(1),
        width: length(2),
        spp: length(3),
        dims: length(4),
        channels: length(5),
        dtype: ["u1", "<u2", ">f4", "<f8"][usize::from(axes & 3)].parse().ok().filter(|_| chosen >> 6 == 3),
        array: (levels == 7).then(|| "a".into()),
    };
    let path = fsot_fuzz::file("array", bytes);
    for options in [ImportOptions::default(), options] {
        if let Ok(imported) = SampleTable::import(&path, &options) {
            fsot_fuzz::check(&imported.table);
        }
    }
});
