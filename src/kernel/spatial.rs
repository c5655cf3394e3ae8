//! Filter weights over the pixels of a frame.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::taps::{NEGLIGIBLE, binomial, centred, check_taps, checked_size, drop_below, fold, gaussian};
use crate::error::KernelError;
use crate::table::extent::Extent;

/// Filter weights over the pixels of a frame, centred on the pixel that is filtered.
///
/// ```
/// use fsot::kernel::SpatialKernel;
///
/// // The convention of Wolfe et al. 2022: a standard deviation.
/// let SpatialKernel::Gaussian { sigma_px } = SpatialKernel::gaussian_from_deviation(1.5) else { panic!() };
/// assert!((sigma_px - 1.5 * 2.0_f64.sqrt()).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum SpatialKernel {
    /// `exp(-r² / sigma_px²)` with `r` in pixels; `sigma_px` in `(0, 1e6]`. The papers use 2.1.
    Gaussian {
        /// Width in pixels; the standard deviation is `sigma_px / √2`.
        sigma_px: f64,
    },
    /// Equal weights on `size` × `size` pixels; an even size reaches one pixel further right and down.
    Box {
        /// Side in pixels.
        size_px: usize,
    },
    /// Outer product of the binomial coefficients of `size_px` taps, centred as [`SpatialKernel::Box`] is.
    Binomial {
        /// Side in pixels, at most 1000.
        size_px: usize,
    },
    /// Any list of taps; repeated offsets add up.
    Taps(Vec<SpatialTap>),
    /// Other taps for each frame back: the first list is of the current frame, the last one of all frames
    /// from there on. The weights of a frame are multiplied by that of the temporal kernel, so that without
    /// one the first list is left. Makes any filter over pixels and frames.
    PerFrame(Vec<Vec<SpatialTap>>),
}

/// One tap of a custom spatial kernel.
///
/// ```
/// use fsot::kernel::{SpatialKernel, SpatialTap};
///
/// // A pixel and its right neighbour.
/// let taps = [(0, 1.0), (1, 0.5)].map(|(dx, weight)| SpatialTap { dy: 0, dx, weight });
/// let kernel = SpatialKernel::Taps(taps.to_vec());
/// # let _ = kernel;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpatialTap {
    /// Rows down from the filtered pixel.
    pub dy: i32,
    /// Columns right from the filtered pixel.
    pub dx: i32,
    /// Weight, finite and at least 0.
    pub weight: f64,
}

impl SpatialKernel {
    /// The Gaussian with this *standard deviation* in pixels, `exp(-r² / (2 s²))`.
    pub fn gaussian_from_deviation(deviation_px: f64) -> Self {
        SpatialKernel::Gaussian { sigma_px: deviation_px * std::f64::consts::SQRT_2 }
    }

    /// Weights of the offsets `(dy, dx)` on a tile that wraps.
    pub(super) fn folded(&self, extent: &Extent) -> Result<BTreeMap<(i32, i32), f64>, KernelError> {
        let axis = match self {
            SpatialKernel::Gaussian { sigma_px } => gaussian("sigma_px", *sigma_px)?,
            SpatialKernel::Box { size_px } => vec![1.0; checked_size("size_px", *size_px)?],
            SpatialKernel::Binomial { size_px } => binomial("size_px", *size_px)?,
            SpatialKernel::Taps(taps) => return folded_taps(taps, extent),
            SpatialKernel::PerFrame(frames) => {
                return folded_taps(frames.first().map_or(&[], Vec::as_slice), extent);
            }
        };
        // A Gaussian is given by its right half, the others by all their taps.
        let symmetric = matches!(self, SpatialKernel::Gaussian { .. });
        let offsets = || {
            let first = if symmetric { 0 } else { (axis.len() as i64 - 1) / 2 };
            axis.iter().enumerate().flat_map(move |(tap, &weight)| {
                let offset = tap as i64 - first;
                let mirrored = (symmetric && tap > 0).then_some((-offset, weight));
                std::iter::once((offset, weight)).chain(mirrored)
            })
        };
        let fold = |len: usize| {
            let mut folded = fold(offsets(), axis.len() >= len, len);
            drop_below(&mut folded, NEGLIGIBLE);
            folded
        };
        let (rows, columns) = (fold(extent.height), fold(extent.width));
        let mut folded = BTreeMap::new();
        for (&dy, &row) in &rows {
            for (&dx, &column) in &columns {
                folded.insert((dy, dx), row * column);
            }
        }
        Ok(folded)
    }
}

/// Weights of taps by their offsets on a tile that wraps.
pub(super) fn folded_taps(
    taps: &[SpatialTap],
    extent: &Extent,
) -> Result<BTreeMap<(i32, i32), f64>, KernelError> {
    check_taps("the spatial kernel", taps.iter().map(|tap| tap.weight))?;
    let mut folded = BTreeMap::new();
    for tap in taps {
        let offset = (centred(tap.dy.into(), extent.height), centred(tap.dx.into(), extent.width));
        *folded.entry(offset).or_default() += tap.weight;
    }
    Ok(folded)
}
