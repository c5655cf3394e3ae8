//! What a run tells its caller on the way and at its end.

use std::sync::OnceLock;
use std::time::Duration;

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

    fn points(&self) -> Vec<f32> {
        let mut points = self.current.points.to_vec();
        if let Some(sweeper) = self.current.sweeper {
            sweeper.write_to(&mut points);
        }
        let Config { extent, dims, .. } = *self.current.config;
        // The frame that an animation begins with stands for all of them.
        if points.len() < extent.samples() * dims { displaced(extent, &points) } else { points }
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

/// Mean squared displacement of this and the last window.
#[derive(Default)]
pub(crate) struct Plateau {
    last: Option<f64>,
    sum: f64,
    steps: u64,
}

impl Plateau {
    pub(crate) fn reached(&mut self, squared: f64, improvement: f64, window: u64) -> bool {
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
