//! Which sites see each other, and how strongly.

use std::collections::BTreeMap;

use crate::simd::{LANES, Row};
use fsot::Extent;
use fsot::kernel::{Kernel, Tap, autocorrelation};

use crate::samplers::SamplerError;

/// Weights of the neighbours of a site on a lattice that wraps: symmetric, without the site itself.
#[derive(Clone, Debug)]
pub(in crate::samplers) struct Neighbours {
    /// `(dt, dy, dx, weight)`. An offset of half an axis stands twice, both ways, with half its weight.
    pub taps: Vec<(i32, i32, i32, f32)>,
    /// Largest `|dy|` and `|dx|`.
    pub reach: [usize; 2],
}

/// Weights `(dt, dy, dx)` of a torus, offsets in `(-len / 2, len / 2]`.
type Weights = BTreeMap<(i32, i32, i32), f64>;

/// Weights of neighbours: all but that of the site itself.
fn others(weights: &Weights) -> impl Iterator<Item = (&(i32, i32, i32), &f64)> {
    weights.iter().filter(|(offset, _)| **offset != (0, 0, 0))
}

/// The largest weight of a neighbour.
fn largest(weights: &Weights) -> f64 {
    others(weights).map(|(_, &weight)| weight).fold(0.0, f64::max)
}

impl Neighbours {
    /// The sum of the taps of kernels, each relative to its own largest, down to their truncations. Temporal
    /// parts count both ways.
    pub fn of_kernels(kernels: &[Kernel], extent: &Extent) -> Result<Self, SamplerError> {
        let mut weights = Weights::new();
        for kernel in kernels {
            for Tap { dt, dy, dx, weight } in kernel.taps(extent)? {
                let ways = if dt == 0 { vec![0] } else { vec![dt, -dt] };
                for dt in ways {
                    let dt = dt.rem_euclid(extent.frames as i32);
                    *weights.entry((dt, dy, dx)).or_default() += weight;
                }
            }
        }
        Ok(Self::new(&weights, extent, 0.0))
    }

    /// `Σ_k (f_k ⋆ f_k)`, the autocorrelations of kernels whose weights are scaled to sum to 1, relative to
    /// the largest weight of a neighbour and without those below this share of it.
    pub fn of_autocorrelations(
        kernels: &[Kernel],
        extent: &Extent,
        truncation: f64,
    ) -> Result<Self, SamplerError> {
        let mut weights = Weights::new();
        for kernel in kernels {
            let taps = kernel.taps(extent)?;
            let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
            for Tap { dt, dy, dx, weight } in autocorrelation(&taps, extent, 0.0)? {
                *weights.entry((dt, dy, dx)).or_default() += weight / (sum * sum);
            }
        }
        let largest = largest(&weights).max(f64::MIN_POSITIVE);
        weights.values_mut().for_each(|weight| *weight /= largest);
        Ok(Self::new(&weights, extent, truncation))
    }

    /// From weights, without those below this share of the largest.
    fn new(weights: &Weights, extent: &Extent, truncation: f64) -> Self {
        let least = truncation * largest(weights);
        let mut taps = Vec::new();
        for (&(dt, dy, dx), &weight) in others(weights).filter(|(_, weight)| **weight > least) {
            let ways = |d: i32, len: usize| if 2 * d == len as i32 { vec![d, -d] } else { vec![d] };
            let (down, across) = (ways(dy, extent.height), ways(dx, extent.width));
            let share = weight / (down.len() * across.len()) as f64;
            for &dy in &down {
                taps.extend(across.iter().map(|&dx| (dt, dy, dx, share as f32)));
            }
        }
        let most = |d: fn(&(i32, i32, i32, f32)) -> i32| {
            taps.iter().map(|tap| d(tap).unsigned_abs() as usize).max().unwrap_or(0)
        };
        let reach = [most(|tap| tap.1), most(|tap| tap.2)];
        Self { taps, reach }
    }

    /// Weights between sites of one frame.
    pub fn in_frame(&self) -> InFrame {
        let [ry, rx] = self.reach;
        let mut weights = vec![0.0; (2 * ry + 1) * (2 * rx + 1)];
        for &(_, dy, dx, weight) in self.taps.iter().filter(|tap| tap.0 == 0) {
            weights[(dy + ry as i32) as usize * (2 * rx + 1) + (dx + rx as i32) as usize] += weight;
        }
        InFrame { reach: self.reach, weights }
    }

    /// The same taps as rows of lanes.
    pub fn runs(&self) -> Vec<Run> {
        let mut runs: BTreeMap<(i32, i32, usize), Row> = BTreeMap::new();
        for &(dt, dy, dx, weight) in &self.taps {
            let column = (dx + self.reach[1] as i32) as usize;
            runs.entry((dt, dy, column / LANES)).or_default()[column % LANES] += weight;
        }
        let first = |block: usize| (block * LANES) as isize - self.reach[1] as isize;
        let run = |((dt, dy, block), weights)| Run { dt, dy, dx: first(block), weights };
        runs.into_iter().map(run).collect()
    }
}

/// Sixteen neighbours side by side, those without weight included.
#[derive(Clone, Copy, Debug)]
pub(in crate::samplers) struct Run {
    pub dt: i32,
    pub dy: i32,
    /// Column of the first lane.
    pub dx: isize,
    pub weights: Row,
}

/// Weights between sites of one frame, by their offset.
#[derive(Clone, Debug)]
pub(in crate::samplers) struct InFrame {
    reach: [usize; 2],
    /// `[dy + reach][dx + reach]`.
    weights: Vec<f32>,
}

impl InFrame {
    /// The weight between two places `[row, column]`; 0 if they do not see each other.
    #[inline(always)]
    pub fn weight(&self, a: [usize; 2], b: [usize; 2]) -> f32 {
        let [ry, rx] = self.reach;
        let (dy, dx) = (b[0] + ry, b[1] + rx);
        let near = dy >= a[0] && dy - a[0] <= 2 * ry && dx >= a[1] && dx - a[1] <= 2 * rx;
        if near { self.weights[(dy - a[0]) * (2 * rx + 1) + dx - a[1]] } else { 0.0 }
    }
}
