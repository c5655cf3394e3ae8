//! Filter weights over the current frame and the frames before it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::taps::{NEGLIGIBLE, binomial, check_taps, checked_size, gaussian, range};
use crate::error::KernelError;

/// Filter weights over the current frame and the frames before it.
///
/// ```
/// use fsot::kernel::TemporalKernel;
///
/// let history = TemporalKernel::Ema { alpha: 0.5 }.taps()?;
/// assert_eq!(history[..3], [1.0, 0.5, 0.25]);
/// # Ok::<(), fsot::kernel::KernelError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum TemporalKernel {
    /// The current frame alone.
    #[default]
    None,
    /// `exp(-k² / sigma_frames²)` for the frame `k` back; the same convention as in space.
    Gaussian {
        /// Width in frames, in `(0, 1e6]`.
        sigma_frames: f64,
    },
    /// Exponential moving average `(1 - alpha)^k`, the history blend of temporal antialiasing.
    Ema {
        /// Weight of the current frame, in `[1e-6, 1]`.
        alpha: f64,
    },
    /// Equal weights on this many frames.
    Box {
        /// Frames.
        frames: usize,
    },
    /// Binomial coefficients over this many frames.
    Binomial {
        /// Frames, at most 1000.
        frames: usize,
    },
    /// Sustained and transient response of the visual system (FovVideoVDP, Mantiuk et al. 2021) as sampled by
    /// Korać et al. 2023 over 0.25 s. Negative weights have no level sets: the kernel ends before the first.
    Perceptual {
        /// Frames per second, in `(0, 10000]`.
        fps: f64,
    },
    /// Any weights, current frame first.
    Taps(Vec<f64>),
}

impl TemporalKernel {
    /// Weights of the current frame (first) and the frames before it, before folding.
    ///
    /// # Errors
    /// A parameter outside its documented range; a negative or non-finite weight; no positive weight.
    pub fn taps(&self) -> Result<Vec<f64>, KernelError> {
        let taps = match self {
            TemporalKernel::None => vec![1.0],
            TemporalKernel::Gaussian { sigma_frames } => gaussian("sigma_frames", *sigma_frames)?,
            TemporalKernel::Ema { alpha } => {
                if !(*alpha >= 1e-6 && *alpha <= 1.0) {
                    return Err(range("alpha", *alpha, "from 1e-6 to 1"));
                }
                let taps = std::iter::successors(Some(1.0), |tap| Some(tap * (1.0 - alpha)));
                taps.take_while(|&tap| tap > NEGLIGIBLE).collect()
            }
            TemporalKernel::Box { frames } => vec![1.0; checked_size("frames of the box", *frames)?],
            TemporalKernel::Binomial { frames } => binomial("frames of the binomial", *frames)?,
            TemporalKernel::Perceptual { fps } => perceptual(*fps)?,
            TemporalKernel::Taps(taps) => taps.clone(),
        };
        check_taps("the temporal kernel", taps.iter().copied())?;
        Ok(taps)
    }

    /// Weights of the offsets `dt ≤ 0` on an animation that wraps.
    pub(super) fn folded(&self, frames: usize) -> Result<BTreeMap<i32, f64>, KernelError> {
        if let TemporalKernel::Ema { alpha } = *self
            && (1e-6..SLOW).contains(&alpha)
        {
            // Millions of taps. Every time around the animation is the same again, up to a factor.
            let taps = std::iter::successors(Some(1.0), |tap| Some(tap * (1.0 - alpha)));
            let taps = taps.take(frames).take_while(|&tap| tap > NEGLIGIBLE);
            return Ok(taps.enumerate().map(|(back, weight)| (-(back as i32), weight)).collect());
        }
        let taps = self.taps()?;
        if taps.len() < frames {
            return Ok(taps.into_iter().enumerate().map(|(back, weight)| (-(back as i32), weight)).collect());
        }
        let mut sums = vec![0.0; frames];
        for taps in taps.chunks(frames) {
            sums.iter_mut().zip(taps).for_each(|(sum, weight)| *sum += weight);
        }
        Ok(sums.into_iter().enumerate().map(|(back, sum)| (-(back as i32), sum)).collect())
    }
}

/// Weight of the current frame below which a moving average has more than a quarter of a million taps.
const SLOW: f64 = 1e-4;

/// Taps of the perceptual kernel, current frame first (Korać et al. 2023, their 15 taps at 60 fps to 4e-16).
fn perceptual(fps: f64) -> Result<Vec<f64>, KernelError> {
    const SECONDS: f64 = 0.25;
    const TRANSIENT: f64 = 0.062_170_507_756_932;
    if !(fps > 0.0 && fps <= 1e4) {
        return Err(range("fps", fps, "above 0, at most 10000"));
    }
    let len = (SECONDS * fps).ceil() as usize;
    // None, of the least positive numbers.
    if len <= 1 {
        return Ok(vec![1.0]);
    }
    let spacing = SECONDS / (len - 1) as f64;
    let sustained: Vec<f64> = (0..len)
        .map(|i| {
            let log_ratio = (i as f64 * spacing + 1e-4).ln() - 0.06_f64.ln();
            (-log_ratio * log_ratio / (2.0 * 0.5 * 0.5)).exp()
        })
        .collect();
    let sum: f64 = sustained.iter().sum();
    let transient = |i: usize| match sustained.get(i + 1) {
        Some(next) => TRANSIENT * (next - sustained[i]) / sum / spacing,
        None => 0.0,
    };
    let taps: Vec<f64> = (0..len).map(|i| sustained[i] / sum + transient(i)).collect();
    let sum: f64 = taps.iter().sum();
    // The last tap is positive again only because its transient part is cut off; it belongs to the tail.
    Ok(taps.into_iter().map(|tap| tap / sum).take_while(|&tap| tap > 0.0).collect())
}
