//! A table as the pair loop reads it: one plane per dimension and sample of a pixel, rows padded with their wrapped ends.

use crate::class::Wanted;
use crate::lattice::Extent;
use crate::row::LANES;

/// Copy of a table in which the neighbours of [`LANES`] consecutive pixels are [`LANES`] consecutive numbers, also
/// across the edge of the tile.
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
        for index in 0..self.runs() {
            let run = self.run(index);
            for lane in 0..self.len(run) {
                let first = self.first(run, lane);
                self.set(run, lane, &points[first..first + self.dims]);
            }
        }
    }

    /// Place of a sample's first coordinate in a table.
    pub(super) fn first(&self, run: Run, lane: usize) -> usize {
        (self.site(run, lane) * self.extent.spp + run.sample) * self.dims
    }

    fn site(&self, run: Run, lane: usize) -> usize {
        (run.frame * self.extent.height + run.y) * self.extent.width + run.x + lane
    }

    /// Moves a sample, and its images in the margins.
    #[inline(always)]
    pub(super) fn set(&mut self, run: Run, lane: usize, point: &[f32]) {
        for (dim, &value) in point.iter().enumerate() {
            self.put(dim, run, lane, value);
        }
    }

    #[inline(always)]
    fn put(&mut self, plane: usize, run: Run, lane: usize, value: f32) {
        let (width, home) = (self.extent.width, run.x + lane + self.margin);
        let begin = self.begin(plane, run.sample, run.frame, run.y);
        let row = &mut self.values[begin..begin + self.stride];
        row[home] = value;
        // The margin is at most as wide as the tile, so that there is one image on either side.
        if home >= width {
            row[home - width] = value;
        }
        if let Some(image) = row.get_mut(home + width) {
            *image = value;
        }
    }
}
