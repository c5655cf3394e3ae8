//! How evenly the samples of a table fill a square.

use super::coordinates::Coordinates;
use super::error::MeasureError;
use super::samples::Samples;
use crate::error::RangeError;

/// Samples counted in `k × k` equal cells of the square of two dimensions, over all pixels and frames.
///
/// ```
/// use fsot::metrics::{Histogram, Samples};
///
/// let points = Samples::points(&[0.1, 0.1, 0.9, 0.1, 0.6, 0.2], 2)?;
/// assert_eq!(Histogram::measure(points, [0, 1], 2)?.counts, [1, 2, 0, 0]);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Histogram {
    /// Samples per cell, row by row: cell `(i, j)` at `j · k + i`, `i` along the first dimension.
    pub counts: Vec<u64>,
    /// Cells per side, `k`.
    pub cells_per_side: usize,
}

impl Histogram {
    /// Counts the samples of two dimensions in `1..=4096` cells per side. O(samples).
    ///
    /// Expect at least 5 samples per cell for [`Histogram::spread`] to mean much.
    ///
    /// # Errors
    /// Equal or missing dimensions; `cells_per_side` is 0 or above 4096.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: [usize; 2],
        cells_per_side: usize,
    ) -> Result<Self, MeasureError> {
        let points = Coordinates::gather(samples, &dims)?;
        if !(1..=4096).contains(&cells_per_side) {
            return Err(RangeError::new("cells per side", cells_per_side as f64, "from 1 to 4096").into());
        }
        let mut counts = vec![0; cells_per_side * cells_per_side];
        // The largest f64 below 1, times k, rounds up to k.
        let cell = |value: f64| ((value * cells_per_side as f64) as usize).min(cells_per_side - 1);
        for point in points.points() {
            counts[cell(point[1]) * cells_per_side + cell(point[0])] += 1;
        }
        Ok(Self { counts, cells_per_side })
    }

    /// Samples of the mean cell.
    pub fn mean(&self) -> f64 {
        self.counts.iter().sum::<u64>() as f64 / self.counts.len() as f64
    }

    /// Pearson's `χ² / (cells − 1)`: 1 for random samples in the mean (standard deviation `√(2 / (cells −
    /// 1))`), 0 for equal counts. NaN for a single cell.
    pub fn spread(&self) -> f64 {
        let mean = self.mean();
        let squares: f64 = self.counts.iter().map(|&count| (count as f64 - mean).powi(2)).sum();
        squares / mean / (self.counts.len() - 1) as f64
    }

    /// Count of the emptiest and of the fullest cell, relative to the mean.
    pub fn extremes(&self) -> [f64; 2] {
        let relative = |count: Option<&u64>| count.map_or(f64::NAN, |&count| count as f64 / self.mean());
        [relative(self.counts.iter().min()), relative(self.counts.iter().max())]
    }

    /// Counts of the four corner cells relative to the mean, at `(low, low)`, `(high, low)`, `(low, high)`
    /// and `(high, high)` of the first and second dimension. Far below 1 means samples pulled to the centre.
    pub fn corners(&self) -> [f64; 4] {
        let last = self.cells_per_side - 1;
        let at = |i: usize, j: usize| self.counts[j * self.cells_per_side + i] as f64 / self.mean();
        [at(0, 0), at(last, 0), at(0, last), at(last, last)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::GroupError;
    use crate::metrics::Estimate;
    use crate::table::SampleTable;
    use crate::table::domain::BELOW_ONE;
    use crate::table::extent::Extent;

    #[test]
    fn counts_stand_where_documented() {
        let extent = Extent { frames: 1, height: 1, width: 3, spp: 2 };
        let values = vec![
            0.9, 0.5, 0.1, /**/ 0.9, 0.5, 0.1, /**/ 0.0, 0.5, 0.0, //
            0.4, 0.5, 0.9, /**/ BELOW_ONE, 0.5, BELOW_ONE, /**/ 0.5, 0.5, 0.5,
        ];
        let table = SampleTable::new(extent, 3, values).unwrap();
        let histogram = Histogram::measure(&table, [0, 2], 3).unwrap();
        assert_eq!(histogram.counts, [1, 0, 2, 0, 1, 0, 0, 1, 1]);
        assert_eq!(histogram.corners(), [1.5, 3.0, 0.0, 1.5]);
        assert_eq!(histogram.extremes(), [0.0, 3.0]);
        // Σ (count − 2/3)² = 4 · 4/9 + 4 · 1/9 + 16/9 = 4, over 2/3, over 8.
        assert!((histogram.spread() - 0.75).abs() < 1e-15);
    }

    /// Mean over 200 tables within 4 standard errors of 1.
    #[test]
    fn white_noise_spreads_by_one() {
        let extent = Extent { frames: 2, height: 8, width: 16, spp: 3 };
        let spreads: Vec<f64> = (0..200)
            .map(|seed| {
                let table = SampleTable::white_noise(extent, 2, seed).unwrap();
                Histogram::measure(&table, [1, 0], 8).unwrap().spread()
            })
            .collect();
        let over = Estimate::of(spreads.into_iter());
        assert!((over.mean - 1.0).abs() < 4.0 * over.standard_error, "{over:?}");
    }

    #[test]
    fn bad_questions_are_named() {
        let extent = Extent { frames: 1, height: 1, width: 1, spp: 1 };
        let table = SampleTable::white_noise(extent, 2, 0).unwrap();
        assert!(matches!(
            Histogram::measure(&table, [0, 0], 4),
            Err(MeasureError::Group(GroupError::Repeated { .. }))
        ));
        assert!(matches!(
            Histogram::measure(&table, [0, 2], 4),
            Err(MeasureError::Group(GroupError::NoSuchDimension { .. }))
        ));
        assert!(matches!(Histogram::measure(&table, [0, 1], 0), Err(MeasureError::Range(RangeError { .. }))));
    }
}
