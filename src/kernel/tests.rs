//! Facts about kernels: taps, folding, conventions.

use approx::assert_relative_eq;

use super::*;
use crate::error::RangeError;

const TILE: Extent = Extent { frames: 10, height: 64, width: 64, spp: 1 };

fn paper() -> SpatialKernel {
    SpatialKernel::Gaussian { sigma_px: 2.1 }
}

fn mean_size(taps: &[Tap]) -> f64 {
    taps.iter().map(|tap| tap.weight).sum()
}

#[test]
fn the_papers_gaussian_has_97_taps_of_13_8_in_the_mean() {
    let taps = Kernel::product(paper(), TemporalKernel::None).taps(&TILE).unwrap();
    assert_eq!(taps.len(), 97);
    assert_relative_eq!(mean_size(&taps), 13.8, epsilon = 0.05); // design: 13.8 samples per slice
    assert_eq!(taps[0], Tap { dt: 0, dy: 0, dx: 0, weight: 1.0 });
    for tap in &taps {
        let expected = (-f64::from(tap.dx * tap.dx + tap.dy * tap.dy) / (2.1 * 2.1)).exp();
        assert_relative_eq!(tap.weight, expected, max_relative = 1e-8);
    }
}

#[test]
fn level_sets_are_whole_shells() {
    let taps = Kernel::product(paper(), TemporalKernel::None).taps(&TILE).unwrap();
    let weight_at = |dy, dx| taps.iter().find(|tap| (tap.dy, tap.dx) == (dy, dx)).unwrap().weight;
    assert_eq!(weight_at(0, 5), weight_at(3, -4)); // both at r² = 25
    assert_eq!(weight_at(1, 2), weight_at(-2, 1));
}

#[test]
fn both_gaussian_conventions_meet() {
    let ours = Kernel::product(paper(), TemporalKernel::None).taps(&TILE).unwrap();
    let deviation = SpatialKernel::gaussian_from_deviation(2.1 / 2.0_f64.sqrt());
    let other = Kernel::product(deviation, TemporalKernel::None).taps(&TILE).unwrap();
    assert_eq!(ours.len(), other.len());
    for (a, b) in ours.iter().zip(&other) {
        assert_relative_eq!(a.weight, b.weight, max_relative = 1e-8);
    }
}

#[test]
fn perceptual_taps_are_those_of_the_paper_at_60_fps() {
    // The first five of Korać et al.'s fifteen taps, as quoted in the project's design notes.
    let expected = [
        0.039_558_285_065_590_9,
        0.398_409_765_599_820,
        0.404_689_211_439_515,
        0.177_879_764_807_883,
        0.041_913_619_519_731_5,
    ];
    let taps = TemporalKernel::Perceptual { fps: 60.0 }.taps().unwrap();
    assert_eq!(taps.len(), expected.len());
    for (tap, expected) in taps.iter().zip(expected) {
        assert!((tap - expected).abs() < 1e-14, "{tap} {expected}");
    }
    for fps in [3.0, 5e-324] {
        assert_eq!(TemporalKernel::Perceptual { fps }.taps().unwrap(), [1.0]);
    }
}

#[test]
fn the_perceptual_kernel_peaks_two_frames_back() {
    let taps = Kernel::product(paper(), TemporalKernel::Perceptual { fps: 60.0 }).taps(&TILE).unwrap();
    assert_eq!(taps[0], Tap { dt: -2, dy: 0, dx: 0, weight: 1.0 });
    // Sum of the five taps over the largest, times the spatial mean size: 36 samples per slice.
    assert_relative_eq!(mean_size(&taps), 36.3, epsilon = 0.2);
}

#[test]
fn temporal_families_have_their_textbook_taps() {
    assert_eq!(TemporalKernel::Binomial { frames: 4 }.taps().unwrap(), [1.0 / 3.0, 1.0, 1.0, 1.0 / 3.0]);
    assert_eq!(TemporalKernel::Box { frames: 3 }.taps().unwrap(), [1.0; 3]);
    let ema = TemporalKernel::Ema { alpha: 0.1 }.taps().unwrap();
    for (k, tap) in ema.iter().enumerate() {
        assert_relative_eq!(*tap, 0.9_f64.powi(k as i32), max_relative = 1e-12);
    }
    assert_eq!(TemporalKernel::Ema { alpha: 1.0 }.taps().unwrap(), [1.0]);
    let gaussian = TemporalKernel::Gaussian { sigma_frames: 2.0 }.taps().unwrap();
    assert_relative_eq!(gaussian[2], (-1.0_f64).exp());
}

#[test]
fn wide_kernels_fold_onto_the_tile_once() {
    let extent = Extent { frames: 3, height: 5, width: 4, spp: 1 };
    let kernel = Kernel { spatial: paper(), temporal: TemporalKernel::Ema { alpha: 0.2 }, truncation: 0.0 };
    let taps = kernel.taps(&extent).unwrap();
    assert_eq!(taps.len(), extent.sites());
    // Brute force over all images; the common factor is the weight of the largest tap.
    let images = |tap: &Tap| {
        let mut sum = 0.0;
        for back in (0..200).filter(|back| (back + tap.dt).rem_euclid(3) == 0) {
            for dy in (-40..=40).filter(|dy| (dy - tap.dy).rem_euclid(5) == 0) {
                for dx in (-40..=40).filter(|dx| (dx - tap.dx).rem_euclid(4) == 0) {
                    sum += 0.8_f64.powi(back) * (-f64::from(dx * dx + dy * dy) / 2.1_f64.powi(2)).exp();
                }
            }
        }
        sum
    };
    let largest = images(&taps[0]);
    for tap in &taps {
        assert_relative_eq!(tap.weight, images(tap) / largest, max_relative = 1e-8);
    }
}

#[test]
fn extreme_widths_end_as_one_tap_or_as_a_constant() {
    let with = |sigma_px| Kernel::product(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
    assert_eq!(with(0.01).taps(&TILE).unwrap().len(), 1);
    let wide = with(1000.0).taps(&TILE).unwrap();
    assert_eq!(wide.len(), 64 * 64);
    assert!(wide.iter().all(|tap| (tap.weight - 1.0).abs() < 1e-9));
}

#[test]
fn boxes_binomials_and_custom_taps_stand_where_documented() {
    let offsets = |spatial| -> Vec<_> {
        let taps = Kernel::product(spatial, TemporalKernel::None).taps(&TILE).unwrap();
        taps.iter().map(|tap| (tap.dy, tap.dx, tap.weight)).collect()
    };
    assert_eq!(
        offsets(SpatialKernel::Box { size_px: 2 }),
        [(0, 0, 1.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 1.0)]
    );
    let binomial = offsets(SpatialKernel::Binomial { size_px: 3 });
    assert_eq!(binomial[0], (0, 0, 1.0));
    assert_eq!(binomial[1], (-1, 0, 0.5));
    assert_eq!(binomial[8].2, 0.25);
    let tap = |dy, dx, weight| SpatialTap { dy, dx, weight };
    let custom = SpatialKernel::Taps(vec![tap(0, 0, 1.0), tap(-1, 63, 2.0), tap(-1, -1, 2.0)]);
    assert_eq!(offsets(custom), [(-1, -1, 1.0), (0, 0, 0.25)]);
}

#[test]
fn separate_is_two_kernels() {
    let [space, time] = Kernel::separate(paper(), TemporalKernel::Box { frames: 3 });
    assert!(space.taps(&TILE).unwrap().iter().all(|tap| tap.dt == 0));
    let time = time.taps(&TILE).unwrap();
    assert!(time.iter().all(|tap| (tap.dy, tap.dx) == (0, 0)));
    assert_eq!(time.len(), 3);
}

#[test]
fn bad_parameters_are_named() {
    let taps = |spatial, temporal| Kernel::product(spatial, temporal).taps(&TILE).unwrap_err();
    for sigma_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = taps(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
        assert!(matches!(error, KernelError::Range(RangeError { name: "sigma_px", .. })), "{error}");
    }
    for alpha in [0.0, 1.1, f64::NAN] {
        let error = taps(paper(), TemporalKernel::Ema { alpha });
        assert!(matches!(error, KernelError::Range(RangeError { name: "alpha", .. })), "{error}");
    }
    let error = taps(paper(), TemporalKernel::Taps(vec![1.0, -0.5]));
    assert_eq!(error, KernelError::BadTap { kernel: "the temporal kernel", index: 1, weight: -0.5 });
    let error = taps(SpatialKernel::Taps(vec![]), TemporalKernel::None);
    assert_eq!(error, KernelError::Empty { kernel: "the spatial kernel" });
    for temporal in [TemporalKernel::Box { frames: 0 }, TemporalKernel::Binomial { frames: 0 }] {
        assert!(matches!(taps(paper(), temporal), KernelError::Range(RangeError { value: 0.0, .. })));
    }
    assert!(matches!(
        taps(paper(), TemporalKernel::Perceptual { fps: 0.0 }),
        KernelError::Range(RangeError { name: "fps", .. })
    ));
    let kernel = Kernel { truncation: 1.0, ..Kernel::product(paper(), TemporalKernel::None) };
    assert!(matches!(kernel.taps(&TILE), Err(KernelError::Range(RangeError { name: "truncation", .. }))));
}
