//! Scrambling keys arranged by the errors that they cause (Heitz et al. 2019).

use fsot::SampleTable;
use fsot::sampler::ScramblingKeys;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::common::{errors, gaussian, tile};

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
        for [other, ..] in &white {
            assert!((alone / other - 1.0).abs() < 1e-9, "the same pixels, {spp} spp: {alone} {other}");
        }
        let mean = white.iter().map(|errors| errors[1]).sum::<f64>() / 8.0;
        let spread: f64 = white.iter().map(|errors| (errors[1] - mean).powi(2)).sum();
        let deviation = (spread / 7.0).sqrt();
        // Eight arrangements know their deviation to a quarter: five of them are certain.
        assert!(after < mean - 5.0 * deviation, "{spp} spp: {after}, {mean} ± {deviation}");
        assert!(after < most * mean, "{spp} spp: {after}, {mean} ± {deviation}");
    }
}
