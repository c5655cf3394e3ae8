//! The coordinates of one dimension group.

use super::error::MeasureError;
use super::samples::{Samples, Values};
use crate::error::GroupError;
use crate::table::extent::Extent;

/// The coordinates of one dimension group in `f64`, gathered once for many uses.
pub(super) struct Coordinates {
    pub extent: Extent,
    dims: usize,
    values: Vec<f64>,
}

impl Coordinates {
    /// Gathers the dimensions of `group` in its order. O(samples · dims).
    pub fn gather<'a>(samples: impl Into<Samples<'a>>, group: &[usize]) -> Result<Self, MeasureError> {
        let samples = samples.into();
        GroupError::check(group, samples.dims())?;
        let values = match samples.values() {
            Values::F32(values) => gathered(values, samples.dims(), group),
            Values::F64(values) => gathered(values, samples.dims(), group),
        };
        Ok(Self { extent: samples.extent(), dims: group.len(), values })
    }

    /// Refuses a group of another number of dimensions than `what` has.
    pub fn fitting(self, what: &'static str, expected: usize) -> Result<Self, MeasureError> {
        if self.dims == expected {
            Ok(self)
        } else {
            Err(MeasureError::GroupSize { what, given: self.dims, expected })
        }
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.extent.samples()
    }

    /// All coordinates, `[site][sample][dim]`.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The coordinates of each sample.
    pub fn points(&self) -> std::slice::ChunksExact<'_, f64> {
        self.values.chunks_exact(self.dims)
    }
}

fn gathered<T: Copy + Into<f64>>(values: &[T], dims: usize, group: &[usize]) -> Vec<f64> {
    values.chunks_exact(dims).flat_map(|x| group.iter().map(|&d| x[d].into())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::SampleTable;

    #[test]
    fn tables_and_points_are_gathered_alike() {
        let extent = Extent { frames: 2, height: 1, width: 2, spp: 2 };
        let table = SampleTable::white_noise(extent, 3, 7).unwrap();
        let wide: Vec<f64> = table.values().iter().map(|&value| value.into()).collect();
        let of_table = Coordinates::gather(&table, &[2, 0]).unwrap();
        let of_points = Coordinates::gather(Samples::points(&wide, 3).unwrap(), &[2, 0]).unwrap();
        assert_eq!(of_table.values(), of_points.values());
        assert_eq!(of_table.points().nth(5).unwrap(), [wide[17], wide[15]]);
        assert_eq!((of_table.count(), of_table.extent), (8, extent));
    }

    #[test]
    fn bad_groups_are_named() {
        let points = Samples::points(&[0.5; 4], 2).unwrap();
        let error = |dims: &[usize]| {
            Coordinates::gather(points, dims).and_then(|found| found.fitting("it", 2)).err().unwrap()
        };
        assert_eq!(error(&[]), MeasureError::Group(GroupError::Empty));
        assert_eq!(error(&[1, 1]), MeasureError::Group(GroupError::Repeated { dimension: 1 }));
        assert_eq!(
            error(&[0, 2]),
            MeasureError::Group(GroupError::NoSuchDimension { dimension: 2, dims: 2 })
        );
        assert_eq!(error(&[0]), MeasureError::GroupSize { what: "it", given: 1, expected: 2 });
    }
}
