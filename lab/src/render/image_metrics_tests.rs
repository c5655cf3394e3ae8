use approx::assert_relative_eq;
use fsot::Extent;

use super::*;
use crate::render::{Scene, render};
use crate::samplers::WhiteNoise;

fn constant(shape: [usize; 3], value: f64) -> Film {
    Film::new(shape, vec![value; shape.iter().product()]).unwrap()
}

/// A reference of a constant image with the given variance of one sample.
fn grey(shape: [usize; 3], mean: f64, variance: f64) -> Reference {
    Reference {
        mean: constant(shape, mean),
        standard_error: constant(shape, 0.0),
        variance: constant(shape, variance),
    }
}

#[test]
fn a_constant_error_passes_every_filter_also_at_the_borders() {
    let shape = [6, 9, 14];
    let reference = grey(shape, 0.5, 1.0);
    let film = constant(shape, 0.75);
    let temporal = TemporalKernel::Perceptual { fps: 60.0 };
    let found = compare(&film, &reference, 4, &temporal).unwrap();
    assert_relative_eq!(found.mse.value, 0.0625, max_relative = 1e-12);
    for figure in [found.rel_mse, found.p_rel_mse, found.p_rel_mse_wide] {
        assert_relative_eq!(figure.value, 0.0625 / 0.26, max_relative = 1e-12);
    }
    assert_relative_eq!(found.mse.white, 0.25, max_relative = 1e-12);
    assert_relative_eq!(found.rmse_ratio(), 0.5, max_relative = 1e-12);
}

#[test]
fn a_cosine_is_damped_by_the_gaussians_transform() {
    // Σ exp(−k²/σ²) cos(ωk) / Σ exp(−k²/σ²) = exp(−ω²σ²/4) up to aliasing of exp(−π²σ²) ≈ 1e-19: the middle
    // of a wide image shows it, far from the borders.
    let width = 120;
    let omega = std::f64::consts::TAU / 12.0;
    let wave = |x: usize| (omega * x as f64).cos();
    let film = Film::new([1, 40, width], (0..40 * width).map(|i| wave(i % width)).collect()).unwrap();
    for sigma in [2.1_f64, 2.1 * 2.0_f64.sqrt()] {
        let filtered = ImageFilter::gaussian(sigma).unwrap().apply(&film).unwrap();
        let damped = (-omega * omega * sigma * sigma / 4.0).exp();
        for x in 40..80 {
            assert_relative_eq!(filtered.values()[20 * width + x], damped * wave(x), epsilon = 1e-8);
        }
    }
}

#[test]
fn white_noise_is_damped_by_the_sum_of_squared_weights() {
    // In the middle Σ w² of a sampled Gaussian is 1/(2πσ²) per plane, for w ∝ exp(−r²/σ²).
    let variance = constant([1, 41, 41], 1.0);
    let filtered = ImageFilter::gaussian(2.1).unwrap().apply_to_variance(&variance).unwrap();
    let expected = 1.0 / (std::f64::consts::TAU * 2.1 * 2.1);
    assert_relative_eq!(filtered.values()[20 * 41 + 20], expected, max_relative = 1e-6);
    // A corner keeps a quarter of the taps: about four times the variance.
    let corner = filtered.values()[0] / expected;
    assert!(corner > 2.0 && corner < 4.0, "{corner}");
}

#[test]
fn the_temporal_filter_looks_back() {
    let mut film = constant([4, 1, 1], 0.0);
    film.values_mut()[1] = 1.0;
    let taps = TemporalKernel::Taps(vec![1.0, 2.0, 5.0]);
    let filtered = ImageFilter::identity().with_temporal(&taps).unwrap().apply(&film).unwrap();
    assert_eq!(filtered.values(), [2.0 / 8.0, 5.0 / 8.0]); // frames 2 and 3
    let error =
        ImageFilter::identity().with_temporal(&TemporalKernel::Box { frames: 5 }).unwrap().apply(&film);
    assert!(matches!(error, Err(RenderError::TooShort { frames: 4, needed: 5 })));
}

#[test]
fn the_image_filter_is_the_kernel_of_the_optimiser() {
    let kernel = fsot::Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, TemporalKernel::None);
    let taps = kernel.taps(&Extent { frames: 1, height: 64, width: 64, spp: 1 }).unwrap();
    let mut impulse = constant([1, 64, 64], 0.0);
    impulse.values_mut()[32 * 64 + 32] = 1.0;
    let spread = ImageFilter::gaussian(2.1).unwrap().apply(&impulse).unwrap();
    let middle = spread.values()[32 * 64 + 32];
    for tap in taps {
        let at = ((32 + tap.dy) * 64 + 32 + tap.dx) as usize;
        assert_relative_eq!(spread.values()[at] / middle, tap.weight, max_relative = 1e-8);
    }
}

#[test]
fn shapes_must_agree() {
    let reference = grey([1, 4, 4], 0.5, 1.0);
    let error = compare(&constant([1, 4, 5], 0.5), &reference, 1, &TemporalKernel::None).unwrap_err();
    assert!(matches!(error, RenderError::Shape { given: [1, 4, 5], expected: [1, 4, 4], .. }), "{error}");
}

#[test]
fn white_noise_has_ratio_one() {
    // The analytic expectation against 64 drawn images: each ratio is within 4 of its standard errors of 1.
    let scene = Scene::by_name("soft_shadow").unwrap();
    let resolution = [32, 32];
    let reference = Reference::render(&scene, resolution, 2048).unwrap();
    for spp in [1, 4] {
        let seeds = 64;
        let ratios: Vec<[f64; 4]> = (0..seeds)
            .map(|seed| {
                let film = render(&scene, &WhiteNoise::new(seed), resolution, spp).unwrap();
                let found = compare(&film, &reference, spp, &TemporalKernel::None).unwrap();
                [found.mse, found.rel_mse, found.p_rel_mse, found.p_rel_mse_wide].map(|f| f.ratio())
            })
            .collect();
        for figure in 0..4 {
            let n = seeds as f64;
            let mean = ratios.iter().map(|r| r[figure]).sum::<f64>() / n;
            let spread = ratios.iter().map(|r| (r[figure] - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let error = (spread / n).sqrt();
            assert!((mean - 1.0).abs() < 4.0 * error && error < 0.1, "{spp} spp: {figure}: {mean} ± {error}");
        }
    }
}
