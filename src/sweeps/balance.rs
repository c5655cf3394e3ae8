//! The balance of the whole table and of its frames within sweeps: along lines in the plane, by cosines above
//! it, and coordinate by coordinate.

use std::f64::consts::PI;

use pulp::Arch;
use rayon::prelude::*;

use super::lines::{Line, LineBuffers};
use super::modes::{ModeBuffers, Modes};
use super::tiles::Tiles;
use crate::classes::Classes;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::random::GOLDEN_RATIO;
use crate::table::domain::BELOW_ONE;

/// Brings what the balanced terms of an objective hold closer to the uniform cube.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    parts: Vec<Part>,
    line_buffers: LineBuffers,
    mode_buffers: ModeBuffers,
    /// Turns per sweep, and lines of a part per turn.
    turns: usize,
    lines: u64,
}

/// One balanced term.
#[derive(Clone, Debug)]
struct Part {
    dims: Vec<usize>,
    /// Whether each frame is balanced by itself.
    per_frame: bool,
    /// Bins of a distribution function.
    bins: usize,
    /// Above two dimensions, where a line says little.
    modes: Option<Modes>,
}

/// Turns per sweep, and lines of a part per turn, from so many samples on. What a line leaves falls less with
/// their number than the noise of as many random samples does: 512×512 after 60 sweeps has a bias of 1.7 with
/// one line a sweep, and of 0.13 with four.
const EFFORT: [(usize, (usize, u64)); 4] =
    [(1 << 18, (2, 4)), (1 << 16, (2, 2)), (1 << 14, (1, 2)), (0, (1, 1))];

impl Balance {
    pub(super) fn new(objective: &Objective) -> Self {
        let terms = objective.terms.iter().filter(|term| objective.is_balanced_in_sweeps(term));
        let samples = objective.extent.samples();
        let part = |term: &PlannedTerm| {
            let (dims, per_frame) = (term.spec.dims.clone(), term.spec.classes == Classes::PerFrame);
            let held = if per_frame { samples / objective.extent.frames } else { samples };
            let bins = (held / SAMPLES_PER_BIN).clamp(FEWEST_BINS, MOST_BINS);
            Part { modes: (dims.len() > 2).then(|| Modes::new(&dims)), dims, per_frame, bins }
        };
        let mut parts: Vec<Part> = terms.map(part).collect();
        // What comes later stays as it is: frames give way to the whole, and all to single coordinates.
        parts.sort_by(|a, b| {
            (!a.per_frame, b.dims.len(), &a.dims).cmp(&(!b.per_frame, a.dims.len(), &b.dims))
        });
        parts.dedup_by(|a, b| (&a.dims, a.per_frame) == (&b.dims, b.per_frame));
        let effort = EFFORT.iter().find(|&&(least, _)| samples >= least);
        let (turns, lines) = effort.map_or((1, 1), |&(_, effort)| effort);
        let (line_buffers, mode_buffers) = (LineBuffers::default(), ModeBuffers::default());
        Self { parts, line_buffers, mode_buffers, turns, lines }
    }

    /// Bytes of the buffers that it has worked in.
    pub(super) fn bytes(&self) -> usize {
        self.line_buffers.bytes() + self.mode_buffers.bytes()
    }

    /// Turns per sweep.
    pub(super) fn turns(&self) -> usize {
        self.turns
    }

    /// Brings every part `share` of the way, as the `turn` has it.
    pub(super) fn advance(&mut self, arch: Arch, tiles: &mut Tiles, turn: u64, share: f64) {
        let Self { parts, line_buffers, mode_buffers, lines, .. } = self;
        for part in parts.iter() {
            match (&part.modes, part.dims.as_slice()) {
                (Some(modes), _) => modes.advance(arch, tiles, mode_buffers, part.per_frame, share),
                (None, [_, _]) => {
                    for line in 0..*lines {
                        let angle = PI * ((turn * *lines + line) as f64 * GOLDEN_RATIO).fract();
                        let line = Line::new(&part.dims, &[angle.cos(), angle.sin()], part.bins);
                        line.advance(arch, tiles, line_buffers, part.per_frame, share);
                    }
                }
                _ => {
                    let line = Line::new(&part.dims, &[1.0], part.bins);
                    line.advance(arch, tiles, line_buffers, part.per_frame, share);
                }
            }
        }
    }

    /// Brings coordinates of which a single one is balanced over the whole table `share` of the way to
    /// `(rank + ½) / n`: all the way their marginals are exact up to the faces, and no value is 0. `samples`
    /// are those that are demanded.
    pub(super) fn settle(&self, points: &mut [f32], dims: usize, samples: &[u32], share: f64) {
        let mut ranks: Vec<(f32, u32)> = Vec::with_capacity(samples.len());
        for part in self.parts.iter().filter(|part| part.dims.len() == 1 && !part.per_frame) {
            let dim = part.dims[0];
            ranks.clear();
            ranks.extend(samples.iter().map(|&sample| (points[sample as usize * dims + dim], sample)));
            ranks.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let cell = 1.0 / ranks.len() as f64;
            for (rank, &(value, sample)) in ranks.iter().enumerate() {
                let value = f64::from(value);
                let settled = value + share * ((rank as f64 + 0.5) * cell - value);
                points[sample as usize * dims + dim] = (settled as f32).clamp(0.0, BELOW_ONE);
            }
        }
    }
}

/// A distribution function is as fine as samples tell it,
const SAMPLES_PER_BIN: usize = 8;
const FEWEST_BINS: usize = 4;
/// and as the samples of a bin are still moved alike.
const MOST_BINS: usize = 1024;

#[cfg(test)]
#[path = "balance_tests.rs"]
mod tests;
