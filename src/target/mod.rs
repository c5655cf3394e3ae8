//! What a class should look like, and its law along a direction.

mod boxes;
mod piece;
mod projected;
#[cfg(test)]
mod tests;

pub use projected::Projected;
use serde::{Deserialize, Serialize};

/// The measure that a class's samples should resemble.
///
/// Sliced transport compares samples and target along one direction at a time, so a target is used through its
/// one-dimensional laws only: see [`Target::project`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Target {
    /// The uniform measure of the unit cube `[0, 1]^D`, for any `D`.
    #[default]
    UniformCube,
}

impl Target {
    /// The law of `x·direction`, where `x` follows this target and `D = direction.len()`.
    ///
    /// The direction need not be a unit vector: its components must be finite, with a finite sum of absolute
    /// values, and may have any sign. A zero or empty direction gives the point mass at 0.
    ///
    /// O(`D`·grid), for a grid of at most eight pieces up to `D` = 4 and of some hundreds beyond or where a component is
    /// below 1e-4 of the sum. See [`Projected`] for the accuracy.
    pub fn project(&self, direction: &[f64]) -> Projected {
        match self {
            Target::UniformCube => Projected::of_cube(direction),
        }
    }

    /// Dimensions of the target; `None` where any number will do.
    pub fn dims(&self) -> Option<usize> {
        None
    }

    /// Lengths of the sides of the unit cube in the space where the target measures distances.
    pub fn scales(&self, dims: usize) -> Vec<f64> {
        vec![1.0; dims]
    }
}
