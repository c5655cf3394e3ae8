//! `Checkpoint::read`: what is read can be looked at.

#![no_main]

use fsot::optimizer::Checkpoint;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(checkpoint) = Checkpoint::read(&mut &*bytes) {
        fsot_fuzz::check(&checkpoint.table());
        let _ = checkpoint.config();
    }
});
