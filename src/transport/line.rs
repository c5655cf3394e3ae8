//! One slice at a time: subsets too long for the lanes, single directions, weighted samples.

use rayon::prelude::*;

use crate::directions::cube_bank::{Block, Boundary};
use crate::directions::{Directions, Laws};
use crate::laws::Pieces;
use crate::table::extent::bytes_of;
use crate::transport::gather::Gather;
use crate::transport::sort::{SHARED, SortBuffers};

/// Cells whose means are computed together.
const BLOCK: usize = 64;

/// Buffers of one worker; they grow to the largest subset seen and stay.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineBuffers {
    projections: Vec<f32>,
    /// Positions by increasing projection.
    order: Vec<u32>,
    sort: SortBuffers,
}

impl LineBuffers {
    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        bytes_of(&self.projections) + bytes_of(&self.order) + self.sort.bytes()
    }
}

/// Law of the projection on one direction.
pub(crate) struct LineLaw<'a> {
    /// Lowest projection.
    lowest: f64,
    /// Length of the support.
    extent: f64,
    cells: LineCells<'a>,
}

/// What lies between the ends of the support.
enum LineCells<'a> {
    /// Of the cube: symmetric about the middle.
    Symmetric(SymmetricLine<'a>),
    /// Of another target.
    Pieces(&'a Pieces),
}

/// A symmetric density, from the lower end of its support.
enum SymmetricLine<'a> {
    /// That of `a U + b V` for independent uniform `U`, `V`, with `a ≥ b ≥ 0`.
    Trapezoid {
        /// `a`.
        longer: f64,
        /// `b`.
        shorter: f64,
    },
    /// From a bank.
    Tabulated {
        /// Where the direction comes from.
        block: &'a Block,
        /// Which of its directions.
        lane: usize,
    },
}

impl SymmetricLine<'_> {
    /// Integrals of the quantile function from 0 to the upper ends of cells, from cell `begin` of `n` on.
    #[inline(always)]
    fn integrals(&self, begin: usize, n: usize, integrals: &mut [f64; BLOCK]) {
        let end = |index: usize| ((begin + index + 1) as u32 as f64 / n as f64).min(0.5);
        match *self {
            SymmetricLine::Trapezoid { longer, shorter } => {
                for (index, integral) in integrals.iter_mut().enumerate() {
                    *integral = trapezoid_integral(longer, shorter, end(index));
                }
            }
            SymmetricLine::Tabulated { block, lane } => {
                for (index, integral) in integrals.iter_mut().enumerate().take(n / 2 - begin) {
                    *integral = block.integral_of_lane(&Boundary::new(end(index)), lane);
                }
            }
        }
    }

    /// Integral of the quantile function from 0 to `u`, at most 1/2.
    fn integral(&self, u: f64) -> f64 {
        match *self {
            SymmetricLine::Trapezoid { longer, shorter } => trapezoid_integral(longer, shorter, u),
            SymmetricLine::Tabulated { block, lane } => block.integral_of_lane(&Boundary::new(u), lane),
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

impl<'a> LineLaw<'a> {
    /// The law of one of the drawn directions.
    #[inline(always)]
    pub(crate) fn new(directions: &Directions, laws: Laws<'a>, lane: usize) -> Self {
        let components = || directions.theta.iter().map(|row| f64::from(row[lane]));
        let lowest = components().map(|component| component.min(0.0)).sum();
        let extent = components().map(f64::abs).sum();
        let cells = match laws {
            Laws::Pieces { bank, places } => LineCells::Pieces(bank.law(places[lane] as usize)),
            Laws::Block { block, on_axis } if !on_axis[lane] => {
                LineCells::Symmetric(SymmetricLine::Tabulated { block, lane })
            }
            // A coordinate axis has the law of one dimension; otherwise there are at most two.
            Laws::Block { .. } | Laws::Closed => {
                let longer = components().map(f64::abs).fold(0.0, f64::max);
                LineCells::Symmetric(SymmetricLine::Trapezoid { longer, shorter: extent - longer })
            }
        };
        Self { lowest, extent, cells }
    }

    /// Visits `n` equal cells with the means of the quantile function over them; symmetric ones from both
    /// ends to the middle.
    #[inline(always)]
    fn for_each_cell(&self, n: usize, mut visit: impl FnMut(usize, f64)) {
        let &LineLaw { lowest, extent, ref cells } = self;
        let symmetric = match cells {
            LineCells::Pieces(pieces) => return pieces.for_each_cell(n, visit),
            LineCells::Symmetric(symmetric) => symmetric,
        };
        let cells = n as f64;
        let mut below = 0.0;
        // Integrals come in blocks of their own, which are whole vectors of square roots.
        for begin in (0..n / 2).step_by(BLOCK) {
            let mut integrals = [0.0; BLOCK];
            symmetric.integrals(begin, n, &mut integrals);
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
        let &LineLaw { lowest, extent, ref cells } = self;
        let symmetric = match cells {
            LineCells::Pieces(pieces) => return pieces.cell_mean(lower, upper),
            LineCells::Symmetric(symmetric) => symmetric,
        };
        let spare = 0.5 * (NARROWEST - (upper - lower)).max(0.0);
        let (lower, upper) = ((lower - spare).max(0.0), (upper + spare).min(1.0));
        // The quantile at 1 - u is the extent less that at u.
        let integral = |u: f64| {
            if u <= 0.5 { symmetric.integral(u) } else { extent * (u - 0.5) + symmetric.integral(1.0 - u) }
        };
        lowest + (integral(upper) - integral(lower)) / (upper - lower)
    }
}

/// Transports a subset along one direction and puts `(position, mass * displacement)` for each of its
/// samples. Masses are `weights`, or 1. Returns the sum of `mass * displacement²`.
#[inline(always)]
pub(crate) fn transport(
    subset: &Gather,
    theta: impl Fn(usize) -> f32 + Sync,
    law: &LineLaw,
    weights: Option<&[f64]>,
    buffers: &mut LineBuffers,
    mut put: impl FnMut(usize, f32),
) -> f64 {
    let n = subset.samples.len();
    let LineBuffers { projections, order, sort } = buffers;
    order.resize(n.max(order.len()), 0);
    projections.resize(n.max(projections.len()), 0.0);
    let (projections, order) = (&mut projections[..n], &mut order[..n]);
    if n >= SHARED {
        let parts = projections.par_chunks_mut(1 << 12).enumerate();
        parts.for_each(|(part, to)| subset.project(part << 12, &theta, to));
    } else {
        subset.project(0, &theta, projections);
    }
    sort.sort(projections, (law.lowest, law.extent), order);
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
