//! Sweeps: every sample once, in random order, moved along the gradient of the closed form.

use std::ops::{AddAssign, Range};

use pulp::{Arch, NullaryFnOnce};
use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::balance::Balance;
use super::pairs::Pairs;
use super::tiles::{Run, Tiles};
use crate::config::{Role, Sweeps};
use crate::error::ConfigError;
use crate::kernel::Tap;
use crate::objective::Objective;
use crate::random::{self, Purpose};
use crate::simd::{self, LANES, Row};
use crate::table::domain::Domain;

/// Steps per sweep. The samples of a step move together, as if the others of that step stood still; with few
/// of them next to each other, large steps are safe.
pub(crate) const STEPS: usize = 16;

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
    balance: Balance,
    dims: usize,
    /// Runs that hold a demanded sample, in the order of this sweep.
    order: Vec<u32>,
    pulls: Vec<Row>,
    /// Largest rate that settles.
    most: f64,
    /// Whether samples have moved here since the table was read or written.
    ahead: bool,
    /// Whether they have moved there.
    behind: bool,
}

impl Sweeper {
    /// Plans the sweeps of an objective.
    ///
    /// # Errors
    /// A descended term without a closed form.
    pub(crate) fn new(objective: &Objective, sweeps: &Sweeps) -> Result<Self, ConfigError> {
        super::check(objective)?;
        let (extent, dims) = (objective.extent, objective.dims);
        let planned = || objective.terms.iter().filter(|term| term.spec.role == Role::Descend);
        let terms: Vec<Pairs> = planned().map(|term| Pairs::new(term, extent, sweeps.truncation)).collect();
        // A coordinate's pull is the mean over the terms that see it, by weight.
        let mut seen = vec![0.0; dims];
        for term in planned() {
            term.spec.dims.iter().for_each(|&dim| seen[dim] += term.spec.weight);
        }
        let factors = planned().zip(&terms).map(|(term, pairs)| {
            let strength = term.spec.weight * pairs.natural_step();
            term.spec.dims.iter().map(|&dim| (strength / seen[dim]) as f32).collect()
        });
        let factors = factors.collect();
        let most = COLLECTIVE * STEPS as f64 / terms.iter().map(Pairs::natural_step).fold(1.0, f64::max);
        let taps: Vec<Tap> = terms.iter().flat_map(Pairs::taps).copied().collect();
        let tiles = Tiles::new(extent, dims, &taps, &objective.wanted);
        let is_wanted = |&index: &u32| tiles.run(index as usize).lanes().next().is_some();
        let order = (0..tiles.runs() as u32).filter(is_wanted).collect();
        Ok(Self {
            arch: Arch::new(),
            terms,
            factors,
            tiles,
            balance: Balance::new(objective),
            dims,
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
            self.tiles.load(points);
            (self.ahead, self.behind) = (false, false);
        }
    }

    /// Says that others have moved samples.
    pub(crate) fn outdate(&mut self) {
        self.behind = true;
    }

    /// Writes the table back, if samples have moved.
    pub(crate) fn store(&mut self, points: &mut [f32]) {
        self.write_to(points);
        self.ahead = false;
    }

    /// Writes the table as it is now, where samples have moved since it was stored.
    pub(crate) fn write_to(&self, points: &mut [f32]) {
        if self.ahead {
            self.tiles.store(points);
        }
    }

    /// Begins a sweep, in an order named by seed and sweep.
    pub(crate) fn shuffle(&mut self, seed: u64, sweep: u64) {
        self.order.sort_unstable();
        self.order.shuffle(&mut random::generator(seed, Purpose::Sweep, sweep, 0));
        // Within a step the order doesn't matter, and neighbours share rows.
        for step in 0..STEPS {
            let part = part(self.order.len(), step);
            self.order[part].sort_unstable();
        }
    }

    /// Moves the samples of one step of the sweep by `rate` times their pull. Returns the pulls' mean square.
    /// What moves is the copy, until it is stored.
    pub(crate) fn step(&mut self, step: usize, rate: f64, domains: &[Domain]) -> MeanSquare {
        let rate = rate.min(self.most);
        let Self { arch, terms, factors, tiles, dims, order, pulls, ahead, .. } = self;
        let dims = *dims;
        let runs = &order[part(order.len(), step)];
        pulls.resize(runs.len() * dims, [0.0; LANES]);
        let tasks = pulls.par_chunks_exact_mut(dims).zip(runs);
        tasks.with_min_len(RUNS_PER_TASK).for_each(|(pulls, &run)| {
            let run = tiles.run(run as usize);
            arch.dispatch(PullOfRun { terms, factors, tiles, run, pulls });
        });
        let mut all = MeanSquare::default();
        for (pulls, &run) in pulls.chunks_exact(dims).zip(runs) {
            let run = tiles.run(run as usize);
            for (dim, (pull, &domain)) in pulls.iter().zip(domains).enumerate() {
                all.add(pull, run);
                tiles.shift(run, dim, &pull.map(|pull| rate as f32 * pull), domain);
            }
        }
        *ahead = true;
        all
    }

    /// Brings the whole table and its frames `share` of the way to where they are uniform.
    pub(crate) fn balance(&mut self, turn: u64, share: f64) {
        self.balance.advance(self.arch, &mut self.tiles, turn, share);
        self.ahead = true;
    }

    /// The pulls of a step that was just taken, by coordinate.
    #[cfg(test)]
    pub(super) fn each_pull(&self, step: usize, mut visit: impl FnMut(usize, f32)) {
        let runs = &self.order[part(self.order.len(), step)];
        for (pulls, &run) in self.pulls.chunks_exact(self.dims).zip(runs) {
            let run = self.tiles.run(run as usize);
            for lane in run.lanes() {
                let first = self.tiles.sample(run, lane) * self.dims;
                pulls.iter().enumerate().for_each(|(dim, pull)| visit(first + dim, pull[lane]));
            }
        }
    }

    #[cfg(test)]
    pub(super) fn pull_of_run<'a>(&'a self, run: usize, pulls: &'a mut [Row]) -> PullOfRun<'a> {
        let Self { terms, factors, tiles, .. } = self;
        PullOfRun { terms, factors, tiles, run: tiles.run(run), pulls }
    }
}

/// The part of a list that a step of the sweep takes.
fn part(len: usize, step: usize) -> Range<usize> {
    len * step / STEPS..len * (step + 1) / STEPS
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
    fn add(&mut self, pulls: &Row, run: Run) {
        let mut squares = [0.0; LANES];
        for lane in run.lanes() {
            squares[lane] = pulls[lane] * pulls[lane];
            self.count += 1;
        }
        self.sum += f64::from(simd::sum(squares));
    }

    pub(crate) fn root(self) -> f64 {
        (self.sum / self.count.max(1) as f64).sqrt()
    }
}

/// Largest motion of all neighbours together, in units of what they see, that settles: at one sample per
/// pixel, from 1.3 on nothing did; at 0.6 tables of many samples are slower.
const COLLECTIVE: f64 = 1.0;

/// Runs per task: some ten microseconds.
const RUNS_PER_TASK: usize = 2;

/// The pull on one run, compiled once per instruction set.
pub(super) struct PullOfRun<'a> {
    terms: &'a [Pairs],
    factors: &'a [Vec<f32>],
    tiles: &'a Tiles,
    run: Run,
    pulls: &'a mut [Row],
}

impl NullaryFnOnce for PullOfRun<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { terms, factors, tiles, run, pulls } = self;
        pulls.fill([0.0; LANES]);
        for (pairs, factors) in terms.iter().zip(factors) {
            pairs.add_pull(tiles, run, factors, pulls);
        }
    }
}
