//! How evenly the samples of a table fill an interval, up to its ends.

use super::coordinates::Coordinates;
use super::error::MeasureError;
use super::samples::Samples;
use crate::error::RangeError;

/// Samples of one dimension, counted in equal bins of `[0, 1)` and next to its two faces.
///
/// A histogram of cells hides what happens within a cell: samples that keep away from 0 and 1 by a hundredth
/// bias every integrand that matters there, such as `-ln u`, in tables of any size.
///
/// ```
/// use fsot::metrics::{Marginal, Samples};
///
/// let thousandths: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect();
/// let marginal = Marginal::measure(Samples::points(&thousandths, 1)?, 0, 4)?;
/// assert_eq!(marginal.counts, [250; 4]);
/// assert!(marginal.faces.iter().all(|face| (face.density - 1.0).abs() < 1e-9));
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Marginal {
    /// Samples per bin, from 0 to 1.
    pub counts: Vec<u64>,
    /// Density next to the faces, from the narrowest slab to the widest.
    pub faces: [FaceDensity; 4],
    /// Samples that are exactly 0, where `-ln u` is infinite.
    pub zeros: u64,
}

/// How densely samples lie within a slab at either face of the cube.
///
/// ```
/// use fsot::metrics::{Marginal, Samples};
///
/// // All samples in the middle: nothing lies next to the faces.
/// let face = Marginal::measure(Samples::points(&[0.5; 100], 1)?, 0, 1)?.faces[2];
/// assert_eq!((face.within, face.density), (0.01, 0.0));
/// // Of a hundred random samples two would: give or take seven tenths of that.
/// assert!((face.standard_error - 0.7).abs() < 1e-9);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FaceDensity {
    /// Thickness of the slabs: values below it, or from 1 less it on.
    pub within: f64,
    /// Samples in both slabs together, relative to the expectation of uniform ones.
    pub density: f64,
    /// Standard error of the same of independent uniform samples.
    pub standard_error: f64,
}

/// Thicknesses of the slabs at the faces.
const WITHIN: [f64; 4] = [0.002, 0.005, 0.01, 0.02];

impl Marginal {
    /// Counts the samples of dimension `dim` in `1..=65536` bins. O(samples).
    ///
    /// # Errors
    /// A dimension that the samples do not have; no bins, or more than 65536.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dim: usize,
        bins: usize,
    ) -> Result<Self, MeasureError> {
        let line = Coordinates::gather(samples, &[dim])?;
        RangeError::check((1..=65536).contains(&bins), "the number of bins", bins as f64, "from 1 to 65536")?;
        let mut counts = vec![0; bins];
        for &value in line.values() {
            // The largest f64 below 1, times the number of bins, rounds up to it.
            counts[((value * bins as f64) as usize).min(bins - 1)] += 1;
        }
        let samples = line.values().len() as f64;
        let faces = WITHIN.map(|within| {
            let is_near = |value: &&f64| **value < within || **value >= 1.0 - within;
            let near = line.values().iter().filter(is_near).count() as f64;
            let share = 2.0 * within;
            let standard_error = ((1.0 - share) / (share * samples)).sqrt();
            FaceDensity { within, density: near / (share * samples), standard_error }
        });
        let zeros = line.values().iter().filter(|&&value| value == 0.0).count() as u64;
        Ok(Self { counts, faces, zeros })
    }

    /// Count of the emptiest and of the fullest bin, relative to the mean.
    pub fn extremes(&self) -> [f64; 2] {
        let mean = self.counts.iter().sum::<u64>() as f64 / self.counts.len() as f64;
        let relative = |count: Option<&u64>| count.map_or(f64::NAN, |&count| count as f64 / mean);
        [relative(self.counts.iter().min()), relative(self.counts.iter().max())]
    }

    /// Count of the two outermost bins together, relative to the mean: what a histogram shows of the faces.
    pub fn ends(&self) -> f64 {
        let mean = self.counts.iter().sum::<u64>() as f64 / self.counts.len() as f64;
        (self.counts[0] + self.counts[self.counts.len() - 1]) as f64 / (2.0 * mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Estimate;
    use crate::table::SampleTable;
    use crate::table::extent::Extent;

    /// Mean over 400 tables within 4 standard errors of 1, and its spread as announced to a fifth.
    #[test]
    fn white_noise_has_density_one_and_the_announced_error() {
        let extent = Extent::animation(2, 32, 32);
        let tables: Vec<Marginal> = (0..400)
            .map(|seed| {
                let table = SampleTable::white_noise(extent, 2, seed).unwrap();
                Marginal::measure(&table, 1, 64).unwrap()
            })
            .collect();
        for slab in 0..WITHIN.len() {
            let over = Estimate::of(tables.iter().map(|marginal| marginal.faces[slab].density));
            assert!((over.mean - 1.0).abs() < 4.0 * over.standard_error, "{slab}: {over:?}");
            let announced = tables[0].faces[slab].standard_error / 20.0; // of a mean over 400
            assert!((over.standard_error / announced - 1.0).abs() < 0.2, "{slab}: {over:?} {announced}");
        }
        let ends = Estimate::of(tables.iter().map(Marginal::ends));
        assert!((ends.mean - 1.0).abs() < 4.0 * ends.standard_error, "{ends:?}");
    }

    #[test]
    fn what_lies_at_the_faces_is_counted_where_it_lies() {
        // 0 and the largest value below 1 are at the faces, 0.003 in the three wider slabs only.
        let values = [0.0, 1.0 - f64::EPSILON / 2.0, 0.003, 0.5];
        let marginal = Marginal::measure(Samples::points(&values, 1).unwrap(), 0, 8).unwrap();
        assert_eq!(marginal.counts, [2, 0, 0, 0, 1, 0, 0, 1]);
        let near = marginal.faces.map(|face| (face.density * 2.0 * face.within * 4.0).round());
        assert_eq!((near, marginal.zeros), ([2.0, 3.0, 3.0, 3.0], 1));
        assert_eq!((marginal.ends(), marginal.extremes()), (3.0, [0.0, 4.0]));
    }

    #[test]
    fn bad_questions_are_named() {
        let points = || Samples::points(&[0.5; 4], 2).unwrap();
        assert!(matches!(Marginal::measure(points(), 2, 4), Err(MeasureError::Group(_))));
        for bins in [0, 65537] {
            assert!(matches!(Marginal::measure(points(), 0, bins), Err(MeasureError::Range(_))), "{bins}");
        }
    }
}
