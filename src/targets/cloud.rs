//! Point clouds as targets.

use serde::{Deserialize, Serialize};

use crate::error::TargetError;
use crate::laws::Pieces;

/// Equally weighted points of the unit cube that stand for a measure: draws of any sampler, or points to be
/// thinned out.
///
/// Along each direction the law of up to 2048 points is exact; of more, neighbours are merged into pieces
/// with their mass and mean.
///
/// ```
/// use fsot::targets::{PointCloud, Target};
///
/// let cloud = PointCloud::new(2, vec![0.25, 0.2, 0.75, 0.6])?;
/// assert_eq!(Target::Cloud(cloud.into()).project(&[1.0, 0.0]).mean(), 0.5);
/// # Ok::<(), fsot::targets::TargetError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct PointCloud {
    dims: usize,
    points: Vec<f32>,
}

/// A cloud as a file says it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    dims: usize,
    points: Vec<f32>,
}

impl TryFrom<Unchecked> for PointCloud {
    type Error = TargetError;

    fn try_from(given: Unchecked) -> Result<Self, TargetError> {
        Self::new(given.dims, given.points)
    }
}

impl PointCloud {
    /// A cloud from `dims` coordinates per point, each in `[0, 1]`.
    ///
    /// # Errors
    /// No points or dimensions, an incomplete last point, a coordinate outside `[0, 1]`.
    pub fn new(dims: usize, points: Vec<f32>) -> Result<Self, TargetError> {
        for (axis, len) in [("dims", dims), ("the number of points of the cloud", points.len())] {
            if len == 0 {
                return Err(TargetError::Empty { what: axis });
            }
        }
        if !points.len().is_multiple_of(dims) {
            return Err(TargetError::IncompletePoint { given: points.len(), dims });
        }
        match points.iter().position(|value| !(0.0..=1.0).contains(value)) {
            Some(index) => Err(TargetError::BadCoordinate { index, value: points[index].into() }),
            None => Ok(Self { dims, points }),
        }
    }

    /// Dimensions of the points.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Coordinates, point by point.
    pub fn points(&self) -> &[f32] {
        &self.points
    }

    pub(super) fn project(&self, direction: &[f64]) -> Pieces {
        let along = |point: &[f32]| point.iter().zip(direction).map(|(&x, theta)| f64::from(x) * theta).sum();
        Pieces::of_samples(self.points.chunks_exact(self.dims).map(along).collect())
    }
}
