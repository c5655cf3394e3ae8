//! Exports stream: what they hold at once is less than the table.

use allocation_counter::measure;
use fsot::files::ExportOptions;
use fsot::{Extent, SampleTable};
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
