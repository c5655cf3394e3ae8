//! The functions whose mean and variance over the unit cube have a closed form.

use std::f64::consts::PI;

use super::volume;

/// A function. Coordinates that a function doesn't name are free.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum IntegrandKind {
    /// 1 where `normal · x < offset`.
    HalfSpace { normal: Vec<f64>, offset: f64 },
    /// `gradient · x`.
    Linear { gradient: Vec<f64> },
    /// `cos(2π (wave · x + phase))`; the wave vector in cycles per unit length.
    Cosine { wave: Vec<f64>, phase: f64 },
    /// `exp(-|x_axes - centre|² / (2 deviation²))`.
    Bump { axes: Vec<usize>, centre: Vec<f64>, deviation: f64 },
    /// 1 where `|x_axes - centre| < radius`. With three axes or more it must lie inside the cube.
    Ball { axes: Vec<usize>, centre: Vec<f64>, radius: f64 },
    /// 1 where `lower ≤ x_axes < upper`, componentwise; `0 ≤ lower ≤ upper ≤ 1`.
    Box { axes: Vec<usize>, lower: Vec<f64>, upper: Vec<f64> },
}

impl IntegrandKind {
    /// Mean and variance over the unit cube.
    pub fn moments(&self) -> (f64, f64) {
        let indicator = |volume: f64| (volume, volume * (1.0 - volume));
        match self {
            Self::HalfSpace { normal, offset } => indicator(volume::half_space(normal, *offset)),
            Self::Linear { gradient } => {
                (0.5 * gradient.iter().sum::<f64>(), gradient.iter().map(|g| g * g).sum::<f64>() / 12.0)
            }
            Self::Cosine { wave, phase } => {
                let mean = mean_cosine(wave, *phase, 1.0);
                // cos² a = (1 + cos 2a) / 2
                (mean, 0.5 * (1.0 + mean_cosine(wave, *phase, 2.0)) - mean * mean)
            }
            Self::Bump { centre, deviation, .. } => {
                let product = |deviation| -> f64 {
                    centre.iter().map(|&centre| volume::gaussian(centre, deviation)).product()
                };
                // The square of a Gaussian is a Gaussian narrower by √2.
                let (mean, mean_sq) = (product(*deviation), product(deviation * 0.5_f64.sqrt()));
                (mean, mean_sq - mean * mean)
            }
            Self::Ball { centre, radius, .. } => indicator(match **centre {
                [x] => ((x + radius).min(1.0) - (x - radius).max(0.0)).max(0.0),
                [x, y] => volume::disc_in_square([x, y], *radius),
                _ => volume::ball(centre.len(), *radius),
            }),
            Self::Box { lower, upper, .. } => {
                indicator(lower.iter().zip(upper).map(|(lower, upper)| upper - lower).product())
            }
        }
    }

    /// Value at a point of the cube.
    #[inline]
    pub fn value(&self, point: &[f64]) -> f64 {
        let inside = |yes: bool| f64::from(u8::from(yes));
        match self {
            Self::HalfSpace { normal, offset } => inside(dot(normal, point) < *offset),
            Self::Linear { gradient } => dot(gradient, point),
            Self::Cosine { wave, phase } => (2.0 * PI * (dot(wave, point) + phase)).cos(),
            Self::Bump { axes, centre, deviation } => {
                (-distance_sq(point, axes, centre) / (2.0 * deviation * deviation)).exp()
            }
            Self::Ball { axes, centre, radius } => inside(distance_sq(point, axes, centre) < radius * radius),
            Self::Box { axes, lower, upper } => inside(
                axes.iter().zip(lower.iter().zip(upper)).all(|(&d, (l, u))| (l..u).contains(&&point[d])),
            ),
        }
    }
}

/// Mean over the cube of `cos(2π · multiple · (wave · x + phase))`: a product of sincs, turned to its
/// mid-phase.
fn mean_cosine(wave: &[f64], phase: f64, multiple: f64) -> f64 {
    let sinc = |t: f64| if t.abs() < 1e-8 { 1.0 } else { (PI * t).sin() / (PI * t) };
    let amplitude: f64 = wave.iter().map(|k| sinc(multiple * k)).product();
    amplitude * (2.0 * PI * multiple * (phase + 0.5 * wave.iter().sum::<f64>())).cos()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Squared distance from `centre` in the subspace of `axes`.
fn distance_sq(point: &[f64], axes: &[usize], centre: &[f64]) -> f64 {
    axes.iter().zip(centre).map(|(&d, c)| (point[d] - c) * (point[d] - c)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{Integrand, Integrands};
    use crate::random;

    /// 50 integrands of every family against 2^15 random points: the estimate of the mean is within 5
    /// standard errors, that of the variance within 5 of its own (from the sample's fourth moment). Under the
    /// normal law one of the 1600 checks fails with probability 1e-3; the seed is fixed.
    #[test]
    fn closed_forms_agree_with_monte_carlo() {
        const POINTS: usize = 1 << 15;
        for dims in [1, 2, 3, 5] {
            let points: Vec<f64> = random::uniforms(9, POINTS * dims).into_iter().map(f64::from).collect();
            let set = Integrands::random(dims, 50, 4).unwrap();
            for integrand in set.iter() {
                let mean_of = |f: &dyn Fn(f64) -> f64| {
                    points.chunks_exact(dims).map(|x| f(integrand.value(x))).sum::<f64>() / POINTS as f64
                };
                let (integral, variance) = (integrand.integral(), integrand.variance());
                let error = mean_of(&|v| v) - integral;
                let allowed = 5.0 * (variance / POINTS as f64).sqrt();
                assert!(error.abs() < allowed, "mean of {integrand:?} is off by {error}");
                let spread = mean_of(&|v| (v - integral).powi(2));
                let fourth = mean_of(&|v| (v - integral).powi(4));
                let error = spread - variance;
                // The last term is for indicators of one half, whose squared deviation does not vary at all.
                let allowed = 5.0 * ((fourth - spread * spread).max(0.0) / POINTS as f64).sqrt() + 2e-4;
                assert!(error.abs() < allowed, "variance of {integrand:?} is off by {error}");
            }
        }
    }

    #[test]
    fn smooth_moments_agree_with_quadrature() {
        let kinds = [
            IntegrandKind::Linear { gradient: vec![0.6, -0.8] },
            IntegrandKind::Cosine { wave: vec![1.7, -0.4], phase: 0.3 },
            IntegrandKind::Cosine { wave: vec![0.0, 1.0], phase: 0.1 },
            IntegrandKind::Bump { axes: vec![1, 0], centre: vec![0.1, 0.7], deviation: 0.2 },
        ];
        for kind in kinds {
            let integrand = Integrand::known(kind, 2);
            let (mut sum, mut sum_sq) = (0.0, 0.0);
            const STEPS: usize = 1000;
            for cell in 0..STEPS * STEPS {
                let at = |i: usize| (i as f64 + 0.5) / STEPS as f64;
                let value = integrand.value(&[at(cell / STEPS), at(cell % STEPS)]);
                sum += value;
                sum_sq += value * value;
            }
            let cells = (STEPS * STEPS) as f64;
            let mean = sum / cells;
            // Midpoint rule: h² / 24 times the integral of the Laplacian, at most 4 (2π · 1.75)² here.
            assert!((mean - integrand.integral()).abs() < 2.1e-5, "{integrand:?}: {mean}");
            let variance = sum_sq / cells - mean * mean;
            assert!((variance - integrand.variance()).abs() < 4e-5, "{integrand:?}: {variance}");
        }
    }

    #[test]
    fn indicators_are_half_open_where_the_cube_is() {
        let halves = IntegrandKind::Box { axes: vec![0], lower: vec![0.0], upper: vec![0.5] };
        let integrand = Integrand::known(halves, 2);
        assert_eq!(integrand.value(&[0.0, 0.9]), 1.0);
        assert_eq!(integrand.value(&[0.5, 0.9]), 0.0);
        assert_eq!((integrand.integral(), integrand.variance()), (0.5, 0.25));
    }
}
