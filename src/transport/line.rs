//! One slice at a time: subsets too long for the lanes, single directions, weighted samples.

use rayon::prelude::*;

use crate::directions::cube_bank::{Block, Boundary};
use crate::laws::Pieces;
use crate::transport::lanes::Gather;

/// Above this many samples a sort is worth sharing between threads.
pub(crate) const SHARED: usize = 1 << 17;

/// From this many samples on, a radix sort beats the comparisons of the standard library.
const RADIX: usize = 256;
/// Up to this many samples it also beats a sort shared between threads, and its positions leave room for a digit.
const LARGEST_RADIX: usize = 1 << (u32::BITS - DIGIT);
/// Bits of a digit of the radix sort, which takes two.
const DIGIT: u32 = 11;

/// Cells whose means are computed together.
const BLOCK: usize = 64;

/// Buffers of one worker; they grow to the largest subset seen and stay.
#[derive(Clone, Debug, Default)]
pub(crate) struct LongBuffers {
    projections: Vec<f32>,
    /// Value and position in one number.
    keys: Vec<u64>,
    /// Digits and positions on their way through the radix sort.
    entries: Vec<u32>,
    /// Positions by increasing projection.
    order: Vec<u32>,
    starts: Vec<[u32; 1 << DIGIT]>,
}

/// Law of the projection on one direction.
pub(crate) struct LongLaw<'a> {
    /// Lowest projection.
    pub lowest: f64,
    /// Length of the support.
    pub extent: f64,
    /// What lies between.
    pub shape: LongShape<'a>,
}

/// Density of a projection, from the lower end of its support.
pub(crate) enum LongShape<'a> {
    /// That of `a U + b V` for independent uniform `U`, `V`, with `a ≥ b ≥ 0`.
    Trapezoid {
        /// `a`.
        longer: f64,
        /// `b`.
        shorter: f64,
    },
    /// Of a target other than the cube.
    Pieces(&'a Pieces),
    /// From a bank.
    Tabulated {
        /// Where the direction comes from.
        block: &'a Block,
        /// Which of its directions.
        lane: usize,
    },
}

impl LongShape<'_> {
    /// Integrals of the quantile function from 0 to the upper ends of cells, from cell `begin` of `n` on.
    #[inline(always)]
    fn integrals(&self, begin: usize, n: usize, integrals: &mut [f64; BLOCK]) {
        let end = |index: usize| ((begin + index + 1) as u32 as f64 / n as f64).min(0.5);
        match *self {
            LongShape::Trapezoid { longer, shorter } => {
                for (index, integral) in integrals.iter_mut().enumerate() {
                    *integral = trapezoid_integral(longer, shorter, end(index));
                }
            }
            _ => {
                for (index, integral) in integrals.iter_mut().enumerate().take(n / 2 - begin) {
                    *integral = self.integral(end(index));
                }
            }
        }
    }

    /// Integral of the quantile function from 0 to `u`, at most 1/2.
    fn integral(&self, u: f64) -> f64 {
        match *self {
            LongShape::Trapezoid { longer, shorter } => trapezoid_integral(longer, shorter, u),
            LongShape::Tabulated { block, lane } => block.integral_of_lane(&Boundary::new(u), lane),
            // Not symmetric: the callers ask it themselves.
            LongShape::Pieces(_) => 0.0,
        }
    }
}

/// Integral of a trapezoid's quantile function from 0 to `u`, at most 1/2.
#[inline(always)]
fn trapezoid_integral(longer: f64, shorter: f64, u: f64) -> f64 {
    let edge = 0.5 * shorter / longer.max(f64::MIN_POSITIVE);
    let rising = u.min(edge);
    let beyond = u - rising;
    (2.0 / 3.0) * (2.0 * longer * shorter * rising).sqrt() * rising
        + beyond * (longer * 0.5 * (u + rising) + 0.5 * shorter)
}

impl LongLaw<'_> {
    /// Visits `n` equal cells, from both ends to the middle, with the means of the quantile function over them.
    #[inline(always)]
    fn for_each_cell(&self, n: usize, mut visit: impl FnMut(usize, f64)) {
        let &LongLaw { lowest, extent, ref shape } = self;
        if let LongShape::Pieces(pieces) = shape {
            return pieces.for_each_cell(n, visit);
        }
        let cells = n as f64;
        let mut below = 0.0;
        // Integrals come in blocks of their own, which are whole vectors of square roots.
        for begin in (0..n / 2).step_by(BLOCK) {
            let mut integrals = [0.0; BLOCK];
            shape.integrals(begin, n, &mut integrals);
            for (cell, integral) in (begin..n / 2).zip(integrals) {
                let above = (integral - below) * cells;
                visit(cell, lowest + above);
                visit(n - 1 - cell, lowest + (extent - above));
                below = integral;
            }
        }
        if n % 2 == 1 {
            visit(n / 2, lowest + 0.5 * extent);
        }
    }

    /// The same for cells in proportion to the weights of the samples in `order`, one after the other.
    fn for_each_weighted_cell(&self, weights: &[f64], order: &[u32], mut visit: impl FnMut(usize, f64)) {
        let total: f64 = weights.iter().sum();
        let (mut below, mut lower) = (0.0, 0.0);
        for (rank, &position) in order.iter().enumerate() {
            below += weights[position as usize];
            let upper = (below / total).min(1.0);
            visit(rank, self.cell_mean(lower, upper));
            lower = upper;
        }
    }

    fn cell_mean(&self, lower: f64, upper: f64) -> f64 {
        // A weight may be too small beside the sum of all to give its cell a width, or its mean any digits.
        const NARROWEST: f64 = 1e-8;
        let &LongLaw { lowest, extent, ref shape } = self;
        if let LongShape::Pieces(pieces) = shape {
            return pieces.cell_mean(lower, upper);
        }
        let spare = 0.5 * (NARROWEST - (upper - lower)).max(0.0);
        let (lower, upper) = ((lower - spare).max(0.0), (upper + spare).min(1.0));
        // The quantile at 1 - u is the extent less that at u.
        let integral = |u: f64| {
            if u <= 0.5 { shape.integral(u) } else { extent * (u - 0.5) + shape.integral(1.0 - u) }
        };
        lowest + (integral(upper) - integral(lower)) / (upper - lower)
    }
}

/// Transports a subset along one direction and puts `(position, mass * displacement)` for each of its samples. Masses are
/// `weights`, or 1. Returns the sum of `mass * displacement²`.
#[inline(always)]
pub(crate) fn transport(
    subset: &Gather,
    theta: impl Fn(usize) -> f32 + Sync,
    law: &LongLaw,
    weights: Option<&[f64]>,
    buffers: &mut LongBuffers,
    mut put: impl FnMut(usize, f32),
) -> f64 {
    let n = subset.samples.len();
    let LongBuffers { projections, keys, entries, order, starts } = buffers;
    if (RADIX..=LARGEST_RADIX).contains(&n) {
        entries.resize(n.max(entries.len()), 0);
    }
    order.resize(n.max(order.len()), 0);
    projections.resize(n.max(projections.len()), 0.0);
    let (projections, order) = (&mut projections[..n], &mut order[..n]);
    if n >= SHARED {
        let parts = projections.par_chunks_mut(1 << 12).enumerate();
        parts.for_each(|(part, to)| subset.project(part << 12, &theta, to));
    } else {
        subset.project(0, &theta, projections);
    }
    match n {
        0..RADIX => sort_few(projections, keys, order),
        RADIX..=LARGEST_RADIX => sort_digits(projections, law, (entries, starts), order),
        _ => sort_shared(projections, keys, order),
    }
    let mut squares = 0.0;
    let mut displace = |rank: usize, mean: f64, weights: Option<&[f64]>| {
        let position = order[rank] as usize;
        let mass = weights.map_or(1.0, |weights| weights[position]);
        let displacement = mean - f64::from(projections[position]);
        squares += mass * displacement * displacement;
        put(position, (mass * displacement) as f32);
    };
    match weights {
        None => law.for_each_cell(n, |rank, mean| displace(rank, mean, None)),
        Some(weights) => {
            law.for_each_weighted_cell(weights, order, |rank, mean| displace(rank, mean, Some(weights)));
        }
    }
    squares
}

/// The projection in the high bits and its position in the low ones.
fn key((position, projection): (usize, &f32)) -> u64 {
    u64::from(ordered_bits(*projection)) << 32 | position as u64
}

fn sort_few(projections: &[f32], keys: &mut Vec<u64>, order: &mut [u32]) {
    keys.clear();
    keys.extend(projections.iter().enumerate().map(key));
    keys.sort_unstable();
    order.iter_mut().zip(keys).for_each(|(order, key)| *order = *key as u32);
}

fn sort_shared(projections: &[f32], keys: &mut Vec<u64>, order: &mut [u32]) {
    keys.resize(projections.len(), 0);
    let pairs = keys.par_iter_mut().zip(projections.par_iter().enumerate()).with_min_len(1 << 12);
    pairs.for_each(|(to, from)| *to = key(from));
    keys.par_sort_unstable();
    order.par_iter_mut().zip(keys).with_min_len(1 << 12).for_each(|(order, key)| *order = *key as u32);
}

/// Sorts by two digits of the projection's place in the support: to a 4-millionth of it, and by position below.
fn sort_digits(
    projections: &[f32],
    law: &LongLaw,
    (entries, starts): (&mut [u32], &mut Vec<[u32; 1 << DIGIT]>),
    order: &mut [u32],
) {
    const DIGITS: u32 = 2 * DIGIT;
    const LOW: u32 = (1 << DIGIT) - 1;
    let scale = (f64::from(1_u32 << DIGITS) / law.extent) as f32;
    let shift = (-law.lowest * f64::from(scale)) as f32;
    // A float becomes 0 rather than negative; rounding may exceed the last place.
    let place = |projection: f32| ((projection * scale + shift) as u32).min((1 << DIGITS) - 1);
    starts.clear();
    starts.resize(2, [0; 1 << DIGIT]);
    let [low, high] = starts.as_mut_slice() else { return };
    for (order, &projection) in order.iter_mut().zip(projections) {
        *order = place(projection);
    }
    for &place in &*order {
        low[(place & LOW) as usize] += 1;
        high[(place >> DIGIT & LOW) as usize] += 1;
    }
    for counts in [&mut *low, &mut *high] {
        let mut sum = 0;
        counts.iter_mut().for_each(|count| sum += std::mem::replace(count, sum));
    }
    for (position, &place) in order.iter().enumerate() {
        let start = &mut low[(place & LOW) as usize];
        entries[*start as usize] = (place & !LOW) << (32 - DIGITS) | position as u32;
        *start += 1;
    }
    for &entry in entries.iter().take(order.len()) {
        let start = &mut high[(entry >> (32 - DIGIT)) as usize];
        order[*start as usize] = entry & (u32::MAX >> DIGIT);
        *start += 1;
    }
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
