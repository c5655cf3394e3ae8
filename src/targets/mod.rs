//! What a class should look like, and its law along a direction.

mod cloud;
mod custom;
mod density;
mod density_sum;
#[cfg(feature = "image")]
mod inks;
#[cfg(feature = "image")]
mod picture;
pub(crate) mod projections;
mod settle;
mod start;
#[cfg(feature = "image")]
mod tone;
pub(crate) mod watch;

use std::ops::ControlFlow;
use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

#[cfg(feature = "image")]
pub use crate::error::PictureError;
pub use crate::error::TargetError;
pub use crate::laws::Projected;
pub use crate::table::vectors::VectorMap;

use self::projections::Asked;
use self::watch::Watch;
pub use cloud::PointCloud;
pub use custom::{CustomTarget, Measure};
pub use density::Density;
pub use density_sum::DensitySum;
#[cfg(feature = "image")]
pub use {
    inks::Inks,
    picture::{Picture, PictureOptions, Pixels, Transfer},
    tone::Tone,
};

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
    /// Densities on top of each other.
    Densities(DensitySum),
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
            Target::Density(_) | Target::Densities(_) if sum > 0.0 && !(1e-100..=1e100).contains(&sum) => {
                Projected::none()
            }
            Target::UniformCube => Projected::of_cube(direction),
            Target::Density(_) | Target::Densities(_) => {
                let mut laws = self.project_all(&[direction.to_vec()]);
                laws.pop().unwrap_or_else(|| Projected::from_samples(Vec::new()))
            }
            Target::Cloud(cloud) => Projected::of_pieces(cloud.project(direction)),
        }
    }

    /// The laws along several directions: for densities in one pass over the pixels.
    pub(crate) fn project_all(&self, directions: &[Vec<f64>]) -> Vec<Projected> {
        if self.densities().is_empty() {
            return directions.par_iter().map(|direction| self.project(direction)).collect();
        }
        let observe = &mut |_| ControlFlow::Continue(());
        let asked = [Asked { densities: self.densities(), points: None }];
        let laws = projections::laws(&asked, directions, &mut Watch::new(observe));
        // Nobody stops it.
        let laws = laws.ok().and_then(|mut laws| laws.pop()).unwrap_or_default();
        laws.into_iter().map(Projected::of_pieces).collect()
    }

    /// The densities that it is the sum of, if it is one.
    pub(crate) fn densities(&self) -> &[Density] {
        match self {
            Target::Density(density) => std::slice::from_ref(density),
            Target::Densities(densities) => densities.parts(),
            _ => &[],
        }
    }

    /// Brings points that lie beside or between bright pixels of a density into those that lack some.
    pub(crate) fn settle(&self, points: &mut [[f32; 2]]) {
        settle::settle(self.densities(), points);
    }

    /// Dimensions of the target; `None` where any number will do.
    pub fn dims(&self) -> Option<usize> {
        match self {
            Target::UniformCube => None,
            Target::Density(_) | Target::Densities(_) => Some(2),
            Target::Cloud(cloud) => Some(cloud.dims()),
            Target::Custom(custom) => Some(custom.get().dims()),
        }
    }

    /// Lengths of the sides of the unit cube in the space where distances are measured: 1, but for pictures
    /// that are not square.
    pub fn scales(&self, dims: usize) -> Vec<f64> {
        match self {
            Target::Density(density) => density.scales().to_vec(),
            Target::Densities(densities) => densities.scales().to_vec(),
            _ => vec![1.0; dims],
        }
    }
}

#[cfg(test)]
mod tests;
