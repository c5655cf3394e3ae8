//! `SampleTable::load`: a table, or a refusal.

#![no_main]

use fsot::SampleTable;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(table) = SampleTable::load(fsot_fuzz::file("table.npy", bytes)) {
        fsot_fuzz::check(&table);
    }
});
