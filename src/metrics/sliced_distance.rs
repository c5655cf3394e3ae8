//! Distance of a point set to a target, averaged over directions.

use rayon::prelude::*;

use crate::error::ConfigError;
use crate::laws::distance::Workspace;
use crate::targets::Target;

/// The sliced 2-Wasserstein distance between equally weighted points and a target: the root of the mean, over
/// `directions` directions, of the squared 2-Wasserstein distance of the projections.
///
/// `points` holds `dims` coordinates per point. Directions divide the half circle evenly in the plane and are those of a
/// fixed random sequence in more dimensions; distances are exact, and in the units in which the target measures
/// ([`Target::scales`]). O(directions · n log n), in parallel.
///
/// # Errors
/// No points or directions, no dimensions or not those of the target, coordinates that are not finite, a target without a
/// finite law along some direction.
pub fn sliced_w2(
    points: &[f64],
    dims: usize,
    target: &Target,
    directions: usize,
) -> Result<f64, ConfigError> {
    for (axis, len) in [("dims", dims), ("points", points.len()), ("directions", directions)] {
        if len == 0 {
            return Err(ConfigError::EmptyAxis { axis });
        }
    }
    if let Some(of) = target.dims()
        && of != dims
    {
        return Err(ConfigError::TargetDims { term: 0, target: of, dims });
    }
    if !points.len().is_multiple_of(dims) {
        let expected = points.len().next_multiple_of(dims);
        return Err(ConfigError::ValueCount { what: "the list of points", given: points.len(), expected });
    }
    if let Some(index) = points.iter().position(|value| !value.is_finite()) {
        return Err(ConfigError::BadPoint { index, value: points[index] });
    }
    let squared = (0..directions).into_par_iter().map(|index| {
        let direction = crate::directions::frames::spread(dims, index, directions);
        let direction: Vec<f64> =
            direction.iter().zip(target.scales(dims)).map(|(component, scale)| component * scale).collect();
        let along = |point: &[f64]| point.iter().zip(&direction).map(|(x, theta)| x * theta).sum();
        let projections: Vec<f64> = points.chunks_exact(dims).map(along).collect();
        let law = target.project(&direction);
        if !law.is_sound() {
            return Err(ConfigError::BadLaw { term: 0, direction });
        }
        Ok(Workspace::default().displacements(&law, &projections, None, &mut vec![0.0; projections.len()]))
    });
    // Collected first: the order of the sum must not depend on the threads.
    let squared: Vec<f64> = squared.collect::<Result<_, _>>()?;
    Ok((squared.iter().sum::<f64>() / directions as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One point at the middle of the square: W2² along theta is the variance 1/12 of the law, whatever theta.
    #[test]
    fn a_single_point_is_as_far_as_the_target_is_wide() {
        let distance = sliced_w2(&[0.5, 0.5], 2, &Target::UniformCube, 16).unwrap();
        assert!((distance - (1.0_f64 / 12.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let measure =
            |points: &[f64], dims, directions| sliced_w2(points, dims, &Target::UniformCube, directions);
        assert_eq!(measure(&[], 2, 4), Err(ConfigError::EmptyAxis { axis: "points" }));
        assert_eq!(measure(&[0.5], 1, 0), Err(ConfigError::EmptyAxis { axis: "directions" }));
        assert!(matches!(measure(&[0.5; 3], 2, 4), Err(ConfigError::ValueCount { expected: 4, .. })));
        assert!(matches!(measure(&[0.5, f64::NAN], 2, 4), Err(ConfigError::BadPoint { index: 1, .. })));
    }
}
