//! The slices that a step draws in one role, shared among chunks.

use rayon::prelude::*;

use super::chunk::Chunk;
use super::draw::{Picked, SubsetDraw, VisitOrder};
use super::part::TablePart;
use crate::config::Role;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::table::extent::bytes_of;
use crate::transport::SHARED;

/// Subsets per chunk: large enough to pay for handing it to a thread.
pub(super) const CHUNK: usize = 8;
/// The same where lanes hold a subset each: enough to find sixteen of about the same size.
pub(super) const CHUNK_ABREAST: usize = 64;
/// A step of few subsets is still shared between threads.
pub(super) const FEWEST_CHUNKS: usize = 8;
/// Samples that the subsets of a chunk should not exceed in the mean, unless a single one does.
pub(super) const CHUNK_TOUCHES: usize = 1 << 13;
/// Chunks in flight, and samples that their subsets hold in the mean: bound the memory of a large step.
pub(super) const IN_FLIGHT: usize = 512;
/// See [`IN_FLIGHT`].
pub(super) const TOUCHES_IN_FLIGHT: usize = 1 << 17;
/// The same of balanced subsets that wait until the others have moved the table. They hold one number per
/// sample.
pub(super) const TOUCHES_WAITING: usize = 1 << 20;

/// The slices that a step draws in one role.
#[derive(Default)]
pub(super) struct Batch {
    pub(super) draws: Vec<SubsetDraw>,
    /// Numbers of the draws in the order of their classes, which are in the high bits.
    order: Vec<u64>,
    /// Draws of subsets that are too large to be in flight with others.
    pub(super) large: Vec<SubsetDraw>,
    chunks: Vec<Chunk>,
    /// How many of the chunks hold moves that are still to be added.
    pub(super) waiting: usize,
    /// How many of the draws have been shared among chunks.
    shared: usize,
}

impl Batch {
    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        let chunks: usize = self.chunks.iter().map(Chunk::bytes).sum();
        bytes_of(&self.draws) + bytes_of(&self.order) + bytes_of(&self.large) + chunks
    }

    pub(super) fn clear(&mut self) {
        self.draws.clear();
        self.order.clear();
        self.large.clear();
        (self.waiting, self.shared) = (0, 0);
    }

    /// Draws the subsets of a step.
    pub(super) fn draw(
        &mut self,
        objective: &Objective,
        seed: u64,
        step: u64,
        pick: Picked,
        orders: &mut Vec<VisitOrder>,
    ) {
        objective.draw_subsets(seed, step, pick, orders, &mut self.draws);
        let is_large = |draw: &SubsetDraw| is_large(&objective.terms[draw.term as usize]);
        self.large.extend(self.draws.iter().filter(|draw| is_large(draw)));
        self.draws.retain(|draw| !is_large(draw));
        self.order.reserve_exact(self.draws.len());
        // Chunks of neighbours read and move the same part of the table. Terms come one after the other as it
        // is.
        for same_term in self.draws.chunk_by(|a, b| a.term == b.term) {
            let begin = self.order.len();
            let keys = same_term.iter().zip(begin..);
            self.order.extend(keys.map(|(draw, index)| u64::from(draw.member) << 32 | index as u64));
            self.order[begin..].sort_unstable();
        }
    }

    /// Subsets per chunk and chunks in flight: fewer large subsets at a time, so that memory is bounded by
    /// samples and not by slices times samples.
    pub(super) fn sizes(&self, objective: &Objective, role: Role, most_touches: usize) -> (usize, usize) {
        let terms = objective.terms.iter().filter(|term| term.spec.role == role && !is_large(term));
        let most = if terms.clone().any(|term| term.abreast) { CHUNK_ABREAST } else { CHUNK };
        let largest = terms.map(|term| term.family.mean_size()).fold(1.0, f64::max) as usize;
        let fewest = self.draws.len().div_ceil(FEWEST_CHUNKS).max(1);
        let per_chunk = (CHUNK_TOUCHES / largest).clamp(1, most).min(fewest);
        (per_chunk, (most_touches / (largest * per_chunk)).clamp(2, IN_FLIGHT))
    }

    /// Shares the next draws among up to `chunks` chunks of `per_chunk`.
    pub(super) fn share(&mut self, per_chunk: usize, chunks: usize) {
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
    pub(super) fn is_done(&self) -> bool {
        self.shared == self.draws.len()
    }

    /// Chunks to be filled, with all draws and their order.
    pub(super) fn in_flight(
        &mut self,
    ) -> impl IndexedParallelIterator<Item = (&mut Chunk, &[SubsetDraw], &[u64])> {
        let Self { draws, order, chunks, waiting, .. } = self;
        chunks[..*waiting].par_iter_mut().map(|chunk| (chunk, draws.as_slice(), order.as_slice()))
    }

    pub(super) fn waiting(&self) -> &[Chunk] {
        &self.chunks[..self.waiting]
    }

    /// Whether any of its slices wait to be added up.
    pub(super) fn waits(&self) -> bool {
        self.waiting > 0
    }

    /// Samples that wait to be moved.
    pub(super) fn touches(&self) -> usize {
        self.waiting().iter().map(|chunk| chunk.touches).sum()
    }

    /// Adds what the waiting slices pull on the samples of a part.
    ///
    /// Each thread has a part of the table and looks for its samples in all chunks, so that every sample is
    /// added to in the order of the draws, whatever the number of parts.
    pub(super) fn add_up(&self, objective: &Objective, part: &mut TablePart) {
        for chunk in self.waiting() {
            chunk.add_to(objective, in_order(&self.draws, &self.order[chunk.draws.clone()]), part);
        }
    }
}

/// Whether subsets of a term come one after the other, and share their sorts between threads.
pub(super) fn is_large(term: &PlannedTerm) -> bool {
    term.family.mean_size() >= SHARED as f64
}

/// Draws by the numbers in the low bits of `order`.
pub(super) fn in_order<'a>(
    draws: &'a [SubsetDraw],
    order: &'a [u64],
) -> impl Iterator<Item = &'a SubsetDraw> {
    order.iter().map(|&key| &draws[key as u32 as usize])
}
