//! Dither masks (Georgiev and Fajardo 2016), patterns shifted by them, and spatio-temporal blue noise (Wolfe
//! et al. 2022).

use fsot::metrics::{Integrands, Spectra};
use fsot::{SampleTable, Site};
use fsot_lab::samplers::{DitherMask, Pattern, Shifted, Stbn, TableSampler, WhiteNoise};

use crate::common::{all, errors, gaussian, low, tabulated, tile};

/// A mask for tests.
fn mask(dims: usize, sweeps: u64) -> SampleTable {
    let mut mask = DitherMask::new(tile(1, 64, 1), dims);
    mask.cooling.sweeps = sweeps;
    mask.table().unwrap()
}

#[test]
fn masks_of_one_and_two_dimensions_lack_low_frequencies() {
    for (dims, most) in [(1, 0.1), (2, 0.3)] {
        let (before, after) = (low(&mask(dims, 0)), low(&mask(dims, 150)));
        // The start has the same values in random order: white within five standard deviations.
        assert!((before - 1.0).abs() < 5.0 * 0.125, "{dims}: {before}");
        // 7 and 5.6 standard deviations below white noise.
        assert!(after < most, "{dims}: {after}");
    }
}

#[test]
fn a_mask_fills_its_interval_evenly() {
    let mut values = mask(1, 5).into_values();
    values.sort_by(f32::total_cmp);
    for (i, value) in values.iter().enumerate() {
        assert_eq!((value * 4096.0) as usize, i);
    }
}

#[test]
fn a_lattice_shifted_by_a_mask_is_dithered() {
    let mask = mask(2, 150);
    let extent = tile(1, 64, 4);
    let lattice = || Pattern::korobov(4, 2).unwrap();
    let dithered = tabulated(&Shifted::new(lattice(), TableSampler::new(&mask)), extent, 2);
    let white = tabulated(&Shifted::new(lattice(), WhiteNoise::new(3)), extent, 2);
    // 4096 pixels of the same pattern: unfiltered errors agree within a few percent, far below white noise's
    // 1.
    let [[dithered_alone, dithered_after, _], [white_alone, white_after, _]] =
        [&dithered, &white].map(|table| errors(table, &gaussian(), 16));
    assert!((dithered_alone / white_alone - 1.0).abs() < 0.15, "{dithered_alone} {white_alone}");
    assert!(white_alone < 0.75, "{white_alone}");
    // About 300 independent filtered pixels: a mean square has a standard deviation of 8 %, so this is almost
    // four.
    assert!(dithered_after < 0.7 * white_after, "{dithered_after} {white_after}");
}

/// Power of the error along time at a pixel, in the lower and upper half of the frequencies, white noise 1.
fn halves_in_time(table: &SampleTable) -> [f64; 2] {
    let integrands = Integrands::random(table.dims(), 16, 5).unwrap();
    let spectrum = Spectra::measure(table, &all(table), &integrands).unwrap().xt;
    let frames = table.extent().frames;
    let mut sums = [(0.0, 0.0); 2];
    for ((row, _), power) in spectrum.indexed_iter() {
        let frequency = row.abs_diff(frames / 2);
        if frequency > 0 {
            let half = &mut sums[usize::from(4 * frequency > frames)];
            *half = (half.0 + power, half.1 + 1.0);
        }
    }
    sums.map(|(sum, count)| sum / count)
}

#[test]
fn stbn_is_blue_in_every_frame_and_at_every_pixel() {
    for dims in [1, 2] {
        let mut mask = Stbn::new(tile(16, 32, 1), dims);
        mask.cooling.sweeps = 60;
        let table = mask.table().unwrap();
        // A frame of 32 × 32 has 32 low frequencies; over 16 frames 256 conjugate pairs: white noise is 1 ±
        // 0.0625.
        let low = low(&table);
        assert!(low < [0.2, 0.6][dims - 1], "{dims}: {low}");
        // The lower half in time has 1024 × 3 conjugate pairs: white noise is 1 ± 0.018. Yet a filter in time
        // needs far less power there than above, and gets it.
        let [slow, fast] = halves_in_time(&table);
        assert!(slow < [0.8, 0.9][dims - 1] && fast > 1.1, "{dims}: {slow} {fast}");
    }
}

#[test]
fn scalar_stbn_has_every_rank_once() {
    let table = Stbn::new(tile(3, 10, 1), 1).table().unwrap();
    let mut ranks: Vec<usize> = table.values().iter().map(|value| (value * 300.0) as usize).collect();
    ranks.sort_unstable();
    assert_eq!(ranks, (0..300).collect::<Vec<usize>>());
    assert_eq!(table.sample(Site { frame: 0, y: 0, x: 0 }, 0).len(), 1);
}
