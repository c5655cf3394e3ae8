//! Pictures in strips of rows, as coarse as points leave them, and the kinks of their corners.

use std::ops::Range;

use rayon::prelude::*;

/// A picture that a law is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane<'a> {
    /// Row by row.
    pub values: &'a [f32],
    /// Columns and rows.
    pub size: [usize; 2],
    /// Points per unit of the values, where the plane has most of them.
    pub points: f64,
    /// Side of the largest blocks that are averaged, a power of two; 1 for none.
    pub side: usize,
}

/// Change of the slope of all laws where a corner of the grid projects, times the lengths of a pixel's
/// projections: the mixed second difference of the values there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kink {
    pub x: u16,
    pub y: u16,
    pub size: f64,
}

/// Rows of a plane, averaged, and the kinks of the corners above them; of the last rows also those below.
#[derive(Clone, Debug, Default)]
pub(super) struct Strip {
    pub rows: Vec<f64>,
    pub kinks: Vec<Kink>,
    above: Vec<f64>,
}

/// Pixels of a strip, about.
const STRIP: usize = 1 << 16;
/// Strips that are looked at together.
pub(super) const IN_FLIGHT: usize = 8;
/// The largest blocks.
const MOST_SIDE: usize = 16;
/// A block is averaged where it holds so small a part of a point, by mass and by area.
const BLOCK: f64 = 1.0 / 64.0;

impl<'a> Plane<'a> {
    /// A plane that has so many points per unit of its values, at most `most` in all. It loses what they
    /// cannot resolve.
    pub(super) fn new(values: &'a [f32], size: [usize; 2], points: f64, most: usize) -> Self {
        let holds = |side: usize| (side * side) as f64 / values.len() as f64 * most as f64;
        let mut side = 1;
        while side < MOST_SIDE && holds(2 * side) <= BLOCK {
            side *= 2;
        }
        Self { values, size, points, side }
    }

    /// The rows of each strip; they depend on the picture alone.
    pub(super) fn strips(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let [width, height] = self.size;
        let rows = MOST_SIDE.max(STRIP / width / MOST_SIDE * MOST_SIDE);
        (0..height).step_by(rows).map(move |first| first..(first + rows).min(height))
    }

    /// Fills strips, in parallel.
    pub(super) fn fill_all(&self, rows: &[Range<usize>], strips: &mut Vec<Strip>) {
        strips.resize_with(rows.len(), Strip::default);
        strips.par_iter_mut().zip(rows).for_each(|(strip, rows)| self.fill(rows, strip));
    }

    fn fill(&self, rows: &Range<usize>, strip: &mut Strip) {
        let [width, height] = self.size;
        let Strip { rows: averaged, kinks, above } = strip;
        // The last row before is that of a block as well.
        self.average(rows.start.saturating_sub(self.side)..rows.start, above);
        self.average(rows.clone(), averaged);
        kinks.clear();
        let none = vec![0.0; width];
        let mut before = above.len().checked_sub(width).map_or(&none[..], |last| &above[last..]);
        let below = if rows.end == height { Some(&none[..]) } else { None };
        for (y, row) in (rows.start..).zip(averaged.chunks_exact(width).chain(below)) {
            let mut left = 0.0;
            let mut push = |x: usize, difference: f64| {
                let size = difference - left;
                left = difference;
                if size != 0.0 {
                    kinks.push(Kink { x: x as u16, y: y as u16, size });
                }
            };
            for (x, (value, above)) in row.iter().zip(before).enumerate() {
                push(x, value - above);
            }
            push(width, 0.0);
            before = row;
        }
    }

    /// Writes rows from a multiple of `side` on.
    fn average(&self, rows: Range<usize>, averaged: &mut Vec<f64>) {
        let width = self.size[0];
        averaged.clear();
        averaged
            .extend(self.values[rows.start * width..rows.end * width].iter().map(|&value| f64::from(value)));
        if self.side == 1 {
            return;
        }
        let side = self.side;
        for top in (0..rows.len()).step_by(side) {
            for left in (0..width).step_by(side) {
                self.level(averaged, [left, top], side);
            }
        }
    }

    /// Averages a block that is too light for its shape to matter, or its quarters.
    fn level(&self, averaged: &mut [f64], [left, top]: [usize; 2], side: usize) {
        let width = self.size[0];
        let (right, bottom) = ((left + side).min(width), (top + side).min(averaged.len() / width));
        if right <= left || bottom <= top {
            return;
        }
        let lines = (top..bottom).map(|y| y * width + left..y * width + right);
        let sum: f64 = lines.clone().map(|line| averaged[line].iter().sum::<f64>()).sum();
        if sum * self.points <= BLOCK {
            let mean = sum / ((right - left) * (bottom - top)) as f64;
            lines.for_each(|line| averaged[line].fill(mean));
        } else if side > 2 {
            let half = side / 2;
            for corner in [[left, top], [left + half, top], [left, top + half], [left + half, top + half]] {
                self.level(averaged, corner, half);
            }
        }
    }
}
