//! Exports stream: what they hold at once is less than the table.

use allocation_counter::measure;
use fsot::files::{Depth, ExportOptions, Rounding};
use fsot::metrics::{Bias, FilteredError, Integrands};
use fsot::{Extent, Kernel, SampleTable};
use tempfile::tempdir;

use crate::ALL;

#[test]
fn no_export_holds_a_second_table() {
    let table = SampleTable::white_noise(Extent::animation(16, 64, 64), 4, 1).unwrap();
    let bytes = size_of_val(table.values()) as u64;
    let home = tempdir().unwrap();
    for (format, name, _) in ALL {
        let path = home.path().join(name);
        let used = measure(|| drop(table.export(&path, &ExportOptions::new(format)).unwrap()));
        // Rows, buffers and the record; a sixteenth of a small table, and no more of a large one.
        assert!(used.bytes_max < bytes / 16, "{format}: {} of {bytes}", used.bytes_max);
        // And none for each number.
        assert!(used.count_total < 20_000, "{format}: {} allocations", used.count_total);
    }
}

/// What an export costs is measured without a second table either: a copy of a pair in `f64` would be one.
#[test]
fn what_levels_cost_is_measured_where_the_table_lies() {
    let table = SampleTable::white_noise(Extent::animation(64, 64, 64), 4, 1).unwrap();
    let bytes = size_of_val(table.values()) as u64;
    let integrands = Integrands::random(2, 1, 0).unwrap();
    let eye = Kernel::gaussian(2.1);
    let used = measure(|| {
        FilteredError::measure_frames(&table, &[0, 1], &integrands, &eye, 4).unwrap();
        Bias::measure(&table, &[0, 1], &integrands).unwrap();
    });
    assert!(used.bytes_max < bytes / 4, "{} of {bytes}", used.bytes_max);
    let mut table = Some(table);
    let used = measure(|| table = table.take().map(|table| table.into_quantized(Depth::U8, Rounding::Floor)));
    assert!(used.bytes_max < bytes / 64, "{} of {bytes}", used.bytes_max);
}
