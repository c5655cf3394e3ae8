//! What a run tells its caller on the way and at its end.

use std::time::Duration;

use crate::config::until::{EndReason, Work};

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
    /// by [`crate::metrics::Bound`].
    pub displacement: f64,
    /// Step size.
    pub rate: f64,
    /// Time since the first step of the run.
    pub elapsed: Duration,
}

/// What a run did.
#[derive(Clone, Copy, Debug)]
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
