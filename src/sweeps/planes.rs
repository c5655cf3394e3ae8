//! A table as the pair loop reads it: one plane per dimension and sample of a pixel, rows padded with their
//! wrapped ends.

use std::ops::Range;

use rayon::prelude::*;

use crate::classes::Wanted;
use crate::simd::{LANES, Row};
use crate::table::domain::Domain;
use crate::table::extent::Extent;

/// Copy of a table in which the neighbours of [`LANES`] consecutive pixels are [`LANES`] consecutive numbers,
/// also across the edge of the tile.
#[derive(Clone, Debug)]
pub(super) struct Planes {
    extent: Extent,
    dims: usize,
    /// Pixels before and after each row.
    margin: usize,
    stride: usize,
    values: Vec<f32>,
    /// Whether the last plane says which samples are demanded.
    partial: bool,
}

/// [`LANES`] consecutive pixels of a row (fewer at its end), one sample of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub sample: usize,
    pub frame: usize,
    pub y: usize,
    pub x: usize,
}

impl Planes {
    /// Room for a table; `margin`, at most the width, is how far neighbours reach in x.
    pub(super) fn new(extent: Extent, dims: usize, margin: usize, wanted: &Wanted) -> Self {
        let stride = extent.width.next_multiple_of(LANES) + 2 * margin;
        let partial = matches!(wanted, Wanted::Some(_));
        let rows = (dims + usize::from(partial)) * extent.spp * extent.frames * extent.height;
        let mut planes = Self { extent, dims, margin, stride, values: vec![0.0; rows * stride], partial };
        if partial {
            for index in 0..planes.runs() {
                let run = planes.run(index);
                for lane in 0..planes.len(run) {
                    let flag = wanted.site(planes.site(run, lane));
                    planes.put(dims, run, lane, if flag { 1.0 } else { 0.0 });
                }
            }
        }
        planes
    }

    pub(super) fn is_partial(&self) -> bool {
        self.partial
    }

    /// Which samples of a row are demanded (1) or not (0); `None` if all are.
    #[inline(always)]
    pub(super) fn demanded(&self, sample: usize, frame: usize, y: usize) -> Option<&[f32]> {
        self.partial.then(|| self.row(self.dims, sample, frame, y))
    }

    /// Whether a sample is demanded.
    pub(super) fn wants(&self, run: Run, lane: usize) -> bool {
        let row = self.demanded(run.sample, run.frame, run.y);
        row.is_none_or(|row| row[run.x + lane + self.margin] > 0.0)
    }

    /// Number of runs that hold all samples.
    pub(super) fn runs(&self) -> usize {
        self.extent.spp * self.extent.frames * self.extent.height * self.extent.width.div_ceil(LANES)
    }

    pub(super) fn run(&self, index: usize) -> Run {
        let Extent { frames, height, width, .. } = self.extent;
        let (row, x) = (index / width.div_ceil(LANES), index % width.div_ceil(LANES) * LANES);
        Run { sample: row / (frames * height), frame: row / height % frames, y: row % height, x }
    }

    /// Pixels of the row from `run.x` on that belong to the run.
    pub(super) fn len(&self, run: Run) -> usize {
        (self.extent.width - run.x).min(LANES)
    }

    /// The values of a row with its margins: the pixel `x + dx` is at `x + margin + dx`.
    #[inline(always)]
    pub(super) fn row(&self, dim: usize, sample: usize, frame: usize, y: usize) -> &[f32] {
        let begin = self.begin(dim, sample, frame, y);
        &self.values[begin..begin + self.stride]
    }

    #[inline(always)]
    fn begin(&self, dim: usize, sample: usize, frame: usize, y: usize) -> usize {
        let Extent { frames, height, spp, .. } = self.extent;
        (((dim * spp + sample) * frames + frame) * height + y) * self.stride
    }

    /// Copies a table in.
    pub(super) fn load(&mut self, points: &[f32]) {
        let Self { extent, dims, margin, stride, .. } = *self;
        let Extent { frames, height, width, spp } = extent;
        let (lines, rows) = (frames * height, dims * spp * frames * height);
        let rows =
            self.values.par_chunks_exact_mut(stride).take(rows).enumerate().with_min_len(ROWS_PER_TASK);
        rows.for_each(|(index, row)| {
            let (plane, line) = (index / lines, index % lines);
            let first = line * width * spp * dims + plane % spp * dims + plane / spp;
            let values = points[first..].iter().step_by(spp * dims);
            row[margin..margin + width].iter_mut().zip(values).for_each(|(to, from)| *to = *from);
            repeat(row, margin, width, 0..width);
        });
    }

    /// Copies the table out.
    pub(super) fn store(&self, points: &mut [f32]) {
        let Self { extent, dims, margin, stride, .. } = *self;
        let Extent { frames, height, width, spp } = extent;
        let per_row = width * spp * dims;
        points.par_chunks_exact_mut(per_row).enumerate().with_min_len(ROWS_PER_TASK).for_each(
            |(line, points)| {
                for (sample, dim) in (0..spp).flat_map(|sample| (0..dims).map(move |dim| (sample, dim))) {
                    let begin = ((dim * spp + sample) * frames * height + line) * stride + margin;
                    let values = &self.values[begin..begin + width];
                    let to = points[sample * dims + dim..].iter_mut().step_by(spp * dims);
                    to.zip(values).for_each(|(to, from)| *to = *from);
                }
            },
        );
    }

    /// Place of a sample's first coordinate in a table.
    #[cfg(test)]
    pub(super) fn first(&self, run: Run, lane: usize) -> usize {
        (self.site(run, lane) * self.extent.spp + run.sample) * self.dims
    }

    fn site(&self, run: Run, lane: usize) -> usize {
        (run.frame * self.extent.height + run.y) * self.extent.width + run.x + lane
    }

    /// Moves coordinate `dim` of the demanded samples of a run by `motion`, and their images in the margins.
    #[inline(always)]
    pub(super) fn shift(&mut self, dim: usize, run: Run, motion: &Row, domain: Domain) {
        let (len, home) = (self.len(run), run.x + self.margin);
        let begin = self.begin(dim, run.sample, run.frame, run.y);
        if self.partial {
            let flags = self.begin(self.dims, run.sample, run.frame, run.y);
            for (lane, motion) in motion.iter().enumerate().take(len) {
                if self.values[flags + home + lane] > 0.0 {
                    let value = &mut self.values[begin + home + lane];
                    *value = domain.admit(*value + motion);
                }
            }
        } else {
            let values = &mut self.values[begin + home..][..len];
            values.iter_mut().zip(motion).for_each(|(value, motion)| *value = domain.admit(*value + motion));
        }
        let row = &mut self.values[begin..begin + self.stride];
        repeat(row, self.margin, self.extent.width, run.x..run.x + len);
    }

    #[inline(always)]
    fn put(&mut self, plane: usize, run: Run, lane: usize, value: f32) {
        let x = run.x + lane;
        let begin = self.begin(plane, run.sample, run.frame, run.y);
        let row = &mut self.values[begin..begin + self.stride];
        row[self.margin + x] = value;
        repeat(row, self.margin, self.extent.width, x..x + 1);
    }
}

/// Rows that are worth handing to a thread.
const ROWS_PER_TASK: usize = 64;

/// Copies pixels of a row to their images in its margins, and behind its end where that is filled up to whole
/// runs.
#[inline(always)]
fn repeat(row: &mut [f32], margin: usize, width: usize, pixels: Range<usize>) {
    // A margin is at most as wide as the tile, so that there is one image on either side.
    let first = pixels.start.max(width - margin);
    if first < pixels.end {
        row.copy_within(margin + first..margin + pixels.end, margin + first - width);
    }
    let last = pixels.end.min(row.len() - margin - width);
    if pixels.start < last {
        row.copy_within(margin + pixels.start..margin + last, margin + pixels.start + width);
    }
}
