//! How noise is shown on contact sheets: on the same scales for all samplers.

use fsot::metrics::Spectra;
use ndarray::{Array2, ArrayView3};

use super::error::RenderError;
use super::film::Film;
use super::image_metrics::ImageFilter;
use super::reference::Reference;

/// Brightness of a scene's pictures and of their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    exposure: f64,
    /// Three standard deviations of filtered white noise.
    three: f64,
}

impl Scales {
    /// Scales for renderings of `spp` samples, whose errors are shown after the filter.
    ///
    /// # Errors
    /// Fewer frames than temporal taps of the filter.
    pub fn new(reference: &Reference, filter: &ImageFilter, spp: u32) -> Result<Self, RenderError> {
        // The 99th percentile of what is noisy becomes almost white; visible lights may be brighter.
        let pairs = reference.mean.values().iter().zip(reference.variance.values());
        let mut noisy: Vec<f64> = pairs.filter(|pair| *pair.1 > 0.0).map(|pair| *pair.0).collect();
        noisy.sort_by(f64::total_cmp);
        let bright = noisy.get(noisy.len().saturating_sub(1) * 99 / 100).copied().unwrap_or(1.0);
        let white = filter.apply_to_variance(&reference.variance)?;
        let mean = white.values().iter().sum::<f64>() / white.values().len() as f64;
        Ok(Self { exposure: 0.9 / bright.max(1e-9), three: 3.0 * (mean / f64::from(spp)).sqrt().max(1e-12) })
    }

    /// What linear luminance is multiplied with.
    pub fn exposure(&self) -> f64 {
        self.exposure
    }

    /// Brightness of a filtered error: ½ is none, 0 and 1 are three standard deviations of white noise.
    pub fn error(&self, filtered: f64) -> f64 {
        0.5 + 0.5 * filtered / self.three
    }
}

/// Power of a signed error over spatial frequencies, mean over frames, zero frequency in the middle, 1 for
/// white noise.
///
/// Errors are first divided by their standard deviation under white noise, else the brightest penumbra would
/// be all that shows. A hundredth of the mean variance is added, because one rare event in an otherwise quiet
/// pixel would be many such deviations. A 3 × 3 box, which wraps, calms the speckle of a single image.
pub fn error_spectrum(error: &Film, variance: &Film, spp: u32) -> Array2<f64> {
    let variances = variance.values();
    let count = variances.len() as f64;
    let quiet = 0.01 * variances.iter().sum::<f64>() / count;
    let white = variances.iter().filter(|&&v| v > 0.0).map(|v| v / (v + quiet)).sum::<f64>() / count;
    let pairs = error.values().iter().zip(variances);
    let scaled = pairs.map(|(&e, &v)| if v > 0.0 { e * (f64::from(spp) / (v + quiet)).sqrt() } else { 0.0 });
    let scaled: Vec<f64> = scaled.collect();
    let image = ArrayView3::from_shape(error.shape(), &scaled).expect("a film is as long as its shape says");
    let power = Spectra::of_image(image, white.max(1e-12)).xy;
    let (height, width) = power.dim();
    let at = |y: usize, x: usize| power[[y % height, x % width]];
    Array2::from_shape_fn((height, width), |(y, x)| {
        let row = |y: usize| at(y, x + width - 1) + at(y, x) + at(y, x + 1);
        (row(y + height - 1) + row(y) + row(y + 1)) / 9.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Scene, render};
    use crate::samplers::WhiteNoise;

    #[test]
    fn white_noise_has_power_one_and_stays_on_the_scale() {
        let scene = Scene::by_name("soft_shadow").unwrap();
        let reference = Reference::render(&scene, [32, 32], 256).unwrap();
        let error = render(&scene, &WhiteNoise::new(1), [32, 32], 4).unwrap().minus(&reference.mean).unwrap();
        let spectrum = error_spectrum(&error, &reference.variance, 4);
        // 512 conjugate pairs, exponential with mean 1: a standard deviation of 0.044, and that of the
        // variances.
        assert!((spectrum.mean().unwrap() - 1.0).abs() < 0.3, "{spectrum}");
        let filter = ImageFilter::gaussian(2.1).unwrap();
        let scales = Scales::new(&reference, &filter, 4).unwrap();
        assert_eq!(scales.error(0.0), 0.5);
        let shown = filter.apply(&error).unwrap();
        let outside = shown.values().iter().filter(|&&e| !(0.0..=1.0).contains(&scales.error(e))).count();
        // Of equal variances 0.3 % would be; those of penumbras are greater than their mean.
        assert!(outside < 1024 / 10, "{outside}");
        assert!(scales.exposure() > 0.0);
    }
}
