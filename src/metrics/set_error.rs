//! Integration error of a point set: of a prefix, of a class.

use super::coordinates::Coordinates;
use super::error::MeasureError;
use super::integrands::Integrands;
use super::ratios::Ratios;
use super::samples::Samples;

/// Squared error of the mean over all samples, as ratio to as many independent random points.
///
/// Times the variance and over the number of points it is the squared error itself: a ratio that falls in
/// proportion to the number of points means an error that falls by its square. The samples of a table count
/// as one set.
///
/// ```
/// use fsot::metrics::{Integrands, Samples, SetError};
///
/// let centres: Vec<f32> = (0..64).map(|i| (i as f32 + 0.5) / 64.0).collect();
/// let points = Samples::points(&centres, 1)?;
/// let error = SetError::measure(points, &[0], &Integrands::random(1, 16, 0)?)?;
/// assert!(error.ratios.mean.mean < 0.05);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SetError {
    /// 1 is random, 0 is exact.
    pub ratios: Ratios,
}

impl SetError {
    /// Measures the dimension group `dims` of samples over test integrands of as many coordinates.
    ///
    /// O(samples · dims) per integrand; parallel, and independent of the number of threads.
    ///
    /// # Errors
    /// A dimension group that is empty, repeats a dimension, exceeds those of the samples, or has another
    /// length than integrands have coordinates.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: &[usize],
        integrands: &Integrands,
    ) -> Result<Self, MeasureError> {
        let points = Coordinates::gather(samples, dims)?.fitting("an integrand", integrands.dims())?;
        let count = points.count() as f64;
        let [ratios] = Ratios::over(
            integrands,
            || (),
            |(), pair, ratios| {
                for (integrand, ratio) in pair.iter().zip(ratios) {
                    let sum: f64 = points.points().map(|point| integrand.value(point)).sum();
                    *ratio = [(sum / count - integrand.integral()).powi(2) * count / integrand.variance()];
                }
            },
        );
        Ok(Self { ratios })
    }
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
            let points = random::uniforms(seed, 128);
            let points = Samples::points(&points, 2).unwrap();
            SetError::measure(points, &[0, 1], &integrands).unwrap().ratios.mean.mean
        };
        let mean = (0..256).map(of).sum::<f64>() / 256.0;
        assert!((mean - 1.0).abs() < 0.15, "{mean}");
    }
}
