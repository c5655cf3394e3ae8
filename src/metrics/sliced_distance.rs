//! Distance of a point set to a target, averaged over directions.

use rayon::prelude::*;

use super::bound::MOST_SLICES;
use super::coordinates::Coordinates;
use super::error::MeasureError;
use super::samples::Samples;
use crate::directions::frames::spread;
use crate::error::{RangeError, TargetError};
use crate::laws::distance::Workspace;
use crate::targets::Target;

/// Sliced Wasserstein distance between equally weighted points and a target.
///
/// Directions divide the half circle evenly in the plane and are those of a fixed random sequence in more
/// dimensions; distances are exact, and in the units in which the target measures ([`Target::scales`]). All
/// samples of a table count as one set.
///
/// ```
/// use fsot::metrics::{Samples, SlicedDistance};
/// use fsot::targets::Target;
///
/// let centre = Samples::points(&[0.5, 0.5], 2)?;
/// let distance = SlicedDistance::measure(centre, &[0, 1], &Target::UniformCube, 16)?;
/// // The deviation of the cube along any direction.
/// assert!((distance.w2 - 12.0_f64.sqrt().recip()).abs() < 1e-12);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SlicedDistance {
    /// Root of the mean over directions of the squared 2-Wasserstein distance of the projections.
    pub w2: f64,
}

/// Directions whose laws are kept at once: a picture is projected on all of them in one pass.
const TOGETHER: usize = 256;

impl SlicedDistance {
    /// Measures the dimension group `dims` of samples along at least one direction.
    ///
    /// O(directions · n log n), in parallel; the same bits at any thread count.
    ///
    /// # Errors
    /// A dimension group that is empty, repeats a dimension, exceeds those of the samples, or has another
    /// length than the target has dimensions; no directions; a target without a finite law along some
    /// direction.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: &[usize],
        target: &Target,
        directions: usize,
    ) -> Result<Self, MeasureError> {
        let points =
            Coordinates::gather(samples, dims)?.fitting("the target", target.dims().unwrap_or(dims.len()))?;
        if directions == 0 {
            return Err(MeasureError::Nothing { what: "directions" });
        }
        let is_good = directions <= MOST_SLICES;
        RangeError::check(is_good, "the number of directions", directions as f64, "of at most 16777216")?;
        let scales = target.scales(dims.len());
        let scaled = |index| {
            let direction = spread(dims.len(), index, directions);
            direction.iter().zip(&scales).map(|(component, scale)| component * scale).collect()
        };
        let all: Vec<Vec<f64>> = (0..directions).map(scaled).collect();
        // Collected first: the order of the sum must not depend on the threads.
        let mut squared: Vec<f64> = Vec::with_capacity(directions);
        for together in all.chunks(TOGETHER) {
            let laws = target.project_all(together);
            let squares = together.par_iter().zip(laws).map(|(direction, law)| {
                let law = law.sound(direction)?;
                let along = |point: &[f64]| point.iter().zip(direction).map(|(x, theta)| x * theta).sum();
                let projections: Vec<f64> = points.points().map(along).collect();
                let displacements = &mut vec![0.0; projections.len()];
                Ok(Workspace::default().displacements(&law, &projections, None, displacements))
            });
            squared.extend(squares.collect::<Result<Vec<f64>, TargetError>>()?);
        }
        Ok(Self { w2: (squared.iter().sum::<f64>() / directions as f64).sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One point at the middle of the square: W2² along theta is the variance 1/12 of the law, whatever
    /// theta.
    #[test]
    fn a_single_point_is_as_far_as_the_target_is_wide() {
        let point = Samples::points(&[0.5, 0.5], 2).unwrap();
        let distance = SlicedDistance::measure(point, &[0, 1], &Target::UniformCube, 16).unwrap();
        assert!((distance.w2 - (1.0_f64 / 12.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let density = crate::targets::Density::new(1, 1, vec![1.0]).unwrap();
        let point = Samples::points(&[0.5; 3], 3).unwrap();
        let measure = |dims: &[usize], target, directions| {
            SlicedDistance::measure(point, dims, target, directions).unwrap_err()
        };
        let error = measure(&[0], &Target::UniformCube, 0);
        assert_eq!(error, MeasureError::Nothing { what: "directions" });
        let error = measure(&[0, 1, 2], &Target::Density(density.into()), 4);
        assert_eq!(error, MeasureError::GroupSize { what: "the target", given: 3, expected: 2 });
    }
}
