//! Sweeps: every sample once, in random order, moved along the gradient of the closed form.

use std::ops::{AddAssign, Range};

use pulp::{Arch, NullaryFnOnce};
use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::balance::Balance;
use super::pairs::{BLOCK, Pairs};
use super::scattered::Scattered;
use super::tiles::Tiles;
use crate::classes::Wanted;
use crate::config::{Role, Sweeps};
use crate::error::ConfigError;
use crate::kernel::Tap;
use crate::objective::Objective;
use crate::objective::plan::PlannedTerm;
use crate::random::{self, Purpose};
use crate::simd::{self, LANES, Row};
use crate::table::domain::Domain;
use crate::table::extent::bytes_of;

/// A table on its way through sweeps.
///
/// A *run* of [`LANES`] samples that lie far from each other, the same cell of as many tiles, is the unit of
/// work. Each step of a sweep moves a random part of the runs; their pulls are computed in parallel from the
/// same table, then applied, so that nothing depends on threads.
pub(crate) struct Sweeper {
    arch: Arch,
    terms: Vec<Pairs>,
    /// What a term's pull counts on each of its coordinates.
    factors: Vec<Vec<f32>>,
    tiles: Tiles,
    /// Instead of tiles, which only balance then, where little is demanded here and there.
    scattered: Option<Scattered>,
    balance: Balance,
    dims: usize,
    /// Dimensions that some term sees.
    swept: Vec<usize>,
    /// Steps of a sweep.
    steps: usize,
    /// The sweep that goes on.
    sweep: u64,
    /// Runs that hold a demanded sample, or scattered samples, in the order of this sweep.
    order: Vec<u32>,
    pulls: Vec<Row>,
    /// Largest rate that settles.
    most: f64,
    /// Whether samples have moved here since the table was read or written.
    ahead: bool,
    /// Whether they have moved there.
    behind: bool,
}

/// How the samples of a step move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// In units of their pull.
    pub rate: f64,
    /// Distances up to this times the rate, in units of a sample's room, count as longer than they are.
    pub softening: f64,
    /// How far of the way a balance moves.
    pub balance: f64,
}

impl Sweeper {
    /// Plans the sweeps of an objective.
    ///
    /// # Errors
    /// A descended term without a closed form.
    pub(crate) fn new(objective: &Objective, sweeps: &Sweeps) -> Result<Self, ConfigError> {
        Self::with_arch(objective, sweeps, Arch::new())
    }

    pub(super) fn with_arch(objective: &Objective, sweeps: &Sweeps, arch: Arch) -> Result<Self, ConfigError> {
        super::check(objective)?;
        let (extent, dims) = (objective.extent, objective.dims);
        // Terms of the same dimensions share a pass over the pairs.
        let mut groups: Vec<Vec<&PlannedTerm>> = Vec::new();
        for term in objective.terms.iter().filter(|term| term.spec.role == Role::Descend) {
            match groups.iter_mut().find(|group| group[0].spec.dims == term.spec.dims) {
                Some(group) => group.push(term),
                None => groups.push(vec![term]),
            }
        }
        let terms: Vec<Pairs> =
            groups.iter().map(|group| Pairs::new(group, extent, sweeps.truncation)).collect();
        let weight = |group: &[&PlannedTerm]| group.iter().map(|term| term.spec.weight).sum::<f64>();
        // A coordinate's pull is the mean over the groups that see it, by weight.
        let mut seen = vec![0.0; dims];
        for group in &groups {
            group[0].spec.dims.iter().for_each(|&dim| seen[dim] += weight(group));
        }
        let share = |group: &Vec<&PlannedTerm>| {
            let weight = weight(group);
            group[0].spec.dims.iter().map(|&dim| weight / seen[dim]).collect::<Vec<f64>>()
        };
        let shares: Vec<Vec<f64>> = groups.iter().map(share).collect();
        let taps: Vec<Tap> = terms.iter().flat_map(Pairs::taps).collect();
        let mut tiles = Tiles::new(extent, dims, &taps, &objective.wanted);
        let mut order = tiles.owned_runs();
        let pairs = terms.iter().map(Pairs::per_sample).sum::<f64>() * (order.len() * LANES) as f64;
        let scattered = Scattered::new(objective, &terms, pairs);
        let mut largest = terms.iter().map(Pairs::natural_step).fold(1.0, f64::max);
        let step_of = |pairs: &Pairs| if scattered.is_some() { 1.0 } else { pairs.natural_step() };
        let times = |(shares, pairs): (&Vec<f64>, &Pairs)| -> Vec<f32> {
            shares.iter().map(|share| (share * step_of(pairs)) as f32).collect()
        };
        let factors = shares.iter().zip(&terms).map(times).collect();
        if let Some(scattered) = &scattered {
            largest = scattered.largest_step().max(1.0);
            let (extent, flags) = scattered.extent();
            tiles = Tiles::new(extent, dims, &[], &Wanted::new(&flags));
            order = scattered.samples().collect();
        }
        let steps = ((STEPS_PER_UNIT * largest) as usize).next_power_of_two().clamp(FEWEST_STEPS, MOST_STEPS);
        let most = COLLECTIVE * steps as f64 / largest;
        Ok(Self {
            arch,
            factors,
            tiles,
            scattered,
            balance: Balance::new(objective),
            dims,
            swept: (0..dims).filter(|&dim| seen[dim] > 0.0).collect(),
            terms,
            steps,
            sweep: 0,
            order,
            pulls: Vec::new(),
            most,
            ahead: false,
            behind: true,
        })
    }

    /// Reads the table, if others have moved samples.
    pub(crate) fn load(&mut self, points: &[f32]) {
        if self.behind {
            match &mut self.scattered {
                Some(scattered) => scattered.load(points),
                None => self.tiles.load(points),
            }
            (self.ahead, self.behind) = (false, false);
        }
    }

    /// Says that others have moved samples.
    pub(crate) fn outdate(&mut self) {
        self.behind = true;
    }

    /// Forgets what has moved here, and reads the table anew when it is needed.
    pub(crate) fn forget(&mut self) {
        (self.ahead, self.behind) = (false, true);
    }

    /// Writes the table back, if samples have moved.
    pub(crate) fn store(&mut self, points: &mut [f32]) {
        self.write_to(points);
        self.ahead = false;
    }

    /// Writes the table as it is now, where samples have moved since it was stored.
    pub(crate) fn write_to(&self, points: &mut [f32]) {
        match &self.scattered {
            _ if !self.ahead => {}
            Some(scattered) => scattered.store(points),
            None => self.tiles.store(points),
        }
    }

    /// Steps of a sweep.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Bytes of all buffers that grow with the table.
    pub(crate) fn bytes(&self) -> usize {
        let scattered = self.scattered.as_ref().map_or(0, Scattered::bytes);
        self.tiles.bytes() + self.balance.bytes() + scattered + bytes_of(&self.order) + bytes_of(&self.pulls)
    }

    /// Pairs of samples that a sweep looks at.
    pub(crate) fn pairs(&self) -> f64 {
        let per_sample: f64 = self.terms.iter().map(Pairs::per_sample).sum();
        let of_tiles = || per_sample * (self.order.len() * LANES) as f64;
        self.scattered.as_ref().map_or_else(of_tiles, Scattered::pairs)
    }

    /// Begins a sweep, in an order named by seed and sweep.
    pub(crate) fn shuffle(&mut self, seed: u64, sweep: u64) {
        self.sweep = sweep;
        self.order.sort_unstable();
        self.order.shuffle(&mut random::generator(seed, Purpose::Sweep, sweep, 0));
        // Within a step the order doesn't matter, and neighbours share rows.
        for step in 0..self.steps {
            let part = part(self.order.len(), self.steps, step);
            self.order[part].sort_unstable();
        }
    }

    /// Moves the samples of one step of the sweep, and balances the table where a turn of that is due.
    /// Returns the pulls' mean square. What moves is the copy, until it is stored.
    pub(crate) fn step(&mut self, step: usize, how: Motion, domains: &[Domain]) -> MeanSquare {
        let rate = how.rate.min(self.most);
        self.terms.iter_mut().for_each(|pairs| pairs.soften(how.softening * rate));
        let pulls = match self.scattered {
            Some(_) => self.move_scattered(step, rate as f32, domains),
            None => self.move_runs(step, rate as f32, domains),
        };
        self.ahead = true;
        let turns = self.balance.turns();
        if (step + 1).is_multiple_of(self.steps / turns) {
            let turn = self.sweep * turns as u64 + (step / (self.steps / turns)) as u64;
            self.balance(turn, how.balance);
        }
        pulls
    }

    /// Moves the runs of one step. Returns the pulls' mean square.
    fn move_runs(&mut self, step: usize, rate: f32, domains: &[Domain]) -> MeanSquare {
        let Self { arch, terms, factors, tiles, dims, swept, steps, order, pulls, .. } = self;
        let dims = *dims;
        let runs = &order[part(order.len(), *steps, step)];
        pulls.resize(runs.len() * dims, [0.0; LANES]);
        // Blocks share what they read, and threads the blocks.
        let block = (runs.len() / FEWEST_BLOCKS).clamp(1, BLOCK);
        let tasks = pulls.par_chunks_mut(block * dims).zip(runs.par_chunks(block));
        tasks.for_each(|(pulls, runs)| arch.dispatch(PullsOfRuns { terms, factors, tiles, runs, pulls }));
        let mut all = MeanSquare::default();
        for (pulls, &run) in pulls.chunks_exact(dims).zip(runs) {
            let run = tiles.run(run as usize);
            for &dim in swept.iter() {
                all.add(&pulls[dim], run.lanes());
                tiles.shift(run, dim, &pulls[dim].map(|pull| rate * pull), domains[dim]);
            }
        }
        all
    }

    /// The same for scattered samples.
    fn move_scattered(&mut self, step: usize, rate: f32, domains: &[Domain]) -> MeanSquare {
        let mut all = MeanSquare::default();
        let Self { arch, terms, factors, scattered, dims, swept, steps, order, pulls, .. } = self;
        let Some(scattered) = scattered else { return all };
        let samples = &order[part(order.len(), *steps, step)];
        pulls.resize(samples.len().div_ceil(LANES) * *dims, [0.0; LANES]);
        scattered.pull(*arch, terms, factors, samples, pulls);
        for (pulls, samples) in pulls.chunks_exact(*dims).zip(samples.chunks(LANES)) {
            for &dim in swept.iter() {
                all.add(&pulls[dim], 0..samples.len());
                for (pull, &sample) in pulls[dim].iter().zip(samples) {
                    scattered.shift(sample, dim, rate * pull, domains[dim]);
                }
            }
        }
        all
    }

    /// Turns of the balance in a sweep.
    pub(crate) fn turns(&self) -> usize {
        self.balance.turns()
    }

    /// Takes one turn of the balance, `share` of the way.
    pub(crate) fn balance(&mut self, turn: u64, share: f64) {
        let Self { arch, balance, tiles, scattered, .. } = self;
        match scattered {
            Some(scattered) => {
                tiles.load(scattered.points());
                balance.advance(*arch, tiles, turn, share);
                tiles.store(scattered.points_mut());
            }
            None => balance.advance(*arch, tiles, turn, share),
        }
        self.ahead = true;
    }

    /// Brings coordinates that are balanced one by one `share` of the way to a regular grid, by rank.
    pub(crate) fn settle(&self, points: &mut [f32], samples: &[u32], share: f64) {
        self.balance.settle(points, self.dims, samples, share);
    }

    /// The pulls of a step that was just taken, by coordinate.
    #[cfg(test)]
    pub(super) fn each_pull(&self, step: usize, mut visit: impl FnMut(usize, f32)) {
        let runs = &self.order[part(self.order.len(), self.steps, step)];
        if let Some(scattered) = &self.scattered {
            for (pulls, samples) in self.pulls.chunks_exact(self.dims).zip(runs.chunks(LANES)) {
                for (lane, &sample) in samples.iter().enumerate() {
                    let first = scattered.in_table(sample) * self.dims;
                    pulls.iter().enumerate().for_each(|(dim, pull)| visit(first + dim, pull[lane]));
                }
            }
            return;
        }
        for (pulls, &run) in self.pulls.chunks_exact(self.dims).zip(runs) {
            let run = self.tiles.run(run as usize);
            for lane in run.lanes() {
                let first = self.tiles.sample(run, lane) * self.dims;
                pulls.iter().enumerate().for_each(|(dim, pull)| visit(first + dim, pull[lane]));
            }
        }
    }

    #[cfg(test)]
    pub(super) fn pulls_of_runs<'a>(&'a self, runs: &'a [u32], pulls: &'a mut [Row]) -> PullsOfRuns<'a> {
        let Self { terms, factors, tiles, .. } = self;
        PullsOfRuns { terms, factors, tiles, runs, pulls }
    }
}

/// The part of a list that a step of the sweep takes.
fn part(len: usize, steps: usize, step: usize) -> Range<usize> {
    len * step / steps..len * (step + 1) / steps
}

/// A mean square on its way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MeanSquare {
    sum: f64,
    count: usize,
}

impl AddAssign for MeanSquare {
    fn add_assign(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
    }
}

impl MeanSquare {
    #[inline(always)]
    fn add(&mut self, pulls: &Row, lanes: impl Iterator<Item = usize>) {
        let mut squares = [0.0; LANES];
        for lane in lanes {
            squares[lane] = pulls[lane] * pulls[lane];
            self.count += 1;
        }
        self.sum += f64::from(simd::sum(squares));
    }

    pub(crate) fn root(self) -> f64 {
        (self.sum / self.count.max(1) as f64).sqrt()
    }
}

/// Steps of a sweep per unit of the natural step. The samples of a step move together, as if the others of
/// that step stood still; the more they see of each other, the fewer of them should.
const STEPS_PER_UNIT: f64 = 4.0;
const FEWEST_STEPS: usize = 16;
/// With more, threads meet too often.
const MOST_STEPS: usize = 64;

/// Largest motion of all neighbours together, in units of what they see, that settles.
const COLLECTIVE: f64 = 0.5;

/// Blocks of a step, at least: enough for some threads.
const FEWEST_BLOCKS: usize = 4;

/// The pulls on a block of runs, compiled once per instruction set.
pub(super) struct PullsOfRuns<'a> {
    terms: &'a [Pairs],
    factors: &'a [Vec<f32>],
    tiles: &'a Tiles,
    runs: &'a [u32],
    pulls: &'a mut [Row],
}

impl NullaryFnOnce for PullsOfRuns<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { terms, factors, tiles, runs, pulls } = self;
        pulls.fill([0.0; LANES]);
        let mut block = [tiles.run(0); BLOCK];
        block.iter_mut().zip(runs).for_each(|(run, &index)| *run = tiles.run(index as usize));
        for (pairs, factors) in terms.iter().zip(factors) {
            pairs.add_pulls(tiles, &block[..runs.len()], factors, pulls);
        }
    }
}
