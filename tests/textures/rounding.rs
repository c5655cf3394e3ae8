//! What levels cost, and what rounding can do about it.

use allocation_counter::measure;
use fsot::config::Work;
use fsot::files::{Depth, ExportOptions, Format, Rounding};
use fsot::metrics::{FilteredError, Integrand, Integrands};
use fsot::{Config, Extent, Kernel, SampleTable, Until};
use tempfile::tempdir;

use crate::ALL;

/// How often each of 256 levels is there, in each dimension and frame.
fn counts(table: &SampleTable) -> Vec<u32> {
    let [frames, _, _, _, dims] = table.shape();
    let mut counts = vec![0; frames * dims * 256];
    let of_frame = table.values().len() / frames;
    for (at, value) in table.values().iter().enumerate() {
        counts[(at / of_frame * dims + at % dims) * 256 + (value * 256.0) as usize] += 1;
    }
    counts
}

/// Finished tables have each level equally often; 8 bits keep it so, whichever way they are rounded.
#[test]
fn levels_stay_equally_often() {
    for (extent, dims) in [(Extent::still(32, 32), 2), (Extent::still(16, 16).with_spp(4), 1)] {
        let table = Config::new(extent, dims).optimize(Until::Sweeps(8)).unwrap();
        let each = (extent.samples() / 256) as u32;
        for rounding in Rounding::ALL {
            let counts = counts(&table.quantized(Depth::U8, rounding));
            assert!(counts.iter().all(|&count| count == each), "{rounding}: {counts:?}");
        }
    }
}

/// Whatever a table is like, diffusion leaves as many of each level, and errs by three quarters of a level at
/// most.
#[test]
fn diffusion_exchanges_levels() {
    for (extent, dims) in [(Extent::animation(3, 9, 7).with_spp(3), 2), (Extent::still(1, 40), 1)] {
        let table = SampleTable::white_noise(extent, dims, 3).unwrap();
        let [floor, diffused] = Rounding::ALL.map(|rounding| table.quantized(Depth::U8, rounding));
        assert_eq!(counts(&floor), counts(&diffused));
        let errors = diffused.values().iter().zip(table.values()).map(|(read, value)| (read - value).abs());
        assert!(errors.fold(0.0, f32::max) <= 0.75 / 256.0 + 1e-6);
        assert_eq!(table.quantized(Depth::F32, Rounding::Diffuse), table);
    }
}

/// A number that is used as it is, such as the start of a ray march, is where diffusion helps: of the error
/// that rounding adds under the filter, it leaves less than a quarter.
#[test]
fn diffusion_lowers_the_filtered_error_of_rounding() {
    let work = Until::Work(Work { sweeps: 32, ..Work::default() });
    let table = Config::new(Extent::still(64, 64).with_spp(4), 2).optimize(work).unwrap();
    let linear = |dim: usize| Integrand::new(2, move |x| x[dim], 0.5, 1.0 / 12.0).unwrap();
    let integrands = Integrands::own(2, "linear", vec![linear(0), linear(1)]).unwrap();
    let error = |table: &SampleTable| {
        let error = FilteredError::measure(table, &[0, 1], &integrands, &Kernel::gaussian(2.1));
        error.unwrap().spatial.mean.mean
    };
    let [before, floor, diffused] = [
        error(&table),
        error(&table.quantized(Depth::U8, Rounding::Floor)),
        error(&table.quantized(Depth::U8, Rounding::Diffuse)),
    ];
    println!("{before:.6} in the table, {floor:.6} by floor, {diffused:.6} diffused");
    assert!(floor > before, "{before} {floor}");
    assert!(diffused - before < 0.25 * (floor - before), "{before} {floor} {diffused}");
}

/// The largest table that is spoken of, as textures of four channels: beside the table, rows and buffers
/// alone; diffusion keeps two bytes a value.
#[test]
fn exports_hold_no_second_table() {
    let table = SampleTable::white_noise(Extent::animation(64, 128, 128), 4, 1).unwrap();
    let bytes = size_of_val(table.values()) as u64;
    let home = tempdir().unwrap();
    for (format, name, _) in ALL {
        let options = ExportOptions::new(format);
        let used = measure(|| drop(table.export(home.path().join(name), &options).unwrap()));
        // An EXR file keeps its blocks' places, a PNG the state of its packer.
        assert!(used.bytes_max < bytes / 8, "{format}: {} of {bytes}", used.bytes_max);
    }
    let options = ExportOptions { rounding: Rounding::Diffuse, ..ExportOptions::new(Format::Ktx2) };
    let used = measure(|| drop(table.export(home.path().join("mask.ktx2"), &options).unwrap()));
    assert!(used.bytes_max < bytes * 5 / 8, "{} of {bytes}", used.bytes_max);
}
