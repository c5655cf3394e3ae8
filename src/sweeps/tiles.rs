//! A table as the pair loop reads it: the lattice cut into sixteen tiles, one per lane of a vector.

use std::ops::Range;

use rayon::prelude::*;

use super::axis::{Axis, Copies};
use super::cut::cut;
use super::reflect;
use crate::classes::Wanted;
use crate::kernel::Tap;
use crate::simd::{LANES, Row};
use crate::table::domain::Domain;
use crate::table::extent::{Extent, Site, bytes_of};

/// Copy of a table in which a vector holds the same cell of sixteen tiles.
///
/// Samples that move together are then far from each other, and no two of them are neighbours along a row;
/// what lies next to all sixteen is again a vector (the layout of Boyle et al. 2015, "Grid: a next generation
/// data parallel C++ QCD library", whose virtual nodes are our tiles).
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    extent: Extent,
    dims: usize,
    /// Along time, y and x.
    axes: [Axis; 3],
    /// Vectors by sample, frame, row, column, and coordinate; a last one says what is demanded. None until a
    /// table is loaded.
    values: Vec<Cell>,
    wanted: Wanted,
    partial: bool,
    /// Along each axis, where the cells are stored.
    copies: [Vec<Vec<Copies>>; 3],
    /// The frames of all lanes, by place in time.
    frames: Vec<[usize; LANES]>,
    /// Per cell, the tiles that own a demanded site there: one bit each.
    owners: Vec<u16>,
}

/// A vector that lies in one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Cell(pub Row);

/// A row of cells.
pub(super) struct CellRow<'a> {
    /// The frames of all lanes.
    pub frames: [usize; LANES],
    pub dims: usize,
    pub cells: &'a mut [Cell],
    /// Vectors that belong together.
    pub stride: usize,
}

/// One sample of the same cell of all tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub sample: usize,
    /// Along time, y and x.
    pub cell: [usize; 3],
    owners: u16,
}

impl Run {
    /// Tiles whose sample is theirs to move.
    #[inline(always)]
    pub(super) fn lanes(self) -> impl Iterator<Item = usize> {
        (0..LANES).filter(move |lane| self.owners >> lane & 1 == 1)
    }
}

impl Tiles {
    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.values) + bytes_of(&self.owners)
    }

    /// Room for a table, whose samples see others at the offsets of `taps`.
    pub(super) fn new(extent: Extent, dims: usize, taps: &[Tap], wanted: &Wanted) -> Self {
        let axes = cut(&extent, taps, wanted);
        let (partial, cells) = (wanted.is_partial(), axes.iter().map(Axis::cells).product());
        let [_, height, width] = axes.each_ref().map(Axis::tiles);
        let copies = [
            axes[0].copies(|lane| lane / width / height, height * width),
            axes[1].copies(|lane| lane / width % height, width),
            axes[2].copies(|lane| lane % width, 1),
        ];
        let (wanted, values) = (wanted.clone(), Vec::new());
        let frames = Vec::new();
        let mut tiles =
            Self { extent, dims, axes, values, wanted, partial, copies, frames, owners: vec![0; cells] };
        let frame = |time: usize, lane: usize| tiles.axes[0].site(tiles.tile(lane)[0], time);
        tiles.frames =
            (0..tiles.axes[0].stored()).map(|time| std::array::from_fn(|lane| frame(time, lane))).collect();
        for index in 0..cells {
            let cell = tiles.run(index * extent.spp).cell;
            let owns = |lane: &usize| {
                let tile = tiles.tile(*lane);
                let owned = (0..3).all(|axis| tiles.axes[axis].owns(tile[axis], cell[axis]));
                owned && tiles.wanted.site(extent.site_index(tiles.site(cell, *lane)))
            };
            tiles.owners[index] = (0..LANES).filter(owns).map(|lane| 1 << lane).sum();
        }
        tiles
    }

    /// Vectors per sample: its coordinates, and whether it is demanded.
    #[inline(always)]
    pub(super) fn planes(&self) -> usize {
        self.dims + usize::from(self.partial)
    }

    pub(super) fn is_partial(&self) -> bool {
        self.partial
    }

    /// Number of runs that hold all samples.
    pub(super) fn runs(&self) -> usize {
        self.extent.spp * self.owners.len()
    }

    /// Runs that hold a demanded sample.
    pub(super) fn owned_runs(&self) -> Vec<u32> {
        (0..self.runs() as u32).filter(|&index| self.run(index as usize).owners != 0).collect()
    }

    /// Runs that follow each other lie next to each other.
    pub(super) fn run(&self, index: usize) -> Run {
        let [_, height, width] = self.axes.each_ref().map(Axis::cells);
        let (cell, sample) = (index / self.extent.spp, index % self.extent.spp);
        let row = cell / width;
        self.run_at(sample, [row / height, row % height, cell % width])
    }

    fn run_at(&self, sample: usize, cell: [usize; 3]) -> Run {
        let [_, height, width] = self.axes.each_ref().map(Axis::cells);
        Run { sample, cell, owners: self.owners[(cell[0] * height + cell[1]) * width + cell[2]] }
    }

    /// The tile of a lane, along each axis.
    fn tile(&self, lane: usize) -> [usize; 3] {
        let [_, height, width] = self.axes.each_ref().map(Axis::tiles);
        [lane / width / height, lane / width % height, lane % width]
    }

    /// The site of a cell in one of the tiles.
    fn site(&self, cell: [usize; 3], lane: usize) -> Site {
        let tile = self.tile(lane);
        let [frame, y, x] = std::array::from_fn(|k| {
            let axis: &Axis = &self.axes[k];
            axis.site(tile[k], axis.place(cell[k], 0))
        });
        Site { frame, y, x }
    }

    /// Place of a run's sample in one of the tiles, in a list of all samples.
    #[cfg(test)]
    pub(super) fn sample(&self, run: Run, lane: usize) -> usize {
        self.extent.site_index(self.site(run.cell, lane)) * self.extent.spp + run.sample
    }

    /// The vectors of a row of cells and its margins, so many sites after a run in time and y.
    #[inline(always)]
    pub(super) fn row(&self, sample: usize, run: Run, [dt, dy]: [i32; 2]) -> &[Cell] {
        let [time, y, x] = &self.axes;
        let row = self.row_at(sample, time.place(run.cell[0], dt), y.place(run.cell[1], dy));
        &self.values[row..row + x.stored() * self.planes()]
    }

    /// Where in its row a vector lies, so many sites after a run in x.
    #[inline(always)]
    pub(super) fn column(&self, run: Run, dx: i32) -> usize {
        self.axes[2].place(run.cell[2], dx) * self.planes()
    }

    #[inline(always)]
    fn row_at(&self, sample: usize, time: usize, y: usize) -> usize {
        let [times, ys, xs] = self.axes.each_ref().map(Axis::stored);
        ((sample * times + time) * ys + y) * xs * self.planes()
    }

    /// Copies a table in.
    pub(super) fn load(&mut self, points: &[f32]) {
        let Self { dims, extent: Extent { spp, .. }, .. } = *self;
        if self.values.is_empty() {
            let stored: usize = self.axes.iter().map(Axis::stored).product();
            self.values = vec![Cell([0.0; LANES]); spp * stored * self.planes()];
            if self.partial {
                let wanted = self.wanted.clone();
                self.fill(dims..dims + 1, |site, _| if wanted.site(site) { &[1.0] } else { &[0.0] });
            }
        }
        self.fill(0..dims, |site, sample| &points[(site * spp + sample) * dims..][..dims]);
    }

    /// Sets some of the vectors of all samples by site and sample.
    fn fill<'a>(&mut self, planes: Range<usize>, values: impl Fn(usize, usize) -> &'a [f32] + Sync) {
        let tiles: [[usize; 3]; LANES] = std::array::from_fn(|lane| self.tile(lane));
        let (stride, extent, axes) = (self.planes(), self.extent, &self.axes);
        let [times, ys, xs] = axes.each_ref().map(Axis::stored);
        let rows = self.values.par_chunks_exact_mut(xs * stride).enumerate().with_min_len(ROWS_PER_TASK);
        rows.for_each(|(row, cells)| {
            let (sample, time, y) = (row / ys / times, row / ys % times, row % ys);
            for (lane, tile) in tiles.iter().enumerate() {
                let line = axes[0].site(tile[0], time) * extent.height + axes[1].site(tile[1], y);
                let mut x = axes[2].site(tile[2], 0);
                for cell in cells.chunks_exact_mut(stride) {
                    let values = values(line * extent.width + x, sample);
                    cell[planes.clone()].iter_mut().zip(values).for_each(|(to, from)| to.0[lane] = *from);
                    x = if x + 1 == extent.width { 0 } else { x + 1 };
                }
            }
        });
    }

    pub(super) fn frames(&self) -> usize {
        self.extent.frames
    }

    /// Rows of cells, of all samples.
    pub(super) fn cell_rows(&self) -> Range<usize> {
        0..self.runs() / self.axes[2].cells()
    }

    /// The first cell of a row.
    fn row_start(&self, row: usize) -> Run {
        let [times, height, _] = self.axes.each_ref().map(Axis::cells);
        self.run_at(row / height / times, [row / height % times, row % height, 0])
    }

    /// Cells of a row, and their owners.
    #[inline(always)]
    pub(super) fn cells_of(&self, row: usize) -> impl Iterator<Item = (&[Cell], u16)> {
        let (width, run) = (self.axes[2].cells(), self.row_start(row));
        let cells = self.values[self.place(run.sample, run)..].chunks_exact(self.planes());
        let first = (row * width) % self.owners.len();
        cells.zip(self.owners[first..first + width].iter().copied())
    }

    /// The frames of a row of cells, by lane.
    pub(super) fn frames_of_row(&self, row: usize) -> [usize; LANES] {
        self.frames[self.axes[0].place(self.row_start(row).cell[0], 0)]
    }

    /// Visits all rows of cells, and renews their copies.
    pub(super) fn for_each_row(&mut self, visit: impl Fn(CellRow) + Sync) {
        let (dims, stride, frames) = (self.dims, self.planes(), &self.frames);
        let [times, ys, xs] = self.axes.each_ref().map(Axis::stored);
        let [own_times, own_ys, own_xs] = self.axes.each_ref().map(Axis::own_places);
        let rows = self.values.par_chunks_exact_mut(xs * stride).enumerate().with_min_len(ROWS_PER_TASK);
        rows.for_each(|(row, cells)| {
            let (time, y) = (row / ys % times, row % ys);
            if own_times.contains(&time) && own_ys.contains(&y) {
                let cells = &mut cells[own_xs.start * stride..own_xs.end * stride];
                visit(CellRow { frames: frames[time], dims, cells, stride });
            }
        });
        self.renew();
    }

    /// Brings all copies up to date.
    fn renew(&mut self) {
        let (dims, stride) = (self.dims, self.planes());
        let Self { axes, copies, values, .. } = self;
        let [time_axis, y_axis, x_axis] = &*axes;
        // Frames by themselves where none has a copy.
        let apart = time_axis.tiles() == 1 && time_axis.stored() == time_axis.cells();
        let times = if apart { 1 } else { time_axis.stored() };
        let (ys, xs) = (y_axis.stored(), x_axis.stored());
        let row_at = |time: usize, y: usize| (time * ys + y) * xs * stride;
        values.par_chunks_exact_mut(times * ys * xs * stride).enumerate().for_each(|(index, values)| {
            let cells = if apart { 0..1 } else { 0..time_axis.cells() };
            for time in cells {
                let of_time = if apart { &copies[0][index % time_axis.stored()] } else { &copies[0][time] };
                for (y, of_y) in copies[1].iter().enumerate() {
                    for (x, of_x) in copies[2].iter().enumerate() {
                        let time = if apart { 0 } else { time_axis.place(time, 0) };
                        let own = row_at(time, y_axis.place(y, 0)) + x_axis.place(x, 0) * stride;
                        for dim in 0..dims {
                            let Cell(moved) = values[own + dim];
                            let at = |time: usize, y: usize, x: usize| {
                                row_at(if apart { 0 } else { time }, y) + x * stride + dim
                            };
                            spread(values, [of_time, of_y, of_x], at, &moved);
                        }
                    }
                }
            }
        });
    }

    /// Copies the demanded samples out.
    pub(super) fn store(&self, points: &mut [f32]) {
        let Self { extent, dims, ref axes, .. } = *self;
        let stride = self.planes();
        let [_, tiles_y, tiles_x] = axes.each_ref().map(Axis::tiles);
        let rows = points.par_chunks_exact_mut(extent.width * extent.spp * dims).enumerate();
        rows.with_min_len(ROWS_PER_TASK).for_each(|(line, points)| {
            let owners = [axes[0].owner(line / extent.height), axes[1].owner(line % extent.height)];
            let [Some([tile_t, time]), Some([tile_y, y])] = owners else { return };
            for (x, points) in points.chunks_exact_mut(extent.spp * dims).enumerate() {
                let Some([tile_x, x]) = axes[2].owner(x) else { continue };
                let lane = (tile_t * tiles_y + tile_y) * tiles_x + tile_x;
                let run = self.run_at(0, [time, y, x]);
                if run.owners >> lane & 1 == 0 {
                    continue;
                }
                for (sample, point) in points.chunks_exact_mut(dims).enumerate() {
                    let from = &self.values[self.place(sample, run)..][..stride];
                    point.iter_mut().zip(from).for_each(|(to, from)| *to = from.0[lane]);
                }
            }
        });
    }

    /// Where the vectors of a run are stored.
    #[inline(always)]
    fn place(&self, sample: usize, run: Run) -> usize {
        let [time, y, _] = std::array::from_fn(|k| self.axes[k].place(run.cell[k], 0));
        self.row_at(sample, time, y) + self.column(run, 0)
    }

    /// Moves coordinate `dim` of a run's samples by `motion`, and their copies.
    #[inline(always)]
    pub(super) fn shift(&mut self, run: Run, dim: usize, motion: &Row, domain: Domain) {
        let own = self.place(run.sample, run) + dim;
        let mut moved = self.values[own].0;
        for lane in run.lanes() {
            moved[lane] = match domain {
                Domain::Interval => reflect(moved[lane] + motion[lane]),
                Domain::Torus => domain.admit(moved[lane] + motion[lane]),
            };
        }
        let [times, ys, xs] = self.axes.each_ref().map(Axis::stored);
        let stride = self.planes();
        let of = std::array::from_fn(|k| self.copies[k][run.cell[k]].as_slice());
        let at = |time, y, x| (((run.sample * times + time) * ys + y) * xs + x) * stride + dim;
        spread(&mut self.values, of, at, &moved);
    }
}

/// Writes a vector to all places where some tile stores its samples.
#[inline(always)]
fn spread(
    values: &mut [Cell],
    [times, ys, xs]: [&[Copies]; 3],
    at: impl Fn(usize, usize, usize) -> usize,
    moved: &Row,
) {
    for time in times {
        for y in ys {
            for x in xs {
                let Cell(copy) = &mut values[at(time.place, y.place, x.place)];
                for (lane, copy) in copy.iter_mut().enumerate() {
                    let from = usize::from(time.of[lane] + y.of[lane] + x.of[lane]);
                    if from < LANES {
                        *copy = moved[from];
                    }
                }
            }
        }
    }
}

/// Rows that are worth handing to a thread.
const ROWS_PER_TASK: usize = 16;

#[cfg(test)]
#[path = "tiles_tests.rs"]
mod tests;
