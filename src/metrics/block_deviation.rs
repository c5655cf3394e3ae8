//! Where a density holds too few or too many points for its mass.

use std::fmt::{Display, Formatter};

use serde::Serialize;

use crate::error::TargetError;
use crate::targets::Density;

/// The block of pixels whose number of points is the least likely for its mass.
///
/// Blocks are the pixels themselves, squares of 2 by 2 pixels, 4 by 4, and so on up to the whole picture,
/// counted from its upper left corner.
///
/// ```
/// use fsot::metrics::{DensityMatch, Samples};
/// use fsot::targets::Density;
///
/// // Half of the mass is in one pixel of 64, and a quarter of 400 points.
/// let mut values = vec![1.0; 64];
/// values[20] = 63.0;
/// let density = Density::new(8, 8, values)?;
/// let spread = (0..300).map(|i| [f64::from(i % 20) / 20.0, f64::from(i / 20) / 15.0]);
/// let points: Vec<f64> = spread.chain((0..100).map(|_| [0.55, 0.3])).flatten().collect();
/// let worst = DensityMatch::measure(Samples::points(&points, 2)?, [0, 1], &density, 0.1)?.worst;
/// assert_eq!([worst.column, worst.row, worst.side], [4, 2, 1]);
/// // 200 ± 10 points were expected.
/// assert!(worst.deviation < -9.0 && worst.points < 110, "{worst:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct BlockDeviation {
    /// How far the number of points is from the share `p` of the mass, in units of the sampling error `sqrt(n
    /// p (1 − p))` of `n` independent points; negative where points are missing.
    ///
    /// More exactly the signed root of the deviance of the binomial law, which agrees with that where many
    /// points are expected, and says how unlikely a number is where few are; an expectation below one counts
    /// as one where there are points, since they cannot be where the picture is dark in less. The worst of
    /// all blocks is about 4 for independent draws of the density and 2 to 3 for optimised ones; where it is
    /// more than 6, mass was lost. What hundreds of bright pixels lose to those between them, a few points
    /// each, no block shows.
    pub deviation: f64,
    /// Its first column.
    pub column: usize,
    /// Its first row.
    pub row: usize,
    /// Columns and rows; fewer at the picture's edges.
    pub side: usize,
    /// Points that it holds.
    pub points: usize,
    /// Points that its mass calls for.
    pub expected: f64,
}

impl Display for BlockDeviation {
    fn fmt(&self, out: &mut Formatter) -> std::fmt::Result {
        let &Self { deviation, column, row, side, points, expected } = self;
        write!(
            out,
            "{:.1} standard errors: {points} points for {expected:.1} in the {side} x {side} pixels from \
             column {column}, row {row} on",
            deviation.abs()
        )
    }
}

/// Points and mass of blocks of one size, row by row.
struct Level {
    columns: usize,
    points: Vec<u32>,
    masses: Vec<f64>,
}

impl BlockDeviation {
    /// Of points that lie in these pixels. O(pixels + points · log points), in 4 bytes a pixel.
    pub(super) fn of(mut pixels: Vec<usize>, density: &Density) -> Result<Self, TargetError> {
        pixels.sort_unstable();
        let [width, height] = density.size();
        let (count, total) = (pixels.len(), density.mass());
        let mut worst =
            Self { deviation: 0.0, column: 0, row: 0, side: 1, points: count, expected: count as f64 };
        let mut next = Level::new(width.div_ceil(2), height.div_ceil(2))?;
        let mut rest = pixels.as_slice();
        for (pixel, &value) in density.values().iter().enumerate() {
            let points = rest.iter().take_while(|&&of| of == pixel).count();
            rest = &rest[points..];
            let at = [pixel % width, pixel / width];
            next.add(at, points as u32, value.into());
            worst.see(at, 1, points as u32, f64::from(value) / total, count);
        }
        let mut side = 2;
        loop {
            let Level { columns, points, masses } = next;
            for (block, (&points, mass)) in points.iter().zip(&masses).enumerate() {
                worst.see([block % columns, block / columns], side, points, mass / total, count);
            }
            if points.len() <= 1 {
                return Ok(worst);
            }
            next = Level::new(columns.div_ceil(2), (points.len() / columns).div_ceil(2))?;
            for (block, (&points, &mass)) in points.iter().zip(&masses).enumerate() {
                next.add([block % columns, block / columns], points, mass);
            }
            side *= 2;
        }
    }

    /// Takes note of a block with the share `p` of the mass.
    fn see(&mut self, [column, row]: [usize; 2], side: usize, points: u32, p: f64, count: usize) {
        let n = count as f64;
        let deviation = deviation(points.into(), n, p.min(1.0));
        if deviation.abs() > self.deviation.abs() {
            let (column, row, points) = (column * side, row * side, points as usize);
            *self = Self { deviation, column, row, side, points, expected: n * p };
        }
    }
}

impl Level {
    fn new(columns: usize, rows: usize) -> Result<Self, TargetError> {
        let blocks = columns * rows;
        let (mut points, mut masses) = (Vec::new(), Vec::new());
        if points.try_reserve_exact(blocks).is_err() || masses.try_reserve_exact(blocks).is_err() {
            return Err(TargetError::Memory { pixels: blocks });
        }
        points.resize(blocks, 0);
        masses.resize(blocks, 0.0);
        Ok(Self { columns, points, masses })
    }

    /// Adds a block of half the side.
    fn add(&mut self, [column, row]: [usize; 2], points: u32, mass: f64) {
        let block = row / 2 * self.columns + column / 2;
        self.points[block] += points;
        self.masses[block] += mass;
    }
}

/// Signed root of the deviance of `k` out of `n` where each has the probability `p`.
fn deviation(k: f64, n: f64, p: f64) -> f64 {
    let part = |seen: f64, expected: f64| {
        let expected = if seen >= 1.0 { expected.max(1.0) } else { expected };
        let logarithm = if seen > 0.0 { seen * (seen / expected).ln() } else { 0.0 };
        logarithm - seen + expected
    };
    let deviance = 2.0 * (part(k, n * p) + part(n - k, n * (1.0 - p)));
    // Rounding leaves less than nothing of a number that is met.
    deviance.max(0.0).sqrt().copysign(k - n * p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_are_normal_and_few_are_as_unlikely_as_they_are() {
        // 1728 of 4096 where half are expected: 10 standard errors.
        let errors = (1728.0 - 2048.0) / (4096.0_f64 * 0.25).sqrt();
        assert!((deviation(1728.0, 4096.0, 0.5) / errors - 1.0).abs() < 0.01);
        assert_eq!(deviation(5.0, 10.0, 0.5), 0.0);
        // None where 8 were expected has the likelihood e^-8, against 1 for the best: sqrt(2 · 8).
        assert!((deviation(0.0, 1e9, 8e-9) + 4.0).abs() < 1e-6);
        // One on one of very many dark pixels says nothing, some dozens do: sqrt(2 (30 ln 30 - 30 + 1)).
        assert!(deviation(1.0, 1e9, 0.0).abs() < 1e-3 && deviation(0.0, 1e9, 0.0) == 0.0);
        assert!((deviation(30.0, 1e9, 1e-12) - 12.1).abs() < 0.1);
        assert!(deviation(3.0, 10.0, 0.0) > 1.5 && deviation(7.0, 10.0, 1.0) < -1.5);
    }
}
