//! What a run tells its caller on the way and at its end.

use std::sync::OnceLock;
use std::time::Duration;

use super::checkpoint::{Checkpoint, Identity, Place};
use super::course::Course;
use super::frame::displaced;

use crate::config::{Config, EndReason, Role, Work};
use crate::objective::{Objective, Slice};
use crate::sweeps::Sweeper;
use crate::table::SampleTable;

/// What a step of slices did: see [`Optimizer::step`](crate::Optimizer::step).
///
/// ```
/// use fsot::{Config, Extent, Optimizer};
///
/// // A schedule of one's own.
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let steps = (0..64).map(|step| optimizer.step(0.95_f64.powi(step), 1.0));
/// let steps = steps.collect::<Result<Vec<_>, _>>()?;
/// let mean = |steps: &[fsot::optimizer::SliceStep]| -> f64 {
///     steps.iter().map(|step| step.displacement).sum::<f64>() / steps.len() as f64
/// };
/// assert!(mean(&steps[48..]) < mean(&steps[..16]));
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SliceStep {
    /// Root mean square distance along the descended slices between the samples and their targets, before the
    /// step.
    pub displacement: f64,
    /// Slices drawn, over all terms.
    pub slices: u64,
}

/// What a run tells its caller after each step: a batch of slices, a part of a sweep, from a sixteenth to a
/// 64th, or a whole sweep of the frame that an animation begins with.
///
/// Its fields cost nothing; [`StepReport::table`] and [`StepReport::loss`] are computed when they are asked
/// for.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let mut losses = Vec::new();
/// optimizer.run_observed(Until::SlicesPerClass(64), |step| {
///     losses.push(step.loss());
///     ControlFlow::Continue(())
/// })?;
/// assert!(losses.last() < losses.first());
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct StepReport<'a> {
    /// Steps taken in this run.
    pub step: u64,
    /// Steps that the run is planned to take.
    pub steps: u64,
    /// Slices drawn in this run, over all terms.
    pub slices: u64,
    /// Root mean square distance along the slices between the samples and their targets, before the step;
    /// during sweeps the root mean square of the pull on a coordinate. A noisy sign of progress.
    pub displacement: f64,
    /// Step size.
    pub rate: f64,
    /// Time since the first step of the run.
    pub elapsed: Duration,
    pub(super) current: Current<'a>,
}

/// What a run has in hand after a step.
#[derive(Clone, Copy)]
pub(super) struct Current<'a> {
    pub config: &'a Config,
    pub objective: &'a Objective,
    pub points: &'a [f32],
    /// Ahead of the points between two balances.
    pub sweeper: Option<&'a Sweeper>,
    /// What the loss is estimated on: drawn once a run.
    pub loss_slices: &'a OnceLock<Vec<Slice>>,
    pub course: &'a Course,
    /// Where slices, sweeps and moments are.
    pub place: Place<'a>,
    pub identity: &'a OnceLock<Identity>,
}

impl std::fmt::Debug for Current<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Current")
    }
}

/// Slices that the running loss is a mean over, at most.
const LOSS_SLICES: usize = 1024;

impl StepReport<'_> {
    /// The table as it is after the step; a copy.
    pub fn table(&self) -> SampleTable {
        let Config { extent, dims, .. } = *self.current.config;
        SampleTable::trusted(extent, dims, self.points())
    }

    /// A running estimate of the objective: the mean of `(n / N) W2²` over at most 1,024 slices, always the
    /// same ones of a run, so that what differs from step to step is the table.
    ///
    /// Takes a millisecond or so; [`metrics::Bound`](crate::metrics::Bound) measures with error bars and
    /// beside white noise.
    pub fn loss(&self) -> f64 {
        let Current { config, objective, loss_slices, .. } = self.current;
        let slices = loss_slices.get_or_init(|| {
            // Others than those of the steps: a seed of their own.
            let all = objective.draw(!config.seed, 0, Role::Descend);
            let stride = all.len().div_ceil(LOSS_SLICES).max(1);
            all.into_iter().step_by(stride).collect()
        });
        objective.value(&self.points(), slices)
    }

    /// All that the rest of the run depends on, as it is after the step; a copy. Who
    /// [resumes](crate::Optimizer::resume) it ends with the same bits as this run.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use fsot::optimizer::Checkpoint;
    /// use fsot::{Config, Extent, Optimizer, Until};
    ///
    /// let config = Config::new(Extent::still(16, 16), 2);
    /// let mut file = Vec::new();
    /// let mut killed = Optimizer::new(config.clone())?;
    /// killed.run_observed(Until::Sweeps(8), |step| {
    ///     if step.step != 40 {
    ///         return ControlFlow::Continue(());
    ///     }
    ///     step.checkpoint().write(&mut file).expect("memory takes everything");
    ///     ControlFlow::Break(())
    /// })?;
    ///
    /// let checkpoint = Checkpoint::read(&mut file.as_slice())?;
    /// let mut resumed = Optimizer::new(checkpoint.config()?)?;
    /// resumed.resume(checkpoint)?;
    /// resumed.finish()?;
    /// assert_eq!(resumed.into_table(), config.optimize(Until::Sweeps(8))?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn checkpoint(&self) -> Checkpoint {
        let Current { config, objective, course, place, identity, .. } = self.current;
        let course = Course { spent: self.elapsed, ..course.clone() };
        let identity = identity.get_or_init(|| Identity::new(config, objective));
        Checkpoint::new(config, identity, Some(course), place, self.swept())
    }

    fn points(&self) -> Vec<f32> {
        let points = self.swept();
        let Config { extent, dims, .. } = *self.current.config;
        // The frame that an animation begins with stands for all of them.
        if points.len() < extent.samples() * dims { displaced(extent, &points) } else { points }
    }

    /// The points that are optimised: of all frames, or of the one that an animation begins with.
    fn swept(&self) -> Vec<f32> {
        let mut points = self.current.points.to_vec();
        if let Some(sweeper) = self.current.sweeper {
            sweeper.write_to(&mut points);
        }
        points
    }
}

/// What a run did.
///
/// ```
/// use fsot::config::EndReason;
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let report = optimizer.run(Until::Sweeps(2))?;
/// assert_eq!((report.ended, report.work.sweeps), (EndReason::Finished, 2));
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct RunReport {
    /// Why it ended.
    pub ended: EndReason,
    /// Steps taken.
    pub steps: u64,
    /// Slices drawn, over all terms.
    pub slices: u64,
    /// What the run was planned for. As [`Until::Work`](crate::Until::Work) it gives the same steps.
    pub work: Work,
    /// Time of the steps, without calibration.
    pub elapsed: Duration,
}
