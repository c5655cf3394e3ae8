//! Balance along a direction: the samples' distribution function there, as a histogram knows it, brought to
//! that of the cube. It is a slice of the whole table without the sort.

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::reflect;
use super::tiles::{Cell, Tiles};
use crate::laws::Projected;
use crate::simd::{LANES, Row};

/// A direction, and the law of the cube there.
#[derive(Debug)]
pub(super) struct Line {
    /// Dimensions of the table, and the components along them.
    components: Vec<(usize, f32)>,
    law: Projected,
    lowest: f32,
    /// Bins per unit.
    scale: f32,
    bins: usize,
}

impl Line {
    pub(super) fn new(dims: &[usize], direction: &[f64], bins: usize) -> Self {
        let law = Projected::of_cube(direction);
        let (lowest, highest) = law.support();
        Self {
            components: dims
                .iter()
                .copied()
                .zip(direction.iter().map(|&component| component as f32))
                .collect(),
            lowest: lowest as f32,
            scale: (bins as f64 / (highest - lowest)) as f32,
            law,
            bins,
        }
    }

    /// Moves all samples, or those of each frame, `share` of the way.
    pub(super) fn advance(&self, arch: Arch, tiles: &mut Tiles, per_frame: bool, share: f64) {
        let frames = if per_frame { tiles.frames() } else { 1 };
        let rows = tiles.cell_rows();
        let parts = PARTS.min(rows.len());
        let part = |part: usize| rows.len() * part / parts..rows.len() * (part + 1) / parts;
        let counts: Vec<Vec<u32>> = (0..parts)
            .into_par_iter()
            .map(|index| {
                let mut counts = vec![0_u32; frames * self.bins];
                for row in part(index) {
                    arch.dispatch(Count { line: self, tiles, per_frame, row, counts: &mut counts });
                }
                counts
            })
            .collect();
        let mut counts = counts.into_iter();
        let mut sum = counts.next().unwrap_or_default();
        for counts in counts {
            sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
        let motions: Vec<f32> =
            sum.chunks_exact(self.bins).flat_map(|counts| self.motions(counts, share)).collect();
        let frames = tiles.frames_by_time();
        tiles.for_each_row(|time, _, cells, stride| {
            let firsts =
                frames[time].map(|frame| if per_frame { (frame * (self.bins + 1)) as u32 } else { 0 });
            arch.dispatch(Move { line: self, motions: &motions, firsts, cells, stride });
        });
    }

    /// What moves the samples at the boundaries of the bins to where the law has as much below.
    fn motions(&self, counts: &[u32], share: f64) -> Vec<f32> {
        let total: u32 = counts.iter().sum();
        let (lowest, highest) = self.law.support();
        let mut below = 0;
        let motion = |(edge, count): (usize, u32)| {
            below += count;
            let at = lowest + (highest - lowest) * edge as f64 / self.bins as f64;
            (share * (self.law.quantile(f64::from(below) / f64::from(total.max(1))) - at)) as f32
        };
        let mut motions = vec![0.0];
        motions.extend((1..).zip(counts.iter().copied()).map(motion));
        motions
    }

    /// Bins of the samples of a vector, and where in them they are.
    #[inline(always)]
    fn place(&self, cell: &[Cell]) -> ([u32; LANES], Row) {
        let mut at = [0.0; LANES];
        for &(dim, component) in &self.components {
            let Cell(values) = cell[dim];
            for lane in 0..LANES {
                at[lane] += component * values[lane];
            }
        }
        let (mut bins, mut shares) = ([0; LANES], [0.0; LANES]);
        let last = (self.bins - 1) as f32;
        for lane in 0..LANES {
            let place = (at[lane] - self.lowest) * self.scale;
            let bin = place.max(0.0).min(last) as i32;
            bins[lane] = bin as u32;
            shares[lane] = place - bin as f32;
        }
        (bins, shares)
    }
}

/// Parts of a table that are counted apart, whatever the number of threads.
const PARTS: usize = 8;

struct Count<'a> {
    line: &'a Line,
    tiles: &'a Tiles,
    per_frame: bool,
    row: usize,
    counts: &'a mut [u32],
}

impl NullaryFnOnce for Count<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { line, tiles, per_frame, row, counts } = self;
        let firsts = tiles.frames_of_row(row).map(|frame| if per_frame { frame * line.bins } else { 0 });
        for (cell, owners) in tiles.cells_of(row) {
            let (bins, _) = line.place(cell);
            for lane in 0..LANES {
                counts[firsts[lane] + bins[lane] as usize] += u32::from(owners >> lane & 1);
            }
        }
    }
}

struct Move<'a> {
    line: &'a Line,
    motions: &'a [f32],
    firsts: [u32; LANES],
    cells: &'a mut [Cell],
    stride: usize,
}

impl NullaryFnOnce for Move<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { line, motions, firsts, cells, stride } = self;
        for cell in cells.chunks_exact_mut(stride) {
            let (bins, shares) = line.place(cell);
            let mut along = [0.0; LANES];
            for lane in 0..LANES {
                let at = (firsts[lane] + bins[lane]) as usize;
                let ends = &motions[at..at + 2];
                along[lane] = ends[0] + shares[lane] * (ends[1] - ends[0]);
            }
            for &(dim, component) in &line.components {
                let Cell(values) = &mut cell[dim];
                for lane in 0..LANES {
                    values[lane] = reflect(values[lane] + component * along[lane]);
                }
            }
        }
    }
}
