//! The optimiser: a table on its way, steps and runs.

pub(crate) mod report;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::classes::demand::Demand;
use crate::config::Config;
use crate::config::term::Role;
use crate::config::until::{EndReason, Until, Work};
use crate::error::ConfigError;
use crate::objective::Objective;
use crate::optimizer::report::{Plateau, RunReport, StepReport};
use crate::slices::Engine;
use crate::slices::draw::Pick;
use crate::slices::part::Part;
use crate::slices::pull::Pull;
use crate::slices::walk::{self, Walker};
use crate::sweeps::{self, MeanSquare, Sweeper};
use crate::table::SampleTable;

/// Optimises a table of white noise, or a given one.
pub struct Optimizer {
    config: Config,
    objective: Objective,
    points: Vec<f32>,
    walker: Walker,
    engine: Engine,
    pull: Pull,
    steps: u64,
    /// Planned when it is first needed.
    sweeper: Option<Sweeper>,
    swept: u64,
}

impl Optimizer {
    /// Starts from white noise; samples whose target is a density or a cloud start from draws of it.
    ///
    /// # Errors
    /// Whatever [`Objective::new`] refuses, and descent parameters outside their ranges.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        let objective =
            Objective::new(config.extent, config.dims, &config.domains, &config.terms, &config.slicing)?;
        Self::with(config, objective)
    }

    /// Starts from white noise and optimises only what a renderer will consume: see [`Objective::for_demand`].
    ///
    /// Everything else keeps its bits. The cost is in proportion to the demand.
    ///
    /// # Errors
    /// Whatever [`Objective::for_demand`] refuses, and descent parameters outside their ranges.
    pub fn for_demand(config: Config, demand: &Demand) -> Result<Self, ConfigError> {
        let Config { extent, dims, domains, terms, slicing, .. } = &config;
        let objective = Objective::for_demand(*extent, *dims, domains, terms, slicing, demand)?;
        Self::with(config, objective)
    }

    fn with(config: Config, objective: Objective) -> Result<Self, ConfigError> {
        config.descent.validate()?;
        config.sweeps.validate()?;
        config.balance.validate()?;
        let mut points = crate::random::uniforms(config.seed, config.extent.samples() * config.dims);
        objective.place(&mut points);
        let coordinates = points.len();
        Ok(Self {
            walker: Walker::new(config.descent, coordinates),
            engine: Engine::new(),
            steps: 0,
            sweeper: None,
            swept: 0,
            pull: Pull::default(),
            points,
            objective,
            config,
        })
    }

    /// Starts from a table, as made by an earlier run.
    ///
    /// # Errors
    /// As [`Optimizer::new`]; a table whose shape is not that of the configuration.
    pub fn from_table(config: Config, table: SampleTable) -> Result<Self, ConfigError> {
        let mut optimizer = Self::new(config)?;
        optimizer.start_from(table)?;
        Ok(optimizer)
    }

    /// Goes on from this table instead of what was reached, with fresh moments.
    ///
    /// # Errors
    /// A table whose shape is not that of the configuration.
    pub fn start_from(&mut self, table: SampleTable) -> Result<(), ConfigError> {
        self.objective.check_table(&table)?;
        self.points = table.into_values();
        self.walker = Walker::new(self.config.descent, self.points.len());
        self.sweeper = None;
        Ok(())
    }

    /// The configuration.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The planned objective.
    pub fn objective(&self) -> &Objective {
        &self.objective
    }

    /// The table as it is now; a copy.
    pub fn table(&self) -> SampleTable {
        SampleTable::trusted(self.config.extent, self.config.dims, self.points.clone())
    }

    /// The table, without the optimiser around it.
    pub fn into_table(self) -> SampleTable {
        SampleTable::trusted(self.config.extent, self.config.dims, self.points)
    }

    /// Takes one step: descends with step size `rate`, then balances with `balance`. Returns the root mean square
    /// displacement before it along the descended slices, and the number of slices drawn.
    ///
    /// All slices see the table as it is before the step, but for balanced subsets of classes of 131,072 samples or more in the
    /// mean, and for those of a step that hold more than a million samples together: they see what the others have made of it.
    ///
    /// For schedules of your own; [`Optimizer::run`] follows those of the configuration.
    pub fn step(&mut self, rate: f64, balance: f64) -> (f64, u64) {
        rayon::scope(|_| self.step_in_pool(rate, balance))
    }

    fn step_in_pool(&mut self, rate: f64, balance: f64) -> (f64, u64) {
        self.advance(self.steps, &[Pick::Batch(Role::Descend), Pick::Batch(Role::Balance)], rate, balance);
        self.steps += 1;
        let Pull { slices, squares, mass, .. } = self.pull;
        ((squares / mass.max(f64::MIN_POSITIVE)).sqrt(), slices)
    }

    /// Moves the samples by the picked slices of a step: first those that descend with step size `rate`, then those
    /// that balance, `share` of the way. All see the table as it is before, so that threads meet twice only; but where those
    /// that balance are very many, or very large, the later ones see what the others have made of it.
    fn advance(&mut self, step: u64, picks: &[Pick], rate: f64, share: f64) {
        let Self { engine, objective, config, points, pull, walker, .. } = self;
        let Config { domains, seed, dims, .. } = config;
        let (dims, samples) = (*dims, points.len() / *dims);
        pull.grow(points.len());
        engine.transport(objective, (*seed, step, picks), points, pull);
        let walk = picks.iter().any(|pick| pick.role() == Role::Descend).then(|| walker.step(rate));
        let Pull { sums, hits, .. } = &mut *pull;
        let moments = walker.moments();
        let table = Part { first: 0, dims, points, sums, hits, moments };
        table.for_each(engine.samples_per_part(samples), &|mut part| {
            if let Some(walk) = walk {
                engine.add_up(objective, Role::Descend, &mut part);
                walk.advance(domains, &mut part);
            }
            if engine.waits(Role::Balance) {
                engine.add_up(objective, Role::Balance, &mut part);
                walk::project(share, domains, &mut part);
            }
        });
        while engine.transport_rest(objective, (*seed, step), points, pull) {
            let table = Part { points, ..pull.part(dims) };
            table.for_each(engine.samples_per_part(samples), &|mut part| {
                engine.add_up(objective, Role::Balance, &mut part);
                walk::project(share, domains, &mut part);
            });
        }
        if engine.pull_of_large(objective, (*seed, step, Role::Balance), points, pull) {
            let table = Part { points, ..pull.part(dims) };
            table.for_each(engine.samples_per_part(samples), &|mut part| {
                walk::project(share, domains, &mut part);
            });
        }
    }

    /// Sweeps once over all samples: each moves `rate` times (at most as far as settles, see [`Sweeps`](crate::config::Sweeps)) along the gradient of
    /// the objective over all slices at once ([`Objective::cramer`]). Half-way and at its end one slice of every class in the role of [`Role::Balance`] moves them
    /// `balance` of the way.
    /// Returns the root mean square pull on a coordinate.
    ///
    /// # Errors
    /// A descended term that has no closed form ([`ConfigError::NotInClosedForm`]).
    pub fn sweep(&mut self, rate: f64, balance: f64) -> Result<f64, ConfigError> {
        rayon::scope(|_| self.sweep_in_pool(rate, balance))
    }

    fn sweep_in_pool(&mut self, rate: f64, balance: f64) -> Result<f64, ConfigError> {
        let mut pulls = MeanSquare::default();
        for step in 0..sweeps::STEPS {
            pulls += self.sweep_step(step, rate, balance)?;
        }
        Ok(pulls.root())
    }

    /// One step of a sweep. Returns what it pulled.
    fn sweep_step(&mut self, step: usize, rate: f64, balance: f64) -> Result<MeanSquare, ConfigError> {
        let Self { objective, config, points, sweeper, swept, .. } = self;
        let Config { domains, seed, sweeps, .. } = config;
        let sweeper = match sweeper {
            Some(sweeper) => sweeper,
            none => none.insert(Sweeper::new(objective, sweeps)?),
        };
        if step == 0 {
            sweeper.shuffle(*seed, *swept);
            // Also one that is broken off is not repeated.
            *swept += 1;
        }
        if step.is_multiple_of(sweeps::STEPS / BALANCES) {
            // What has moved the table since: a balance, slices, a caller.
            sweeper.load(points);
        }
        let pulls = sweeper.step(step, rate, domains);
        if (step + 1).is_multiple_of(sweeps::STEPS / BALANCES) {
            sweeper.store(points);
            let turn = *swept * BALANCES as u64 + (step / (sweeps::STEPS / BALANCES)) as u64;
            self.balance(turn, balance);
        }
        Ok(pulls)
    }

    /// Moves the samples `share` of the way along one slice of every class in the role of [`Role::Balance`].
    fn balance(&mut self, turn: u64, share: f64) {
        self.advance(turn, &[Pick::Each(Role::Balance)], 0.0, share);
    }

    /// Brings the balances within each other, of frames and of the whole table, to an agreement after the last sweep.
    fn settle(&mut self, sweeps: u64, share: f64) {
        if self.objective.balances_are_nested() {
            for turn in 0..SETTLING_TURNS.min(sweeps.saturating_mul(BALANCES as u64)) {
                self.balance((self.swept + 1) * BALANCES as u64 + turn, share);
            }
        }
    }

    /// Takes steps until `until`, or until `observe` breaks off. The table keeps what was reached.
    ///
    /// A run begins with fresh moments and at the start of the schedules; its slices and sweeps go on where the last
    /// run's ended.
    ///
    /// # Errors
    /// A number of seconds or an improvement outside its range; sweeps of an objective that has no closed form. Nothing is
    /// changed then.
    pub fn run(
        &mut self,
        until: Until,
        observe: impl FnMut(&StepReport) -> ControlFlow<()> + Send,
    ) -> Result<RunReport, ConfigError> {
        // On a thread of the pool from here on, instead of going there and back for each step.
        rayon::scope(|_| self.run_in_pool(until, observe))
    }

    fn run_in_pool(
        &mut self,
        until: Until,
        mut observe: impl FnMut(&StepReport) -> ControlFlow<()>,
    ) -> Result<RunReport, ConfigError> {
        // A closure that panicked in an earlier run may have left one behind.
        self.sweeper = None;
        let work = self.plan(until)?;
        let per_step = self.objective.slices_per_class_and_step();
        let batches = (work.slices_per_class as f64 / per_step).ceil() as u64;
        let steps = batches.saturating_add(work.sweeps.saturating_mul(sweeps::STEPS as u64));
        self.walker = Walker::new(self.config.descent, self.points.len());
        let begin = Instant::now();
        let mut plateau = Plateau::default();
        let mut report =
            RunReport { ended: EndReason::Finished, steps: 0, slices: 0, work, elapsed: Duration::ZERO };
        for step in 0..steps {
            let (displacement, rate) = if step < batches {
                let progress = step as f64 / batches as f64;
                let rate = self.config.descent.rate().at(progress);
                let (displacement, slices) = self.step_in_pool(rate, self.config.balance.at(progress));
                report.slices += slices;
                (displacement, rate)
            } else {
                if step == batches {
                    // Sweeps need the room that batches have taken for themselves.
                    self.engine = Engine::new();
                }
                let progress = (step - batches) as f64 / (steps - batches) as f64;
                let rate = self.config.sweeps.of_a_run(work).at(progress);
                let part = (step - batches) as usize % sweeps::STEPS;
                (self.sweep_step(part, rate, self.config.balance.at(progress))?.root(), rate)
            };
            report.steps += 1;
            let elapsed = begin.elapsed();
            let seen =
                StepReport { step: step + 1, steps, slices: report.slices, displacement, rate, elapsed };
            if observe(&seen).is_break() {
                report.ended = EndReason::Stopped;
                break;
            }
            if let Until::Converged { improvement, window_steps, .. } = until
                && plateau.reached(displacement * displacement, improvement, window_steps)
            {
                report.ended = EndReason::Converged;
                break;
            }
        }
        if work.sweeps > 0 && report.ended == EndReason::Finished {
            self.settle(work.sweeps, self.config.balance.at(1.0));
        }
        if let Some(sweeper) = &mut self.sweeper {
            // A run may be broken off between two balances.
            sweeper.store(&mut self.points);
        }
        report.elapsed = begin.elapsed();
        // Buffers are as large as the largest subset, and copies of the table; nobody needs them until the next run.
        self.engine = Engine::new();
        self.pull = Pull::default();
        self.sweeper = None;
        Ok(report)
    }

    /// The work of a run.
    fn plan(&mut self, until: Until) -> Result<Work, ConfigError> {
        let out_of_range = |name, value, expected| Err(ConfigError::OutOfRange { name, value, expected });
        let slices = |slices_per_class| Work { slices_per_class, sweeps: 0 };
        let work = match until {
            Until::SlicesPerClass(slices_per_class) => slices(slices_per_class),
            Until::Epochs(epochs) => slices(epochs.saturating_mul(self.config.slicing.directions as u64)),
            Until::Sweeps(sweeps) => Work { slices_per_class: 0, sweeps },
            Until::Work(work) => work,
            Until::Converged { improvement, .. } if !(0.0..1.0).contains(&improvement) => {
                return out_of_range("the least improvement", improvement, "in [0, 1)");
            }
            Until::Converged { window_steps: 0, .. } => {
                return out_of_range("the window", 0.0, "of at least 1 step");
            }
            Until::Converged { at_most, .. } => slices(at_most),
            Until::Seconds(seconds) if !(seconds > 0.0 && seconds <= 1e9) => {
                return out_of_range("the number of seconds", seconds, "above 0, at most 1e9");
            }
            Until::Seconds(seconds) => self.fit(seconds)?,
        };
        if work.sweeps > 0 {
            sweeps::check(&self.objective)?;
        }
        Ok(work)
    }

    /// The work that fits into a time: all of it sweeps, unless half of it is enough for a good number of slices.
    fn fit(&mut self, seconds: f64) -> Result<Work, ConfigError> {
        let per_step = self.objective.slices_per_class_and_step();
        if sweeps::check(&self.objective).is_err() {
            let slices = seconds / self.seconds_per_batch() * per_step;
            return Ok(Work { slices_per_class: slices.max(1.0) as u64, sweeps: 0 });
        }
        let seconds_per_sweep = self.seconds_per_sweep()?;
        let slices = 0.5 * seconds / self.seconds_per_batch() * per_step;
        let (slices, share) = if slices >= ENOUGH_SLICES { (slices as u64, 0.5) } else { (0, 1.0) };
        let sweeps = (share * seconds / seconds_per_sweep).max(1.0) as u64;
        Ok(Work { slices_per_class: slices, sweeps })
    }

    /// Times a few steps that leave the table as it is.
    fn seconds_per_batch(&mut self) -> f64 {
        let steps = self.steps;
        // The first step grows the buffers and does not count.
        self.step_in_pool(0.0, 0.0);
        let seconds = mean_seconds(|| {
            self.step_in_pool(0.0, 0.0);
        });
        self.steps = steps;
        seconds
    }

    /// Times a few sweeps that leave the table as it is.
    fn seconds_per_sweep(&mut self) -> Result<f64, ConfigError> {
        let swept = self.swept;
        self.sweep_step(0, 0.0, 0.0)?;
        let mut outcome = Ok(0.0);
        let seconds = mean_seconds(|| outcome = self.sweep_in_pool(0.0, 0.0));
        self.swept = swept;
        self.sweeper = None;
        outcome.map(|_| seconds)
    }
}

/// Turns of the balance per sweep: with one alone, the bias is three times as large.
const BALANCES: usize = 2;

/// Turns of nested balances after the last sweep, at most as many as the sweeps had. 64×64×10, 200 slices and 100 sweeps: they bring the bias from 0.34 to 0.19 and
/// the filtered error from 0.1395 to 0.1407; 16 turns bring 0.08 and 0.1412.
const SETTLING_TURNS: u64 = 8;

/// Slices per pixel and frame from which on it is worth beginning with them.
const ENOUGH_SLICES: f64 = 64.0;

/// Mean time of a call, over as many as make a reliable figure: the median of three windows, since other work may share
/// the machine.
fn mean_seconds(mut call: impl FnMut()) -> f64 {
    const WINDOW: Duration = Duration::from_millis(8);
    let mut means = Vec::with_capacity(3);
    while means.len() < 3 {
        let (begin, mut timed) = (Instant::now(), 0);
        while begin.elapsed() < WINDOW {
            call();
            timed += 1;
        }
        means.push(begin.elapsed().as_secs_f64() / f64::from(timed));
        if means[0] > 0.1 {
            break; // long enough not to be disturbed
        }
    }
    means.sort_unstable_by(f64::total_cmp);
    means[means.len() / 2]
}
