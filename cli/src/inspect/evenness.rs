//! How evenly all samples of a table fill a square, or an interval.

use fsot::SampleTable;
use fsot::metrics::{Histogram, Marginal, MeasureError};

/// Counts of samples in equal cells.
pub struct Evenness {
    /// `k`, for `k × k` cells of a square or `k` of an interval.
    pub per_side: usize,
    /// One or two.
    pub dims: usize,
    /// Per cell, relative to the mean; first dimension fastest.
    pub counts: Vec<f64>,
    /// `χ² / (cells − 1)`: 1 for random samples, 0 for equal counts.
    pub spread: f64,
    /// Cells at the ends: low and high; or low-low, high-low, low-high, high-high.
    pub corners: Vec<f64>,
}

impl Evenness {
    /// Counts the samples of one or two dimensions in as many cells as keep 8 samples each, at most 32 per
    /// side.
    pub fn new(table: &SampleTable, dims: &[usize]) -> Result<Self, MeasureError> {
        let samples = table.extent().samples();
        let cells = |per_side: usize| per_side.pow(dims.len() as u32);
        let sides = [32, 16, 8, 4, 2];
        let per_side = sides.into_iter().find(|&side| samples >= 8 * cells(side)).unwrap_or(1);
        if let &[a, b] = dims {
            let histogram = Histogram::measure(table, [a, b], per_side)?;
            let mean = histogram.mean();
            return Ok(Self {
                per_side,
                dims: 2,
                counts: histogram.counts.iter().map(|&count| count as f64 / mean).collect(),
                spread: histogram.spread(),
                corners: histogram.corners().to_vec(),
            });
        }
        let mean = samples as f64 / per_side as f64;
        let marginal = Marginal::measure(table, dims[0], per_side)?;
        let counts: Vec<f64> = marginal.counts.iter().map(|&count| count as f64 / mean).collect();
        let squares: f64 = counts.iter().map(|count| (count - 1.0).powi(2)).sum();
        let spread = squares * mean / (per_side - 1) as f64;
        let corners = vec![counts[0], counts[per_side - 1]];
        Ok(Self { per_side, dims: 1, counts, spread, corners })
    }

    /// `16 x 16`, or `32`.
    pub fn cells(&self) -> String {
        if self.dims == 2 { format!("{0} x {0}", self.per_side) } else { self.per_side.to_string() }
    }

    /// Counts of the emptiest and of the fullest cell, relative to the mean.
    pub fn extremes(&self) -> [f64; 2] {
        self.counts.iter().fold([f64::INFINITY, 0.0], |[low, high], &count| [low.min(count), high.max(count)])
    }
}
