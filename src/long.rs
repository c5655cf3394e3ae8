//! One slice at a time: subsets too long for the lanes, single directions, weighted samples.

use rayon::prelude::*;

use crate::bank::{Block, Boundary};
use crate::lanes::Gather;
use crate::target::Projected;

/// Above this many samples a sort is worth sharing between threads.
pub(crate) const SHARED: usize = 1 << 15;

/// Buffers of one worker; they grow to the largest subset seen and stay.
#[derive(Clone, Debug, Default)]
pub(crate) struct LongBuffers {
    projections: Vec<f32>,
    keys: Vec<u64>,
    means: Vec<f64>,
}

/// Law of the projection on one direction.
pub(crate) enum LongLaw<'a> {
    /// In closed form.
    Closed(Projected),
    /// From a bank, shifted by the sum of the direction's negative components.
    Tabulated {
        /// Where the direction comes from.
        block: &'a Block,
        /// Which of its directions.
        lane: usize,
        /// Lowest projection.
        lowest: f64,
        /// Length of the support.
        extent: f64,
    },
}

impl LongLaw<'_> {
    fn cell_means(&self, means: &mut [f64]) {
        match *self {
            LongLaw::Closed(ref law) => law.cell_means_into(means),
            LongLaw::Tabulated { block, lane, lowest, extent } => {
                let n = means.len();
                let cells = n as f64;
                let mut below = 0.0;
                for cell in 0..n / 2 {
                    let boundary = Boundary::new((cell + 1) as f64 / cells);
                    let integral = block.integral_of_lane(&boundary, lane);
                    let above = (integral - below) * cells;
                    means[cell] = lowest + above;
                    means[n - 1 - cell] = lowest + (extent - above);
                    below = integral;
                }
                if n % 2 == 1 {
                    means[n / 2] = lowest + 0.5 * extent;
                }
            }
        }
    }

    fn cell_mean(&self, lower: f64, upper: f64) -> f64 {
        match *self {
            LongLaw::Closed(ref law) => law.cell_mean(lower, upper),
            LongLaw::Tabulated { block, lane, lowest, extent } => {
                // A weight may be too small beside the sum of all to give its cell a width, or its mean any digits.
                const NARROWEST: f64 = 1e-8;
                let spare = 0.5 * (NARROWEST - (upper - lower)).max(0.0);
                let (lower, upper) = ((lower - spare).max(0.0), (upper + spare).min(1.0));
                let lower_half = |u: f64| block.integral_of_lane(&Boundary::new(u), lane);
                // The quantile at 1 - u is the extent less that at u.
                let integral = |u: f64| {
                    if u <= 0.5 { lower_half(u) } else { extent * (u - 0.5) + lower_half(1.0 - u) }
                };
                lowest + (integral(upper) - integral(lower)) / (upper - lower)
            }
        }
    }
}

/// Transports a subset along one direction and adds, per sample and dimension of the group, `mass * displacement *
/// theta` to `moves`. Masses are `weights`, or 1. Returns the sum of `mass * displacement²`.
pub(crate) fn transport(
    subset: &Gather,
    theta: impl Fn(usize) -> f32 + Sync,
    law: &LongLaw,
    weights: Option<&[f64]>,
    buffers: &mut LongBuffers,
    moves: &mut [f32],
) -> f64 {
    let (n, dims) = (subset.samples.len(), subset.dims.len());
    let project = |j: usize| (0..dims).map(|dim| subset.coordinate(j, dim) * theta(dim)).sum::<f32>();
    buffers.projections.resize(n, 0.0);
    buffers.keys.resize(n, 0);
    let (projections, keys) = (&mut buffers.projections[..n], &mut buffers.keys[..n]);
    let key = |(j, (projection, key)): (usize, (&mut f32, &mut u64))| {
        *projection = project(j);
        *key = u64::from(ordered_bits(*projection)) << 32 | j as u64;
    };
    if n >= SHARED {
        projections.par_iter_mut().zip(keys.par_iter_mut()).enumerate().with_min_len(1 << 12).for_each(key);
        keys.par_sort_unstable();
    } else {
        projections.iter_mut().zip(keys.iter_mut()).enumerate().for_each(key);
        keys.sort_unstable();
    }
    buffers.means.resize(n, 0.0);
    let means = &mut buffers.means[..n];
    match weights {
        None => law.cell_means(means),
        Some(weights) => {
            let total: f64 = weights.iter().sum();
            let (mut below, mut lower) = (0.0, 0.0);
            for (mean, &key) in means.iter_mut().zip(&*keys) {
                below += weights[key as u32 as usize];
                let upper = (below / total).min(1.0);
                *mean = law.cell_mean(lower, upper);
                lower = upper;
            }
        }
    }
    let mut squares = 0.0;
    for (&mean, &key) in means.iter().zip(&*keys) {
        let position = key as u32 as usize;
        let mass = weights.map_or(1.0, |weights| weights[position]);
        let displacement = mean - f64::from(projections[position]);
        squares += mass * displacement * displacement;
        let moved = (mass * displacement) as f32;
        for (dim, along) in moves[position * dims..][..dims].iter_mut().enumerate() {
            *along += moved * theta(dim);
        }
    }
    squares
}

/// Bits that sort as the numbers do.
fn ordered_bits(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_sort_as_numbers_do() {
        let values = [-1.0, -0.5, -1e-30, -0.0, 0.0, 1e-30, 0.25, 1.0, 1.5];
        assert!(values.map(ordered_bits).is_sorted());
    }
}
