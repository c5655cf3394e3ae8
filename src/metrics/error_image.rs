//! The Monte Carlo error of every pixel.

use ndarray::Array3;

use super::error::MeasureError;
use super::errors::Errors;
use super::integrand::Integrand;
use super::samples::Samples;
use crate::table::extent::Extent;

/// Error `e[t, y, x] = (1/spp) Σ_s f(x_s) − ∫f` of every pixel of every frame.
///
/// ```
/// use fsot::metrics::{ErrorImage, Integrand, Samples};
///
/// let product = Integrand::new(2, |x| x[0] * x[1], 0.25, 7.0 / 144.0)?;
/// let points = Samples::points(&[0.5, 0.25, 0.75, 0.5], 2)?;
/// let image = ErrorImage::measure(points, &[0, 1], &product)?;
/// assert_eq!(image.errors[[0, 0, 0]], 0.125 - 0.25);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ErrorImage {
    /// The errors, `[frame, y, x]`.
    pub errors: Array3<f64>,
    /// Expected square of an error in white noise, `Var f / spp`.
    pub white_variance: f64,
}

impl ErrorImage {
    /// Estimates the integral in every pixel.
    ///
    /// `dims` names the dimensions of the samples that the integrand's coordinates are read from. O(samples ·
    /// dims).
    ///
    /// # Errors
    /// `dims` is empty, names a dimension twice or one that the samples don't have, or has another length
    /// than the integrand has coordinates.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: &[usize],
        integrand: &Integrand,
    ) -> Result<Self, MeasureError> {
        let found = Errors::of(samples, dims, "the integrand", integrand.dims())?;
        let Extent { frames, height, width, spp } = found.extent;
        let errors = found.all(integrand).collect();
        let errors = Array3::from_shape_vec((frames, height, width), errors).expect("one error per site");
        Ok(Self { errors, white_variance: integrand.variance() / spp as f64 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::integrand_kind::IntegrandKind;
    use crate::table::SampleTable;
    use approx::assert_abs_diff_eq;

    #[test]
    fn the_error_is_the_mean_of_the_pixel_less_the_integral() {
        let extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };
        let values = (0..extent.samples() * 3).map(|i| i as f32 / 256.0).collect();
        let table = SampleTable::new(extent, 3, values).unwrap();
        let gradient = vec![0.6, -0.8];
        let integrand = Integrand::known(IntegrandKind::Linear { gradient }, 2);
        let image = ErrorImage::measure(&table, &[2, 0], &integrand).unwrap();
        let [a, b] = [0, 1].map(|s| f64::from(table.view()[[1, 2, 3, s, 2]]));
        let [c, d] = [0, 1].map(|s| f64::from(table.view()[[1, 2, 3, s, 0]]));
        let expected = 0.6 * 0.5 * (a + b) - 0.8 * 0.5 * (c + d) - (0.3 - 0.4);
        assert_abs_diff_eq!(image.errors[[1, 2, 3]], expected, epsilon = 1e-14);
        assert_abs_diff_eq!(image.white_variance, 1.0 / 24.0, epsilon = 1e-15);
    }

    #[test]
    fn the_integrand_fits_the_group() {
        let integrand = Integrand::known(IntegrandKind::Linear { gradient: vec![1.0, 0.0] }, 2);
        let points = Samples::points(&[0.5; 4], 2).unwrap();
        let error = ErrorImage::measure(points, &[0], &integrand).unwrap_err();
        assert_eq!(error, MeasureError::GroupSize { what: "the integrand", given: 1, expected: 2 });
    }
}
