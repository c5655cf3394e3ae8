//! The subsets that one worker transports together, and what they pull.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::config::term::Role;
use crate::directions::Directions;
use crate::directions::cube_bank::Boundary;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::slices::draw::Draw;
use crate::slices::part::Part;
use crate::transport::cells::{FromAtlas, LaneLaw, Tabulated, Trapezoid};
use crate::transport::lanes::{self, Gather, LaneBuffers, Samples};
use crate::transport::line::{self, LongBuffers, LongLaw, LongShape};
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
    long: LongBuffers,
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
    subsets: Vec<Subset>,
    /// First and last sample.
    span: (u32, u32),
    /// Samples of the subsets that are not runs.
    pub(super) samples: Vec<u32>,
    /// Per sample of a subset and dimension of its group, the sum of `mass · displacement · theta`; of a subset with a single
    /// direction `mass · displacement`, per sample.
    pub(super) moves: Vec<f32>,
    /// The direction of each subset that has but one.
    thetas: Vec<f32>,
    /// Masses of the samples of weighted terms.
    masses: Vec<f32>,
}

/// A subset of a chunk.
#[derive(Clone, Copy)]
struct Subset {
    len: usize,
    /// The first of consecutive samples; others are listed.
    run: Option<u32>,
    /// Whether it has a single direction.
    single: bool,
}

/// The work of one chunk, compiled once per instruction set.
pub(super) struct Transport<'a, Draws: Iterator<Item = &'a Draw>> {
    pub objective: &'a Objective,
    pub seed: u64,
    pub step: u64,
    pub points: &'a [f32],
    pub draws: Draws,
    pub chunk: &'a mut Chunk,
    pub scratch: &'a mut Scratch,
}

impl<'a, Draws: Iterator<Item = &'a Draw>> WithSimd for Transport<'a, Draws> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { objective, seed, step, points, draws, chunk, scratch } = self;
        chunk.clear();
        for draw in draws {
            let term = &objective.terms[draw.term as usize];
            objective.draw_directions(seed, step, draw, &mut scratch.directions, &mut scratch.cut);
            // A long run needs no list.
            let run = term.family.run(draw.member as usize).filter(|run| run.len() > term.longest);
            if run.is_none() {
                term.family.select(draw.member as usize, draw.level, &mut scratch.subset);
                term.family.weigh(draw.member as usize, &mut scratch.weights);
            }
            chunk.transport(simd, objective, term, run, points, scratch);
        }
    }
}

impl Chunk {
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
        let Scratch { directions, cut, subset, weights, grid, lanes, long } = scratch;
        let samples = run.clone().map_or(Samples::List(subset), Samples::Run);
        let (n, dims) = (samples.len(), &term.spec.dims);
        let Directions { count, theta, block, laws, on_axis, .. } = &*directions;
        let in_lanes = n <= term.longest;
        let single = !in_lanes && *count == 1;
        let first = self.moves.len();
        self.moves.resize(first + n * if single { 1 } else { dims.len() }, 0.0);
        let moves = &mut self.moves[first..];
        let gather = Gather { samples, points, stride: objective.dims, dims, cut };
        let atlas = term.slicer.atlas();
        let block = term.slicer.bank().map(|bank| bank.block(*block));
        let weights = term.family.is_weighted().then_some(weights.as_slice());
        self.slices += *count as u64;
        self.mass += *count as f64 * weights.map_or(n as f64, |weights| weights.iter().sum());
        self.masses.extend(weights.into_iter().flatten().map(|&weight| weight as f32));
        if single {
            self.thetas.extend(theta.iter().map(|row| row[0]));
        }
        if n == 0 {
            // None of the class's samples at this level is demanded.
        } else if in_lanes {
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
        } else {
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
                self.squares += if single {
                    let put = |position: usize, moved| moves[position] = moved;
                    line::transport(&gather, component, &law, weights, long, put)
                } else {
                    let put = |position: usize, moved| {
                        let along = &mut moves[position * dims.len()..][..dims.len()];
                        along
                            .iter_mut()
                            .enumerate()
                            .for_each(|(dim, along)| *along += moved * component(dim));
                    };
                    line::transport(&gather, component, &law, weights, long, put)
                };
            }
        }
        self.append(Subset { len: n, run: run.map(|run| run.start), single }, subset);
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

    /// Adds the moves to those samples that they belong to whose coordinates `part` holds.
    pub(super) fn add_to<'a>(
        &self,
        objective: &Objective,
        draws: impl Iterator<Item = &'a Draw>,
        part: &mut Part,
    ) {
        let (first, last) = self.span;
        if part.first + part.len() <= first as usize || (last as usize) < part.first {
            return;
        }
        let (mut samples, mut moves) = (self.samples.as_slice(), self.moves.as_slice());
        let (mut thetas, mut masses) = (self.thetas.as_slice(), self.masses.as_slice());
        for (draw, subset) in draws.zip(&self.subsets) {
            let term = &objective.terms[draw.term as usize];
            let (dims, n) = (&term.spec.dims, subset.len);
            let masses = term.family.is_weighted().then(|| take(&mut masses, n));
            let moves = take(&mut moves, n * if subset.single { 1 } else { dims.len() });
            let theta = take(&mut thetas, if subset.single { dims.len() } else { 0 });
            let mut adding = Adding::new(objective, term, draw, masses, part);
            match subset.run {
                Some(first) if subset.single => {
                    let inside = adding.part.overlap(first, n);
                    adding.add_run(first + inside.start as u32, &moves[inside], theta);
                }
                Some(first) => {
                    let inside = adding.part.overlap(first, n);
                    for (j, moved) in inside.clone().zip(moves.chunks_exact(dims.len()).skip(inside.start)) {
                        adding.add_one(first + j as u32, j, |dim| moved[dim]);
                    }
                }
                None if subset.single => {
                    for (j, (&sample, moved)) in take(&mut samples, n).iter().zip(moves).enumerate() {
                        adding.add_one(sample, j, |dim| moved * theta[dim]);
                    }
                }
                None => {
                    let samples = take(&mut samples, n).iter().zip(moves.chunks_exact(dims.len()));
                    for (j, (&sample, moved)) in samples.enumerate() {
                        adding.add_one(sample, j, |dim| moved[dim]);
                    }
                }
            }
        }
    }
}

/// Cuts the first `len` off.
fn take<'a, T>(rest: &mut &'a [T], len: usize) -> &'a [T] {
    let (taken, left) = rest.split_at(len);
    *rest = left;
    taken
}

/// How the moves of a subset are added to a part.
struct Adding<'a, 'b> {
    part: &'a mut Part<'b>,
    dims: &'a [usize],
    stretch: &'a [f32],
    factor: f32,
    count: f32,
    masses: Option<&'a [f32]>,
}

impl<'a, 'b> Adding<'a, 'b> {
    #[inline(always)]
    fn new(
        objective: &Objective,
        term: &'a PlannedTerm,
        draw: &Draw,
        masses: Option<&'a [f32]>,
        part: &'a mut Part<'b>,
    ) -> Self {
        let dims = term.spec.dims.as_slice();
        // E[theta thetaᵀ] = I / d makes d the natural step of a mean over directions; a projection goes as far as
        // its target along each.
        let factor = match term.spec.role {
            Role::Descend => dims.len() as f32,
            Role::Balance => 1.0,
        };
        // 1 where the number of slices says all.
        let emphasis = objective.emphasis(draw.term as usize, draw.member as usize) as f32;
        let (factor, count) = (factor * emphasis, term.slicer.per_subset() as f32 * emphasis);
        Self { part, dims, stretch: &term.stretch, factor, count, masses }
    }

    /// Adds the move of the subset's `j`th sample, if the part holds it.
    #[inline(always)]
    fn add_one(&mut self, sample: u32, j: usize, moved: impl Fn(usize) -> f32) {
        let Some((sums, hits)) = self.part.pull_on(sample) else { return };
        match (self.dims, self.masses) {
            (&[x, y], None) => {
                // The common case by itself, without a loop over two dimensions.
                sums[x] += self.factor * self.stretch[0] * moved(0);
                sums[y] += self.factor * self.stretch[1] * moved(1);
                hits[x] += self.count;
                hits[y] += self.count;
            }
            (dims, masses) => {
                let mass = masses.map_or(1.0, |masses| masses[j]);
                for (k, (&dim, stretch)) in dims.iter().zip(self.stretch).enumerate() {
                    sums[dim] += self.factor * stretch * moved(k);
                    hits[dim] += self.count * mass;
                }
            }
        }
    }

    /// Adds the moves of consecutive samples along one direction; the part holds all of them.
    #[inline(always)]
    fn add_run(&mut self, first: u32, moves: &[f32], theta: &[f32]) {
        if moves.is_empty() {
            return; // wherever the run may be
        }
        let Self { part, dims, stretch, factor, count, .. } = self;
        let begin = (first as usize - part.first) * part.dims;
        let end = begin + moves.len() * part.dims;
        let (sums, hits) = (&mut part.sums[begin..end], &mut part.hits[begin..end]);
        if let ([0, 1], 2) = (&**dims, part.dims) {
            // The common case by itself: whole vectors.
            let (along, count) = ([0, 1].map(|k| (*factor * stretch[k], theta[k])), *count);
            let pulls = sums.as_chunks_mut::<2>().0.iter_mut().zip(hits.as_chunks_mut::<2>().0);
            for ((sums, hits), moved) in pulls.zip(moves) {
                for (k, (factor, theta)) in along.iter().enumerate() {
                    sums[k] += factor * (moved * theta);
                    hits[k] += count;
                }
            }
            return;
        }
        let pulls = sums.chunks_exact_mut(part.dims).zip(hits.chunks_exact_mut(part.dims));
        for ((sums, hits), moved) in pulls.zip(moves) {
            for ((&dim, stretch), theta) in dims.iter().zip(*stretch).zip(theta) {
                sums[dim] += *factor * stretch * (moved * theta);
                hits[dim] += *count;
            }
        }
    }
}
