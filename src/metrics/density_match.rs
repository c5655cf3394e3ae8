//! Whether points are where a density is, to the eye and to the count.

use super::block_deviation::BlockDeviation;
use super::coordinates::Coordinates;
use super::error::MeasureError;
use super::samples::Samples;
use crate::error::{RangeError, TargetError};
use crate::targets::Density;

/// How points follow a density: after both are blurred, and by their numbers in blocks of pixels.
///
/// ```
/// use fsot::metrics::{DensityMatch, Samples};
/// use fsot::targets::Density;
///
/// let left_half = Density::new(8, 1, vec![1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0])?;
/// let points = Samples::points(&[0.1, 0.5, 0.4, 0.2, 0.9, 0.5], 2)?;
/// assert_eq!(DensityMatch::measure(points, [0, 1], &left_half, 0.1)?.strays, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DensityMatch {
    /// Pearson's correlation of both blurred pictures over their pixels; 1 for a constant picture matched by
    /// a constant.
    pub correlation: f64,
    /// Points that the blurred density does not reach.
    pub strays: usize,
    /// The block of pixels whose number of points is the least likely for its mass. It tells what no blur
    /// shows: points that lie beside a bright pixel instead of in it.
    pub worst: BlockDeviation,
}

/// Standard deviations after which the Gaussian ends.
const REACH: f64 = 3.0;
/// Standard deviations in pixels beyond which the picture is averaged down first, and to how many.
const WIDE_PX: f64 = 48.0;
const AVERAGED_PX: f64 = 32.0;

impl DensityMatch {
    /// Blurs the density and the histogram of the points over its pixels with the Gaussian
    /// `exp(-r² / (2 sigma²))`, cut off after three standard deviations, and compares.
    ///
    /// `dims` names the coordinates that run to the right and down. `sigma`, in `(0, 1]`, is in units of the
    /// picture's longer side; about two distances between neighbouring points is what an eye blurs. Where it
    /// is more than 48 pixels, the picture is averaged down first, so that it is 32; [`DensityMatch::worst`]
    /// is always that of the picture itself. O(pixels + points · log points), in about 8 bytes a pixel where
    /// the picture is averaged down, and 40 elsewhere.
    ///
    /// # Errors
    /// Equal or missing dimensions; a `sigma` that is not positive, or beyond 1; not enough memory.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: [usize; 2],
        density: &Density,
        sigma: f64,
    ) -> Result<Self, MeasureError> {
        let points = Coordinates::gather(samples, &dims)?;
        if !(sigma > 0.0 && sigma <= 1.0) {
            let expected = "above 0, at most 1 (of the longer side)";
            return Err(RangeError::new("sigma", sigma, expected).into());
        }
        let pixels = points.points().map(|point| pixel_of(point, density.size())).collect();
        let worst = BlockDeviation::of(pixels, density)?;
        let sigma_px = |density: &Density| sigma * density.size().into_iter().max().unwrap_or(1) as f64;
        let fewer = match sigma_px(density) {
            wide if wide > WIDE_PX => (AVERAGED_PX / wide).powi(2) * density.values().len() as f64,
            _ => f64::INFINITY,
        };
        let density = &density.averaged_down(fewer.ceil() as usize)?;
        let ([width, height], sigma_px) = (density.size(), sigma_px(density));
        let pixel = |point: &[f64]| pixel_of(point, [width, height]);
        let mut histogram = zeros(width * height)?;
        points.points().for_each(|point| histogram[pixel(point)] += 1.0);
        let found = blurred(&histogram, width, sigma_px)?;
        let mut wanted = histogram;
        wanted.iter_mut().zip(density.values()).for_each(|(wanted, &value)| *wanted = value.into());
        let wanted = blurred(&wanted, width, sigma_px)?;
        let strays = points.points().filter(|point| wanted[pixel(point)] == 0.0).count();
        Ok(Self { correlation: correlation(&found, &wanted), strays, worst })
    }
}

/// The pixel in which a point lies.
fn pixel_of(point: &[f64], [width, height]: [usize; 2]) -> usize {
    let at = |value: f64, len: usize| ((value * len as f64) as usize).min(len - 1);
    at(point[1], height) * width + at(point[0], width)
}

/// A picture under a Gaussian; beyond its edges there is nothing.
fn blurred(picture: &[f64], width: usize, sigma_px: f64) -> Result<Vec<f64>, TargetError> {
    let reach = (REACH * sigma_px).ceil() as usize;
    let taps: Vec<f64> = (0..=reach).map(|r| (-0.5 * (r as f64 / sigma_px).powi(2)).exp()).collect();
    let height = picture.len() / width;
    let pass = |picture: &[f64], step: usize, len: usize, lines: &mut dyn Iterator<Item = usize>| {
        let mut out = zeros(picture.len())?;
        for first in lines {
            for at in 0..len {
                let from = at.saturating_sub(reach)..(at + reach + 1).min(len);
                let sum: f64 =
                    from.map(|other| taps[other.abs_diff(at)] * picture[first + other * step]).sum();
                out[first + at * step] = sum;
            }
        }
        Ok(out)
    };
    let rows = pass(picture, 1, width, &mut (0..height).map(|row| row * width))?;
    pass(&rows, width, height, &mut (0..width))
}

/// Nothing in each of these pixels.
fn zeros(pixels: usize) -> Result<Vec<f64>, TargetError> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(pixels).map_err(|_| TargetError::Memory { pixels })?;
    zeros.resize(pixels, 0.0);
    Ok(zeros)
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |x: &[f64], mean_x: f64, y: &[f64], mean_y: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum()
    };
    // What rounding leaves of a constant picture is none.
    let [spread_a, spread_b] = [(a, mean_a), (b, mean_b)].map(|(values, mean)| {
        let spread = product(values, mean, values, mean).sqrt();
        if spread > 1e-9 * mean * (values.len() as f64).sqrt() { spread } else { 0.0 }
    });
    match (spread_a > 0.0, spread_b > 0.0) {
        (true, true) => product(a, mean_a, b, mean_b) / (spread_a * spread_b),
        (false, false) => 1.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_the_density_match_and_others_stray() {
        let values = (0..64 * 64).map(|i| if i % 64 < 16 { 1.0 } else { 0.0 }).collect();
        let density = Density::new(64, 64, values).unwrap();
        let grid = |right: f64| -> Vec<f64> {
            (0..32 * 32).flat_map(|i| [f64::from(i % 32) / 32.0 * right, f64::from(i / 32) / 32.0]).collect()
        };
        let measure = |points: Vec<f64>| {
            DensityMatch::measure(Samples::points(&points, 2).unwrap(), [0, 1], &density, 0.02).unwrap()
        };
        let good = measure(grid(0.25));
        assert!(good.correlation > 0.99 && good.strays == 0, "{good:?}");
        let bad = measure(grid(1.0));
        // Columns from 0.25 + 3 · 0.02 on: 22 of 32.
        assert!(bad.correlation < 0.5 && (21..=23).contains(&(bad.strays / 32)), "{bad:?}");
    }

    /// Half of the mass in one pixel of 512 × 256, and 42.2 % of the points: what a blur takes for perfect.
    #[test]
    fn points_beside_a_bright_pixel_are_seen_by_their_number_alone() {
        let (width, count) = (512, 4096_usize);
        let mut values = vec![1.0; width * 256];
        values[100 * width + 300] = (width * 256 - 1) as f32;
        let density = Density::new(width, 256, values).unwrap();
        let set = |inside: usize, beside: usize| -> Vec<f64> {
            let grid = |i: usize, of: usize| [(i as f64 * 0.618_034).fract(), (i as f64 + 0.5) / of as f64];
            let place = |i: usize| match i {
                _ if i < inside => grid(i, inside).map(|x| 0.02 + 0.96 * x),
                _ if i < inside + beside => [-0.2, grid(i - inside, beside)[1]],
                _ => grid(i - inside - beside, count - inside - beside),
            };
            (0..count)
                .flat_map(|i| match place(i) {
                    [x, y] if i < inside + beside => [(300.0 + x) / 512.0, (100.0 + y) / 256.0],
                    other => other,
                })
                .collect()
        };
        let measure = |points: Vec<f64>| {
            DensityMatch::measure(Samples::points(&points, 2).unwrap(), [0, 1], &density, 0.02).unwrap()
        };
        let good = measure(set(2048, 0));
        assert!(good.correlation > 0.9999 && good.worst.deviation.abs() < 5.0, "{good:?}");
        let bad = measure(set(1728, 320));
        assert!(bad.correlation > 0.9999 && bad.strays == 0, "{bad:?}");
        // Ten standard errors are missing from the bright pixel; 320 points on the dark one beside it are
        // even less likely.
        let worst = bad.worst;
        assert!(worst.deviation > 9.9, "{bad:?}");
        assert_eq!([worst.column, worst.row, worst.side, worst.points], [299, 100, 1, 320], "{bad:?}");
    }
}
