//! What the slices of a step want of the samples, summed: what transport hands to descent.

use crate::slices::part::Part;

/// Sum of displacements along the directions of the slices, and how many slices there were, per coordinate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pull {
    /// Sum of `factor · mass · displacement · theta` over slices; the factor is the number of dimensions of the slice's
    /// group where the term is descended, and 1 where it is balanced.
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
    pub(crate) fn part(&mut self, dims: usize) -> Part<'_> {
        let (sums, hits) = (&mut self.sums, &mut self.hits);
        Part { first: 0, dims, points: &mut [], sums, hits, moments: [&mut [], &mut []] }
    }
}
