//! What a metric measures: the samples of a table, or a list of points.

use std::ops::{Bound, RangeBounds};

use rayon::prelude::*;

use super::error::MeasureError;
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// A view of samples in `[0, 1)^dims`, without a copy: a whole table, or a list of points.
///
/// Every metric takes `impl Into<Samples>`, so that a table is measured as `&table`. Points on no lattice
/// count as one row of pixels with a sample each, [`Extent::points`].
///
/// ```
/// use fsot::metrics::Samples;
/// use fsot::{Extent, SampleTable};
///
/// let extent = Extent { frames: 2, height: 4, width: 8, spp: 1 };
/// let table = SampleTable::white_noise(extent, 2, 0)?;
/// assert_eq!(Samples::from(&table).extent(), extent);
///
/// // Points of either float type, and some of them.
/// let points = Samples::points(table.values(), 2)?;
/// assert_eq!(points.select(..10)?.count(), 10);
/// assert!(Samples::points(&[0.5, 1.0], 2).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples<'a> {
    extent: Extent,
    dims: usize,
    values: Values<'a>,
}

/// Coordinates in single or double precision, `[frame][y][x][sample][dim]` in C order.
///
/// ```
/// use fsot::metrics::{Samples, Values};
///
/// let points = Samples::points(&[0.5_f32, 0.25], 1)?;
/// assert_eq!(points.values(), Values::F32(&[0.5, 0.25]));
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values<'a> {
    /// As in tables.
    F32(&'a [f32]),
    /// As mathematics wants them.
    F64(&'a [f64]),
}

impl<'a> From<&'a [f32]> for Values<'a> {
    fn from(values: &'a [f32]) -> Self {
        Self::F32(values)
    }
}

impl<'a> From<&'a [f64]> for Values<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self::F64(values)
    }
}

impl<'a> From<&'a SampleTable> for Samples<'a> {
    fn from(table: &'a SampleTable) -> Self {
        Self { extent: table.extent(), dims: table.dims(), values: Values::F32(table.values()) }
    }
}

impl<'a> Samples<'a> {
    /// Points of `dims` coordinates each, one after the other, as `f32` or `f64`. O(values), in parallel.
    ///
    /// # Errors
    /// No dimensions or points, an incomplete last point, a value outside `[0, 1)`.
    pub fn points<T>(values: &'a [T], dims: usize) -> Result<Self, MeasureError>
    where
        T: Copy + Into<f64> + Sync,
        &'a [T]: Into<Values<'a>>,
    {
        for (what, count) in [("dimensions", dims), ("points", values.len())] {
            if count == 0 {
                return Err(MeasureError::Nothing { what });
            }
        }
        if !values.len().is_multiple_of(dims) {
            return Err(MeasureError::PointCount { given: values.len(), dims });
        }
        let outside = |value: &T| !(0.0..1.0).contains(&(*value).into());
        if let Some(index) = values.par_iter().position_first(outside) {
            let (point, dimension) = (index / dims, index % dims);
            return Err(MeasureError::BadPoint { point, dimension, value: values[index].into() });
        }
        Ok(Self { extent: Extent::points(values.len() / dims), dims, values: values.into() })
    }

    /// The same samples on a lattice of pixels and frames, in its order: those of a table in double
    /// precision, say. O(1).
    ///
    /// ```
    /// use fsot::Extent;
    /// use fsot::metrics::Samples;
    ///
    /// let values: Vec<f64> = (0..24).map(|i| f64::from(i) / 24.0).collect();
    /// let samples = Samples::points(&values, 2)?.on(Extent::still(3, 4))?;
    /// assert_eq!(samples.shape(), [1, 3, 4, 1, 2]);
    /// assert!(Samples::points(&values, 2)?.on(Extent::still(4, 4)).is_err());
    /// # Ok::<(), fsot::metrics::MeasureError>(())
    /// ```
    ///
    /// # Errors
    /// A lattice of another number of samples.
    pub fn on(self, extent: Extent) -> Result<Self, MeasureError> {
        let on = Self { extent, ..self };
        if extent.samples() != self.count() {
            let [given, expected] = [self.shape(), on.shape()].map(Box::new);
            return Err(MeasureError::OtherShape { given, expected });
        }
        Ok(on)
    }

    /// Some consecutive samples as points: a prefix of a sequence, a class, a pixel. O(1).
    ///
    /// # Errors
    /// A range that is empty or ends beyond the last sample.
    pub fn select(&self, samples: impl RangeBounds<usize>) -> Result<Self, MeasureError> {
        let count = self.count();
        let start = match samples.start_bound() {
            Bound::Included(&start) => start,
            Bound::Excluded(&before) => before.saturating_add(1),
            Bound::Unbounded => 0,
        };
        let end = match samples.end_bound() {
            Bound::Included(&last) => last.saturating_add(1),
            Bound::Excluded(&end) => end,
            Bound::Unbounded => count,
        };
        if start >= end || end > count {
            return Err(MeasureError::NoSuchPoints { start, end, count });
        }
        let values = match self.values {
            Values::F32(values) => Values::F32(&values[start * self.dims..end * self.dims]),
            Values::F64(values) => Values::F64(&values[start * self.dims..end * self.dims]),
        };
        Ok(Self { extent: Extent::points(end - start), dims: self.dims, values })
    }

    /// Frames, height, width and samples per pixel.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Dimensions of a sample.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.extent.samples()
    }

    /// All values in C order.
    pub fn values(&self) -> Values<'a> {
        self.values
    }

    /// Lengths of the five axes `[frame, y, x, sample, dim]`.
    pub fn shape(&self) -> [usize; 5] {
        let Extent { frames, height, width, spp } = self.extent;
        [frames, height, width, spp, self.dims]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selections_are_points() {
        let extent = Extent { frames: 1, height: 2, width: 2, spp: 2 };
        let table = SampleTable::white_noise(extent, 3, 1).unwrap();
        let samples = Samples::from(&table);
        assert_eq!(samples.shape(), table.shape());
        let pixel = samples.select(2..4).unwrap();
        assert_eq!((pixel.extent(), pixel.dims()), (Extent::points(2), 3));
        assert_eq!(pixel.values(), Values::F32(&table.values()[6..12]));
        assert_eq!(samples.select(2..=3), samples.select((Bound::Excluded(1), Bound::Excluded(4))));
        assert_eq!(samples.select(..), Samples::points(table.values(), 3));
    }

    #[test]
    fn what_is_not_there_cannot_be_selected() {
        let points = Samples::points(&[0.0; 6], 2).unwrap();
        for (start, end) in [(1, 1), (2, 1), (0, 4), (usize::MAX, usize::MAX)] {
            assert_eq!(points.select(start..end), Err(MeasureError::NoSuchPoints { start, end, count: 3 }));
        }
        assert!(points.select(..=usize::MAX).is_err());
    }

    #[test]
    fn what_are_no_points_is_refused() {
        assert_eq!(Samples::points(&[0.5], 0), Err(MeasureError::Nothing { what: "dimensions" }));
        assert_eq!(Samples::points::<f32>(&[], 2), Err(MeasureError::Nothing { what: "points" }));
        assert_eq!(Samples::points(&[0.5; 3], 2), Err(MeasureError::PointCount { given: 3, dims: 2 }));
        for bad in [1.0, -1e-9, f64::INFINITY] {
            let error = Samples::points(&[0.5, 0.0, 0.9, bad, 7.0, 0.1], 2).unwrap_err();
            assert_eq!(error, MeasureError::BadPoint { point: 1, dimension: 1, value: bad });
        }
        assert!(Samples::points(&[f32::NAN], 1).is_err());
    }
}
