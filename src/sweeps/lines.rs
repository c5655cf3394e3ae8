//! Balance along a direction: the samples' distribution function there, as a histogram knows it, brought to
//! that of the cube. It is a slice of the whole table without the sort.

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::reflect;
use super::tiles::{Cell, CellRow, Tiles};
use crate::laws::SquareLaw;
use crate::simd::{LANES, Row};
use crate::table::extent::bytes_of;

/// A direction in one or two dimensions, and the law of the cube there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// A dimension of the table, and the component along it; the second is 0 on a line of one dimension.
    components: [(usize, f32); 2],
    law: SquareLaw,
    lowest: f32,
    /// Bins per unit.
    scale: f32,
    bins: usize,
}

/// Buffers that stay.
#[derive(Clone, Debug, Default)]
pub(super) struct LineBuffers {
    counts: Vec<u32>,
    motions: Vec<f32>,
}

impl LineBuffers {
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.counts) + bytes_of(&self.motions)
    }
}

/// Parts of a table that are counted apart, whatever the number of threads.
pub(super) const PARTS: usize = 8;

/// Parts of so many rows that are worth handing to a thread.
pub(super) fn parts_per_task(rows: usize) -> usize {
    (PARTS * 32).div_ceil(rows.max(1)).clamp(1, PARTS)
}

impl Line {
    pub(super) fn new(dims: &[usize], direction: &[f64], bins: usize) -> Self {
        let law = SquareLaw::new(direction);
        let (lowest, highest) = law.support();
        let component =
            |k: usize| (dims.get(k).copied().unwrap_or(dims[0]), *direction.get(k).unwrap_or(&0.0) as f32);
        Self {
            components: [component(0), component(1)],
            lowest: lowest as f32,
            scale: (bins as f64 / (highest - lowest)) as f32,
            law,
            bins,
        }
    }

    /// Moves all samples, or those of each frame, `share` of the way.
    pub(super) fn advance(
        &self,
        arch: Arch,
        tiles: &mut Tiles,
        buffers: &mut LineBuffers,
        per_frame: bool,
        share: f64,
    ) {
        let frames = if per_frame { tiles.frames() } else { 1 };
        let LineBuffers { counts, motions } = buffers;
        let (len, rows) = (frames * self.bins, tiles.cell_rows());
        counts.clear();
        counts.resize(PARTS * len, 0);
        let parts = counts.par_chunks_exact_mut(len).enumerate().with_min_len(parts_per_task(rows.len()));
        parts.for_each(|(part, counts)| {
            for row in rows.len() * part / PARTS..rows.len() * (part + 1) / PARTS {
                arch.dispatch(Count { line: self, tiles, per_frame, row, counts });
            }
        });
        let (counts, others) = counts.split_at_mut(len);
        for other in others.chunks_exact(len) {
            counts.iter_mut().zip(other).for_each(|(sum, count)| *sum += count);
        }
        motions.clear();
        counts.chunks_exact(self.bins).for_each(|counts| self.add_motions(counts, share, motions));
        tiles.for_each_row(|row| arch.dispatch(Move { line: self, motions, per_frame, row }));
    }

    /// What moves the samples at the boundaries of the bins to where the law has as much below.
    fn add_motions(&self, counts: &[u32], share: f64, motions: &mut Vec<f32>) {
        let total = f64::from(counts.iter().sum::<u32>().max(1));
        let (lowest, highest) = self.law.support();
        let mut below = 0;
        motions.push(0.0);
        motions.extend((1..).zip(counts).map(|(edge, count)| {
            below += count;
            let at = lowest + (highest - lowest) * f64::from(edge) / self.bins as f64;
            (share * (self.law.quantile(f64::from(below) / total) - at)) as f32
        }));
    }

    /// Bins of the samples of a vector, and where in them they are.
    #[inline(always)]
    fn place(&self, cell: &[Cell]) -> ([u32; LANES], Row) {
        let [(first, along), (second, across)] = self.components;
        let [Cell(x), Cell(y)] = [cell[first], cell[second]];
        let (mut bins, mut shares) = ([0; LANES], [0.0; LANES]);
        let last = (self.bins - 1) as f32;
        for lane in 0..LANES {
            let place = (along * x[lane] + across * y[lane] - self.lowest) * self.scale;
            let bin = place.clamp(0.0, last) as i32;
            bins[lane] = bin as u32;
            shares[lane] = place - bin as f32;
        }
        (bins, shares)
    }
}

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
    per_frame: bool,
    row: CellRow<'a>,
}

impl NullaryFnOnce for Move<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { line, motions, per_frame, row: CellRow { frames, cells, stride, .. } } = self;
        let firsts = frames.map(|frame| if per_frame { (frame * (line.bins + 1)) as u32 } else { 0 });
        for cell in cells.chunks_exact_mut(stride) {
            let (bins, shares) = line.place(cell);
            let mut motion = [0.0; LANES];
            for lane in 0..LANES {
                let at = (firsts[lane] + bins[lane]) as usize;
                let ends = &motions[at..at + 2];
                motion[lane] = ends[0] + shares[lane] * (ends[1] - ends[0]);
            }
            for (dim, component) in line.components {
                let Cell(values) = &mut cell[dim];
                for lane in 0..LANES {
                    values[lane] = reflect(values[lane] + component * motion[lane]);
                }
            }
        }
    }
}
