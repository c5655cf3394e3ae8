//! The optimiser: a table on its way, steps and runs.

mod budget;
mod checkpoint;
mod course;
mod frame;
mod plan;
mod record;
mod report;
mod resume;
mod run;

use std::ops::ControlFlow;
use std::sync::OnceLock;

pub use self::checkpoint::Checkpoint;
use self::checkpoint::Identity;
use self::course::Course;
pub use self::plan::Plan;
use self::record::Past;
pub use self::report::{RunReport, SliceStep, StepReport};
use crate::classes::Demand;
use crate::config::{Config, Role, Until, check_step};
pub use crate::error::CheckpointError;
use crate::error::ConfigError;
use crate::objective::Objective;
use crate::slices::{Picked, Slices, Step};
use crate::sweeps::{MeanSquare, Motion, Sweeper};
use crate::table::SampleTable;
use crate::table::extent::check_memory;

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
    /// Whether the points are still those that this optimiser began with.
    fresh: bool,
    past: Past,
    /// Whether a demand left something out.
    partial: bool,
    /// The run that goes on, and the points of the frame that it begins with, if it is there.
    resumed: Option<(Course, Option<Vec<f32>>)>,
    /// Found when it is first needed.
    identity: OnceLock<Identity>,
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

/// Bytes that any run takes for each of the table's, at the least.
const ROOM: usize = 4;

/// Refuses a table that is too large for this machine's memory before anything is made of it.
fn check_room(config: &Config) -> Result<(), ConfigError> {
    let Config { extent, dims, .. } = *config;
    extent.validate(dims)?;
    let table = size_of::<f32>() * extent.samples() * dims;
    Ok(check_memory("optimising the table", ROOM.saturating_mul(table))?)
}

impl Optimizer {
    /// Starts from white noise; samples whose target is a density or a cloud start from draws of it.
    ///
    /// # Errors
    /// Whatever [`Objective::new`] refuses, descent parameters outside their ranges, and a table of which
    /// memory does not hold what a run takes.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        check_room(&config)?;
        let objective = Objective::new(&config)?;
        Self::with(config, objective)
    }

    /// The same, telling the share of the planning that is done: see [`Objective::new_observed`].
    ///
    /// # Errors
    /// As [`Optimizer::new`]; [`ConfigError::Stopped`] if `observe` breaks off.
    pub fn new_observed(
        config: Config,
        observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ConfigError> {
        let objective = Objective::new_observed(&config, observe)?;
        Self::with(config, objective)
    }

    /// Starts from white noise and optimises only what a renderer will consume: see
    /// [`Objective::for_demand`].
    ///
    /// Everything else keeps its bits. The less is demanded, the less it costs: docs/results.md says how
    /// much.
    ///
    /// # Errors
    /// Whatever [`Objective::for_demand`] refuses, and descent parameters outside their ranges.
    pub fn for_demand(config: Config, demand: &Demand) -> Result<Self, ConfigError> {
        Self::for_demand_observed(config, demand, |_| ControlFlow::Continue(()))
    }

    /// The same, telling the share of the planning that is done: see [`Objective::new_observed`].
    ///
    /// # Errors
    /// As [`Optimizer::for_demand`]; [`ConfigError::Stopped`] if `observe` breaks off.
    pub fn for_demand_observed(
        config: Config,
        demand: &Demand,
        observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ConfigError> {
        check_room(&config)?;
        let objective = Objective::for_demand_observed(&config, demand, observe)?;
        let partial = !objective.is_whole(&config);
        Ok(Self { partial, ..Self::with(config, objective)? })
    }

    fn with(config: Config, objective: Objective) -> Result<Self, ConfigError> {
        config.descent.validate()?;
        config.sweeps.validate()?;
        config.balance.validate()?;
        let mut points = crate::random::uniforms(config.seed, config.extent.samples() * config.dims);
        objective.place(&mut points);
        let slices = Slices::new(config.descent, points.len());
        Ok(Self {
            slices,
            steps: 0,
            sweeper: None,
            swept: 0,
            fresh: true,
            past: Past::Nothing,
            partial: false,
            resumed: None,
            identity: OnceLock::new(),
            points,
            objective,
            config,
        })
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
    ///
    /// # Errors
    /// A `rate` or a `balance` outside of `0..=1e6` ([`ConfigError::Range`]). Nothing is changed then.
    pub fn step(&mut self, rate: f64, balance: f64) -> Result<SliceStep, ConfigError> {
        check_step(rate, balance)?;
        (self.resumed, self.past) = (None, Past::Other);
        Ok(rayon::scope(|_| self.step_in_pool(rate, balance)))
    }

    fn step_in_pool(&mut self, rate: f64, balance: f64) -> SliceStep {
        let picks = [Picked::Batch(Role::Descend), Picked::Batch(Role::Balance)];
        let (displacement, slices) = self.advance(self.steps, &picks, rate, balance);
        self.steps = self.steps.wrapping_add(1);
        SliceStep { displacement, slices }
    }

    /// Moves the samples by the picked slices of a step.
    fn advance(&mut self, number: u64, picks: &[Picked], rate: f64, share: f64) -> (f64, u64) {
        let step = Step { seed: self.config.seed, number, picks, rate, share };
        if let Some(sweeper) = &mut self.sweeper {
            sweeper.outdate();
        }
        self.fresh = false;
        self.slices.step(&self.objective, &mut self.points, &step)
    }

    /// Sweeps once over all samples: each moves `rate` times (at most as far as settles, see
    /// [`Sweeps`](crate::config::Sweeps)) along the gradient of the objective over all slices at once
    /// ([`Objective::cramer`]). At its end, and half-way where there are many samples, what is balanced moves
    /// `balance` of the way: the whole table and its frames along a line or by their low frequencies, single
    /// coordinates by their distribution function, other classes in the role of [`Role::Balance`] along one
    /// slice each.
    ///
    /// Returns the root mean square pull on a coordinate.
    ///
    /// # Errors
    /// A `rate` or a `balance` outside of `0..=1e6` ([`ConfigError::Range`]); a descended term that has no
    /// closed form ([`ConfigError::NotInClosedForm`]). Nothing is changed then.
    pub fn sweep(&mut self, rate: f64, balance: f64) -> Result<f64, ConfigError> {
        check_step(rate, balance)?;
        (self.resumed, self.past) = (None, Past::Other);
        rayon::scope(|_| self.sweep_in_pool(rate, balance))
    }

    fn sweep_in_pool(&mut self, rate: f64, balance: f64) -> Result<f64, ConfigError> {
        let mut pulls = MeanSquare::default();
        for step in 0..self.sweeper()?.steps() {
            pulls += self.sweep_step(step, Motion { rate, softening: 0.0, balance })?;
        }
        self.fetch();
        Ok(pulls.root())
    }

    /// The sweeps of the objective, planned.
    fn sweeper(&mut self) -> Result<&mut Sweeper, ConfigError> {
        match &mut self.sweeper {
            Some(sweeper) => Ok(sweeper),
            none => Ok(none.insert(Sweeper::new(&self.objective, &self.config.sweeps)?)),
        }
    }

    /// One step of a sweep. Returns what it pulled.
    fn sweep_step(&mut self, step: usize, motion: Motion) -> Result<MeanSquare, ConfigError> {
        let (seed, sweep) = (self.config.seed, self.swept);
        self.sweeper()?;
        let Self { sweeper: Some(sweeper), points, config, .. } = self else {
            unreachable!("it was planned")
        };
        if step == 0 {
            sweeper.shuffle(seed, sweep);
            // Also one that is broken off is not repeated.
            self.swept += 1;
        }
        sweeper.load(points);
        let pulls = sweeper.step(step, motion, &config.domains);
        let is_last = step + 1 == sweeper.steps();
        self.fresh = false;
        if is_last && self.objective.has_balances_beside_sweeps() {
            self.fetch();
            self.balance_by_slices(self.swept, motion.balance);
        }
        Ok(pulls)
    }

    /// Moves the samples `share` of the way along one slice of every class that sweeps do not balance by
    /// themselves.
    fn balance_by_slices(&mut self, turn: u64, share: f64) {
        self.advance(turn, &[Picked::Each(Role::Balance)], 0.0, share);
    }

    /// Brings the samples from the sweeps' copy.
    fn fetch(&mut self) {
        if let Some(sweeper) = &mut self.sweeper {
            sweeper.store(&mut self.points);
        }
    }

    /// Brings marginals `share` of the way to exact ones, which sweeps have come close to.
    fn settle(&mut self, share: f64) {
        self.fetch();
        let Self { sweeper: Some(sweeper), objective, points, config, .. } = self else { return };
        let spp = config.extent.spp;
        let is_wanted = |&sample: &u32| objective.wanted.site(sample as usize / spp);
        let samples: Vec<u32> = (0..config.extent.samples() as u32).filter(is_wanted).collect();
        sweeper.settle(points, &samples, share);
        sweeper.outdate();
    }
}
