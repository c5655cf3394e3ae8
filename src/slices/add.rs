//! Adding up what the subsets of a chunk pull on the samples of a part.

use super::chunk::Chunk;
use super::draw::SubsetDraw;
use super::part::TablePart;
use crate::config::Role;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;

impl Chunk {
    /// Adds the moves to those samples that they belong to whose coordinates `part` holds.
    pub(super) fn add_to<'a>(
        &self,
        objective: &Objective,
        draws: impl Iterator<Item = &'a SubsetDraw>,
        part: &mut TablePart,
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
    part: &'a mut TablePart<'b>,
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
        draw: &SubsetDraw,
        masses: Option<&'a [f32]>,
        part: &'a mut TablePart<'b>,
    ) -> Self {
        let dims = term.spec.dims.as_slice();
        // E[theta thetaᵀ] = I / d makes d the natural step of a mean over directions; a projection goes as
        // far as its target along each.
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
