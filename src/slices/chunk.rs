//! The subsets that one worker transports together, and what they pull.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::draw::SubsetDraw;
use crate::directions::Directions;
use crate::directions::cube_bank::Boundary;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::simd::LANES;
use crate::table::extent::bytes_of;
use crate::transport::abreast::{self, AbreastBuffers, LaneSubset};
use crate::transport::cells::LaneLaws;
use crate::transport::gather::{Gather, SubsetSamples};
use crate::transport::lanes::{self, LaneBuffers};
use crate::transport::line::{self, LineBuffers, LineLaw};
use crate::transport::network::Network;

/// What a worker needs while it transports.
#[derive(Default)]
pub(super) struct Scratch {
    directions: Directions,
    cut: Vec<Option<f32>>,
    subset: Vec<u32>,
    weights: Vec<f64>,
    /// Quantile cells of a subset whose size is not planned.
    grid: Vec<Boundary>,
    lanes: LaneBuffers,
    line: LineBuffers,
    waiting: Vec<Waiting>,
    abreast: AbreastBuffers,
}

/// A subset that waits for others to be transported with.
#[derive(Clone, Copy)]
struct Waiting {
    len: usize,
    /// Its place among the samples and the moves of its chunk.
    samples: usize,
    moves: usize,
    cut: Option<f32>,
}

/// What the subsets of a chunk pull, in the order of the draws.
#[derive(Default)]
pub(super) struct Chunk {
    /// Which draws of the step they are, by their order.
    pub draws: Range<usize>,
    /// Samples that the subsets hold, over all of them.
    pub touches: usize,
    /// Slices transported, the sum of their `mass · displacement²` and that of `mass`.
    pub slices: u64,
    pub squares: f64,
    pub mass: f64,
    pub(super) subsets: Vec<Subset>,
    /// First and last sample.
    pub(super) span: (u32, u32),
    /// Samples of the subsets that are not runs.
    pub(super) samples: Vec<u32>,
    /// Per sample of a subset and dimension of its group, the sum of `mass · displacement · theta`; of a
    /// subset with a single direction `mass · displacement`, per sample.
    pub(super) moves: Vec<f32>,
    /// The direction of each subset that has but one.
    pub(super) thetas: Vec<f32>,
    /// Masses of the samples of weighted terms.
    pub(super) masses: Vec<f32>,
}

/// A subset of a chunk.
#[derive(Clone, Copy)]
pub(super) struct Subset {
    pub(super) len: usize,
    /// The first of consecutive samples; others are listed.
    pub(super) run: Option<u32>,
    /// Whether it has a single direction.
    pub(super) single: bool,
}

/// The work of one chunk, compiled once per instruction set.
pub(super) struct Transport<'a, Draws: Iterator<Item = &'a SubsetDraw>> {
    pub objective: &'a Objective,
    pub seed: u64,
    pub step: u64,
    pub points: &'a [f32],
    pub draws: Draws,
    pub chunk: &'a mut Chunk,
    pub scratch: &'a mut Scratch,
}

impl<'a, Draws: Iterator<Item = &'a SubsetDraw>> WithSimd for Transport<'a, Draws> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { objective, seed, step, points, draws, chunk, scratch } = self;
        chunk.clear();
        let mut before = None;
        for draw in draws {
            let term = &objective.terms[draw.term as usize];
            if let Some(before) = before.replace(term)
                && !std::ptr::eq(before, term)
            {
                chunk.transport_abreast(simd, before, points, objective.dims, scratch);
            }
            objective.draw_directions(seed, step, draw, &mut scratch.directions, &mut scratch.cut);
            // A long run needs no list.
            let run = term.family.run(draw.member as usize).filter(|run| run.len() > term.longest);
            if run.is_none() {
                term.family.select(draw.member as usize, draw.level, &mut scratch.subset);
                term.family.weigh(draw.member as usize, &mut scratch.weights);
            }
            chunk.transport(simd, objective, term, run, points, scratch);
        }
        if let Some(term) = before {
            chunk.transport_abreast(simd, term, points, objective.dims, scratch);
        }
    }
}

impl Scratch {
    /// Bytes that grow with the largest subset.
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.subset) + bytes_of(&self.weights) + bytes_of(&self.grid) + self.line.bytes()
    }
}

impl Chunk {
    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        let floats = bytes_of(&self.moves) + bytes_of(&self.thetas) + bytes_of(&self.masses);
        bytes_of(&self.subsets) + bytes_of(&self.samples) + floats
    }

    fn clear(&mut self) {
        self.subsets.clear();
        self.samples.clear();
        self.moves.clear();
        self.thetas.clear();
        self.masses.clear();
        (self.touches, self.slices, self.squares, self.mass) = (0, 0, 0.0, 0.0);
        self.span = (u32::MAX, 0);
    }

    /// Gives the list of samples back, so that there is one where a chunk holds a single subset at a time.
    pub(super) fn give_back(&mut self, scratch: &mut Scratch) {
        std::mem::swap(&mut self.samples, &mut scratch.subset);
    }

    /// Transports a subset, the run or else the selected one, along its directions and appends the moves.
    #[inline(always)]
    fn transport<S: Simd>(
        &mut self,
        simd: S,
        objective: &Objective,
        term: &PlannedTerm,
        run: Option<Range<u32>>,
        points: &[f32],
        scratch: &mut Scratch,
    ) {
        let Scratch { directions, cut, subset, weights, grid, lanes, line, waiting, .. } = scratch;
        let samples = run.clone().map_or(SubsetSamples::List(subset), SubsetSamples::Run);
        let (n, dims) = (samples.len(), &term.spec.dims);
        let directions = &*directions;
        let Directions { count, theta, .. } = directions;
        let in_lanes = n <= term.longest;
        let single = !in_lanes && *count == 1;
        let first = self.moves.len();
        self.moves.resize(first + n * if single { 1 } else { dims.len() }, 0.0);
        let moves = &mut self.moves[first..];
        let gather = Gather { samples, points, stride: objective.dims, dims, cut };
        let laws = term.slicer.laws(directions);
        let weights = term.family.is_weighted().then_some(weights.as_slice());
        self.slices += *count as u64;
        self.mass += *count as f64 * weights.map_or(n as f64, |weights| weights.iter().sum());
        self.masses.extend(weights.into_iter().flatten().map(|&weight| weight as f32));
        if single {
            self.thetas.extend(theta.iter().map(|row| row[0]));
        }
        if n == 0 {
            // None of the class's samples at this level is demanded.
        } else if in_lanes && term.abreast {
            waiting.push(Waiting { len: n, samples: self.samples.len(), moves: first, cut: cut[0] });
        } else if in_lanes {
            let laws = LaneLaws::new(simd, directions, laws, || term.grid(n, grid));
            let network = &term.networks[Network::blocks(n)];
            let squares = lanes::transport(simd, &gather, theta, &laws, network, lanes, moves);
            self.squares += f64::from(squares);
        } else {
            for lane in 0..directions.count {
                let component = |dim: usize| directions.theta[dim][lane];
                let law = LineLaw::new(directions, laws, lane);
                self.squares += if single {
                    let put = |position: usize, moved| moves[position] = moved;
                    line::transport(&gather, component, &law, weights, line, put)
                } else {
                    let put = |position: usize, moved| {
                        let along = &mut moves[position * dims.len()..][..dims.len()];
                        along
                            .iter_mut()
                            .enumerate()
                            .for_each(|(dim, along)| *along += moved * component(dim));
                    };
                    line::transport(&gather, component, &law, weights, line, put)
                };
            }
        }
        self.append(Subset { len: n, run: run.map(|run| run.start), single }, subset);
    }

    /// Transports the subsets of a term that wait, those of like size together.
    #[inline(always)]
    fn transport_abreast<S: Simd>(
        &mut self,
        simd: S,
        term: &PlannedTerm,
        points: &[f32],
        dims: usize,
        scratch: &mut Scratch,
    ) {
        let Scratch { waiting, abreast, .. } = scratch;
        let Self { samples, moves, squares, .. } = self;
        waiting.sort_unstable_by_key(|subset| (subset.len, subset.moves));
        for group in waiting.chunks(LANES) {
            let mut subsets = [LaneSubset { samples: &[], cut: None }; LANES];
            for (lane, &Waiting { len, samples: first, cut, .. }) in subsets.iter_mut().zip(group) {
                *lane = LaneSubset { samples: &samples[first..first + len], cut };
            }
            let (subsets, table) = (&subsets[..group.len()], (points, dims, term.spec.dims[0]));
            let put = |lane: usize, position, moved| moves[group[lane].moves + position] = moved;
            *squares += abreast::transport(simd, subsets, table, &term.networks, abreast, put);
        }
        waiting.clear();
    }

    fn append(&mut self, subset: Subset, list: &mut Vec<u32>) {
        self.subsets.push(subset);
        self.touches += subset.len;
        let (first, last) = match subset.run {
            Some(first) => (first, first + subset.len as u32 - 1),
            None => list
                .iter()
                .fold((u32::MAX, 0), |(first, last), &sample| (first.min(sample), last.max(sample))),
        };
        self.span = (self.span.0.min(first), self.span.1.max(last));
        match subset.run {
            Some(_) => {}
            None if self.samples.is_empty() => std::mem::swap(&mut self.samples, list),
            None => self.samples.extend_from_slice(list),
        }
    }
}
