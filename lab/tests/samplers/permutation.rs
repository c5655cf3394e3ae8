//! Pixels that choose among estimates, and seeds that move between frames (Heitz and Belcour 2019).

use fsot::metrics::Spectra;
use fsot::{SampleTable, Site};
use fsot_lab::render::{Film, Reference, Scene, render, render_frame};
use fsot_lab::samplers::{DitherMask, OwenSobol, Sampler, SeedPermutation, histogram_sampling};
use ndarray::ArrayView3;

use crate::common::tile;

const RESOLUTION: [usize; 2] = [64, 64];

fn mask() -> SampleTable {
    let mut mask = DitherMask::new(tile(1, 64, 1), 1);
    mask.cooling.sweeps = 100;
    mask.table().unwrap()
}

/// Share of low frequencies in a picture's error, each pixel's relative to its standard deviation; white
/// noise 1.
fn low(picture: &[f64], truth: &[f64], variance: &[f64]) -> f64 {
    let quiet = 0.01 * variance.iter().sum::<f64>() / 4096.0;
    let scaled: Vec<f64> = (0..4096)
        .map(|i| if variance[i] > 0.0 { (picture[i] - truth[i]) / (variance[i] + quiet).sqrt() } else { 0.0 })
        .collect();
    let power = scaled.iter().map(|error| error * error).sum::<f64>() / 4096.0;
    let image = ArrayView3::from_shape((1, 64, 64), &scaled).unwrap();
    Spectra::of_image(image, power).low_frequency_share(0.1)
}

#[test]
fn a_histogram_of_estimates_is_dithered() {
    let scene = Scene::by_name("soft_shadow").unwrap();
    let reference = Reference::render(&scene, RESOLUTION, 512).unwrap();
    let films: Vec<Film> =
        (0..16).map(|seed| render(&scene, &OwenSobol::new(seed), RESOLUTION, 1).unwrap()).collect();
    let estimates: Vec<&[f64]> = films.iter().map(Film::values).collect();
    let mask = mask();
    let chosen = histogram_sampling(&estimates, mask.values()).unwrap();
    let share = |picture: &[f64]| low(picture, reference.mean.values(), reference.variance.values());
    let (before, after) = (share(estimates[0]), share(&chosen));
    assert!((before - 1.0).abs() < 5.0 * 0.125, "{before}");
    // Over five standard deviations below white noise.
    assert!(after < 0.375, "{after}");
    // What is chosen is one of the estimates.
    assert!((0..4096).all(|i| estimates.iter().any(|estimate| estimate[i] == chosen[i])));
}

/// Share of low frequencies in the error of frame 13, while the camera turns around the scene: the mean over
/// eight permutations that have nothing in common.
fn later_frame(degrees_per_frame: f64) -> f64 {
    let mut scene = Scene::by_name("soft_shadow").unwrap();
    let eye = scene.camera.eye;
    let mask = mask();
    let mut all: Vec<SeedPermutation> =
        (0..8).map(|seed| SeedPermutation::new(RESOLUTION, &mask, seed).unwrap()).collect();
    let sorted = |seeds: &SeedPermutation| {
        let mut sorted = seeds.seeds().to_vec();
        sorted.sort_unstable();
        sorted
    };
    let before: Vec<Vec<u32>> = all.iter().map(sorted).collect();
    let mut shares = Vec::new();
    for frame in 0..14 {
        let (sin, cos) = (degrees_per_frame * f64::from(frame)).to_radians().sin_cos();
        scene.camera.eye = [cos * eye.x + sin * eye.z, eye.y, cos * eye.z - sin * eye.x].into();
        let reference = (frame == 13).then(|| Reference::render(&scene, RESOLUTION, 256).unwrap());
        for seeds in &mut all {
            let film = render_frame(&scene, 0, &*seeds, RESOLUTION, 1).unwrap();
            if let Some(Reference { mean, variance, .. }) = &reference {
                shares.push(low(film.values(), mean.values(), variance.values()));
            }
            seeds.advance(film.values()).unwrap();
        }
    }
    assert_eq!(all.iter().map(sorted).collect::<Vec<_>>(), before, "seeds are permuted, never lost");
    shares.iter().sum::<f64>() / 8.0
}

#[test]
fn the_next_frame_is_bluer_on_a_still_scene_and_less_so_under_motion() {
    // The mean over eight frames of white noise is 1 ± 0.044: five of them.
    let still = later_frame(0.0);
    assert!(still < 1.0 - 5.0 * 0.044, "{still}");
    // A turn by a quarter exchanges what pixels see: three deviations of a difference.
    let moving = later_frame(90.0);
    assert!(moving > still + 3.0 * 0.062, "{moving} {still}");
}

#[test]
fn seeds_follow_the_mask_where_all_pixels_integrate_the_same() {
    let mask = mask();
    let mut seeds = SeedPermutation::new(RESOLUTION, &mask, 1).unwrap();
    let picture = |seeds: &SeedPermutation| -> Vec<f64> {
        let value = |i: usize| f64::from(seeds.sample(Site { frame: 0, y: i / 64, x: i % 64 }, 0, 0));
        (0..4096).map(value).collect()
    };
    let share = |values: &[f64]| low(values, &[0.5; 4096], &[1.0 / 12.0; 4096]);
    let before = share(&picture(&seeds));
    for _ in 0..16 {
        seeds.advance(&picture(&seeds)).unwrap();
    }
    let after = share(&picture(&seeds));
    assert!((before - 1.0).abs() < 5.0 * 0.125, "{before}");
    assert!(after < 0.375, "{after}");
}

#[test]
fn the_sampler_gives_a_pixel_the_sequence_of_its_seed() {
    let seeds = SeedPermutation::new(RESOLUTION, &mask(), 1).unwrap();
    let at = |frame, y, x, sample, dim| seeds.sample(Site { frame, y, x }, sample, dim);
    assert_eq!(at(0, 3, 5, 0, 1), at(9, 3, 5, 0, 1));
    assert_eq!(at(0, 3, 5, 0, 1), at(0, 67, 69, 0, 1));
    assert_ne!(at(0, 3, 5, 0, 1), at(0, 3, 6, 0, 1));
    assert_ne!(at(0, 3, 5, 0, 1), at(0, 3, 5, 1 << 16, 1));
}
