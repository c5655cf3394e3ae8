//! One step's slices, in parallel, summed in a fixed order.
//!
//! The subsets of a step are cut into chunks of fixed size; workers transport them into buffers of their own. Then each
//! worker adds up the displacements of its part of the table, chunk after chunk in the order of the draws, so that no
//! result depends on how many threads there are. Buffers are reused from step to step.

mod chunk;

use std::sync::{Mutex, PoisonError};

use pulp::Arch;
use rayon::prelude::*;

use self::chunk::{Chunk, Scratch, Transport};
use crate::draw::{Draw, Order, Pick};
use crate::long;
use crate::objective::Objective;
use crate::part::Part;
use crate::pull::Pull;
use crate::term::Role;

/// Subsets per chunk: large enough to pay for handing it to a thread.
const CHUNK: usize = 8;
/// A step of few subsets is still shared between threads.
const FEWEST_CHUNKS: usize = 8;
/// Samples that the subsets of a chunk should not exceed in the mean, unless a single one does.
const CHUNK_TOUCHES: usize = 1 << 13;
/// Chunks in flight, and samples that their subsets hold in the mean: bound the memory of a large step.
const IN_FLIGHT: usize = 512;
/// See [`IN_FLIGHT`].
const TOUCHES_IN_FLIGHT: usize = 1 << 17;

/// Buffers, and the order of visits.
pub(crate) struct Engine {
    arch: Arch,
    orders: Vec<Order>,
    descended: Batch,
    balanced: Batch,
    /// What each worker needs while it transports: its own, which its caches hold.
    scratch: Vec<Mutex<Scratch>>,
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
}

impl Batch {
    fn clear(&mut self) {
        self.draws.clear();
        self.order.clear();
        self.large.clear();
        self.waiting = 0;
    }

    /// Draws the subsets of a step.
    fn draw(&mut self, objective: &Objective, seed: u64, step: u64, pick: Pick, orders: &mut Vec<Order>) {
        objective.draw_subsets(seed, step, pick, orders, &mut self.draws);
        let is_large =
            |draw: &Draw| objective.terms[draw.term as usize].family.mean_size() >= long::SHARED as f64;
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

    /// Subsets per chunk and chunks in flight: fewer large subsets at a time, so that memory is bounded by samples and not
    /// by slices times samples.
    fn cut(&self, objective: &Objective, role: Role) -> (usize, usize) {
        let terms = objective.terms.iter().filter(|term| term.spec.role == role);
        let largest = terms.map(|term| term.family.mean_size()).fold(1.0, f64::max) as usize;
        let fewest = self.draws.len().div_ceil(FEWEST_CHUNKS).max(1);
        let per_chunk = (CHUNK_TOUCHES / largest).clamp(1, CHUNK).min(fewest);
        (per_chunk, (TOUCHES_IN_FLIGHT / (largest * per_chunk)).clamp(2, IN_FLIGHT))
    }

    /// Shares up to `chunks` times `per_chunk` draws, from `begin` on, among chunks. Returns where they end.
    fn share(&mut self, begin: usize, per_chunk: usize, chunks: usize) -> usize {
        let end = self.draws.len().min(begin.saturating_add(per_chunk.saturating_mul(chunks)));
        self.waiting = (end - begin).div_ceil(per_chunk);
        self.chunks.resize_with(self.chunks.len().max(self.waiting), Chunk::default);
        for (index, chunk) in self.chunks[..self.waiting].iter_mut().enumerate() {
            let first = begin + index * per_chunk;
            chunk.draws = first..end.min(first + per_chunk);
        }
        end
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
    /// `pull`, which has one entry per coordinate. The largest balanced subsets wait for [`Engine::pull_of_large`].
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
        scratch.resize_with(rayon::current_num_threads().max(scratch.len()), Mutex::default);
        let scratch = scratch.as_slice();
        let (first, first_role, other, other_role) = match picks.first().map(|pick| pick.role()) {
            Some(Role::Balance) => (balanced, Role::Balance, descended, Role::Descend),
            _ => (descended, Role::Descend, balanced, Role::Balance),
        };
        let (per_chunk, _) = other.cut(objective, other_role);
        other.share(0, per_chunk, usize::MAX);
        let (per_chunk, in_flight) = first.cut(objective, first_role);
        let mut begin = 0;
        loop {
            let others = if begin == 0 { other.waiting } else { 0 };
            begin = first.share(begin, per_chunk, in_flight);
            // The other role's come first: they may be the longest.
            let chunks = other.in_flight().take(others).chain(first.in_flight());
            chunks.with_max_len(1).for_each(|(chunk, draws, order)| {
                let worker = rayon::current_thread_index().unwrap_or(0);
                let scratch = &mut *scratch[worker].lock().unwrap_or_else(PoisonError::into_inner);
                let draws = in_order(draws, &order[chunk.draws.clone()]);
                arch.dispatch(Transport { objective, seed, step, points, draws, chunk, scratch });
            });
            other.waiting()[..others].iter().for_each(|chunk| count(chunk, other_role, pull));
            first.waiting().iter().for_each(|chunk| count(chunk, first_role, pull));
            if begin == first.draws.len() {
                return;
            }
            let samples = samples_per_part(points.len() / objective.dims, first.touches());
            pull.part(objective.dims).for_each(samples, &|mut part| first.add_up(objective, &mut part));
        }
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
