//! Parts of a table that threads own while samples move, and what pulls on them: what transport hands to
//! descent.

use std::ops::Range;

/// Consecutive samples: where they stand, what pulls them, and the moments of their descent.
///
/// Points and moments may be empty, where nothing needs them.
pub(crate) struct TablePart<'a> {
    /// The first of the samples.
    pub first: usize,
    /// Coordinates of a sample.
    pub dims: usize,
    pub points: &'a mut [f32],
    pub sums: &'a mut [f32],
    pub hits: &'a mut [f32],
    pub moments: [&'a mut [f32]; 2],
}

impl TablePart<'_> {
    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.sums.len() / self.dims
    }

    /// Sums and hits of a sample, if it is one of the part's.
    #[inline(always)]
    pub(crate) fn pull_on(&mut self, sample: u32) -> Option<(&mut [f32], &mut [f32])> {
        // A sample before the first becomes a large number.
        let first = (sample as usize).wrapping_sub(self.first).wrapping_mul(self.dims);
        let last = first.wrapping_add(self.dims);
        Some((self.sums.get_mut(first..last)?, self.hits.get_mut(first..last)?))
    }

    /// Which of the `count` samples from `first` on are the part's.
    pub(crate) fn overlap(&self, first: u32, count: usize) -> Range<usize> {
        let first = first as usize;
        let before = self.first.saturating_sub(first).min(count);
        let until = (self.first + self.len()).saturating_sub(first).min(count);
        before..until.max(before)
    }

    /// Calls `visit` for parts of at most `most` samples, in parallel. Allocates nothing.
    pub(crate) fn for_each(self, most: usize, visit: &(impl Fn(TablePart) + Sync)) {
        if self.len() <= most.max(1) {
            return visit(self);
        }
        let TablePart { first, dims, points, sums, hits, moments: [velocities, squares] } = self;
        let half = sums.len() / dims / 2;
        let split = |slice| split(slice, half * dims);
        let (points, sums, hits) = (split(points), split(sums), split(hits));
        let (velocities, squares) = (split(velocities), split(squares));
        let part =
            |first, points, sums, hits, moments| TablePart { first, dims, points, sums, hits, moments };
        let before = part(first, points.0, sums.0, hits.0, [velocities.0, squares.0]);
        let after = part(first + half, points.1, sums.1, hits.1, [velocities.1, squares.1]);
        rayon::join(|| before.for_each(most, visit), || after.for_each(most, visit));
    }
}

/// Two parts of a slice; both are empty if it is.
fn split(slice: &mut [f32], at: usize) -> (&mut [f32], &mut [f32]) {
    let at = at.min(slice.len());
    slice.split_at_mut(at)
}

/// Sum of displacements along the directions of the slices, and how many slices there were, per coordinate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pull {
    /// Sum of `factor · mass · displacement · theta` over slices; the factor is the number of dimensions of
    /// the slice's group where the term is descended, and 1 where it is balanced.
    pub sums: Vec<f32>,
    /// Sum of `mass` over the slices that saw the coordinate.
    pub hits: Vec<f32>,
    /// Slices of the step.
    pub slices: u64,
    /// Sum over the descended slices and their samples of `mass · displacement²`, and of `mass`.
    pub squares: f64,
    /// See `squares`.
    pub mass: f64,
}

impl Pull {
    /// Makes room for this many coordinates, with no pull on any that are new.
    pub(crate) fn grow(&mut self, coordinates: usize) {
        self.sums.resize(coordinates, 0.0);
        self.hits.resize(coordinates, 0.0);
    }

    /// All samples, without points and moments.
    pub(crate) fn part(&mut self, dims: usize) -> TablePart<'_> {
        let (sums, hits) = (&mut self.sums, &mut self.hits);
        TablePart { first: 0, dims, points: &mut [], sums, hits, moments: [&mut [], &mut []] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_every_sample_once() {
        for (samples, most) in [(1, 1), (7, 2), (64, 64), (65, 64), (1000, 1), (3, 0)] {
            let (mut sums, mut hits) = (vec![0.0; 3 * samples], vec![0.0; 3 * samples]);
            let moments = [&mut [][..], &mut []];
            let table =
                TablePart { first: 0, dims: 3, points: &mut [], sums: &mut sums, hits: &mut hits, moments };
            table.for_each(most, &|mut part| {
                assert!((1..=most.max(1)).contains(&part.len()) && part.points.is_empty());
                let own = part.overlap(0, samples);
                for sample in 0..samples as u32 {
                    assert_eq!(own.contains(&(sample as usize)), part.pull_on(sample).is_some());
                    if let Some((sums, _)) = part.pull_on(sample) {
                        assert_eq!(sums.len(), 3);
                        sums.iter_mut().for_each(|sum| *sum += sample as f32);
                    }
                }
            });
            assert!(sums.iter().enumerate().all(|(i, &sum)| sum == (i / 3) as f32), "{samples}, {most}");
        }
    }
}
