//! One step's slices, in parallel, summed in a fixed order.
//!
//! The subsets of a step are cut into chunks of fixed size; workers transport them into buffers of their own. Then each
//! worker adds up the displacements of its part of the table, chunk after chunk in the order of the draws, so that no
//! result depends on how many threads there are. Buffers are reused from step to step.

use std::sync::{Mutex, PoisonError};

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::bank::Boundary;
use crate::direction::Directions;
use crate::draw::{Draw, Order, Pick};
use crate::lanes::{self, Gather, LaneBuffers};
use crate::law::{FromAtlas, LaneLaw, Tabulated, Trapezoid};
use crate::long::{self, LongBuffers, LongLaw, LongShape};
use crate::network::Network;
use crate::objective::Objective;
use crate::plan::PlannedTerm;
use crate::pull::Pull;
use crate::term::Role;

/// Subsets per chunk: large enough to pay for handing it to a thread.
const CHUNK: usize = 16;
/// Chunks in flight: bounds the memory of a large step.
const IN_FLIGHT: usize = 128;
/// A step of few subsets is still shared between threads.
const FEWEST_CHUNKS: usize = 8;
/// Samples that the subsets of a chunk should not exceed in the mean, unless a single one does.
const CHUNK_TOUCHES: usize = 1 << 13;

/// Buffers, and the order of visits.
pub(crate) struct Engine {
    arch: Arch,
    orders: Vec<Order>,
    draws: Vec<Draw>,
    chunks: Vec<Chunk>,
    /// What workers need while they transport; as many as there are workers.
    scratch: Mutex<Vec<Scratch>>,
    /// The same for the largest subsets, which come one after the other and share their sorts between threads: a few
    /// times the table, but once.
    large: Scratch,
}

#[derive(Default)]
struct Scratch {
    directions: Directions,
    cut: Vec<Option<f32>>,
    subset: Vec<u32>,
    weights: Vec<f64>,
    /// Quantile cells of a subset whose size is not planned.
    grid: Vec<Boundary>,
    lanes: LaneBuffers,
    long: LongBuffers,
}

/// What the subsets of a chunk pull, in the order of the draws.
#[derive(Default)]
struct Chunk {
    samples: Vec<u32>,
    /// First and last of them.
    span: (u32, u32),
    moves: Vec<f32>,
    /// Masses of the samples of weighted terms.
    masses: Vec<f32>,
    slices: u64,
    squares: f64,
    mass: f64,
    ends: Vec<usize>,
}

impl Engine {
    pub(crate) fn new() -> Self {
        Self {
            arch: Arch::new(),
            orders: Vec::new(),
            draws: Vec::new(),
            chunks: Vec::new(),
            scratch: Mutex::default(),
            large: Scratch::default(),
        }
    }

    /// Transports the slices that are drawn in a step from `points` and adds what they pull to `pull`,
    /// which has one entry per coordinate.
    pub(crate) fn pull(
        &mut self,
        objective: &Objective,
        (seed, step, pick): (u64, u64, Pick),
        points: &[f32],
        pull: &mut Pull,
    ) {
        let Self { arch, orders, draws, chunks, scratch, large } = self;
        let scratch = &*scratch;
        objective.draw_subsets(seed, step, pick, orders, draws);
        (pull.slices, pull.squares, pull.mass) = (0, 0.0, 0.0);
        let is_large =
            |draw: &Draw| objective.terms[draw.term as usize].family.mean_size() >= long::SHARED as f64;
        for draw in draws.iter().filter(|draw| is_large(draw)) {
            chunks.resize_with(chunks.len().max(1), Chunk::default);
            let (draws, chunk) = (std::slice::from_ref(draw), &mut chunks[0]);
            arch.dispatch(Transport { objective, seed, step, points, draws, chunk, scratch: large });
            add_up(objective, std::slice::from_ref(chunk), draws, 1, pull);
            // The list of all samples stays one.
            std::mem::swap(&mut chunk.samples, &mut large.subset);
        }
        draws.retain(|draw| !is_large(draw));
        // Chunks of neighbours read and move the same part of the table.
        draws.sort_unstable_by_key(|draw| (draw.term, draw.member, draw.name));
        // Fewer large subsets at a time, so that memory is bounded by samples and not by slices times samples.
        let sizes = objective
            .terms
            .iter()
            .filter(|term| term.spec.role == pick.role())
            .map(|term| term.family.mean_size());
        let largest = sizes.fold(1.0, f64::max) as usize;
        let per_chunk =
            (CHUNK_TOUCHES / largest).clamp(1, CHUNK).min(draws.len().div_ceil(FEWEST_CHUNKS).max(1));
        let in_flight = (CHUNK_TOUCHES * IN_FLIGHT / (largest * per_chunk)).clamp(2, IN_FLIGHT);
        for draws in draws.chunks(per_chunk * in_flight) {
            let used = draws.len().div_ceil(per_chunk);
            chunks.resize_with(chunks.len().max(used), Chunk::default);
            let chunks = &mut chunks[..used];
            chunks.par_iter_mut().zip(draws.par_chunks(per_chunk)).for_each(|(chunk, draws)| {
                let pooled = scratch.lock().unwrap_or_else(PoisonError::into_inner).pop();
                let mut mine = pooled.unwrap_or_default();
                arch.dispatch(Transport { objective, seed, step, points, draws, chunk, scratch: &mut mine });
                scratch.lock().unwrap_or_else(PoisonError::into_inner).push(mine);
            });
            add_up(objective, chunks, draws, per_chunk, pull);
        }
    }
}

/// The work of one chunk, compiled once per instruction set.
struct Transport<'a> {
    objective: &'a Objective,
    seed: u64,
    step: u64,
    points: &'a [f32],
    draws: &'a [Draw],
    chunk: &'a mut Chunk,
    scratch: &'a mut Scratch,
}

impl WithSimd for Transport<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { objective, seed, step, points, draws, chunk, scratch } = self;
        chunk.samples.clear();
        chunk.moves.clear();
        chunk.masses.clear();
        chunk.ends.clear();
        (chunk.slices, chunk.squares, chunk.mass) = (0, 0.0, 0.0);
        for draw in draws {
            let term = &objective.terms[draw.term as usize];
            objective.draw_directions(seed, step, draw, &mut scratch.directions, &mut scratch.cut);
            term.family.select(draw.member as usize, draw.level, &mut scratch.subset);
            term.family.weigh(draw.member as usize, &mut scratch.weights);
            chunk.transport(simd, objective, term, points, scratch);
            if chunk.samples.is_empty() {
                std::mem::swap(&mut chunk.samples, &mut scratch.subset);
            } else {
                chunk.samples.extend_from_slice(&scratch.subset);
            }
            chunk.ends.push(chunk.samples.len());
        }
        let samples = chunk.samples.iter();
        chunk.span =
            samples.fold((u32::MAX, 0), |(first, last), &sample| (first.min(sample), last.max(sample)));
    }
}

impl Chunk {
    /// Transports the selected subset along its directions and appends the moves.
    #[inline(always)]
    fn transport<S: Simd>(
        &mut self,
        simd: S,
        objective: &Objective,
        term: &PlannedTerm,
        points: &[f32],
        scratch: &mut Scratch,
    ) {
        let Scratch { directions, cut, subset, weights, grid, lanes, long } = scratch;
        let (n, dims) = (subset.len(), &term.spec.dims);
        let first = self.moves.len();
        self.moves.resize(first + n * dims.len(), 0.0);
        let moves = &mut self.moves[first..];
        let gather = Gather { samples: subset, points, stride: objective.dims, dims, cut };
        let Directions { count, theta, block, laws, on_axis, .. } = &*directions;
        let atlas = term.slicer.atlas();
        let block = term.slicer.bank().map(|bank| bank.block(*block));
        self.slices += *count as u64;
        let weights = term.family.is_weighted().then_some(weights.as_slice());
        self.mass += *count as f64 * weights.map_or(n as f64, |weights| weights.iter().sum());
        self.masses.extend(weights.into_iter().flatten().map(|&weight| weight as f32));
        if n == 0 {
            return; // none of the class's samples at this level is demanded
        }
        if n <= term.longest {
            let law = match (atlas, block) {
                (Some(atlas), _) => LaneLaw::Atlas(FromAtlas::new(directions, atlas)),
                (None, None) => LaneLaw::Trapezoid(Trapezoid::new(simd, directions)),
                (None, Some(block)) => {
                    let planned = term.grids.get(&n);
                    if planned.is_none() {
                        grid.clear();
                        grid.extend(Boundary::grid(n));
                    }
                    LaneLaw::Tabulated(Tabulated::new(directions, block, planned.unwrap_or(grid)))
                }
            };
            let network = &term.networks[Network::blocks(n)];
            let squares = lanes::transport(simd, &gather, theta, &law, network, lanes, moves);
            self.squares += f64::from(squares);
            return;
        }
        for lane in 0..*count {
            let component = |dim: usize| theta[dim][lane];
            let components = || theta.iter().map(|row| f64::from(row[lane]));
            let lowest = components().map(|component| component.min(0.0)).sum();
            let extent = components().map(f64::abs).sum();
            let shape = match (atlas, block) {
                (Some(atlas), _) => LongShape::Pieces(atlas.law(laws[lane] as usize)),
                (None, Some(block)) if !on_axis[lane] => LongShape::Tabulated { block, lane },
                // A coordinate axis has the law of one dimension; otherwise there are at most two.
                _ => {
                    let longer = components().map(f64::abs).fold(0.0, f64::max);
                    LongShape::Trapezoid { longer, shorter: extent - longer }
                }
            };
            let law = LongLaw { lowest, extent, shape };
            self.squares += long::transport(&gather, component, &law, weights, long, moves);
        }
    }

    /// Adds the moves to those samples that they belong to whose coordinates `part` holds.
    fn add_to(&self, objective: &Objective, draws: &[Draw], part: &mut Part) {
        let mut begin = 0;
        let mut moves = self.moves.as_slice();
        let mut masses = self.masses.iter();
        for (draw, &end) in draws.iter().zip(&self.ends) {
            let term = &objective.terms[draw.term as usize];
            let dims = &term.spec.dims;
            let count = term.slicer.per_subset() as f32;
            // E[theta thetaᵀ] = I / d makes d the natural step of a mean over directions; a projection goes as far as
            // its target along each.
            let factor = match term.spec.role {
                Role::Descend => dims.len() as f32,
                Role::Balance => 1.0,
            };
            // 1 where the number of slices says all.
            let emphasis = objective.emphasis(draw.term as usize, draw.member as usize) as f32;
            let (factor, count) = (factor * emphasis, count * emphasis);
            let (these, rest) = moves.split_at((end - begin) * dims.len());
            let samples = &self.samples[begin..end];
            let weighted = term.family.is_weighted();
            if let (&[x, y], false) = (dims.as_slice(), weighted) {
                // The common case by itself, without a loop over two dimensions.
                let (factor_x, factor_y) = (factor * term.stretch[0], factor * term.stretch[1]);
                for (&sample, [along_x, along_y]) in samples.iter().zip(these.as_chunks::<2>().0) {
                    let Some((sums, hits)) = part.sample(sample, objective.dims) else { continue };
                    sums[x] += factor_x * along_x;
                    sums[y] += factor_y * along_y;
                    hits[x] += count;
                    hits[y] += count;
                }
            } else {
                for (&sample, along) in samples.iter().zip(these.chunks_exact(dims.len())) {
                    let mass = if weighted { masses.next().copied().unwrap_or(0.0) } else { 1.0 };
                    let Some((sums, hits)) = part.sample(sample, objective.dims) else { continue };
                    for ((&dim, along), stretch) in dims.iter().zip(along).zip(&term.stretch) {
                        sums[dim] += factor * stretch * along;
                        hits[dim] += count * mass;
                    }
                }
            }
            moves = rest;
            begin = end;
        }
    }
}

/// Coordinates of consecutive samples, with what pulls them.
struct Part<'a> {
    /// The first of the samples.
    first: usize,
    sums: &'a mut [f32],
    hits: &'a mut [f32],
}

impl Part<'_> {
    /// Sums and hits of a sample, if it is one of the part's.
    #[inline(always)]
    fn sample(&mut self, sample: u32, dims: usize) -> Option<(&mut [f32], &mut [f32])> {
        // A sample before the first becomes a large number.
        let first = (sample as usize).wrapping_sub(self.first).wrapping_mul(dims);
        let last = first.wrapping_add(dims);
        Some((self.sums.get_mut(first..last)?, self.hits.get_mut(first..last)?))
    }
}

/// Samples whose moves are worth sharing between threads.
const SHARED_MOVES: usize = 1 << 11;

/// Adds the moves of all chunks. Each thread has a part of the table and looks for its samples in all of them, so that
/// every sample is added to in the order of the draws, whatever the number of parts.
fn add_up(objective: &Objective, chunks: &[Chunk], draws: &[Draw], per_chunk: usize, pull: &mut Pull) {
    for chunk in chunks {
        pull.slices += chunk.slices;
        pull.squares += chunk.squares;
        pull.mass += chunk.mass;
    }
    let samples = pull.sums.len() / objective.dims;
    let moved: usize = chunks.iter().map(|chunk| chunk.samples.len()).sum();
    let parts = if moved < SHARED_MOVES { 1 } else { rayon::current_num_threads() };
    let per_part = samples.div_ceil(parts);
    let add = |(index, (sums, hits)): (usize, (&mut [f32], &mut [f32]))| {
        let mut part = Part { first: index * per_part, sums, hits };
        let samples = part.first..part.first + per_part;
        for (chunk, draws) in chunks.iter().zip(draws.chunks(per_chunk)) {
            let (first, last) = chunk.span;
            if (first as usize) < samples.end && samples.start <= last as usize {
                chunk.add_to(objective, draws, &mut part);
            }
        }
    };
    if parts == 1 {
        return add((0, (&mut pull.sums, &mut pull.hits)));
    }
    let coordinates = per_part * objective.dims;
    let parts = pull.sums.par_chunks_mut(coordinates).zip(pull.hits.par_chunks_mut(coordinates));
    parts.enumerate().for_each(add);
}

#[cfg(test)]
mod dispatch;
#[cfg(test)]
mod stress;
