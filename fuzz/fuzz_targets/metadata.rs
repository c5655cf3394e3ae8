//! `SampleTable::load_with` and `Metadata::load`: a pair, or a refusal.

#![no_main]

use fsot::files::Metadata;
use fsot::{Extent, SampleTable};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = fsot_fuzz::file("table.json", bytes).with_extension("npy");
    let table = SampleTable::white_noise(Extent::still(2, 2), 2, 0).expect("a small table");
    if !path.exists() {
        table.save(&path).expect("a table to read");
    }
    let fits = Metadata::load(&path).is_ok_and(|metadata| metadata.check(&table).is_ok());
    assert_eq!(fits, SampleTable::load_with(&path).is_ok());
});
