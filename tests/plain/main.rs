//! Formats without a decoder: bare numbers, text, C and C++. Whoever reads them has only the documents' word
//! for where a number lies; these tests read them by that.

mod bare;
mod compiled;
mod memory;
mod refusals;
mod text;

use std::path::{Path, PathBuf};

use fsot::files::{Depth, ExportOptions, ExportRecord, Exported, Format, ImportOptions, Imported};
use fsot::{Extent, SampleTable};
use tempfile::{TempDir, tempdir};

/// Shapes that every format must hold: large, small, oblong, and with several samples.
fn shapes() -> [SampleTable; 4] {
    let oblong = Extent::animation(3, 20, 48);
    let several = Extent::still(7, 5).with_spp(2);
    [(Extent::animation(64, 128, 128), 2), (Extent::still(64, 64), 1), (oblong, 3), (several, 4)].map(table)
}

/// Those of them that tests read value by value.
fn small_shapes() -> [SampleTable; 3] {
    let [_, small @ ..] = shapes();
    small
}

/// White noise with the ends of the range in it.
fn table((extent, dims): (Extent, usize)) -> SampleTable {
    let mut values = SampleTable::white_noise(extent, dims, 5).unwrap().into_values();
    values[..5].copy_from_slice(&[0.0, 1.0_f32.next_down(), f32::from_bits(1), 1e-7, 0.5]);
    SampleTable::new(extent, dims, values).unwrap()
}

/// What a depth leaves of a value.
fn kept(value: f32, depth: Depth) -> f32 {
    match depth.levels() {
        Some(levels) => ((f64::from(value) * f64::from(levels)).floor() + 0.5) as f32 / levels as f32,
        // Only floats of 32 bits here.
        None => value,
    }
}

/// A table in a file of this name.
struct Home {
    home: TempDir,
    path: PathBuf,
    exported: Exported,
}

fn export(table: &SampleTable, name: &str, format: Format, depth: Depth) -> Home {
    let home = tempdir().unwrap();
    let path = home.path().join(name);
    let options = ExportOptions { depth: Some(depth), ..ExportOptions::new(format) };
    let exported = table.export(&path, &options).unwrap();
    Home { home, path, exported }
}

impl Home {
    /// The files alone, as somebody else gets them.
    fn without_record(self) -> Self {
        std::fs::remove_file(ExportRecord::path_beside(&self.path)).unwrap();
        self
    }

    fn import(&self, options: &ImportOptions) -> Imported {
        import(&self.path, options)
    }
}

fn import(path: &Path, options: &ImportOptions) -> Imported {
    SampleTable::import(path, options).unwrap_or_else(|error| panic!("{error}"))
}

/// All lengths of a table.
fn lengths(table: &SampleTable) -> ImportOptions {
    let [frames, height, width, spp, dims] = table.shape().map(Some);
    ImportOptions { frames, height, width, spp, dims, ..ImportOptions::default() }
}

fn assert_kept(found: &SampleTable, table: &SampleTable, depth: Depth, what: &str) {
    assert_eq!(found.shape(), table.shape(), "{what}");
    let differs =
        found.values().iter().zip(table.values()).position(|(found, value)| *found != kept(*value, depth));
    assert_eq!(differs, None, "{what}");
}

/// Everything that these formats hold.
const ALL: [(Format, &str, &[Depth]); 6] = [
    (Format::Raw, "mask.raw", &[Depth::F32, Depth::U16, Depth::U8]),
    (Format::Fast, "mask.bin", &[Depth::F32]),
    (Format::Pbrt, "mask.cpp", &[Depth::U16]),
    (Format::C, "mask.h", &[Depth::F32, Depth::U16, Depth::U8]),
    (Format::Csv, "mask.csv", &[Depth::F32]),
    (Format::Dat, "mask.dat", &[Depth::F32]),
];

#[test]
fn what_is_exported_is_imported_to_the_bits_that_it_has() {
    for table in shapes() {
        for (format, name, depths) in ALL {
            for &depth in depths {
                // A second is enough for the large one.
                if table.values().len() > 1 << 20 && (format, depth) == (Format::C, Depth::F32) {
                    continue;
                }
                let home = export(&table, name, format, depth);
                let imported = home.import(&ImportOptions::default());
                assert_kept(&imported.table, &table, depth, &format!("{format} {depth} {:?}", table.shape()));
                assert_eq!(imported.levels, depth.levels().map(u64::from));
                assert_eq!(home.exported.record.shape, table.shape());
            }
        }
    }
}

/// Five dimensions go to files of four, two samples to two files.
#[test]
fn several_files_make_one_table() {
    let table = table((Extent::animation(2, 4, 6).with_spp(2), 5));
    let home = export(&table, "mask.bin", Format::Fast, Depth::F32);
    let names: Vec<_> =
        home.exported.files.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["mask_s0_d0-3.bin", "mask_s0_d4.bin", "mask_s1_d0-3.bin", "mask_s1_d4.bin"]);
    assert_eq!(home.import(&ImportOptions::default()).table, table);
    // The record itself says as much.
    assert_eq!(import(&home.exported.record_path, &ImportOptions::default()).table, table);
}
