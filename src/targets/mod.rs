//! What a class should look like, and its law along a direction.

mod cloud;
mod custom;
mod density;
#[cfg(feature = "image")]
mod inks;
#[cfg(feature = "image")]
mod picture;
mod start;
#[cfg(feature = "image")]
mod tone;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

#[cfg(feature = "image")]
pub use crate::error::PictureError;
pub use crate::error::TargetError;
pub use crate::laws::Projected;
pub use crate::table::vectors::VectorMap;

pub use cloud::PointCloud;
pub use custom::{CustomTarget, Measure};
pub use density::Density;
#[cfg(feature = "image")]
pub use {inks::Inks, picture::Picture, tone::Tone};

/// The measure that a class's samples should resemble.
///
/// Sliced transport compares samples and target along one direction at a time, so a target is used through
/// its one-dimensional laws only: see [`Target::project`].
///
/// ```
/// use fsot::targets::Target;
///
/// let law = Target::UniformCube.project(&[0.6, 0.8]);
/// assert!((law.mean() - 0.7).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Target {
    /// The uniform measure of the unit cube `[0, 1]^D`, for any `D`.
    #[default]
    UniformCube,
    /// A density on the square: a picture.
    Density(Arc<Density>),
    /// Equally weighted points.
    Cloud(Arc<PointCloud>),
    /// A measure of the caller's own.
    Custom(CustomTarget),
}

impl Target {
    /// A measure of the caller's own.
    pub fn custom(measure: impl Measure + 'static) -> Self {
        Self::Custom(CustomTarget::shared(Arc::new(measure)))
    }

    /// The law of `x·direction`, where `x` follows this target and `D = direction.len()`.
    ///
    /// The direction need not be a unit vector: its components must be finite, with a finite sum of absolute
    /// values, and may have any sign. A zero or empty direction gives the point mass at 0. Others have no
    /// law: theirs is NaN, and refused when it is used; so is a density's where that sum is not from 1e-100
    /// to 1e100.
    ///
    /// Cube: O(`D`·grid), for a grid of at most eight pieces up to `D` = 4 and of some hundreds beyond or
    /// where a component is below 1e-4 of the sum. Density: O(pixels). Cloud: O(points · log points). See
    /// [`Projected`] for the accuracy.
    pub fn project(&self, direction: &[f64]) -> Projected {
        let sum: f64 = direction.iter().map(|component| component.abs()).sum();
        match self {
            Target::Custom(custom) => custom.get().project(direction),
            _ if !sum.is_finite() => Projected::none(),
            Target::Density(_) if sum > 0.0 && !(1e-100..=1e100).contains(&sum) => Projected::none(),
            Target::UniformCube => Projected::of_cube(direction),
            Target::Density(density) => Projected::of_pieces(density.project(direction)),
            Target::Cloud(cloud) => Projected::of_pieces(cloud.project(direction)),
        }
    }

    /// Dimensions of the target; `None` where any number will do.
    pub fn dims(&self) -> Option<usize> {
        match self {
            Target::UniformCube => None,
            Target::Density(_) => Some(2),
            Target::Cloud(cloud) => Some(cloud.dims()),
            Target::Custom(custom) => Some(custom.get().dims()),
        }
    }

    /// Lengths of the sides of the unit cube in the space where distances are measured: 1, but for pictures
    /// that are not square.
    pub fn scales(&self, dims: usize) -> Vec<f64> {
        match self {
            Target::Density(density) => density.scales().to_vec(),
            _ => vec![1.0; dims],
        }
    }
}

#[cfg(test)]
mod tests;
