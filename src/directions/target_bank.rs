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

impl TargetBank {
    /// The bank of a target.
    ///
    /// # Errors
    /// A law that is none.
    pub(crate) fn new(dims: usize, target: &Target) -> Result<Self, TargetError> {
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
        let all: Vec<Vec<f64>> = directions.into_iter().chain((0..dims).map(axis)).collect();
        let theta: Vec<f32> = all
            .iter()
            .flat_map(|theta| theta.iter().zip(&scales).map(|(x, scale)| (x * scale) as f32))
            .collect();
        let laws: Result<Vec<Pieces>, TargetError> = theta
            .par_chunks(dims)
            .map(|theta| {
                // The law belongs to the direction as it will be used, rounded.
                let direction: Vec<f64> = theta.iter().map(|&component| component.into()).collect();
                Ok(target.project(&direction).sound(&direction)?.into_pieces())
            })
            .collect();
        Ok(Self { theta, dims, laws: laws? })
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
