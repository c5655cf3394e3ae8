//! The balance of the whole table and of its frames, without slices: by its cosines and by its marginals.

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::lines::Line;
use super::modes::{Modes, Waves};
use super::tiles::Tiles;
use crate::classes::Classes;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::simd::{LANES, Row};
use crate::table::domain::Domain;

/// Brings what the balanced terms of an objective hold closer to the uniform cube.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    parts: Vec<Part>,
    /// Dimensions whose marginals are brought in order.
    lines: Vec<usize>,
    bins: usize,
}

/// One balanced term.
#[derive(Clone, Debug)]
struct Part {
    dims: Vec<usize>,
    modes: Modes,
    /// Whether each frame is balanced by itself.
    per_frame: bool,
}

impl Balance {
    pub(super) fn new(objective: &Objective) -> Self {
        let terms = || objective.terms.iter().filter(|term| objective.is_balanced_in_sweeps(term));
        let is_line = |term: &&PlannedTerm| term.spec.dims.len() == 1 && term.spec.classes == Classes::WholeTable;
        let parts = terms().filter(|term| !is_line(term)).map(|term| Part {
            modes: Modes::new(&term.spec.dims),
            dims: term.spec.dims.clone(),
            per_frame: term.spec.classes == Classes::PerFrame,
        });
        let mut parts: Vec<Part> = parts.collect();
        // What holds more comes later: it is what remains exact.
        parts.sort_by_key(|part| !part.per_frame);
        let lines = terms().filter(is_line).map(|term| term.spec.dims[0]).collect();
        let bins = (objective.extent.samples() / 8).clamp(4, 1024);
        Self { parts, lines, bins }
    }

    pub(super) fn advance(&self, arch: Arch, tiles: &mut Tiles, turn: u64, share: f64) {
        let env = |k: &str, d: usize| std::env::var(k).map_or(d, |v| v.parse().unwrap());
        for part in &self.parts {
            if part.dims.len() == 2 && env("DIRS", 1) > 0 {
                for i in 0..env("DIRS", 1) as u64 {
                    let angle = std::f64::consts::PI * ((turn * env("DIRS", 1) as u64 + i) as f64 * 0.618_033_988_749_894_8).fract();
                    let direction = [angle.cos(), angle.sin()];
                    Line::new(&part.dims, &direction, self.bins).advance(arch, tiles, part.per_frame, share as f32);
                }
            }
            else if env("MODES", 1) > 0 { part.advance(arch, tiles, share as f32); }
        }
        if env("LINES", 1) > 0 {
            for &dim in &self.lines {
                Line::new(&[dim], &[1.0], self.bins).advance(arch, tiles, false, share as f32);
            }
        }
    }
}

const ROWS_PER_TASK: usize = 16;

impl Part {
    fn advance(&self, arch: Arch, tiles: &mut Tiles, share: f32) {
        let frames = if self.per_frame { tiles.frames() } else { 1 };
        let len = self.modes.len();
        let rows = tiles.cell_rows();
        let sums: Vec<(usize, Vec<Row>)> = rows
            .into_par_iter()
            .map(|row| (row, arch.dispatch(Sum { tiles, modes: &self.modes, row })))
            .collect();
        let mut means = vec![[0.0_f64; 2]; frames * (len + 1)];
        for (row, sums) in sums {
            for lane in 0..LANES {
                let frame = if self.per_frame { tiles.frame_of_row(row, lane) } else { 0 };
                for (mean, sum) in means[frame * (len + 1)..].iter_mut().zip(&sums) {
                    mean[0] += f64::from(sum[lane]);
                }
            }
        }
        let means: Vec<f32> = means
            .chunks_exact(len + 1)
            .flat_map(|frame| {
                let count = frame[len][0].max(1.0);
                frame[..len].iter().map(move |mean| share * (mean[0] / count) as f32)
            })
            .collect();
        let dims = tiles.dims();
        let (modes, per_frame) = (&self.modes, self.per_frame);
        let frames = tiles.frames_by_time();
        let rows: Vec<Vec<Row>> = frames
            .iter()
            .map(|lanes| {
                (0..len)
                    .map(|mode| lanes.map(|frame| means[if per_frame { frame * len } else { 0 } + mode]))
                    .collect()
            })
            .collect();
        tiles.for_each_stored_row(|time, cells, stride| {
            arch.dispatch(Move { modes, means: &rows[time], cells, stride, dims });
        });
    }
}

struct Sum<'a> {
    tiles: &'a Tiles,
    modes: &'a Modes,
    row: usize,
}

impl NullaryFnOnce for Sum<'_> {
    type Output = Vec<Row>;

    #[inline(always)]
    fn call(self) -> Vec<Row> {
        let mut sums = vec![[0.0; LANES]; self.modes.len() + 1];
        let mut waves = Waves::default();
        for (cell, owners) in self.tiles.cells_of(self.row) {
            let mut counts = [0.0; LANES];
            for lane in 0..LANES {
                counts[lane] = f32::from(owners >> lane & 1);
            }
            let (last, sums) = sums.split_last_mut().expect("it has one more");
            self.modes.add(|dim| cell[dim].0, &counts, &mut waves, sums);
            for lane in 0..LANES {
                last[lane] += counts[lane];
            }
        }
        sums
    }
}

struct Move<'a> {
    modes: &'a Modes,
    means: &'a [Row],
    cells: &'a mut [super::tiles::Cell],
    stride: usize,
    dims: usize,
}

impl NullaryFnOnce for Move<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut waves = Waves::default();
        let mut motions = vec![[0.0; LANES]; self.stride];
        for cell in self.cells.chunks_exact_mut(self.stride) {
            motions.fill([0.0; LANES]);
            self.modes.silence(|dim| cell[dim].0, self.means, &mut waves, &mut motions);
            for (cell, motion) in cell.iter_mut().zip(&motions).take(self.dims) {
                for lane in 0..LANES {
                    cell.0[lane] = (cell.0[lane] + motion[lane]).max(0.0).min(crate::table::domain::BELOW_ONE);
                }
            }
        }
    }
}
