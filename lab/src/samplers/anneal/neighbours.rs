//! Which sites see each other, and how strongly.

use std::collections::BTreeMap;

use fsot::Extent;
use fsot::kernel::{Kernel, Tap};

use super::LANES;
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
pub(in crate::samplers) type Weights = BTreeMap<(i32, i32, i32), f64>;

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

    /// From weights, without those below this share of the largest.
    pub fn new(weights: &Weights, extent: &Extent, truncation: f64) -> Self {
        let others = || weights.iter().filter(|(offset, _)| **offset != (0, 0, 0));
        let largest = others().map(|(_, &weight)| weight).fold(0.0, f64::max);
        let mut taps = Vec::new();
        for (&(dt, dy, dx), &weight) in others().filter(|(_, weight)| **weight > truncation * largest) {
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

    /// Weights between sites of one frame, `[dy + reach][dx + reach]`.
    pub fn in_frame(&self) -> Vec<f32> {
        let [ry, rx] = self.reach;
        let mut weights = vec![0.0; (2 * ry + 1) * (2 * rx + 1)];
        for &(_, dy, dx, weight) in self.taps.iter().filter(|tap| tap.0 == 0) {
            weights[(dy + ry as i32) as usize * (2 * rx + 1) + (dx + rx as i32) as usize] += weight;
        }
        weights
    }

    /// The same taps as rows of lanes.
    pub fn runs(&self) -> Vec<Run> {
        let mut runs: BTreeMap<(i32, i32, usize), [f32; LANES]> = BTreeMap::new();
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
    pub weights: [f32; LANES],
}

impl Run {
    /// Where the first lane stands, from the site, in a patch of so many frames of `size` with rows of
    /// `stride`.
    pub fn offset(&self, frame: usize, frames: usize, size: usize, stride: usize) -> isize {
        let other = (frame as i32 + self.dt).rem_euclid(frames as i32) as isize;
        (other - frame as isize) * size as isize + self.dy as isize * stride as isize + self.dx
    }
}

/// `Σ_k (f_k ⋆ f_k)`, the autocorrelations of kernels whose weights are scaled to sum to 1, on the torus;
/// then scaled so that the largest weight of a neighbour is 1.
pub(in crate::samplers) fn autocorrelation(
    kernels: &[Kernel],
    extent: &Extent,
) -> Result<Weights, SamplerError> {
    let centred = |d: i32, len: usize| {
        let wrapped = d.rem_euclid(len as i32);
        if 2 * wrapped > len as i32 { wrapped - len as i32 } else { wrapped }
    };
    let mut weights = Weights::new();
    for kernel in kernels {
        let taps = kernel.taps(extent)?;
        let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
        for a in &taps {
            for b in &taps {
                let offset = (
                    centred(a.dt - b.dt, extent.frames),
                    centred(a.dy - b.dy, extent.height),
                    centred(a.dx - b.dx, extent.width),
                );
                *weights.entry(offset).or_default() += a.weight * b.weight / (sum * sum);
            }
        }
    }
    let others = weights.iter().filter(|(offset, _)| **offset != (0, 0, 0));
    let largest = others.map(|(_, &weight)| weight).fold(f64::MIN_POSITIVE, f64::max);
    weights.values_mut().for_each(|weight| *weight /= largest);
    Ok(weights)
}
