//! Runs: how long they are, what they tell on the way, how they ended.

use std::time::Duration;

use serde::{Deserialize, Serialize};

/// When a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Until {
    /// After this many slices per pixel and frame, or per class of a point set (rounded up to whole steps).
    SlicesPerClass(u64),
    /// After this many epochs, of `directions` slices per pixel and frame each.
    Epochs(u64),
    /// After this many sweeps.
    Sweeps(u64),
    /// Slices first, then sweeps.
    Work(Work),
    /// After about this many seconds, in the sequence that gets furthest by then: sweeps where the objective has its
    /// closed form, after slices if there is time for both; slices elsewhere. A brief calibration fixes how much work fits,
    /// schedules follow it, and [`RunReport::work`] makes the very same table again, anywhere.
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

/// An amount of work: slices come first, then sweeps.
///
/// Slices hold any class and target, and reach the lower bound; sweeps ([`Optimizer::sweep`](crate::Optimizer::sweep))
/// take the whole of the objective's directions into account at once, and are the sooner at a low error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Slices per pixel and frame (rounded up to whole steps).
    pub slices_per_class: u64,
    /// Sweeps over all samples.
    pub sweeps: u64,
}

/// What a run tells its caller after each step: a batch of slices, or a sixteenth of a sweep.
#[derive(Clone, Copy, Debug)]
pub struct StepReport {
    /// Steps taken in this run.
    pub step: u64,
    /// Steps that the run is planned to take.
    pub steps: u64,
    /// Slices drawn in this run, over all terms.
    pub slices: u64,
    /// Root mean square distance along the slices between the samples and their targets, before the step; during sweeps
    /// the root mean square of the pull on a coordinate. A noisy sign of progress; the objective itself is measured
    /// by [`crate::metrics::bound()`].
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
    /// What the run was planned for. As [`Until::Work`] it gives the same steps.
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
