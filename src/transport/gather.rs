//! Where the samples of a subset stand, and their projections.

use std::ops::Range;

/// Numbers of the samples of a subset.
#[derive(Clone)]
pub(crate) enum SubsetSamples<'a> {
    List(&'a [u32]),
    Run(Range<u32>),
}

impl SubsetSamples<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            SubsetSamples::List(list) => list.len(),
            SubsetSamples::Run(run) => run.len(),
        }
    }
}

/// Where the samples of a subset stand, seen from one dimension group.
pub(crate) struct Gather<'a> {
    /// Numbers of the samples.
    pub samples: SubsetSamples<'a>,
    /// Values of the whole table.
    pub points: &'a [f32],
    /// Dimensions of the table.
    pub stride: usize,
    /// Dimensions of the group.
    pub dims: &'a [usize],
    /// Shift of each dimension of the group before it wraps; `None` for an interval.
    pub cut: &'a [Option<f32>],
}

impl Gather<'_> {
    /// Writes the coordinates of a listed subset, sample by sample, from the middle of the cube. A run is
    /// none that the lanes take.
    #[inline(always)]
    pub(super) fn gather(&self, coordinates: &mut [f32]) {
        let SubsetSamples::List(list) = self.samples else { return };
        let values = list.iter().map(|&sample| self.sample(sample));
        if let ([x, y], [None, None]) = (self.dims, self.cut) {
            // The common case by itself, without a choice per coordinate.
            let (points, _) = coordinates.as_chunks_mut::<2>();
            for (point, values) in points.iter_mut().zip(values) {
                *point = [values[*x] - 0.5, values[*y] - 0.5];
            }
            return;
        }
        for (point, values) in coordinates.chunks_exact_mut(self.dims.len()).zip(values) {
            for (dim, value) in point.iter_mut().enumerate() {
                *value = self.coordinate(values, dim) - 0.5;
            }
        }
    }

    /// Writes the projections of the samples from `first` on along a direction.
    #[inline(always)]
    pub(crate) fn project(&self, first: usize, theta: &impl Fn(usize) -> f32, projections: &mut [f32]) {
        match &self.samples {
            SubsetSamples::List(list) => {
                let values = list[first..].iter().map(|&sample| self.sample(sample));
                self.project_each(values, theta, projections);
            }
            SubsetSamples::Run(run) => {
                let points = &self.points[(run.start as usize + first) * self.stride..];
                self.project_each(points.chunks_exact(self.stride), theta, projections);
            }
        }
    }

    #[inline(always)]
    fn project_each<'a>(
        &self,
        samples: impl Iterator<Item = &'a [f32]> + Clone,
        theta: &impl Fn(usize) -> f32,
        projections: &mut [f32],
    ) {
        if let (&[x, y], [None, None]) = (self.dims, self.cut) {
            // The common case by itself, without a choice per coordinate.
            let theta = [theta(0), theta(1)];
            for (projection, values) in projections.iter_mut().zip(samples) {
                *projection = values[x] * theta[0] + values[y] * theta[1];
            }
            return;
        }
        projections.fill(0.0);
        for dim in 0..self.dims.len() {
            let component = theta(dim);
            for (projection, values) in projections.iter_mut().zip(samples.clone()) {
                *projection += self.coordinate(values, dim) * component;
            }
        }
    }

    /// Coordinates of a sample in the table.
    #[inline(always)]
    fn sample(&self, sample: u32) -> &[f32] {
        &self.points[sample as usize * self.stride..][..self.stride]
    }

    /// Coordinate `dim` (of the group) of a sample, shifted and wrapped where the dimension is a torus.
    #[inline(always)]
    fn coordinate(&self, values: &[f32], dim: usize) -> f32 {
        let value = values[self.dims[dim]];
        match self.cut[dim] {
            None => value,
            Some(cut) => {
                let shifted = value - cut;
                if shifted < 0.0 { shifted + 1.0 } else { shifted }
            }
        }
    }
}
