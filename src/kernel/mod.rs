//! Filters over pixels and frames, and their taps: lattice offsets sorted by falling weight.
//!
//! Conventions, stated once. The spatial Gaussian is `exp(-r² / sigma_px²)` (Georgiev and Fajardo 2016; Salaün
//! et al. 2022), whose standard deviation is `sigma_px / √2`; [`SpatialKernel::gaussian_from_deviation`] takes
//! the other convention, `exp(-r² / (2 s²))` (Wolfe et al. 2022; Donnelly et al. 2024). Temporal kernels weight
//! the current and *past* frames. Weights are relative: only their ratios matter.

mod autocorrelation;

pub use self::autocorrelation::autocorrelation;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::error::ConfigError;
use crate::table::extent::Extent;

/// Filter weights over the pixels of a frame, centred on the pixel that is filtered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
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
}

/// One tap of a custom spatial kernel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpatialTap {
    /// Rows down from the filtered pixel.
    pub dy: i32,
    /// Columns right from the filtered pixel.
    pub dx: i32,
    /// Weight, finite and at least 0.
    pub weight: f64,
}

/// Filter weights over the current frame and the frames before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TemporalKernel {
    /// The current frame alone.
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

/// A filter over pixels and frames: the product of a spatial and a temporal kernel.
///
/// The other combination in use, *separate* (a spatial filter in every frame and a temporal filter at every
/// pixel, Wolfe et al. 2022), is two kernels: [`Kernel::separate`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kernel {
    /// Weights in space.
    pub spatial: SpatialKernel,
    /// Weights in time.
    pub temporal: TemporalKernel,
    /// Taps below this share of the largest are dropped; in `[0, 1)`. The default, 1e-3, keeps 97 taps of the
    /// Gaussian with `sigma_px = 2.1` and 99.9 % of its weight; 0 keeps everything down to 1e-12.
    pub truncation: f64,
}

/// One lattice offset of a kernel and its weight relative to the largest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tap {
    /// Frames forward, so at most 0: the filter looks back.
    pub dt: i32,
    /// Rows down.
    pub dy: i32,
    /// Columns right.
    pub dx: i32,
    /// Weight in `(0, 1]`; the largest is 1.
    pub weight: f64,
}

impl SpatialKernel {
    /// The Gaussian with this *standard deviation* in pixels, `exp(-r² / (2 s²))`.
    pub fn gaussian_from_deviation(deviation_px: f64) -> Self {
        SpatialKernel::Gaussian { sigma_px: deviation_px * std::f64::consts::SQRT_2 }
    }

    /// Weights of the offsets `(dy, dx)` on a tile that wraps.
    fn folded(&self, extent: &Extent) -> Result<BTreeMap<(i32, i32), f64>, ConfigError> {
        let mut folded = BTreeMap::new();
        let axis = match self {
            SpatialKernel::Gaussian { sigma_px } => gaussian("sigma_px", *sigma_px)?,
            SpatialKernel::Box { size_px } => vec![1.0; checked_size("size_px", *size_px)?],
            SpatialKernel::Binomial { size_px } => binomial("size_px", *size_px)?,
            SpatialKernel::Taps(taps) => {
                check_taps("the spatial kernel", taps.iter().map(|tap| tap.weight))?;
                for tap in taps {
                    let offset =
                        (centred(tap.dy.into(), extent.height), centred(tap.dx.into(), extent.width));
                    *folded.entry(offset).or_default() += tap.weight;
                }
                return Ok(folded);
            }
        };
        // A Gaussian is given by its right half, the others by all their taps.
        let symmetric = matches!(self, SpatialKernel::Gaussian { .. });
        let fold = |len: usize| {
            let mut folded = BTreeMap::new();
            for (tap, &weight) in axis.iter().enumerate() {
                let offset = if symmetric { tap as i64 } else { tap as i64 - (axis.len() as i64 - 1) / 2 };
                *folded.entry(centred(offset, len)).or_insert(0.0) += weight;
                if symmetric && tap > 0 {
                    *folded.entry(centred(-offset, len)).or_insert(0.0) += weight;
                }
            }
            drop_below(&mut folded, NEGLIGIBLE);
            folded
        };
        let (rows, columns) = (fold(extent.height), fold(extent.width));
        for (&dy, &row) in &rows {
            for (&dx, &column) in &columns {
                folded.insert((dy, dx), row * column);
            }
        }
        Ok(folded)
    }
}

impl TemporalKernel {
    /// Weights of the current frame (first) and the frames before it, before folding.
    ///
    /// # Errors
    /// A parameter outside its documented range; a negative or non-finite weight; no positive weight.
    pub fn taps(&self) -> Result<Vec<f64>, ConfigError> {
        let taps = match self {
            TemporalKernel::None => vec![1.0],
            TemporalKernel::Gaussian { sigma_frames } => gaussian("sigma_frames", *sigma_frames)?,
            TemporalKernel::Ema { alpha } => {
                if !(*alpha >= 1e-6 && *alpha <= 1.0) {
                    return Err(out_of_range("alpha", *alpha, "from 1e-6 to 1"));
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
    fn folded(&self, frames: usize) -> Result<BTreeMap<i32, f64>, ConfigError> {
        let mut folded = BTreeMap::new();
        for (back, weight) in self.taps()?.into_iter().enumerate() {
            *folded.entry(-((back % frames) as i32)).or_insert(0.0) += weight;
        }
        Ok(folded)
    }
}

impl Kernel {
    /// The product of both, with the default truncation.
    pub fn product(spatial: SpatialKernel, temporal: TemporalKernel) -> Self {
        Self { spatial, temporal, truncation: 1e-3 }
    }

    /// The spatial filter within a frame, and the temporal filter within a pixel, as two kernels.
    pub fn separate(spatial: SpatialKernel, temporal: TemporalKernel) -> [Self; 2] {
        let point = SpatialKernel::Box { size_px: 1 };
        [Self::product(spatial, TemporalKernel::None), Self::product(point, temporal)]
    }

    /// The taps of the kernel on a table that wraps, by falling weight.
    ///
    /// A kernel wider than the tile or longer than the animation folds onto itself: each offset occurs once, with
    /// the sum of its images' weights. Weights that differ by rounding only (relative 1e-9) are made equal, so
    /// that level sets keep the kernel's symmetry.
    ///
    /// # Errors
    /// An empty extent; a parameter outside its documented range; a negative or non-finite weight; no positive weight.
    pub fn taps(&self, extent: &Extent) -> Result<Vec<Tap>, ConfigError> {
        extent.validate(1)?;
        if !(0.0..1.0).contains(&self.truncation) {
            return Err(out_of_range("truncation", self.truncation, "in [0, 1)"));
        }
        let truncation = self.truncation.max(NEGLIGIBLE);
        let mut temporal = self.temporal.folded(extent.frames)?;
        let mut spatial = self.spatial.folded(extent)?;
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
        // Stable: equal weights stay in the order of their offsets.
        taps.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        for tap in 1..taps.len() {
            if taps[tap].weight > taps[tap - 1].weight * (1.0 - 1e-9) {
                taps[tap].weight = taps[tap - 1].weight;
            }
        }
        Ok(taps)
    }
}

/// Relative weight below which even an untruncated kernel ends.
const NEGLIGIBLE: f64 = 1e-12;

fn out_of_range(name: &'static str, value: f64, expected: &'static str) -> ConfigError {
    ConfigError::OutOfRange { name, value, expected }
}

/// Right half `exp(-k² / sigma²)`, `k = 0, 1, …`, down to [`NEGLIGIBLE`].
fn gaussian(name: &'static str, sigma: f64) -> Result<Vec<f64>, ConfigError> {
    if !(sigma > 0.0 && sigma <= 1e6) {
        return Err(out_of_range(name, sigma, "above 0, at most 1e6"));
    }
    let weight = |k: u32| (-(f64::from(k) / sigma).powi(2)).exp();
    Ok((0..).map(weight).take_while(|&weight| weight > NEGLIGIBLE).collect())
}

/// Binomial coefficients `C(size - 1, k)` relative to the largest.
fn binomial(name: &'static str, size: usize) -> Result<Vec<f64>, ConfigError> {
    if !(1..=1000).contains(&size) {
        return Err(out_of_range(name, size as f64, "from 1 to 1000"));
    }
    let ratio = |k: usize| (size - k) as f64 / k as f64;
    let mut taps = vec![1.0];
    for k in 1..size {
        taps.push(taps[k - 1] * ratio(k));
    }
    // At most C(999, 499) ≈ 1e300, still finite.
    let largest = taps.iter().copied().fold(0.0, f64::max);
    Ok(taps.into_iter().map(|tap| tap / largest).collect())
}

fn checked_size(name: &'static str, size: usize) -> Result<usize, ConfigError> {
    if (1..=1_000_000).contains(&size) {
        Ok(size)
    } else {
        Err(out_of_range(name, size as f64, "from 1 to 1000000"))
    }
}

/// Taps of the perceptual kernel, current frame first (Korać et al. 2023, their 15 taps at 60 fps to 4e-16).
fn perceptual(fps: f64) -> Result<Vec<f64>, ConfigError> {
    const SECONDS: f64 = 0.25;
    const TRANSIENT: f64 = 0.062_170_507_756_932;
    if !(fps > 0.0 && fps <= 1e4) {
        return Err(out_of_range("fps", fps, "above 0, at most 10000"));
    }
    let len = (SECONDS * fps).ceil() as usize;
    if len == 1 {
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

fn check_taps(kernel: &'static str, weights: impl Iterator<Item = f64> + Clone) -> Result<(), ConfigError> {
    for (index, weight) in weights.clone().enumerate() {
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(ConfigError::BadTap { kernel, index, weight });
        }
    }
    if !weights.clone().sum::<f64>().is_finite() {
        return Err(out_of_range("the sum of a kernel's weights", f64::INFINITY, "that is finite"));
    }
    if !weights.into_iter().any(|weight| weight > 0.0) {
        return Err(ConfigError::EmptyKernel { kernel });
    }
    Ok(())
}

/// The offset on an axis that wraps, in `(-len/2, len/2]`.
fn centred(offset: i64, len: usize) -> i32 {
    let len = len as i64;
    let wrapped = offset.rem_euclid(len);
    (if 2 * wrapped > len { wrapped - len } else { wrapped }) as i32
}

fn maximum<K>(weights: &BTreeMap<K, f64>) -> f64 {
    weights.values().copied().fold(0.0, f64::max)
}

fn drop_below<K: Ord>(weights: &mut BTreeMap<K, f64>, share: f64) {
    let least = share * maximum(weights);
    weights.retain(|_, weight| *weight >= least);
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const TILE: Extent = Extent { frames: 10, height: 64, width: 64, spp: 1 };

    fn paper() -> SpatialKernel {
        SpatialKernel::Gaussian { sigma_px: 2.1 }
    }

    fn mean_size(taps: &[Tap]) -> f64 {
        taps.iter().map(|tap| tap.weight).sum()
    }

    #[test]
    fn the_papers_gaussian_has_97_taps_of_13_8_in_the_mean() {
        let taps = Kernel::product(paper(), TemporalKernel::None).taps(&TILE).unwrap();
        assert_eq!(taps.len(), 97);
        assert_relative_eq!(mean_size(&taps), 13.8, epsilon = 0.05); // design: 13.8 samples per slice
        assert_eq!(taps[0], Tap { dt: 0, dy: 0, dx: 0, weight: 1.0 });
        for tap in &taps {
            let expected = (-f64::from(tap.dx * tap.dx + tap.dy * tap.dy) / (2.1 * 2.1)).exp();
            assert_relative_eq!(tap.weight, expected, max_relative = 1e-8);
        }
    }

    #[test]
    fn level_sets_are_whole_shells() {
        let taps = Kernel::product(paper(), TemporalKernel::None).taps(&TILE).unwrap();
        let weight_at = |dy, dx| taps.iter().find(|tap| (tap.dy, tap.dx) == (dy, dx)).unwrap().weight;
        assert_eq!(weight_at(0, 5), weight_at(3, -4)); // both at r² = 25
        assert_eq!(weight_at(1, 2), weight_at(-2, 1));
    }

    #[test]
    fn both_gaussian_conventions_meet() {
        let ours = Kernel::product(paper(), TemporalKernel::None).taps(&TILE).unwrap();
        let deviation = SpatialKernel::gaussian_from_deviation(2.1 / 2.0_f64.sqrt());
        let other = Kernel::product(deviation, TemporalKernel::None).taps(&TILE).unwrap();
        assert_eq!(ours.len(), other.len());
        for (a, b) in ours.iter().zip(&other) {
            assert_relative_eq!(a.weight, b.weight, max_relative = 1e-8);
        }
    }

    #[test]
    fn perceptual_taps_are_those_of_the_paper_at_60_fps() {
        // The first five of Korać et al.'s fifteen taps, as quoted in the project's design notes.
        let expected = [
            0.039_558_285_065_590_9,
            0.398_409_765_599_820,
            0.404_689_211_439_515,
            0.177_879_764_807_883,
            0.041_913_619_519_731_5,
        ];
        let taps = TemporalKernel::Perceptual { fps: 60.0 }.taps().unwrap();
        assert_eq!(taps.len(), expected.len());
        for (tap, expected) in taps.iter().zip(expected) {
            assert!((tap - expected).abs() < 1e-14, "{tap} {expected}");
        }
        assert_eq!(TemporalKernel::Perceptual { fps: 3.0 }.taps().unwrap(), [1.0]);
    }

    #[test]
    fn the_perceptual_kernel_peaks_two_frames_back() {
        let taps = Kernel::product(paper(), TemporalKernel::Perceptual { fps: 60.0 }).taps(&TILE).unwrap();
        assert_eq!(taps[0], Tap { dt: -2, dy: 0, dx: 0, weight: 1.0 });
        // Sum of the five taps over the largest, times the spatial mean size: 36 samples per slice.
        assert_relative_eq!(mean_size(&taps), 36.3, epsilon = 0.2);
    }

    #[test]
    fn temporal_families_have_their_textbook_taps() {
        assert_eq!(TemporalKernel::Binomial { frames: 4 }.taps().unwrap(), [1.0 / 3.0, 1.0, 1.0, 1.0 / 3.0]);
        assert_eq!(TemporalKernel::Box { frames: 3 }.taps().unwrap(), [1.0; 3]);
        let ema = TemporalKernel::Ema { alpha: 0.1 }.taps().unwrap();
        for (k, tap) in ema.iter().enumerate() {
            assert_relative_eq!(*tap, 0.9_f64.powi(k as i32), max_relative = 1e-12);
        }
        assert_eq!(TemporalKernel::Ema { alpha: 1.0 }.taps().unwrap(), [1.0]);
        let gaussian = TemporalKernel::Gaussian { sigma_frames: 2.0 }.taps().unwrap();
        assert_relative_eq!(gaussian[2], (-1.0_f64).exp());
    }

    #[test]
    fn wide_kernels_fold_onto_the_tile_once() {
        let extent = Extent { frames: 3, height: 5, width: 4, spp: 1 };
        let kernel =
            Kernel { spatial: paper(), temporal: TemporalKernel::Ema { alpha: 0.2 }, truncation: 0.0 };
        let taps = kernel.taps(&extent).unwrap();
        assert_eq!(taps.len(), extent.sites());
        // Brute force over all images; the common factor is the weight of the largest tap.
        let images = |tap: &Tap| {
            let mut sum = 0.0;
            for back in (0..200).filter(|back| (back + tap.dt).rem_euclid(3) == 0) {
                for dy in (-40..=40).filter(|dy| (dy - tap.dy).rem_euclid(5) == 0) {
                    for dx in (-40..=40).filter(|dx| (dx - tap.dx).rem_euclid(4) == 0) {
                        sum += 0.8_f64.powi(back) * (-f64::from(dx * dx + dy * dy) / 2.1_f64.powi(2)).exp();
                    }
                }
            }
            sum
        };
        let largest = images(&taps[0]);
        for tap in &taps {
            assert_relative_eq!(tap.weight, images(tap) / largest, max_relative = 1e-8);
        }
    }

    #[test]
    fn extreme_widths_end_as_one_tap_or_as_a_constant() {
        let with = |sigma_px| Kernel::product(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
        assert_eq!(with(0.01).taps(&TILE).unwrap().len(), 1);
        let wide = with(1000.0).taps(&TILE).unwrap();
        assert_eq!(wide.len(), 64 * 64);
        assert!(wide.iter().all(|tap| (tap.weight - 1.0).abs() < 1e-9));
    }

    #[test]
    fn boxes_binomials_and_custom_taps_stand_where_documented() {
        let offsets = |spatial| -> Vec<_> {
            let taps = Kernel::product(spatial, TemporalKernel::None).taps(&TILE).unwrap();
            taps.iter().map(|tap| (tap.dy, tap.dx, tap.weight)).collect()
        };
        assert_eq!(
            offsets(SpatialKernel::Box { size_px: 2 }),
            [(0, 0, 1.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 1.0)]
        );
        let binomial = offsets(SpatialKernel::Binomial { size_px: 3 });
        assert_eq!(binomial[0], (0, 0, 1.0));
        assert_eq!(binomial[1], (-1, 0, 0.5));
        assert_eq!(binomial[8].2, 0.25);
        let tap = |dy, dx, weight| SpatialTap { dy, dx, weight };
        let custom = SpatialKernel::Taps(vec![tap(0, 0, 1.0), tap(-1, 63, 2.0), tap(-1, -1, 2.0)]);
        assert_eq!(offsets(custom), [(-1, -1, 1.0), (0, 0, 0.25)]);
    }

    #[test]
    fn separate_is_two_kernels() {
        let [space, time] = Kernel::separate(paper(), TemporalKernel::Box { frames: 3 });
        assert!(space.taps(&TILE).unwrap().iter().all(|tap| tap.dt == 0));
        let time = time.taps(&TILE).unwrap();
        assert!(time.iter().all(|tap| (tap.dy, tap.dx) == (0, 0)));
        assert_eq!(time.len(), 3);
    }

    #[test]
    fn bad_parameters_are_named() {
        let taps = |spatial, temporal| Kernel::product(spatial, temporal).taps(&TILE).unwrap_err();
        for sigma_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = taps(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
            assert!(matches!(error, ConfigError::OutOfRange { name: "sigma_px", .. }), "{error}");
        }
        for alpha in [0.0, 1.1, f64::NAN] {
            let error = taps(paper(), TemporalKernel::Ema { alpha });
            assert!(matches!(error, ConfigError::OutOfRange { name: "alpha", .. }), "{error}");
        }
        let error = taps(paper(), TemporalKernel::Taps(vec![1.0, -0.5]));
        assert_eq!(error, ConfigError::BadTap { kernel: "the temporal kernel", index: 1, weight: -0.5 });
        let error = taps(SpatialKernel::Taps(vec![]), TemporalKernel::None);
        assert_eq!(error, ConfigError::EmptyKernel { kernel: "the spatial kernel" });
        for temporal in [TemporalKernel::Box { frames: 0 }, TemporalKernel::Binomial { frames: 0 }] {
            assert!(matches!(taps(paper(), temporal), ConfigError::OutOfRange { value: 0.0, .. }));
        }
        assert!(matches!(
            taps(paper(), TemporalKernel::Perceptual { fps: 0.0 }),
            ConfigError::OutOfRange { name: "fps", .. }
        ));
        let kernel = Kernel { truncation: 1.0, ..Kernel::product(paper(), TemporalKernel::None) };
        assert!(matches!(kernel.taps(&TILE), Err(ConfigError::OutOfRange { name: "truncation", .. })));
    }
}
