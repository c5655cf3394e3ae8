//! Scrambling keys arranged by the errors that they cause (Heitz et al. 2019).

use fsot::SampleTable;
use fsot::metrics::{FilteredError, Integrands};
use fsot_lab::samplers::{OwenSobol, ScramblingKeys};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::common::{errors, gaussian, tabulated, tile};

/// The first samples of every pixel.
fn first(table: &SampleTable, spp: usize) -> SampleTable {
    let extent = fsot::Extent { spp, ..table.extent() };
    let per_pixel = table.values().chunks_exact(table.extent().spp * table.dims());
    let values = per_pixel.flat_map(|pixel| &pixel[..spp * table.dims()]).copied().collect();
    SampleTable::new(extent, table.dims(), values).unwrap()
}

/// The pixels in random order.
fn shuffled(table: &SampleTable, seed: u64) -> SampleTable {
    let mut pixels: Vec<&[f32]> = table.values().chunks_exact(table.extent().spp * table.dims()).collect();
    pixels.shuffle(&mut Xoshiro256PlusPlus::seed_from_u64(seed));
    SampleTable::new(table.extent(), table.dims(), pixels.concat()).unwrap()
}

#[test]
fn filtered_errors_fall_and_unfiltered_errors_stay() {
    let mut keys = ScramblingKeys::new(tile(1, 64, 4), 2);
    (keys.cooling.sweeps, keys.integrands) = (100, 64);
    let table = keys.table().unwrap();
    // Arranged for 4 samples, ranked for 2 and 1. The integrands are others than those that were learnt.
    for (spp, most) in [(4, 0.75), (2, 0.8), (1, 0.8)] {
        let table = first(&table, spp);
        let [alone, after, _] = errors(&table, &gaussian(), 16);
        let white: Vec<[f64; 3]> =
            (0..8).map(|seed| errors(&shuffled(&table, seed), &gaussian(), 16)).collect();
        // Without the filter pixels are as good as with white keys: five errors of the ratio of two means
        // over 4096 pixels.
        let plain = tabulated(&OwenSobol::new(9), tile(1, 64, spp), 2);
        let [usual, ..] = errors(&plain, &gaussian(), 16);
        assert!((alone / usual - 1.0).abs() < 5.0 * (4.0_f64 / 4096.0).sqrt(), "{spp} spp: {alone} {usual}");
        let mean = white.iter().map(|errors| errors[1]).sum::<f64>() / 8.0;
        let spread: f64 = white.iter().map(|errors| (errors[1] - mean).powi(2)).sum();
        let deviation = (spread / 7.0).sqrt();
        // Eight arrangements know their deviation to a quarter: five of them are certain.
        assert!(after < mean - 5.0 * deviation, "{spp} spp: {after}, {mean} ± {deviation}");
        assert!(after < most * mean, "{spp} spp: {after}, {mean} ± {deviation}");
    }
}

/// Where there are too many dimensions for so few pixels to arrange, the keys are no worse than white ones.
#[test]
fn many_dimensions_fall_back_to_uncorrelated_errors() {
    let mut keys = ScramblingKeys::new(tile(1, 32, 4), 12);
    (keys.cooling.sweeps, keys.integrands) = (50, 32);
    let table = keys.table().unwrap();
    let pair = |table: &SampleTable, dims: &[usize]| {
        let integrands = Integrands::random(2, 16, 0).unwrap();
        let found = FilteredError::measure(table, dims, &integrands, &gaussian()).unwrap();
        found.spatial.mean.mean
    };
    for dims in [[0, 1], [10, 11]] {
        let white: Vec<f64> = (0..8).map(|seed| pair(&shuffled(&table, seed), &dims)).collect();
        let mean = white.iter().sum::<f64>() / 8.0;
        let deviation = (white.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / 7.0).sqrt();
        let arranged = pair(&table, &dims);
        assert!(arranged < mean + 5.0 * deviation, "{dims:?}: {arranged}, {mean} ± {deviation}");
    }
}
