//! The course of a run: how much of which work is done.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::config::{Until, Work};

/// Most slices per class, and sweeps, of a run.
pub(super) const MOST_COUNT: u64 = 1_000_000_000;
/// More steps, sweeps or slices than anybody takes; there is room above to count on.
pub(super) const MOST_COUNTED: u64 = 1 << 56;
/// Some thirty thousand years.
const LONGEST: Duration = Duration::from_secs(1_000_000_000_000);

/// A run on its way.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Course {
    /// What it was planned for.
    pub work: Work,
    /// Steps taken: sweeps of the frame that an animation begins with, batches of slices, and parts of
    /// sweeps.
    pub step: u64,
    /// Slices drawn.
    pub slices: u64,
    /// Time of these steps.
    pub spent: Duration,
    /// What ends it earlier.
    pub plateau: Option<Plateau>,
}

/// Mean squared displacement of this and the last window: see [`Until::Converged`].
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Plateau {
    improvement: f64,
    window: u64,
    last: Option<f64>,
    sum: f64,
    steps: u64,
    /// Whether a window brought less than that.
    pub reached: bool,
}

impl Course {
    /// At its beginning.
    pub(super) fn new(work: Work, until: Until) -> Self {
        let plateau = match until {
            Until::Converged { improvement, window_steps, .. } => {
                Some(Plateau::new(improvement, window_steps))
            }
            _ => None,
        };
        Self { work, step: 0, slices: 0, spent: Duration::ZERO, plateau }
    }

    /// Whether a run can be here: a checkpoint may say anything.
    pub(super) fn is_possible(&self) -> bool {
        let Self { ref work, step, slices, spent, ref plateau } = *self;
        let counts = [work.frame_sweeps, work.slices_per_class, work.sweeps];
        counts.iter().all(|&count| count <= MOST_COUNT)
            && step.max(slices) <= MOST_COUNTED
            && spent < LONGEST
            && plateau.as_ref().is_none_or(|plateau| plateau.window > 0 && plateau.steps < plateau.window)
    }

    pub(super) fn has_converged(&self) -> bool {
        self.plateau.as_ref().is_some_and(|plateau| plateau.reached)
    }
}

impl Plateau {
    fn new(improvement: f64, window: u64) -> Self {
        Self { improvement, window, last: None, sum: 0.0, steps: 0, reached: false }
    }

    /// Takes note of the mean squared displacement of a step.
    pub(super) fn add(&mut self, squared: f64) {
        self.sum += squared;
        self.steps += 1;
        if self.steps < self.window {
            return;
        }
        let mean = self.sum / self.window as f64;
        self.reached |= self.last.is_some_and(|last| mean > last * (1.0 - self.improvement));
        (self.last, self.sum, self.steps) = (Some(mean), 0.0, 0);
    }
}
