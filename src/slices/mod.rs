//! One step's slices, in parallel, summed in a fixed order.
//!
//! The subsets of a step are cut into chunks, in the order of their classes; workers transport them into buffers of their
//! own. Then each worker adds up the displacements of its part of the table, chunk after chunk, so that no result depends
//! on how many threads there are. Buffers are reused from step to step.

mod chunk;
pub(crate) mod draw;
pub(crate) mod part;
pub(crate) mod pull;
pub(crate) mod walk;

use std::sync::{Mutex, PoisonError};

use pulp::Arch;
use rayon::prelude::*;

use self::chunk::{Chunk, Scratch, Transport};
use crate::config::term::Role;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::slices::draw::{Draw, Order, Pick};
use crate::slices::part::Part;
use crate::slices::pull::Pull;
use crate::transport::line;

/// LabelSubsets per chunk: large enough to pay for handing it to a thread.
const CHUNK: usize = 8;
/// A step of few subsets is still shared between threads.
const FEWEST_CHUNKS: usize = 8;
/// Samples that the subsets of a chunk should not exceed in the mean, unless a single one does.
const CHUNK_TOUCHES: usize = 1 << 13;
/// Chunks in flight, and samples that their subsets hold in the mean: bound the memory of a large step.
const IN_FLIGHT: usize = 512;
/// See [`IN_FLIGHT`].
const TOUCHES_IN_FLIGHT: usize = 1 << 17;
/// The same of balanced subsets that wait until the others have moved the table. They hold one number per sample.
const TOUCHES_WAITING: usize = 1 << 20;

/// Buffers, and the order of visits.
pub(crate) struct Engine {
    arch: Arch,
    orders: Vec<Order>,
    descended: Batch,
    balanced: Batch,
    /// What each worker needs while it transports: its own, which its caches hold. It is taken out meanwhile, so that a worker
    /// that is lent to another chunk in the middle of one makes do with a new one.
    scratch: Vec<Mutex<Option<Scratch>>>,
    /// The same for the largest subsets, which come one after the other and share their sorts between threads: a few
    /// times the table, but once.
    large: Scratch,
    /// What the last of them pulls.
    alone: Chunk,
}

/// The slices that a step draws in one role.
#[derive(Default)]
struct Batch {
    draws: Vec<Draw>,
    /// Numbers of the draws in the order of their classes, which are in the high bits.
    order: Vec<u64>,
    /// Draws of subsets that are too large to be in flight with others.
    large: Vec<Draw>,
    chunks: Vec<Chunk>,
    /// How many of the chunks hold moves that are still to be added.
    waiting: usize,
    /// How many of the draws have been shared among chunks.
    shared: usize,
}

impl Batch {
    fn clear(&mut self) {
        self.draws.clear();
        self.order.clear();
        self.large.clear();
        (self.waiting, self.shared) = (0, 0);
    }

    /// Draws the subsets of a step.
    fn draw(&mut self, objective: &Objective, seed: u64, step: u64, pick: Pick, orders: &mut Vec<Order>) {
        objective.draw_subsets(seed, step, pick, orders, &mut self.draws);
        let is_large = |draw: &Draw| is_large(&objective.terms[draw.term as usize]);
        self.large.extend(self.draws.iter().filter(|draw| is_large(draw)));
        self.draws.retain(|draw| !is_large(draw));
        // Chunks of neighbours read and move the same part of the table. Terms come one after the other as it is.
        for same_term in self.draws.chunk_by(|a, b| a.term == b.term) {
            let begin = self.order.len();
            let keys = same_term.iter().zip(begin..);
            self.order.extend(keys.map(|(draw, index)| u64::from(draw.member) << 32 | index as u64));
            self.order[begin..].sort_unstable();
        }
    }

    /// LabelSubsets per chunk and chunks in flight: fewer large subsets at a time, so that memory is bounded by samples and not
    /// by slices times samples.
    fn sizes(&self, objective: &Objective, role: Role, most_touches: usize) -> (usize, usize) {
        let terms = objective.terms.iter().filter(|term| term.spec.role == role && !is_large(term));
        let largest = terms.map(|term| term.family.mean_size()).fold(1.0, f64::max) as usize;
        let fewest = self.draws.len().div_ceil(FEWEST_CHUNKS).max(1);
        let per_chunk = (CHUNK_TOUCHES / largest).clamp(1, CHUNK).min(fewest);
        (per_chunk, (most_touches / (largest * per_chunk)).clamp(2, IN_FLIGHT))
    }

    /// Shares the next draws among up to `chunks` chunks of `per_chunk`.
    fn share(&mut self, per_chunk: usize, chunks: usize) {
        let begin = self.shared;
        let end = self.draws.len().min(begin.saturating_add(per_chunk.saturating_mul(chunks)));
        self.waiting = (end - begin).div_ceil(per_chunk);
        self.chunks.resize_with(self.chunks.len().max(self.waiting), Chunk::default);
        for (index, chunk) in self.chunks[..self.waiting].iter_mut().enumerate() {
            let first = begin + index * per_chunk;
            chunk.draws = first..end.min(first + per_chunk);
        }
        self.shared = end;
    }

    /// Whether all draws have been shared among chunks.
    fn is_done(&self) -> bool {
        self.shared == self.draws.len()
    }

    /// Chunks to be filled, with all draws and their order.
    fn in_flight(&mut self) -> impl IndexedParallelIterator<Item = (&mut Chunk, &[Draw], &[u64])> {
        let Self { draws, order, chunks, waiting, .. } = self;
        chunks[..*waiting].par_iter_mut().map(|chunk| (chunk, draws.as_slice(), order.as_slice()))
    }

    fn waiting(&self) -> &[Chunk] {
        &self.chunks[..self.waiting]
    }

    /// Samples that wait to be moved.
    fn touches(&self) -> usize {
        self.waiting().iter().map(|chunk| chunk.touches).sum()
    }

    fn add_up(&self, objective: &Objective, part: &mut Part) {
        for chunk in self.waiting() {
            chunk.add_to(objective, in_order(&self.draws, &self.order[chunk.draws.clone()]), part);
        }
    }
}

/// Whether subsets of a term come one after the other, and share their sorts between threads.
fn is_large(term: &PlannedTerm) -> bool {
    term.family.mean_size() >= line::SHARED as f64
}

/// Transports the subsets of chunks, in parallel.
fn fill<'a>(
    chunks: impl IndexedParallelIterator<Item = (&'a mut Chunk, &'a [Draw], &'a [u64])>,
    arch: Arch,
    scratch: &mut Vec<Mutex<Option<Scratch>>>,
    (objective, seed, step, points): (&Objective, u64, u64, &[f32]),
) {
    scratch.resize_with(rayon::current_num_threads().max(scratch.len()), Mutex::default);
    let scratch = scratch.as_slice();
    chunks.with_max_len(1).for_each(|(chunk, draws, order)| {
        let own = &scratch[rayon::current_thread_index().unwrap_or(0)];
        let taken = own.lock().unwrap_or_else(PoisonError::into_inner).take();
        let mut mine = taken.unwrap_or_default();
        let draws = in_order(draws, &order[chunk.draws.clone()]);
        arch.dispatch(Transport { objective, seed, step, points, draws, chunk, scratch: &mut mine });
        *own.lock().unwrap_or_else(PoisonError::into_inner) = Some(mine);
    });
}

/// Draws by the numbers in the low bits of `order`.
fn in_order<'a>(draws: &'a [Draw], order: &'a [u64]) -> impl Iterator<Item = &'a Draw> {
    order.iter().map(|&key| &draws[key as u32 as usize])
}

impl Engine {
    pub(crate) fn new() -> Self {
        Self {
            arch: Arch::new(),
            orders: Vec::new(),
            descended: Batch::default(),
            balanced: Batch::default(),
            scratch: Vec::new(),
            large: Scratch::default(),
            alone: Chunk::default(),
        }
    }

    /// Transports the slices that are picked in a step from `points`, in one role or in both. What they pull waits for
    /// [`Engine::add_up`]; but where the first of the roles has more than should be kept waiting, most of that is added to
    /// `pull`, which has one entry per coordinate. What the second has more than that is left to
    /// [`Engine::transport_rest`], the largest balanced subsets to [`Engine::pull_of_large`].
    pub(crate) fn transport(
        &mut self,
        objective: &Objective,
        (seed, step, picks): (u64, u64, &[Pick]),
        points: &[f32],
        pull: &mut Pull,
    ) {
        (pull.slices, pull.squares, pull.mass) = (0, 0.0, 0.0);
        self.descended.clear();
        self.balanced.clear();
        for &pick in picks {
            let batch = match pick.role() {
                Role::Descend => &mut self.descended,
                Role::Balance => &mut self.balanced,
            };
            batch.draw(objective, seed, step, pick, &mut self.orders);
        }
        self.pull_of_large(objective, (seed, step, Role::Descend), points, pull);
        let Self { arch, descended, balanced, scratch, .. } = self;
        let (first, first_role, other, other_role) = match picks.first().map(|pick| pick.role()) {
            Some(Role::Balance) => (balanced, Role::Balance, descended, Role::Descend),
            _ => (descended, Role::Descend, balanced, Role::Balance),
        };
        let (per_chunk, in_flight) = other.sizes(objective, other_role, TOUCHES_WAITING);
        other.share(per_chunk, in_flight);
        let (per_chunk, in_flight) = first.sizes(objective, first_role, TOUCHES_IN_FLIGHT);
        let in_flight = in_flight.max(rayon::current_num_threads());
        let mut others = other.waiting;
        loop {
            first.share(per_chunk, in_flight);
            // The other role's come first: they may be the longest.
            let chunks = other.in_flight().take(others).chain(first.in_flight());
            fill(chunks, *arch, scratch, (objective, seed, step, points));
            other.waiting()[..others].iter().for_each(|chunk| count(chunk, other_role, pull));
            first.waiting().iter().for_each(|chunk| count(chunk, first_role, pull));
            if first.is_done() {
                return;
            }
            others = 0;
            let samples = samples_per_part(points.len() / objective.dims, first.touches());
            pull.part(objective.dims).for_each(samples, &|mut part| first.add_up(objective, &mut part));
        }
    }

    /// Transports the next of the balanced slices of a step that were too many to wait with the others. Returns whether there
    /// are any, which wait for [`Engine::add_up`] now.
    pub(crate) fn transport_rest(
        &mut self,
        objective: &Objective,
        (seed, step): (u64, u64),
        points: &[f32],
        pull: &mut Pull,
    ) -> bool {
        let Self { arch, descended, balanced, scratch, .. } = self;
        descended.waiting = 0;
        let (per_chunk, in_flight) = balanced.sizes(objective, Role::Balance, TOUCHES_WAITING);
        balanced.share(per_chunk, in_flight);
        fill(balanced.in_flight(), *arch, scratch, (objective, seed, step, points));
        balanced.waiting().iter().for_each(|chunk| count(chunk, Role::Balance, pull));
        balanced.waiting > 0
    }

    /// Transports the largest subsets of a role, one after the other, and adds what they pull to `pull`. Returns whether
    /// there are any.
    pub(crate) fn pull_of_large(
        &mut self,
        objective: &Objective,
        (seed, step, role): (u64, u64, Role),
        points: &[f32],
        pull: &mut Pull,
    ) -> bool {
        let Self { arch, descended, balanced, large, alone: chunk, .. } = self;
        let draws = match role {
            Role::Descend => &descended.large,
            Role::Balance => &balanced.large,
        };
        for draw in draws {
            let draws = std::iter::once(draw);
            arch.dispatch(Transport { objective, seed, step, points, draws, chunk, scratch: large });
            count(chunk, role, pull);
            let samples = samples_per_part(points.len() / objective.dims, chunk.touches);
            pull.part(objective.dims).for_each(samples, &|mut part| {
                chunk.add_to(objective, std::iter::once(draw), &mut part);
            });
            chunk.give_back(large);
        }
        !draws.is_empty()
    }

    /// Whether slices of a role wait for [`Engine::add_up`].
    pub(crate) fn waits(&self, role: Role) -> bool {
        self.batch(role).waiting > 0
    }

    /// Samples of a part of the table that is worth a thread of its own, with what waits to be added.
    pub(crate) fn samples_per_part(&self, samples: usize) -> usize {
        samples_per_part(samples, self.descended.touches() + self.balanced.touches())
    }

    /// Adds what the waiting slices of a role pull on the samples of a part.
    ///
    /// Each thread has a part of the table and looks for its samples in all chunks, so that every sample is added to in the
    /// order of the draws, whatever the number of parts.
    pub(crate) fn add_up(&self, objective: &Objective, role: Role, part: &mut Part) {
        self.batch(role).add_up(objective, part);
    }

    fn batch(&self, role: Role) -> &Batch {
        match role {
            Role::Descend => &self.descended,
            Role::Balance => &self.balanced,
        }
    }
}

/// Counts the slices of a chunk, and the displacements of those that descend.
fn count(chunk: &Chunk, role: Role, pull: &mut Pull) {
    pull.slices += chunk.slices;
    if role == Role::Descend {
        pull.squares += chunk.squares;
        pull.mass += chunk.mass;
    }
}

/// Samples per part, if as many moves are added.
fn samples_per_part(samples: usize, touches: usize) -> usize {
    /// Moves, or samples to walk, that are worth sharing between threads.
    const SHARED: usize = 1 << 11;
    if touches + samples / 8 < SHARED { samples } else { samples.div_ceil(rayon::current_num_threads()) }
}

#[cfg(test)]
mod dispatch;
#[cfg(test)]
mod stress;
