//! Families of test integrands, and the distribution of their parameters.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::integrand::{Integrand, Shape};
use crate::error::ConfigError;
use crate::random::{Purpose, generator};

/// Kinds of integrands, from what renderers integrate: edges, shading, highlights and lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Half-planes and half-spaces: the edge of an occluder.
    HalfSpace,
    /// Linear functions, cosines and Gaussian bumps in equal shares.
    Smooth,
    /// Discs and balls.
    Ball,
    /// Axis-parallel boxes.
    Box,
}

impl Family {
    /// All four, in the order of reports.
    pub const ALL: [Self; 4] = [Self::HalfSpace, Self::Smooth, Self::Ball, Self::Box];

    /// Name for reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::Smooth => "smooth",
            Self::Ball => "ball",
            Self::Box => "box",
        }
    }
}

/// Equally many random integrands of every family, on `[0, 1)^dims`.
#[derive(Clone, Debug, PartialEq)]
pub struct Integrands {
    dims: usize,
    families: [Vec<Integrand>; 4],
}

/// Integrands of less variance are not drawn: an indicator has it at volumes below 0.1 % and above 99.9 %. Their
/// ratios to white noise are those of a few lucky samples.
///
/// The rare small half-spaces above it count: in the plane 8 % of the family have a volume below 1 % or above
/// 99 %, and theirs is the part of the ratio that no filter of a few pixels can reduce.
const MIN_VARIANCE: f64 = 0.001;

/// Bumps, balls and boxes constrain at most this many coordinates, drawn at random: in more, a body inside the
/// cube has next to no volume. Half-spaces, linear functions and cosines use all.
const MAX_AXES: usize = 4;

impl Integrands {
    /// Draws `per_family` integrands of every family; the same `seed` gives the same integrands.
    ///
    /// In the plane (and, with D for 2, beyond it):
    /// - *half-space*: normal uniform on the circle, threshold uniform over the projection of the square on it;
    /// - *smooth*: in turn a linear function with gradient uniform on the circle; a cosine with wave vector of
    ///   uniform direction and 0.25 to 2 cycles per unit length, uniform phase; a Gaussian bump with centre
    ///   uniform in the square and standard deviation uniform in 0.1 to 0.5;
    /// - *ball*: centre uniform in the square, radius uniform in 0.1 to 0.5, clipped by the square. In three
    ///   dimensions or more: radius uniform in 0.25 to 0.5 and centre uniform where the ball fits into the cube;
    /// - *box*: every side uniform in 0.2 to 0.8, position uniform where the box fits into the cube.
    ///
    /// A draw whose variance is below 0.001 is rejected. Bumps, balls and boxes constrain at most 4 coordinates.
    ///
    /// Ratios depend on this distribution, the less smooth and the smaller the bodies the closer to 1: compare
    /// tables under the same integrands only. 256 per family leave a standard error of about 2 % in the mean.
    ///
    /// # Errors
    /// `dims` or `per_family` is 0.
    pub fn random(dims: usize, per_family: usize, seed: u64) -> Result<Self, ConfigError> {
        for (axis, len) in [("dims", dims), ("integrands per family", per_family)] {
            if len == 0 {
                return Err(ConfigError::EmptyAxis { axis });
            }
        }
        let families = Family::ALL.map(|family| {
            (0..per_family)
                .map(|index| {
                    let mut random = generator(seed, Purpose::Integrands, family as u64, index as u64);
                    loop {
                        let integrand = Integrand::new(draw(family, index, dims, &mut random), dims);
                        if integrand.variance() >= MIN_VARIANCE {
                            return integrand;
                        }
                    }
                })
                .collect()
        });
        Ok(Self { dims, families })
    }

    /// Integrands that somebody chose, equally many or not; at least one of every family.
    #[cfg(test)]
    pub(super) fn chosen(dims: usize, families: [Vec<Integrand>; 4]) -> Self {
        Self { dims, families }
    }

    /// Number of coordinates of the integrands.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The integrands of a family.
    pub fn family(&self, family: Family) -> &[Integrand] {
        &self.families[family as usize]
    }

    /// All integrands, family by family.
    pub fn iter(&self) -> impl Iterator<Item = &Integrand> {
        self.families.iter().flatten()
    }
}

fn draw(family: Family, index: usize, dims: usize, random: &mut Xoshiro256PlusPlus) -> Shape {
    match family {
        Family::HalfSpace => {
            let normal = direction(dims, random);
            let low: f64 = normal.iter().map(|n| n.min(0.0)).sum();
            let high: f64 = normal.iter().map(|n| n.max(0.0)).sum();
            Shape::HalfSpace { offset: between(low, high, random), normal }
        }
        Family::Smooth => match index % 3 {
            0 => Shape::Linear { gradient: direction(dims, random) },
            1 => {
                let frequency = between(0.25, 2.0, random);
                let wave = direction(dims, random).into_iter().map(|w| w * frequency).collect();
                Shape::Cosine { wave, phase: random.random() }
            }
            _ => {
                let axes = axes(dims, random);
                let centre = axes.iter().map(|_| random.random()).collect();
                Shape::Bump { axes, centre, deviation: between(0.1, 0.5, random) }
            }
        },
        Family::Ball => {
            let axes = axes(dims, random);
            let (smallest, clipped) = if axes.len() <= 2 { (0.1, true) } else { (0.25, false) };
            let radius = between(smallest, 0.5, random);
            let margin = if clipped { 0.0 } else { radius };
            let centre = axes.iter().map(|_| between(margin, 1.0 - margin, random)).collect();
            Shape::Ball { axes, centre, radius }
        }
        Family::Box => {
            let axes = axes(dims, random);
            let side = |_| {
                let side = between(0.2, 0.8, random);
                let lower = between(0.0, 1.0 - side, random);
                (lower, lower + side)
            };
            let (lower, upper) = axes.iter().map(side).unzip();
            Shape::Box { axes, lower, upper }
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
    fn the_seed_names_the_integrands() {
        let few = Integrands::random(2, 8, 5).unwrap();
        let many = Integrands::random(2, 16, 5).unwrap();
        for family in Family::ALL {
            assert_eq!(few.family(family), &many.family(family)[..8]);
        }
        assert_ne!(few, Integrands::random(2, 8, 6).unwrap());
        assert_eq!(few.iter().count(), 32);
    }

    #[test]
    fn every_dimension_gets_integrands_of_some_variance() {
        for dims in [1, 2, 3, 4, 7, 16] {
            for integrand in Integrands::random(dims, 64, 1).unwrap().iter() {
                assert_eq!(integrand.dims(), dims);
                assert!(integrand.variance() >= MIN_VARIANCE, "{integrand:?}");
            }
        }
    }

    #[test]
    fn nothing_to_draw_is_named() {
        let error = Integrands::random(0, 8, 5).unwrap_err();
        assert_eq!(error, ConfigError::EmptyAxis { axis: "dims" });
        assert!(Integrands::random(2, 0, 5).is_err());
    }
}
