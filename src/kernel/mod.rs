//! Filters over pixels and frames, and their taps: lattice offsets sorted by falling weight.
//!
//! Conventions, stated once. The spatial Gaussian is `exp(-r² / sigma_px²)` (Georgiev and Fajardo 2016;
//! Salaün et al. 2022), whose standard deviation is `sigma_px / √2`;
//! [`SpatialKernel::gaussian_from_deviation`] takes the other convention, `exp(-r² / (2 s²))` (Wolfe et al.
//! 2022; Donnelly et al. 2024). Temporal kernels weight the current and *past* frames. Weights are relative:
//! only their ratios matter.

mod autocorrelation;
pub(crate) mod fft;
mod per_frame;
mod spatial;
mod taps;
mod temporal;
mod weights;

use serde::{Deserialize, Serialize};

pub use self::autocorrelation::autocorrelation;
pub use self::spatial::{SpatialKernel, SpatialTap};
pub use self::taps::Tap;
use self::taps::{NEGLIGIBLE, drop_below, maximum, range, to_unit};
pub use self::temporal::TemporalKernel;
pub use self::weights::check_fit;
pub use crate::error::KernelError;
use crate::table::extent::Extent;

/// A filter over pixels and frames: the product of a spatial and a temporal kernel.
///
/// The other combination in use, *separate* (a spatial filter in every frame and a temporal filter at every
/// pixel, Wolfe et al. 2022), is two kernels: [`Kernel::separate`]. Filters of given weights are made by
/// [`Kernel::from_weights`] and [`Kernel::from_frame_weights`].
///
/// ```
/// use fsot::kernel::{SpatialKernel, TemporalKernel};
/// use fsot::{Extent, Kernel};
///
/// // What temporal antialiasing with a weight of a tenth shows of a box of 3 by 3 pixels.
/// let space = SpatialKernel::Box { size_px: 3 };
/// let kernel = Kernel::product(space, TemporalKernel::Ema { alpha: 0.1 });
/// let taps = kernel.taps(&Extent::animation(64, 32, 32))?;
/// assert_eq!(taps.iter().filter(|tap| tap.dt == -1).count(), 9);
/// # Ok::<(), fsot::kernel::KernelError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kernel {
    /// Weights in space.
    pub spatial: SpatialKernel,
    /// Weights in time.
    #[serde(default)]
    pub temporal: TemporalKernel,
    /// Taps below this share of the largest are dropped; in `[0, 1)`. The default, 1e-3, keeps 97 taps of the
    /// Gaussian with `sigma_px = 2.1` and 99.9 % of its weight; 0 keeps everything down to 1e-12.
    #[serde(default = "thousandth")]
    pub truncation: f64,
}

impl Kernel {
    /// The spatial Gaussian `exp(-r² / sigma_px²)` alone, whose standard deviation is `sigma_px / √2`.
    ///
    /// ```
    /// use fsot::{Extent, Kernel};
    ///
    /// let taps = Kernel::gaussian(2.1).taps(&Extent::still(64, 64))?;
    /// assert_eq!((taps.len(), taps[0].weight), (97, 1.0));
    /// # Ok::<(), fsot::kernel::KernelError>(())
    /// ```
    pub fn gaussian(sigma_px: f64) -> Self {
        Self::product(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None)
    }

    /// The same in space, times this in time.
    #[must_use]
    pub fn with_temporal(self, temporal: TemporalKernel) -> Self {
        Self { temporal, ..self }
    }

    /// The product of both, with the default truncation.
    pub fn product(spatial: SpatialKernel, temporal: TemporalKernel) -> Self {
        Self { spatial, temporal, truncation: thousandth() }
    }

    /// The spatial filter within a frame, and the temporal filter within a pixel, as two kernels.
    pub fn separate(spatial: SpatialKernel, temporal: TemporalKernel) -> [Self; 2] {
        let point = SpatialKernel::Box { size_px: 1 };
        [Self::product(spatial, TemporalKernel::None), Self::product(point, temporal)]
    }

    /// The taps of the kernel on a table that wraps, by falling weight.
    ///
    /// A kernel wider than the tile or longer than the animation folds onto itself: each offset occurs once,
    /// with the sum of its images' weights. Weights that differ by rounding only (relative 1e-9) are made
    /// equal, so that level sets keep the kernel's symmetry.
    ///
    /// # Errors
    /// An empty extent; a parameter outside its documented range; a negative or non-finite weight; no
    /// positive weight.
    pub fn taps(&self, extent: &Extent) -> Result<Vec<Tap>, KernelError> {
        extent.validate(1)?;
        if !(0.0..1.0).contains(&self.truncation) {
            return Err(range("truncation", self.truncation, "in [0, 1)"));
        }
        let truncation = self.truncation.max(NEGLIGIBLE);
        if let SpatialKernel::PerFrame(frames) = &self.spatial {
            return Ok(in_order(per_frame::taps(frames, &self.temporal, truncation, extent)?));
        }
        let mut temporal = self.temporal.folded(extent.frames)?;
        let mut spatial = self.spatial.folded(extent)?;
        // Products of large or small weights would leave the range of numbers.
        to_unit(&mut temporal);
        to_unit(&mut spatial);
        drop_below(&mut temporal, truncation);
        drop_below(&mut spatial, truncation);
        let largest = maximum(&temporal) * maximum(&spatial);
        let mut taps = Vec::new();
        for (&dt, &in_time) in &temporal {
            for (&(dy, dx), &in_space) in &spatial {
                let weight = in_time * in_space / largest;
                if weight >= truncation {
                    taps.push(Tap { dt, dy, dx, weight });
                }
            }
        }
        Ok(in_order(taps))
    }
}

fn thousandth() -> f64 {
    1e-3
}

/// By falling weight, and those that differ by rounding only made equal.
fn in_order(mut taps: Vec<Tap>) -> Vec<Tap> {
    // Stable: equal weights stay in the order of their offsets.
    taps.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    for tap in 1..taps.len() {
        if taps[tap].weight > taps[tap - 1].weight * (1.0 - 1e-9) {
            taps[tap].weight = taps[tap - 1].weight;
        }
    }
    taps
}

#[cfg(test)]
mod tests;
