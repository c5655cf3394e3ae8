//! Random integrands: the distribution of their parameters.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::integrand::Integrand;
use super::integrand_kind::IntegrandKind;
use super::integrands::Family;
use crate::random::{Purpose, generator};

/// The families of [`super::Integrands::random`]. Their order names their random numbers.
#[derive(Clone, Copy)]
pub(super) enum DrawnFamily {
    HalfSpace,
    Smooth,
    Ball,
    Box,
}

/// Integrands of less variance are not drawn: an indicator has it at volumes below 0.1 % and above 99.9 %.
/// Their ratios to white noise are those of a few lucky samples.
///
/// The rare small half-spaces above it count: in the plane 8 % of the family have a volume below 1 % or above
/// 99 %, and theirs is the part of the ratio that no filter of a few pixels can reduce.
const MIN_VARIANCE: f64 = 0.001;

/// Bumps, balls and boxes constrain at most this many coordinates, drawn at random: in more, a body inside
/// the cube has next to no volume. Half-spaces, linear functions and cosines use all.
const MAX_AXES: usize = 4;

impl DrawnFamily {
    pub const ALL: [Self; 4] = [Self::HalfSpace, Self::Smooth, Self::Ball, Self::Box];

    pub fn name(self) -> &'static str {
        match self {
            Self::HalfSpace => Family::HALF_SPACE,
            Self::Smooth => Family::SMOOTH,
            Self::Ball => Family::BALL,
            Self::Box => Family::BOX,
        }
    }

    /// The integrand of this number.
    pub fn integrand(self, seed: u64, index: usize, dims: usize) -> Integrand {
        let mut random = generator(seed, Purpose::Integrands, self as u64, index as u64);
        loop {
            let integrand = Integrand::known(draw(self, index, dims, &mut random), dims);
            if integrand.variance() >= MIN_VARIANCE {
                return integrand;
            }
        }
    }
}

fn draw(family: DrawnFamily, index: usize, dims: usize, random: &mut Xoshiro256PlusPlus) -> IntegrandKind {
    match family {
        DrawnFamily::HalfSpace => {
            let normal = direction(dims, random);
            let low: f64 = normal.iter().map(|n| n.min(0.0)).sum();
            let high: f64 = normal.iter().map(|n| n.max(0.0)).sum();
            IntegrandKind::HalfSpace { offset: between(low, high, random), normal }
        }
        DrawnFamily::Smooth => match index % 3 {
            0 => IntegrandKind::Linear { gradient: direction(dims, random) },
            1 => {
                let frequency = between(0.25, 2.0, random);
                let wave = direction(dims, random).into_iter().map(|w| w * frequency).collect();
                IntegrandKind::Cosine { wave, phase: random.random() }
            }
            _ => {
                let axes = axes(dims, random);
                let centre = axes.iter().map(|_| random.random()).collect();
                IntegrandKind::Bump { axes, centre, deviation: between(0.1, 0.5, random) }
            }
        },
        DrawnFamily::Ball => {
            let axes = axes(dims, random);
            let (smallest, clipped) = if axes.len() <= 2 { (0.1, true) } else { (0.25, false) };
            let radius = between(smallest, 0.5, random);
            let margin = if clipped { 0.0 } else { radius };
            let centre = axes.iter().map(|_| between(margin, 1.0 - margin, random)).collect();
            IntegrandKind::Ball { axes, centre, radius }
        }
        DrawnFamily::Box => {
            let axes = axes(dims, random);
            let side = |_| {
                let side = between(0.2, 0.8, random);
                let lower = between(0.0, 1.0 - side, random);
                (lower, lower + side)
            };
            let (lower, upper) = axes.iter().map(side).unzip();
            IntegrandKind::Box { axes, lower, upper }
        }
    }
}

/// Uniform on the unit sphere of `dims` dimensions.
fn direction(dims: usize, random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    loop {
        let normal: Vec<f64> = (0..dims).map(|_| random.sample(StandardNormal)).collect();
        let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        // Zero, and lengths whose square is subnormal, would lose the direction.
        if length > 1e-100 {
            return normal.into_iter().map(|n| n / length).collect();
        }
    }
}

/// All axes, or a uniform choice of [`MAX_AXES`] of them.
fn axes(dims: usize, random: &mut Xoshiro256PlusPlus) -> Vec<usize> {
    let mut axes: Vec<usize> = (0..dims).collect();
    for chosen in 0..MAX_AXES.min(dims) {
        axes.swap(chosen, random.random_range(chosen..dims));
    }
    axes.truncate(MAX_AXES);
    axes
}

fn between(low: f64, high: f64, random: &mut Xoshiro256PlusPlus) -> f64 {
    low + (high - low) * random.random::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dimension_gets_integrands_of_some_variance() {
        for dims in [1, 2, 3, 4, 7, 16] {
            for family in DrawnFamily::ALL {
                for index in 0..64 {
                    let integrand = family.integrand(1, index, dims);
                    assert_eq!(integrand.dims(), dims);
                    assert!(integrand.variance() >= MIN_VARIANCE, "{integrand:?}");
                }
            }
        }
    }
}
