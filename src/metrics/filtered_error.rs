//! Squared error after the filter of the eye, the quantity that a table is optimised for.

use rustfft::num_complex::Complex64;

use super::error::MeasureError;
use super::errors::Errors;
use super::integrands::Integrands;
use super::ratios::Ratios;
use super::samples::Samples;
use crate::kernel::fft::Transform;
use crate::kernel::{Kernel, TemporalKernel};
use crate::table::extent::Extent;

mod some_frames;

/// Mean squared error of a table before and after filtering, each as ratio to white noise of the same shape.
///
/// The filter replaces the error image `e` by `Σ_tap w e(p + tap) / Σ_tap w`, which wraps in space and time.
/// The squared error is averaged over all pixels and frames, then divided by its expectation for white noise,
/// `Var f / spp` before and `Var f / spp · Σw² / (Σw)²` after filtering.
///
/// ```
/// use fsot::kernel::{SpatialKernel, TemporalKernel};
/// use fsot::metrics::{FilteredError, Integrands};
/// use fsot::{Extent, Kernel, SampleTable};
///
/// let extent = Extent { frames: 1, height: 16, width: 16, spp: 1 };
/// let table = SampleTable::white_noise(extent, 2, 0)?;
/// let eye = Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, TemporalKernel::None);
/// let error = FilteredError::measure(&table, &[0, 1], &Integrands::random(2, 16, 0)?, &eye)?;
/// assert!((0.5..1.5).contains(&error.spatial.mean.mean));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FilteredError {
    /// Without filter: the error of single pixels. 1 for any table that has one sample per pixel and fills
    /// the cube uniformly.
    pub unfiltered: Ratios,
    /// After the spatial part of the kernel alone.
    pub spatial: Ratios,
    /// After the whole kernel. Equal to `spatial` for a single frame.
    pub spatio_temporal: Ratios,
}

impl FilteredError {
    /// Measures the dimension group `dims` of samples over test integrands of as many coordinates, with a
    /// kernel.
    ///
    /// The kernel's truncation counts: with the default, weights below 0.1 % are dropped. Cost per integrand:
    /// O(samples · dims) to evaluate and O(sites log sites) to filter. Runs on rayon's current pool; the
    /// result does not depend on the number of threads.
    ///
    /// # Errors
    /// A dimension group that is empty, repeats a dimension, exceeds those of the samples, or has another
    /// length than integrands have coordinates; a bad kernel.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: &[usize],
        integrands: &Integrands,
        kernel: &Kernel,
    ) -> Result<Self, MeasureError> {
        let errors = Errors::of(samples, dims, "an integrand", integrands.dims())?;
        let extent = errors.extent;
        let meter = Meter::new(&extent, kernel)?;
        let [unfiltered, spatial, spatio_temporal] = Ratios::over(
            integrands,
            || meter.transform.scratch(),
            |scratch, pair, ratios| {
                // Two real images ride in one complex transform.
                scratch.data.fill(Complex64::default());
                for (site, error) in scratch.data.iter_mut().zip(errors.all(&pair[0])) {
                    site.re = error;
                }
                if let Some(second) = pair.get(1) {
                    for (site, error) in scratch.data.iter_mut().zip(errors.all(second)) {
                        site.im = error;
                    }
                }
                meter.transform.forward(scratch);
                let errors = meter.mean_squares(&scratch.data);
                for ((ratio, integrand), error) in ratios.iter_mut().zip(pair).zip(errors) {
                    let white = integrand.variance() / extent.spp as f64;
                    *ratio = std::array::from_fn(|k| error[k] / (white * meter.white[k]));
                }
            },
        );
        Ok(Self { unfiltered, spatial, spatio_temporal })
    }
}

/// Mean squares of an image before and after filtering, from its Fourier transform.
///
/// By Parseval the mean over sites of the squared filtered image is `Σ_k |E(k)|² |W(k)|² / N²`, so that
/// nothing is transformed back. (A kernel tap shifts the other way than in a convolution; `|W|` is the same.)
struct Meter {
    transform: Transform,
    mirrors: Vec<u32>,
    /// `|W(k)|²` of no kernel, of the spatial and of the whole kernel, normalised to `W(0) = 1`.
    power: Vec<[f64; 3]>,
    /// `Σw² / (Σw)²` of the three.
    white: [f64; 3],
}

impl Meter {
    fn new(extent: &Extent, kernel: &Kernel) -> Result<Self, MeasureError> {
        let transform = Transform::new(extent.frames, extent.height, extent.width);
        let spatial = Kernel { temporal: TemporalKernel::None, ..kernel.clone() };
        let mut power = vec![[1.0; 3]; transform.len()];
        let mut white = [1.0; 3];
        let mut scratch = transform.scratch();
        for (stage, kernel) in [(1, &spatial), (2, kernel)] {
            let taps = kernel.taps(extent)?;
            let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
            white[stage] = taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum();
            scratch.data.fill(Complex64::default());
            let origin = extent.site(0);
            for tap in &taps {
                let site = extent.wrapped(origin, (tap.dt.into(), tap.dy.into(), tap.dx.into()));
                scratch.data[extent.site_index(site)].re = tap.weight / sum;
            }
            transform.forward(&mut scratch);
            for (power, value) in power.iter_mut().zip(&scratch.data) {
                power[stage] = value.norm_sqr();
            }
        }
        Ok(Self { mirrors: transform.mirrors(), transform, power, white })
    }

    /// Mean squares of the three stages, of the real and of the imaginary part of an image.
    fn mean_squares(&self, image: &[Complex64]) -> [[f64; 3]; 2] {
        let sums = sums_of_squares(image, &self.mirrors, |site| self.power[site]);
        let sites = image.len() as f64;
        sums.map(|part| part.map(|sum| 0.5 * sum / (sites * sites)))
    }
}

/// Twice the sums over frequencies of the power of an image's real and of its imaginary part, from its
/// Fourier transform, with each frequency's power changed by the factors of real kernels.
fn sums_of_squares<const STAGES: usize>(
    image: &[Complex64],
    mirrors: &[u32],
    power: impl Fn(usize) -> [f64; STAGES],
) -> [[f64; STAGES]; 2] {
    let mut sums = [[0.0; STAGES]; 2];
    for (site, (&value, &mirror)) in image.iter().zip(mirrors).enumerate() {
        // The parts' transforms are A = (Z(k) + Z(−k)*) / 2 and B = (Z(k) − Z(−k)*) / 2i. Over the pair
        // of k and −k, on which the power of a real kernel is equal, |A|² sums to |Z|² + Re Z(k) Z(−k),
        // twice over, and |B|² to the difference.
        let (square, cross) = (value.norm_sqr(), (value * image[mirror as usize]).re);
        for (stage, power) in power(site).into_iter().enumerate() {
            sums[0][stage] += power * (square + cross);
            sums[1][stage] += power * (square - cross);
        }
    }
    sums
}

#[cfg(test)]
mod tests;
