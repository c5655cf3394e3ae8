//! One-dimensional transport in `f64`: sort, match, displacement, cost. Pure, sequential, without randomness.
//!
//! The textbook path: gradients on explicit slices and every measurement go through it, and the optimiser's
//! fast paths are checked against it.

use crate::laws::Projected;

/// Buffers of the functions below.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    order: Vec<u32>,
}

impl Workspace {
    /// Ranks of the projections; equal projections rank by position, so that the result is one permutation.
    fn sort(&mut self, projections: &[f64]) -> &[u32] {
        self.order.clear();
        self.order.extend(0..projections.len() as u32);
        self.order.sort_unstable_by(|&a, &b| {
            projections[a as usize].total_cmp(&projections[b as usize]).then(a.cmp(&b))
        });
        &self.order
    }

    /// Calls `visit(position, lower, upper)` for each projection, by increasing value, with the cell of the
    /// target's quantile function that it is matched with. Masses are `weights`, or equal.
    fn match_cells(
        &mut self,
        projections: &[f64],
        weights: Option<&[f64]>,
        mut visit: impl FnMut(usize, f64, f64),
    ) {
        let order = self.sort(projections);
        let total = weights.map_or(projections.len() as f64, |weights| weights.iter().sum());
        let (mut below, mut lower) = (0.0, 0.0);
        for (rank, &position) in order.iter().enumerate() {
            let position = position as usize;
            below += weights.map_or(1.0, |weights| weights[position]);
            let last = rank + 1 == order.len();
            let upper = if last { 1.0 } else { (below / total).min(1.0) };
            visit(position, lower, upper);
            lower = upper;
        }
    }

    /// Writes the displacement of each projection to the mean of its quantile cell and returns the squared
    /// 2-Wasserstein distance between the (weighted) projections and the law.
    ///
    /// The distance splits into the squared displacements and the spread of the law inside the cells, which
    /// does not depend on the projections: minus twice the mass times the displacement is its exact gradient.
    pub(crate) fn displacements(
        &mut self,
        law: &Projected,
        projections: &[f64],
        weights: Option<&[f64]>,
        displacements: &mut [f64],
    ) -> f64 {
        let mut squared = law.second_moment();
        self.match_cells(projections, weights, |position, lower, upper| {
            let mean = law.cell_mean(lower, upper);
            let displacement = mean - projections[position];
            displacements[position] = displacement;
            squared += (upper - lower) * (displacement * displacement - mean * mean);
        });
        squared.max(0.0)
    }

    /// The 1-Wasserstein distance between the (weighted) projections and the law, exactly.
    pub(crate) fn w1(&mut self, law: &Projected, projections: &[f64], weights: Option<&[f64]>) -> f64 {
        let mut distance = 0.0;
        self.match_cells(projections, weights, |position, lower, upper| {
            distance += law.w1_cell(lower, upper, projections[position]);
        });
        distance
    }
}

#[cfg(test)]
mod tests;
