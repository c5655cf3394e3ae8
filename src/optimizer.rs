//! The optimiser: a configuration, a table on its way, steps and runs.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::class::Form;
use crate::demand::Demand;
use crate::descent::{self, Descent, Schedule, Walker};
use crate::domain::Domain;
use crate::engine::Engine;
use crate::error::ConfigError;
use crate::kernel::{Kernel, SpatialKernel, TemporalKernel};
use crate::lattice::{Extent, MOST_DIMS};
use crate::objective::Objective;
use crate::pull::Pull;
use crate::table::SampleTable;
use crate::term::{DimensionGroup, Role, Slicing, Term};

/// Everything that determines a table, but for the length of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// Frames, height, width and samples per pixel.
    pub extent: Extent,
    /// Dimensions of a sample.
    pub dims: usize,
    /// Interval or torus, per dimension.
    pub domains: Vec<Domain>,
    /// What is optimised.
    pub terms: Vec<Term>,
    /// How slices are drawn.
    pub slicing: Slicing,
    /// How steps move the samples.
    pub descent: Descent,
    /// How far the terms in the role of [`Role::Balance`] move the samples towards their targets, over a run.
    pub balance: Schedule,
    /// Names every random number: the same seed gives the same bits.
    pub seed: u64,
}

impl Config {
    /// The defaults for a table of this extent: interval domains, the spatial Gaussian of the papers (`sigma_px =
    /// 2.1`), times the perceptual kernel at 60 frames per second if there are several frames, consecutive pairs of
    /// dimensions and all of them at half their weight, unbiased, barycentric steps.
    pub fn new(extent: Extent, dims: usize) -> Self {
        let temporal = match extent.frames {
            0 | 1 => TemporalKernel::None,
            _ => TemporalKernel::Perceptual { fps: 60.0 },
        };
        let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, temporal);
        let groups = DimensionGroup::pairs_and_whole(dims);
        Self {
            extent,
            dims,
            // More dimensions are refused when the configuration is used; a list of them might not fit the memory.
            domains: vec![Domain::Interval; dims.min(MOST_DIMS)],
            terms: Objective::blue_noise(&[kernel], Form::LevelSets, &groups, &extent),
            slicing: Slicing::default(),
            descent: Descent::default(),
            balance: Schedule::constant(1.0),
            seed: 0,
        }
    }
}

/// When a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Until {
    /// After this many slices per pixel and frame (rounded up to whole steps).
    SlicesPerClass(u64),
    /// After this many epochs, of `directions` slices per pixel and frame each.
    Epochs(u64),
    /// After about this many seconds. A brief calibration fixes the number of steps that fit, schedules follow that
    /// number, and [`RunReport::slices_per_class`] makes the very same table again, anywhere.
    Seconds(f64),
    /// As soon as the mean squared displacement falls by less than the share `improvement` from one window to the
    /// next, and at the latest after `at_most` slices per pixel and frame, the number that schedules follow.
    Converged {
        /// Least relative improvement worth going on for, in `[0, 1)`.
        improvement: f64,
        /// Length of a window, in steps.
        window_steps: u64,
        /// Slices per pixel and frame.
        at_most: u64,
    },
}

/// What a run tells its caller after each step.
#[derive(Clone, Copy, Debug)]
pub struct StepReport {
    /// Steps taken in this run.
    pub step: u64,
    /// Steps that the run is planned to take.
    pub steps: u64,
    /// Slices drawn in this run, over all terms.
    pub slices: u64,
    /// Root mean square distance along the slices between the samples and their targets, before the step. A noisy
    /// sign of progress; the objective itself is measured by [`crate::metrics::bound()`].
    pub displacement: f64,
    /// Step size.
    pub rate: f64,
    /// Time since the first step of the run.
    pub elapsed: Duration,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ended {
    /// All planned steps were taken.
    Finished,
    /// The rule of [`Until::Converged`] held.
    Converged,
    /// The caller's closure broke it off.
    Stopped,
}

/// What a run did.
#[derive(Clone, Copy, Debug)]
pub struct RunReport {
    /// Why it ended.
    pub ended: Ended,
    /// Steps taken.
    pub steps: u64,
    /// Slices drawn, over all terms.
    pub slices: u64,
    /// Slices per pixel and frame that the run was planned for. As [`Until::SlicesPerClass`] it gives the same steps.
    pub slices_per_class: u64,
    /// Time of the steps, without calibration.
    pub elapsed: Duration,
}

/// Optimises a table of white noise, or a given one.
pub struct Optimizer {
    config: Config,
    objective: Objective,
    points: Vec<f32>,
    walker: Walker,
    engine: Engine,
    pull: Pull,
    steps: u64,
}

impl Optimizer {
    /// Starts from white noise.
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
        config.balance.validate()?;
        let points = crate::stream::uniforms(config.seed, config.extent.samples() * config.dims);
        let coordinates = points.len();
        let pull = Pull { sums: vec![0.0; coordinates], hits: vec![0.0; coordinates], ..Pull::default() };
        Ok(Self {
            walker: Walker::new(config.descent, coordinates),
            engine: Engine::new(),
            steps: 0,
            pull,
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

    /// Goes on from this table instead of what was reached.
    ///
    /// # Errors
    /// A table whose shape is not that of the configuration.
    pub fn start_from(&mut self, table: SampleTable) -> Result<(), ConfigError> {
        self.objective.check_table(&table)?;
        self.points = table.into_values();
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
    /// For schedules of your own; [`Optimizer::run`] follows those of the configuration.
    pub fn step(&mut self, rate: f64, balance: f64) -> (f64, u64) {
        // On a thread of the pool from here on, instead of going there and back for each of the loops.
        rayon::scope(|_| self.step_in_pool(rate, balance))
    }

    fn step_in_pool(&mut self, rate: f64, balance: f64) -> (f64, u64) {
        let Self { engine, objective, config, steps, points, pull, walker } = self;
        let Config { domains, seed, .. } = config;
        engine.pull(objective, (*seed, *steps, Role::Descend), points, pull);
        let displacement = (pull.squares / pull.mass.max(f64::MIN_POSITIVE)).sqrt();
        let slices = pull.slices;
        walker.step(rate, domains, points, pull);
        engine.pull(objective, (*seed, *steps, Role::Balance), points, pull);
        if pull.slices > 0 {
            descent::project(balance, domains, points, pull);
        }
        *steps += 1;
        (displacement, slices + pull.slices)
    }

    /// Takes steps until `until`, or until `observe` breaks off. The table keeps what was reached.
    ///
    /// A run begins with fresh moments and at the start of the schedule; its slices go on where the last run's ended.
    ///
    /// # Errors
    /// A number of seconds or an improvement outside its range. Nothing is changed then.
    pub fn run(
        &mut self,
        until: Until,
        mut observe: impl FnMut(&StepReport) -> ControlFlow<()>,
    ) -> Result<RunReport, ConfigError> {
        let slices_per_class = self.plan(until)?;
        let steps = (slices_per_class as f64 / self.objective.slices_per_class_and_step()).ceil() as u64;
        self.walker = Walker::new(self.config.descent, self.points.len());
        let begin = Instant::now();
        let mut plateau = Plateau::default();
        let mut report = RunReport {
            ended: Ended::Finished,
            steps: 0,
            slices: 0,
            slices_per_class,
            elapsed: Duration::ZERO,
        };
        for step in 0..steps {
            let progress = step as f64 / steps as f64;
            let rate = self.config.descent.rate().at(progress);
            let (displacement, slices) = self.step(rate, self.config.balance.at(progress));
            report.steps += 1;
            report.slices += slices;
            let elapsed = begin.elapsed();
            let seen =
                StepReport { step: step + 1, steps, slices: report.slices, displacement, rate, elapsed };
            if observe(&seen).is_break() {
                report.ended = Ended::Stopped;
                break;
            }
            if let Until::Converged { improvement, window_steps, .. } = until
                && plateau.reached(displacement * displacement, improvement, window_steps)
            {
                report.ended = Ended::Converged;
                break;
            }
        }
        report.elapsed = begin.elapsed();
        // The buffers of a run are as large as its largest subset; nobody needs them until the next.
        self.engine = Engine::new();
        Ok(report)
    }

    /// Slices per pixel and frame that a run is planned for.
    fn plan(&mut self, until: Until) -> Result<u64, ConfigError> {
        let out_of_range = |name, value, expected| Err(ConfigError::OutOfRange { name, value, expected });
        match until {
            Until::SlicesPerClass(slices) => Ok(slices),
            Until::Epochs(epochs) => Ok(epochs.saturating_mul(self.config.slicing.directions as u64)),
            Until::Converged { improvement, .. } if !(0.0..1.0).contains(&improvement) => {
                out_of_range("the least improvement", improvement, "in [0, 1)")
            }
            Until::Converged { window_steps: 0, .. } => out_of_range("the window", 0.0, "of at least 1 step"),
            Until::Converged { at_most, .. } => Ok(at_most),
            Until::Seconds(seconds) if !(seconds > 0.0 && seconds <= 1e9) => {
                out_of_range("the number of seconds", seconds, "above 0, at most 1e9")
            }
            Until::Seconds(seconds) => {
                let steps = seconds / self.seconds_per_step();
                Ok((steps * self.objective.slices_per_class_and_step()).max(1.0) as u64)
            }
        }
    }

    /// Times a few steps that leave the table as it is.
    fn seconds_per_step(&mut self) -> f64 {
        const ENOUGH: Duration = Duration::from_millis(30);
        let steps = self.steps;
        // The first step grows the buffers and does not count.
        self.step(0.0, 0.0);
        let (begin, mut timed) = (Instant::now(), 0);
        while begin.elapsed() < ENOUGH {
            self.step(0.0, 0.0);
            timed += 1;
        }
        let mean = begin.elapsed().as_secs_f64() / f64::from(timed);
        self.steps = steps;
        mean
    }
}

/// Mean squared displacement of this and the last window.
#[derive(Default)]
struct Plateau {
    last: Option<f64>,
    sum: f64,
    steps: u64,
}

impl Plateau {
    fn reached(&mut self, squared: f64, improvement: f64, window: u64) -> bool {
        self.sum += squared;
        self.steps += 1;
        if self.steps < window {
            return false;
        }
        let mean = self.sum / window as f64;
        let stalled = self.last.is_some_and(|last| mean > last * (1.0 - improvement));
        *self = Self { last: Some(mean), sum: 0.0, steps: 0 };
        stalled
    }
}
