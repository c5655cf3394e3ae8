//! Directions of targets other than the cube, with their laws.
//!
//! The cube's laws have closed forms, or symmetries that make many directions out of a few. Other targets
//! have neither: their laws are tabulated once, along a fixed set of directions that every slice is taken
//! from.

use rayon::prelude::*;

use super::frames::{frames, spread};
use crate::error::TargetError;
use crate::laws::Pieces;
use crate::simd::LANES;
use crate::targets::Target;
use crate::targets::projections::{self, Asked};
use crate::targets::watch::{Stopped, Watch};

/// Why there is no bank.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BankError {
    Target(TargetError),
    Stopped,
}

impl From<TargetError> for BankError {
    fn from(problem: TargetError) -> Self {
        Self::Target(problem)
    }
}

impl From<Stopped> for BankError {
    fn from(Stopped: Stopped) -> Self {
        Self::Stopped
    }
}

/// Directions and laws of a target in one number of dimensions.
#[derive(Clone, Debug)]
pub(crate) struct TargetBank {
    /// Components of each direction, times the scales of the target. The coordinate axes come last.
    theta: Vec<f32>,
    dims: usize,
    laws: Vec<Pieces>,
}

/// Directions in the plane. In a square of 65,536 points, the edge of the square moves by less than the
/// distance of two points from one direction to the next.
const IN_THE_PLANE: usize = 256;
/// Directions in space.
const IN_SPACE: usize = 512;

/// Directions whose laws are asked for at once, of targets that are no densities.
const AT_ONCE: usize = 32;

impl TargetBank {
    /// The banks of targets, each with the number of points that are to follow it. They must be one target,
    /// or densities of one size, which are projected together.
    ///
    /// # Errors
    /// A law that is none; planning was stopped.
    pub(crate) fn of_targets(
        dims: usize,
        asked: &[(&Target, usize)],
        watch: &mut Watch,
    ) -> Result<Vec<Self>, BankError> {
        let Some(&(target, _)) = asked.first() else { return Ok(Vec::new()) };
        let theta = directions(dims, target);
        // The law belongs to the direction as it will be used, rounded.
        let exact: Vec<Vec<f64>> = theta
            .chunks(dims)
            .map(|theta| theta.iter().map(|&component| component.into()).collect())
            .collect();
        if !target.densities().is_empty() {
            let densities = asked
                .iter()
                .map(|&(target, points)| Asked { densities: target.densities(), points: Some(points) });
            let laws = projections::laws(&densities.collect::<Vec<_>>(), &exact, watch)?;
            return Ok(laws.into_iter().map(|laws| Self { theta: theta.clone(), dims, laws }).collect());
        }
        let mut laws = Vec::with_capacity(exact.len());
        for directions in exact.chunks(AT_ONCE) {
            let of = |direction: &Vec<f64>| Ok(target.project(direction).sound(direction)?.into_pieces());
            laws.extend(directions.par_iter().map(of).collect::<Result<Vec<_>, TargetError>>()?);
            watch.tell(laws.len() as f64 / exact.len() as f64)?;
        }
        Ok(vec![Self { theta, dims, laws }])
    }

    /// Number of directions, without the axes.
    pub(crate) fn len(&self) -> usize {
        self.laws.len() - self.dims
    }

    /// Components of a direction; those from [`TargetBank::len`] on are the axes.
    pub(crate) fn theta(&self, index: usize) -> &[f32] {
        &self.theta[index * self.dims..][..self.dims]
    }

    pub(crate) fn law(&self, index: usize) -> &Pieces {
        &self.laws[index]
    }

    /// The direction of `lane` among `count` that are spread from `phase` in `[0, 1)` on.
    pub(crate) fn index(&self, phase: f64, lane: usize, count: usize) -> usize {
        match self.dims {
            1 => 0,
            _ if count == 1 => (phase * self.len() as f64) as usize % self.len(),
            // Evenly around the half circle.
            2 => ((phase + lane as f64) / count as f64 * self.len() as f64) as usize % self.len(),
            // A run of frames.
            _ => (phase * (self.len() / LANES) as f64) as usize % (self.len() / LANES) * LANES + lane,
        }
    }
}

/// Components of the directions of a target, times its scales.
fn directions(dims: usize, target: &Target) -> Vec<f32> {
    let count = match dims {
        1 => 0,
        2 => IN_THE_PLANE,
        _ => IN_SPACE,
    };
    let scales = target.scales(dims);
    let directions: Vec<Vec<f64>> = match dims {
        ..=2 => (0..count).map(|index| spread(dims, index, count)).collect(),
        _ => frames(dims, count),
    };
    let axis = |axis: usize| (0..dims).map(|dim| if dim == axis { 1.0 } else { 0.0 }).collect();
    let all = directions.into_iter().chain((0..dims).map(axis));
    let scaled =
        |theta: Vec<f64>| theta.into_iter().zip(&scales).map(|(x, scale)| (x * scale) as f32).collect();
    all.flat_map::<Vec<f32>, _>(scaled).collect()
}
