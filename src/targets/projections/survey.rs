//! What there is to know of pictures before they are projected: where the knots of their laws should be.

use std::ops::Range;

use super::line::{Grid, Line};
use super::planes::{IN_FLIGHT, Kink, Plane, Strip};
use crate::targets::watch::{Stopped, Watch};

/// Pictures of one size, looked through once.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    size: [usize; 2],
    /// Sums over the columns and the rows, by plane.
    pub sums: Vec<[Vec<f64>; 2]>,
    /// Corners whose kinks matter to some point.
    heavy: Vec<Heavy>,
    /// Points per block of `block` by `block` pixels, of all planes.
    coarse: Vec<f64>,
    block: usize,
    /// Of those, in points per pixel.
    coarse_kinks: Vec<Kink>,
}

/// A corner with the size of its kink in points.
#[derive(Clone, Copy, Debug)]
struct Heavy {
    x: u16,
    y: u16,
    points: f64,
}

/// Corners that are knots themselves where they are no more; the law is exact then.
const FEW_CORNERS: usize = 1024;
/// Corners that are knots themselves at most.
const MOST_HEAVY: usize = 4096;
/// Points that a kink must move to another pixel to be a knot.
const HEAVY: f64 = 0.25;
/// Blocks along the longer side, for a first idea of a law.
const BLOCKS: usize = 128;
/// Even pieces of that idea.
const COARSE_PIECES: usize = 512;
/// Pieces along a direction per pixel of the longer side, within limits, beside those of heavy corners.
const PIECES_PER_PX: usize = 2;
const PIECES: std::ops::RangeInclusive<usize> = 256..=2048;

impl Survey {
    /// Looks through planes of one size.
    pub(super) fn of(size: [usize; 2], planes: &[Plane], watch: &mut Watch) -> Result<Self, Stopped> {
        let [width, height] = size;
        let block = width.max(height).div_ceil(BLOCKS);
        let sums = vec![[vec![0.0; width], vec![0.0; height]]; planes.len()];
        let coarse = vec![0.0; width.div_ceil(block) * height.div_ceil(block)];
        let mut survey = Self { size, sums, heavy: Vec::new(), coarse, coarse_kinks: Vec::new(), block };
        let mut strips = Vec::new();
        for (index, plane) in planes.iter().enumerate() {
            let rows: Vec<Range<usize>> = plane.strips().collect();
            let mut done = 0;
            for together in rows.chunks(IN_FLIGHT) {
                plane.fill_all(together, &mut strips);
                together.iter().zip(&strips).for_each(|(rows, strip)| survey.add(index, plane, rows, strip));
                done += together.len();
                watch.tell((index as f64 + done as f64 / rows.len() as f64) / planes.len() as f64)?;
            }
        }
        survey.keep_heaviest();
        survey.coarse_kinks = survey.kinks_of_blocks();
        Ok(survey)
    }

    /// Takes note of a strip of a plane.
    fn add(&mut self, plane: usize, of: &Plane, rows: &Range<usize>, strip: &Strip) {
        let width = self.size[0];
        let blocks = width.div_ceil(self.block);
        for (y, row) in rows.clone().zip(strip.rows.chunks_exact(width)) {
            let [columns, lines] = &mut self.sums[plane];
            columns.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
            let coarse = &mut self.coarse[y / self.block * blocks..][..blocks];
            for (sum, values) in coarse.iter_mut().zip(row.chunks(self.block)) {
                let values: f64 = values.iter().sum();
                lines[y] += values;
                *sum += of.points * values;
            }
        }
        let is_few = (self.size[0] + 1) * (self.size[1] + 1) <= FEW_CORNERS;
        let least = if is_few { 0.0 } else { HEAVY };
        let heavy =
            strip.kinks.iter().map(|&Kink { x, y, size }| Heavy { x, y, points: size.abs() * of.points });
        self.heavy.extend(heavy.filter(|heavy| heavy.points >= least));
        if self.heavy.len() > 4 * MOST_HEAVY {
            self.keep_heaviest();
        }
    }

    fn keep_heaviest(&mut self) {
        let order = |a: &Heavy, b: &Heavy| b.points.total_cmp(&a.points).then((a.y, a.x).cmp(&(b.y, b.x)));
        if self.heavy.len() > MOST_HEAVY {
            self.heavy.select_nth_unstable_by(MOST_HEAVY, order);
            self.heavy.truncate(MOST_HEAVY);
        }
    }

    /// Knots at most.
    pub(super) fn most_pieces(&self) -> usize {
        self.wanted() + self.heavy.len() + 4
    }

    fn wanted(&self) -> usize {
        (PIECES_PER_PX * self.size[0].max(self.size[1])).clamp(*PIECES.start(), *PIECES.end())
    }

    /// The knots of laws along a line: heavy corners, and places between which there is an equal share of the
    /// mean of all points and of the picture's width.
    pub(super) fn grid(&self, line: &Line) -> Grid {
        let wanted = self.wanted();
        if let Some(axis) = line.axis
            && self.size[axis] <= *PIECES.end()
        {
            return Grid::new(line, (0..=self.size[axis]).map(|index| line.place(index, index)).collect());
        }
        let mut knots = self.spread(line, wanted);
        knots.extend(line.corners(self.size));
        knots.extend(self.heavy.iter().map(|heavy| line.place(heavy.x.into(), heavy.y.into())));
        Grid::new(line, knots)
    }

    /// Knots by the points of coarse blocks.
    fn spread(&self, line: &Line, wanted: usize) -> Vec<f64> {
        let coarse = Grid::even(line, COARSE_PIECES);
        let mut changes = vec![[0.0; 4]; coarse.pieces()];
        let points = match line.axis {
            Some(axis) => {
                let sums = self.blocks_along(axis);
                line.add_sums(axis, &sums, &coarse, &mut changes);
                sums.iter().sum()
            }
            None => {
                line.add(&self.coarse_kinks, &coarse, &mut changes);
                self.coarse.iter().sum()
            }
        };
        let pieces = coarse.pieces() as f64;
        let (mut knots, mut before) = (Vec::with_capacity(wanted), 0.0);
        for (piece, (mass, _)) in line.masses(points, &coarse, changes.into_iter()).enumerate() {
            let step = 0.5 * (mass + 1.0 / pieces);
            let after = before + step;
            let first = (before * wanted as f64).ceil();
            let mut knot = first;
            while knot < after * wanted as f64 {
                let share = (knot / wanted as f64 - before) / step;
                knots.push(line.at((piece as f64 + share) / pieces));
                knot += 1.0;
            }
            before = after;
        }
        knots
    }

    /// Points of the columns or rows, evenly over each block.
    fn blocks_along(&self, axis: usize) -> Vec<f64> {
        let blocks = self.size.map(|len| len.div_ceil(self.block));
        let mut sums = vec![0.0; blocks[axis]];
        for (index, points) in self.coarse.iter().enumerate() {
            sums[[index % blocks[0], index / blocks[0]][axis]] += points;
        }
        let len = self.size[axis];
        let pixels = |at: usize| ((at / self.block + 1) * self.block).min(len) - at / self.block * self.block;
        (0..len).map(|at| sums[at / self.block] / pixels(at) as f64).collect()
    }

    fn kinks_of_blocks(&self) -> Vec<Kink> {
        let [width, height] = self.size;
        let [columns, rows] = self.size.map(|len| len.div_ceil(self.block));
        let edge = |index: usize, len: usize| (index * self.block).min(len);
        let value = |column: usize, row: usize| {
            // Before the first and after the last there is nothing.
            let (column, row) = (column.wrapping_sub(1), row.wrapping_sub(1));
            if column >= columns || row >= rows {
                return 0.0;
            }
            let area =
                (edge(column + 1, width) - edge(column, width)) * (edge(row + 1, height) - edge(row, height));
            self.coarse[row * columns + column] / area as f64
        };
        let corners = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
        let kink = |(column, row): (usize, usize)| Kink {
            x: edge(column, width) as u16,
            y: edge(row, height) as u16,
            size: value(column + 1, row + 1) - value(column, row + 1) - value(column + 1, row)
                + value(column, row),
        };
        corners.map(kink).collect()
    }
}
