//! Integration error of a point set: of a prefix, of a class.

use rayon::prelude::*;

use super::integrands::Integrands;
use super::ratios::Ratios;
use crate::error::ConfigError;

/// Squared error of the mean over a point set of test integrands, as ratio to as many independent random points.
///
/// `points` holds one coordinate per dimension of the integrands for each point. Times `1 / points` and the variance it is the
/// squared error itself: a ratio that falls in proportion to the number of points means an error that falls by its square.
/// O(points) per integrand; parallel, and independent of the number of threads.
///
/// # Errors
/// No points, or an incomplete last one; coordinates outside `[0, 1)`.
pub fn set_error(points: &[f64], integrands: &Integrands) -> Result<Ratios, ConfigError> {
    let dims = integrands.dims();
    if points.is_empty() {
        return Err(ConfigError::EmptyAxis { axis: "points" });
    }
    if !points.len().is_multiple_of(dims) {
        let expected = points.len().next_multiple_of(dims);
        return Err(ConfigError::ValueCount { what: "the list of points", given: points.len(), expected });
    }
    if let Some(index) = points.par_iter().position_first(|value| !(0.0..1.0).contains(value)) {
        return Err(ConfigError::BadPoint { index, value: points[index] });
    }
    let count = (points.len() / dims) as f64;
    let [ratios] = Ratios::over(
        integrands,
        || (),
        |(), pair, ratios| {
            for (integrand, ratio) in pair.iter().zip(ratios) {
                let sum: f64 = points.chunks_exact(dims).map(|point| integrand.value(point)).sum();
                *ratio = [(sum / count - integrand.integral()).powi(2) * count / integrand.variance()];
            }
        },
    );
    Ok(ratios)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    /// Mean over 256 sets of 64 points, each over 4 × 16 integrands: the standard error is below 0.05.
    #[test]
    fn independent_points_have_ratio_1() {
        let integrands = Integrands::random(2, 16, 3).unwrap();
        let of = |seed| {
            let points: Vec<f64> = random::uniforms(seed, 128).into_iter().map(f64::from).collect();
            set_error(&points, &integrands).unwrap().mean.mean
        };
        let mean = (0..256).map(of).sum::<f64>() / 256.0;
        assert!((mean - 1.0).abs() < 0.15, "{mean}");
    }

    #[test]
    fn what_is_no_set_is_refused() {
        let integrands = Integrands::random(2, 1, 3).unwrap();
        assert_eq!(set_error(&[], &integrands), Err(ConfigError::EmptyAxis { axis: "points" }));
        assert!(matches!(set_error(&[0.5], &integrands), Err(ConfigError::ValueCount { .. })));
        assert!(matches!(set_error(&[0.5, 1.0], &integrands), Err(ConfigError::BadPoint { index: 1, .. })));
    }
}
