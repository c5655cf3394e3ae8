//! Errors of a rendering as ratios to white noise.
//!
//! White noise needs no drawing: samples are independent between pixels, so the expected squared error of a
//! pixel is `variance / spp`, and after a filter with weights `w` it is `Σ w² variance / spp`. Both come from
//! the
//! [`Reference`]. At the borders of the image filters are cut off and renormalised: their weights inside sum
//! to 1.

use fsot::config::RangeError;
use fsot::kernel::{SpatialKernel, TemporalKernel};

use super::error::RenderError;
use super::film::Film;
use super::reference::Reference;

/// Guards relative errors where the reference is dark.
const EPSILON: f64 = 0.01;

/// A separable filter over pixels and past frames; weights sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFilter {
    /// Right half of the spatial taps, relative to the middle.
    half: Vec<f64>,
    /// Current frame first.
    temporal: Vec<f64>,
}

impl ImageFilter {
    /// No filter.
    pub fn identity() -> Self {
        Self { half: vec![1.0], temporal: vec![1.0] }
    }

    /// `exp(-r² / sigma_px²)`, as [`SpatialKernel::Gaussian`]; down to 1e-9 of the largest weight.
    ///
    /// # Errors
    /// `sigma_px` outside `(0, 1000]`.
    pub fn gaussian(sigma_px: f64) -> Result<Self, RenderError> {
        if !(sigma_px > 0.0 && sigma_px <= 1000.0) {
            let (name, expected) = ("sigma_px", "above 0, at most 1000");
            return Err(RangeError::new(name, sigma_px, expected).into());
        }
        let tap = |k: u32| (-(f64::from(k) / sigma_px).powi(2)).exp();
        let half = (0..).map(tap).take_while(|&tap| tap > 1e-9).collect();
        Ok(Self { half, ..Self::identity() })
    }

    /// This filter in space, followed by one over the current and past frames.
    ///
    /// # Errors
    /// A temporal kernel outside its documented range.
    pub fn with_temporal(mut self, kernel: &TemporalKernel) -> Result<Self, RenderError> {
        let taps = kernel.taps()?;
        let sum: f64 = taps.iter().sum();
        self.temporal = taps.into_iter().map(|tap| tap / sum).collect();
        Ok(self)
    }

    /// The filtered film. Only frames with their whole past are kept: `k` temporal taps drop the first
    /// `k - 1`.
    ///
    /// # Errors
    /// Fewer frames than temporal taps.
    pub fn apply(&self, film: &Film) -> Result<Film, RenderError> {
        self.weigh(film, |weight| weight)
    }

    /// Variances after the filter, from those of independent pixels: weights are squared.
    ///
    /// # Errors
    /// Fewer frames than temporal taps.
    pub fn apply_to_variance(&self, variance: &Film) -> Result<Film, RenderError> {
        self.weigh(variance, |weight| weight * weight)
    }

    fn weigh(&self, film: &Film, power: impl Fn(f64) -> f64) -> Result<Film, RenderError> {
        let [frames, height, width] = film.shape();
        let needed = self.temporal.len();
        if frames < needed {
            return Err(RenderError::TooShort { frames, needed });
        }
        let (size, kept) = (height * width, frames + 1 - needed);
        let mut out = Film::black([kept, height, width])?;
        for (frame, image) in out.values_mut().chunks_exact_mut(size).enumerate() {
            for (back, &tap) in self.temporal.iter().enumerate() {
                let past = film.frame(frame + needed - 1 - back)?;
                image.iter_mut().zip(past).for_each(|(sum, value)| *sum += power(tap) * value);
            }
        }
        let (along_x, along_y) = (self.axis(width, &power), self.axis(height, &power));
        let mut rows = vec![0.0; size];
        for image in out.values_mut().chunks_exact_mut(size) {
            for y in 0..height {
                for (x, (first, weights)) in along_x.iter().enumerate() {
                    let window = &image[y * width + first..][..weights.len()];
                    rows[y * width + x] = window.iter().zip(weights).map(|(v, w)| v * w).sum();
                }
            }
            for (y, (first, weights)) in along_y.iter().enumerate() {
                let target = &mut image[y * width..(y + 1) * width];
                target.fill(0.0);
                for (row, weight) in (*first..).zip(weights) {
                    let source = &rows[row * width..(row + 1) * width];
                    target.iter_mut().zip(source).for_each(|(sum, v)| *sum += weight * v);
                }
            }
        }
        Ok(out)
    }

    /// First source and powers of the renormalised weights of every position on an axis.
    fn axis(&self, len: usize, power: impl Fn(f64) -> f64) -> Vec<(usize, Vec<f64>)> {
        let reach = self.half.len() - 1;
        (0..len)
            .map(|at| {
                let sources = at.saturating_sub(reach)..(at + reach + 1).min(len);
                let sum: f64 = sources.clone().map(|source| self.half[source.abs_diff(at)]).sum();
                let weight = |source: usize| power(self.half[source.abs_diff(at)] / sum);
                (sources.start, sources.map(weight).collect())
            })
            .collect()
    }
}

/// One error of a rendering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Measured.
    pub value: f64,
    /// Expected of white noise of the same shape and number of samples.
    pub white: f64,
    /// Expected of the reference's own error alone: `value` is not to be trusted near it.
    pub floor: f64,
}

impl Figure {
    /// Measured over white noise; 1 = as bad as white noise. `NaN` for a scene without variance.
    pub fn ratio(&self) -> f64 {
        self.value / self.white
    }
}

/// Errors of a rendering against its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Mean over pixels and frames of `(I − R)²`.
    pub mse: Figure,
    /// Mean of `(I − R)² / (R² + 0.01)`.
    pub rel_mse: Figure,
    /// Perceptual: mean of `(g∗(I − R))² / ((g∗R)² + 0.01)`, g ∝ exp(−r²/2.1²) times the temporal kernel.
    pub p_rel_mse: Figure,
    /// The same with the normal density of *standard deviation* 2.1, exp(−r²/(2·2.1²)).
    pub p_rel_mse_wide: Figure,
}

impl Comparison {
    /// Root of the ratio of `mse`: the error of white noise in units of luminance is 1.
    pub fn rmse_ratio(&self) -> f64 {
        self.mse.ratio().sqrt()
    }
}

/// Width of the spatial filters of perceptual errors, in pixels (Georgiev and Fajardo 2016; Salaün et al.
/// 2022).
const SIGMA_PX: f64 = 2.1;

/// The mean of `f(value) / (truth² + 0.01)` over the pixels of films of one shape.
pub fn relative_mean(film: &Film, truth: &Film, f: impl Fn(f64) -> f64) -> f64 {
    let pairs = film.values().iter().zip(truth.values());
    let terms = pairs.map(|(&value, &truth)| f(value) / (truth * truth + EPSILON));
    terms.sum::<f64>() / film.values().len() as f64
}

/// Compares a rendering of `spp` samples a pixel to the truth. `temporal` filters perceptual errors only, and
/// they are taken over the frames that have their whole past.
///
/// # Errors
/// Different shapes; 0 samples; a temporal kernel out of range or longer than the film.
pub fn compare(
    film: &Film,
    reference: &Reference,
    spp: u32,
    temporal: &TemporalKernel,
) -> Result<Comparison, RenderError> {
    super::error::not_empty("spp", spp as usize)?;
    let error = film.minus(&reference.mean)?;
    let map = |film: &Film, f: &dyn Fn(f64) -> f64| {
        Film::new(film.shape(), film.values().iter().map(|&value| f(value)).collect())
    };
    let white = map(&reference.variance, &|variance| variance / f64::from(spp))?;
    let floor = map(&reference.standard_error, &|error| error * error)?;
    let figure = |filter: &ImageFilter, relative: bool| -> Result<Figure, RenderError> {
        let truth = filter.apply(&reference.mean)?;
        let mean = |film: &Film, f: fn(f64) -> f64| match relative {
            true => relative_mean(film, &truth, f),
            false => film.values().iter().map(|&value| f(value)).sum::<f64>() / film.values().len() as f64,
        };
        Ok(Figure {
            value: mean(&filter.apply(&error)?, |e| e * e),
            white: mean(&filter.apply_to_variance(&white)?, |v| v),
            floor: mean(&filter.apply_to_variance(&floor)?, |v| v),
        })
    };
    let perceptual = |deviation_px: f64| {
        let SpatialKernel::Gaussian { sigma_px } = SpatialKernel::gaussian_from_deviation(deviation_px)
        else {
            unreachable!("a Gaussian is made from its deviation")
        };
        figure(&ImageFilter::gaussian(sigma_px)?.with_temporal(temporal)?, true)
    };
    Ok(Comparison {
        mse: figure(&ImageFilter::identity(), false)?,
        rel_mse: figure(&ImageFilter::identity(), true)?,
        p_rel_mse: perceptual(SIGMA_PX / std::f64::consts::SQRT_2)?,
        p_rel_mse_wide: perceptual(SIGMA_PX)?,
    })
}

#[cfg(test)]
#[path = "image_metrics_tests.rs"]
mod tests;
