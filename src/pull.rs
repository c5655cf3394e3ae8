//! What the slices of a step want of the samples: the one thing that transport hands to descent.

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
    /// Sum over slices and samples of `mass · displacement²`, and of `mass`.
    pub squares: f64,
    /// See `squares`.
    pub mass: f64,
}
