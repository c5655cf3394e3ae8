//! Textures: what is written is read back, and a decoder that is not ours finds every number where the
//! documents say.
#![cfg(feature = "image")]

mod broken;
mod foreign;
mod open_exr;
mod places;
mod refusals;
mod rounding;
mod sets;

use std::path::{Path, PathBuf};

use fsot::files::{Depth, ExportOptions, Exported, Format, ImportOptions, Imported, Rounding};
use fsot::{Extent, SampleTable};
use tempfile::{TempDir, tempdir};

/// All formats of this kind, with a name and the numbers that they hold.
const ALL: [(Format, &str, &[Depth]); 5] = [
    (Format::Atlas, "mask.png", &[Depth::U8, Depth::U16]),
    (Format::Slices, "mask.png", &[Depth::U8, Depth::U16]),
    (Format::Ktx2, "mask.ktx2", &[Depth::U8, Depth::U16, Depth::Half, Depth::F32]),
    (Format::Exr, "mask.exr", &[Depth::F32, Depth::Half]),
    (Format::ExrLayers, "mask.exr", &[Depth::F32, Depth::Half]),
];

/// Shapes that every format must hold: large, small, oblong, with several samples, with many dimensions.
fn shapes() -> [SampleTable; 5] {
    let oblong = Extent::animation(3, 20, 48);
    let several = Extent::still(7, 5).with_spp(2);
    let many = Extent::animation(2, 3, 4).with_spp(2);
    let large = Extent::animation(64, 128, 128);
    [(large, 2), (Extent::still(64, 64), 1), (oblong, 3), (several, 4), (many, 7)].map(table)
}

/// White noise with the ends of the range in it.
fn table((extent, dims): (Extent, usize)) -> SampleTable {
    let mut values = SampleTable::white_noise(extent, dims, 5).unwrap().into_values();
    // 0.99999 is nearest to 1 in half precision.
    values[..6].copy_from_slice(&[0.0, 1.0_f32.next_down(), f32::from_bits(1), 1e-7, 0.99999, 0.5]);
    SampleTable::new(extent, dims, values).unwrap()
}

/// The level of a value, or its bits in floating point.
fn number(value: f32, depth: Depth) -> u32 {
    match depth {
        Depth::U8 => (value * 256.0).floor() as u32,
        Depth::U16 => (value * 65536.0).floor() as u32,
        Depth::Half => half::f16::from_f32(value).to_bits().min(0x3bff).into(),
        Depth::F32 => value.to_bits(),
    }
}

/// What a depth leaves of a value.
fn kept(value: f32, depth: Depth) -> f32 {
    match depth {
        Depth::U8 => (number(value, depth) as f32 + 0.5) / 256.0,
        Depth::U16 => (number(value, depth) as f32 + 0.5) / 65536.0,
        Depth::Half => half::f16::from_bits(number(value, depth) as u16).to_f32(),
        Depth::F32 => value,
    }
}

/// A table in a file of this name.
struct Home {
    home: TempDir,
    path: PathBuf,
    exported: Exported,
}

fn export(table: &SampleTable, name: &str, format: Format, depth: Depth) -> Home {
    let options = ExportOptions { depth: Some(depth), ..ExportOptions::new(format) };
    export_as(table, name, &options)
}

fn export_as(table: &SampleTable, name: &str, options: &ExportOptions) -> Home {
    let home = tempdir().unwrap();
    let path = home.path().join(name);
    let exported = table.export(&path, options).unwrap();
    Home { home, path, exported }
}

fn import(path: &Path) -> Imported {
    SampleTable::import(path, &ImportOptions::default()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn what_is_written_is_read_back() {
    for table in shapes() {
        for (format, name, depths) in ALL {
            for &depth in depths {
                let Home { path, exported, home: _home } = export(&table, name, format, depth);
                let imported = import(&path);
                let case = format!("{format} of {depth}, {:?}", table.shape());
                assert_eq!(imported.table.shape(), table.shape(), "{case}");
                let is_kept = |(read, value): (&f32, &f32)| *read == kept(*value, depth);
                assert!(imported.table.values().iter().zip(table.values()).all(is_kept), "{case}");
                assert_eq!(imported.table, table.quantized(depth, Rounding::Floor), "{case}");
                assert_eq!(imported.record.as_ref(), Some(&exported.record_path), "{case}");
                assert_eq!(import(&exported.record_path).table, imported.table, "{case}");
            }
        }
    }
}

/// Without the record the numbers are the same where the shape is plain: one file, dimensions that fill the
/// channels.
#[test]
fn a_plain_file_needs_no_record() {
    for extent in [Extent::still(64, 64), Extent::animation(3, 20, 20)] {
        for dims in [1, 2, 4] {
            let table = table((extent, dims));
            for (format, name, depths) in ALL {
                for &depth in depths {
                    let Home { exported, home: _home, .. } = export(&table, name, format, depth);
                    if exported.files.len() > 1 {
                        continue;
                    }
                    let [file] = &exported.files[..] else { panic!() };
                    std::fs::remove_file(&exported.record_path).unwrap();
                    let imported = import(file);
                    assert_eq!(imported.record, None);
                    assert_eq!(imported.table, table.quantized(depth, Rounding::Floor), "{format}, {depth}");
                }
            }
        }
    }
}

/// Only as many suffixes as are needed.
#[test]
fn files_are_called_by_what_they_hold() {
    let file_names = |frames, spp, dims, format, name: Option<&str>| {
        let table = table((Extent::animation(frames, 4, 6).with_spp(spp), dims));
        let options = ExportOptions { name: name.map(String::from), ..ExportOptions::new(format) };
        let Home { exported, home, .. } = export_as(&table, "a b.png", &options);
        let listed =
            exported.files.iter().map(|file| file.file_name().unwrap().to_str().unwrap().to_string());
        let listed: Vec<String> = listed.collect();
        let mut sorted = [listed.clone(), vec!["a b.png.json".into()]].concat();
        sorted.sort();
        assert_eq!(names(home.path()), sorted);
        listed
    };
    assert_eq!(file_names(3, 1, 2, Format::Atlas, None), ["a b.png"]);
    assert_eq!(file_names(1, 2, 4, Format::Atlas, None), ["a b_s0.png", "a b_s1.png"]);
    assert_eq!(file_names(1, 1, 9, Format::Atlas, None), ["a b_d0-3.png", "a b_d4-7.png", "a b_d8.png"]);
    let both = ["a b_s0_d0-3.png", "a b_s0_d4.png", "a b_s1_d0-3.png", "a b_s1_d4.png"];
    assert_eq!(file_names(1, 2, 5, Format::Atlas, None), both);
    let slices = ["a b_vec2_2Dx1D_6x4x2_0.png", "a b_vec2_2Dx1D_6x4x2_1.png"];
    assert_eq!(file_names(2, 1, 2, Format::Slices, None), slices);
    assert_eq!(file_names(1, 1, 1, Format::Slices, None), ["a b_scalar_2Dx1D_6x4x1_0.png"]);
    let own = Some("{frames}.{frame}~{kind}{sample}of{dims}");
    assert_eq!(file_names(2, 1, 3, Format::Slices, own), ["2.0~vec30of0-2.png", "2.1~vec30of0-2.png"]);
}
