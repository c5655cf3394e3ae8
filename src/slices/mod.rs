//! One step's slices, in parallel, summed in a fixed order.
//!
//! The subsets of a step are cut into chunks, in the order of their classes; workers transport them into
//! buffers of their own. Then each worker adds up the displacements of its part of the table, chunk after
//! chunk, and moves its samples, so that no result depends on how many threads there are. Buffers are reused
//! from step to step.

mod add;
mod batch;
mod chunk;
#[cfg(test)]
mod dispatch;
mod draw;
mod part;
#[cfg(test)]
mod stress;
mod walk;

use std::sync::{Mutex, PoisonError};

use pulp::Arch;
use rayon::prelude::*;

use self::batch::{Batch, TOUCHES_IN_FLIGHT, TOUCHES_WAITING, in_order};
use self::chunk::{Chunk, Scratch, Transport};
pub(crate) use self::draw::Picked;
use self::draw::{SubsetDraw, VisitOrder};
use self::part::{Pull, TablePart};
pub(crate) use self::walk::Walker;
use crate::config::{Descent, Role};
use crate::objective::Objective;
use crate::table::extent::bytes_of;

/// What a step does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<'a> {
    pub seed: u64,
    /// Names its random numbers.
    pub number: u64,
    /// The slices that it takes, one role after the other.
    pub picks: &'a [Picked],
    /// Step size of what descends.
    pub rate: f64,
    /// How far of its way what balances goes.
    pub share: f64,
}

/// Steps of slices: buffers, the order of visits, and the moments of the descent.
pub(crate) struct Slices {
    orders: Vec<VisitOrder>,
    batches: Batches,
    workers: Workers,
    pull: Pull,
    walker: Walker,
}

/// The slices of a step, by role.
#[derive(Default)]
struct Batches {
    descended: Batch,
    balanced: Batch,
}

/// What transports.
struct Workers {
    arch: Arch,
    /// What each worker needs while it transports: its own, which its caches hold. It is taken out meanwhile,
    /// so that a worker that is lent to another chunk in the middle of one makes do with a new one.
    scratch: Vec<Mutex<Option<Scratch>>>,
    /// The same for the largest subsets, which come one after the other and share their sorts between
    /// threads: a few times the table, but once.
    large: Scratch,
    /// What the last of them pulls.
    alone: Chunk,
}

impl Slices {
    /// Begins with fresh moments, for tables of so many coordinates.
    pub(crate) fn new(descent: Descent, coordinates: usize) -> Self {
        Self {
            orders: Vec::new(),
            batches: Batches::default(),
            workers: Workers::new(),
            pull: Pull::default(),
            walker: Walker::new(descent, coordinates),
        }
    }

    /// The descent, with its moments.
    pub(crate) fn walker(&self) -> &Walker {
        &self.walker
    }

    /// Goes on with these moments.
    pub(crate) fn set_walker(&mut self, walker: Walker) {
        self.walker = walker;
    }

    /// Bytes of all buffers that grow with the table.
    pub(crate) fn bytes(&self) -> usize {
        let Self { orders, batches, workers, pull, walker } = self;
        let scratch = |scratch: &Mutex<Option<Scratch>>| {
            scratch.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map_or(0, Scratch::bytes)
        };
        orders.iter().map(VisitOrder::bytes).sum::<usize>()
            + batches.descended.bytes()
            + batches.balanced.bytes()
            + workers.scratch.iter().map(scratch).sum::<usize>()
            + workers.large.bytes()
            + workers.alone.bytes()
            + bytes_of(&pull.sums)
            + bytes_of(&pull.hits)
            + walker.bytes()
    }

    /// Gives buffers back: they are as large as the largest subset, and copies of the table.
    pub(crate) fn release(&mut self) {
        (self.orders, self.batches, self.workers) = (Vec::new(), Batches::default(), Workers::new());
        self.pull = Pull::default();
    }

    /// Moves the samples by the slices that a step picks: first those that descend, then those that balance.
    /// All see the table as it is before, so that threads meet twice only; but where those that balance are
    /// very many, or very large, the later ones see what the others have made of it.
    ///
    /// Returns the root mean square displacement along the descended slices before the step, and the number
    /// of slices.
    pub(crate) fn step(&mut self, objective: &Objective, points: &mut [f32], step: &Step) -> (f64, u64) {
        self.pull.grow(points.len());
        self.transport(objective, points, step);
        let descends = step.picks.iter().any(|pick| pick.role() == Role::Descend);
        let walk = descends.then(|| self.walker.step(step.rate));
        let domains = objective.domains.as_slice();
        let balance = |part: &mut TablePart| walk::project(step.share, domains, part);
        let samples = points.len() / objective.dims;

        let Self { batches, pull, walker, .. } = self;
        let table = TablePart { points, moments: walker.moments_mut(), ..pull.part(objective.dims) };
        table.for_each(batches.samples_per_part(samples), &|mut part| {
            if let Some(walk) = walk {
                batches.descended.add_up(objective, &mut part);
                walk.advance(domains, &mut part);
            }
            if batches.balanced.waits() {
                batches.balanced.add_up(objective, &mut part);
                balance(&mut part);
            }
        });
        while self.transport_rest(objective, points, step) {
            let Self { batches, pull, .. } = self;
            let table = TablePart { points, ..pull.part(objective.dims) };
            table.for_each(batches.samples_per_part(samples), &|mut part| {
                batches.balanced.add_up(objective, &mut part);
                balance(&mut part);
            });
        }
        if self.pull_of_large(objective, points, step, Role::Balance) {
            let table = TablePart { points, ..self.pull.part(objective.dims) };
            table.for_each(self.batches.samples_per_part(samples), &|mut part| balance(&mut part));
        }
        let Pull { slices, squares, mass, .. } = self.pull;
        ((squares / mass.max(f64::MIN_POSITIVE)).sqrt(), slices)
    }

    /// Transports the slices that are picked in a step from `points`, in one role or in both. What they pull
    /// waits to be added up; but where the first of the roles has more than should be kept waiting, most of
    /// that is added to the pull. What the second has more than that is left to [`Slices::transport_rest`],
    /// the largest balanced subsets to [`Slices::pull_of_large`].
    fn transport(&mut self, objective: &Objective, points: &[f32], step: &Step) {
        let Self { batches, orders, .. } = self;
        batches.descended.clear();
        batches.balanced.clear();
        for &pick in step.picks {
            batches.of_mut(pick.role()).draw(objective, step.seed, step.number, pick, orders);
        }
        (self.pull.slices, self.pull.squares, self.pull.mass) = (0, 0.0, 0.0);
        self.pull_of_large(objective, points, step, Role::Descend);

        let Self { batches: Batches { descended, balanced }, workers, pull, .. } = self;
        let (first, first_role, other, other_role) = match step.picks.first().map(|pick| pick.role()) {
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
            workers.fill(chunks, objective, points, step);
            other.waiting()[..others].iter().for_each(|chunk| pull.count(chunk, other_role));
            first.waiting().iter().for_each(|chunk| pull.count(chunk, first_role));
            if first.is_done() {
                return;
            }
            others = 0;
            let samples = samples_per_part(points.len() / objective.dims, first.touches());
            pull.part(objective.dims).for_each(samples, &|mut part| first.add_up(objective, &mut part));
        }
    }

    /// Transports the next of the balanced slices of a step that were too many to wait with the others.
    /// Returns whether there are any, which wait to be added up now.
    fn transport_rest(&mut self, objective: &Objective, points: &[f32], step: &Step) -> bool {
        let Self { batches: Batches { descended, balanced }, workers, pull, .. } = self;
        descended.waiting = 0;
        let (per_chunk, in_flight) = balanced.sizes(objective, Role::Balance, TOUCHES_WAITING);
        balanced.share(per_chunk, in_flight);
        workers.fill(balanced.in_flight(), objective, points, step);
        balanced.waiting().iter().for_each(|chunk| pull.count(chunk, Role::Balance));
        balanced.waits()
    }

    /// Transports the largest subsets of a role, one after the other, and adds what they pull. Returns
    /// whether there are any.
    fn pull_of_large(&mut self, objective: &Objective, points: &[f32], step: &Step, role: Role) -> bool {
        let Self { batches, workers, pull, .. } = self;
        let Workers { arch, large, alone: chunk, .. } = workers;
        let draws = &batches.of_mut(role).large;
        let &Step { seed, number: step, .. } = step;
        for draw in draws {
            let draws = std::iter::once(draw);
            arch.dispatch(Transport { objective, seed, step, points, draws, chunk, scratch: large });
            pull.count(chunk, role);
            let samples = samples_per_part(points.len() / objective.dims, chunk.touches);
            pull.part(objective.dims).for_each(samples, &|mut part| {
                chunk.add_to(objective, std::iter::once(draw), &mut part);
            });
            chunk.give_back(large);
        }
        !draws.is_empty()
    }
}

impl Batches {
    fn of_mut(&mut self, role: Role) -> &mut Batch {
        match role {
            Role::Descend => &mut self.descended,
            Role::Balance => &mut self.balanced,
        }
    }

    /// Samples of a part of the table that is worth a thread of its own, with what waits to be added.
    fn samples_per_part(&self, samples: usize) -> usize {
        samples_per_part(samples, self.descended.touches() + self.balanced.touches())
    }
}

impl Workers {
    fn new() -> Self {
        Self { arch: Arch::new(), scratch: Vec::new(), large: Scratch::default(), alone: Chunk::default() }
    }

    /// Transports the subsets of chunks, in parallel.
    fn fill<'a>(
        &mut self,
        chunks: impl IndexedParallelIterator<Item = (&'a mut Chunk, &'a [SubsetDraw], &'a [u64])>,
        objective: &Objective,
        points: &[f32],
        &Step { seed, number: step, .. }: &Step,
    ) {
        let Self { arch, scratch, .. } = self;
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
}

impl Pull {
    /// Counts the slices of a chunk, and the displacements of those that descend.
    fn count(&mut self, chunk: &Chunk, role: Role) {
        self.slices += chunk.slices;
        if role == Role::Descend {
            self.squares += chunk.squares;
            self.mass += chunk.mass;
        }
    }
}

/// Samples per part, if as many moves are added.
fn samples_per_part(samples: usize, touches: usize) -> usize {
    /// Moves, or samples to walk, that are worth sharing between threads.
    const WORTH_SHARING: usize = 1 << 11;
    if touches + samples / 8 < WORTH_SHARING {
        samples
    } else {
        samples.div_ceil(rayon::current_num_threads())
    }
}
