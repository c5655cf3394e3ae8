//! The optimiser: a table on its way, steps and runs.

mod budget;
mod record;
mod report;
mod run;

pub use self::report::{RunReport, SliceStep, StepReport};
use crate::classes::Demand;
use crate::config::{Config, Role, Until};
use crate::error::ConfigError;
use crate::objective::Objective;
use crate::slices::{Picked, Slices, Step};
use crate::sweeps::{self, MeanSquare, Sweeper};
use crate::table::SampleTable;

/// Optimises a table of white noise, or a given one.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let report = optimizer.run_observed(Until::Sweeps(8), |step| {
///     println!("{} of {}", step.step, step.steps);
///     ControlFlow::Continue(())
/// })?;
/// println!("{:.3} s", report.elapsed.as_secs_f64());
/// let table = optimizer.into_table();
/// # assert_eq!(table.dims(), 2);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
pub struct Optimizer {
    config: Config,
    objective: Objective,
    points: Vec<f32>,
    slices: Slices,
    steps: u64,
    /// Planned when it is first needed.
    sweeper: Option<Sweeper>,
    swept: u64,
}

impl std::fmt::Debug for Optimizer {
    /// What it is about; its buffers are large.
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { config, steps, swept, .. } = self;
        let mut fields = formatter.debug_struct("Optimizer");
        fields.field("config", config).field("steps", steps).field("swept", swept).finish_non_exhaustive()
    }
}

impl Config {
    /// Makes the table of this configuration, from white noise.
    ///
    /// An [`Optimizer`] says more: how the run went, and the metadata of the table.
    ///
    /// # Errors
    /// As [`Optimizer::new`] and [`Optimizer::run`].
    pub fn optimize(self, until: Until) -> Result<SampleTable, ConfigError> {
        let mut optimizer = Optimizer::new(self)?;
        optimizer.run(until)?;
        Ok(optimizer.into_table())
    }
}

impl Optimizer {
    /// Starts from white noise; samples whose target is a density or a cloud start from draws of it.
    ///
    /// # Errors
    /// Whatever [`Objective::new`] refuses, and descent parameters outside their ranges.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        let objective = Objective::new(&config)?;
        Self::with(config, objective)
    }

    /// Starts from white noise and optimises only what a renderer will consume: see
    /// [`Objective::for_demand`].
    ///
    /// Everything else keeps its bits. The cost is in proportion to the demand.
    ///
    /// # Errors
    /// Whatever [`Objective::for_demand`] refuses, and descent parameters outside their ranges.
    pub fn for_demand(config: Config, demand: &Demand) -> Result<Self, ConfigError> {
        let objective = Objective::for_demand(&config, demand)?;
        Self::with(config, objective)
    }

    fn with(config: Config, objective: Objective) -> Result<Self, ConfigError> {
        config.descent.validate()?;
        config.sweeps.validate()?;
        config.balance.validate()?;
        let mut points = crate::random::uniforms(config.seed, config.extent.samples() * config.dims);
        objective.place(&mut points);
        let slices = Slices::new(config.descent, points.len());
        Ok(Self { slices, steps: 0, sweeper: None, swept: 0, points, objective, config })
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
        self.slices = Slices::new(self.config.descent, self.points.len());
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

    /// The coordinates of all samples as they are now, in the order of a table.
    pub fn points(&self) -> &[f32] {
        &self.points
    }

    /// The table as it is now; a copy.
    pub fn table(&self) -> SampleTable {
        SampleTable::trusted(self.config.extent, self.config.dims, self.points.clone())
    }

    /// The table, without the optimiser around it.
    pub fn into_table(self) -> SampleTable {
        SampleTable::trusted(self.config.extent, self.config.dims, self.points)
    }

    /// Takes one step: descends with step size `rate`, then balances with `balance`.
    ///
    /// All slices see the table as it is before the step, but for balanced subsets of classes of 131,072
    /// samples or more in the mean, and for those of a step that hold more than a million samples together:
    /// they see what the others have made of it.
    ///
    /// For schedules of your own; [`Optimizer::run`] follows those of the configuration.
    pub fn step(&mut self, rate: f64, balance: f64) -> SliceStep {
        rayon::scope(|_| self.step_in_pool(rate, balance))
    }

    fn step_in_pool(&mut self, rate: f64, balance: f64) -> SliceStep {
        let picks = [Picked::Batch(Role::Descend), Picked::Batch(Role::Balance)];
        let (displacement, slices) = self.advance(self.steps, &picks, rate, balance);
        self.steps += 1;
        SliceStep { displacement, slices }
    }

    /// Moves the samples by the picked slices of a step.
    fn advance(&mut self, number: u64, picks: &[Picked], rate: f64, share: f64) -> (f64, u64) {
        let step = Step { seed: self.config.seed, number, picks, rate, share };
        if let Some(sweeper) = &mut self.sweeper {
            sweeper.outdate();
        }
        self.slices.step(&self.objective, &mut self.points, &step)
    }

    /// Sweeps once over all samples: each moves `rate` times (at most as far as settles, see
    /// [`Sweeps`](crate::config::Sweeps)) along the gradient of the objective over all slices at once
    /// ([`Objective::cramer`]). Half-way and at its end one slice of every class in the role of
    /// [`Role::Balance`] moves them `balance` of the way.
    ///
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
        self.fetch();
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
        sweeper.load(points);
        let pulls = sweeper.step(step, rate, domains);
        if (step + 1).is_multiple_of(sweeps::STEPS / balances()) {
            let turn = *swept * balances() as u64 + (step / (sweeps::STEPS / balances())) as u64;
            sweeper.balance(turn, balance);
            let slices = objective.terms.iter().any(|term| term.spec.role == Role::Balance && !objective.is_balanced_in_sweeps(term));
            if slices {
                sweeper.store(points);
                let turn = *swept * balances() as u64 + (step / (sweeps::STEPS / balances())) as u64;
                self.balance(turn, balance);
            }
        }
        Ok(pulls)
    }

    /// Brings the samples from the sweeps' copy.
    fn fetch(&mut self) {
        if let Some(sweeper) = &mut self.sweeper {
            sweeper.store(&mut self.points);
        }
    }

    /// Moves the samples `share` of the way along one slice of every class in the role of [`Role::Balance`].
    fn balance(&mut self, turn: u64, share: f64) {
        self.advance(turn, &[Picked::Each(Role::Balance)], 0.0, share);
    }

    /// Brings the balances within each other, of frames and of the whole table, to an agreement after the
    /// last sweep.
    fn settle(&mut self, sweeps: u64, share: f64) {
        let n = std::env::var("SETTLE").map_or(0, |v| v.parse().unwrap());
        for _ in 0..n { self.sweeper.as_mut().unwrap().balance(0, share); }
    }
}
fn balances() -> usize { std::env::var("BAL").map_or(2, |v| v.parse().unwrap()) }

/// Turns of the balance per sweep: with one alone, the bias is three times as large.
const BALANCES: usize = 2;

/// Turns of nested balances after the last sweep, at most as many as the sweeps had. 64×64×10, 200 slices and
/// 100 sweeps: they bring the bias from 0.34 to 0.19 and the filtered error from 0.1395 to 0.1407; 16 turns
/// bring 0.08 and 0.1412.
const SETTLING_TURNS: u64 = 8;
