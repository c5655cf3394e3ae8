//! How long a run is, and how it ended.

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
    /// After about this many seconds, in the sequence that gets furthest by then: sweeps where the objective
    /// has its closed form, after slices if there is time for both; slices elsewhere. A brief calibration
    /// fixes how much work fits, schedules follow it, and [`RunReport::work`](crate::RunReport::work) makes
    /// the very same table again, anywhere.
    Seconds(f64),
    /// As soon as the mean squared displacement falls by less than the share `improvement` from one window to
    /// the next, and at the latest after `at_most` slices per pixel and frame, the number that schedules
    /// follow.
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
/// Slices hold any class and target, and reach the lower bound; sweeps
/// ([`Optimizer::sweep`](crate::Optimizer::sweep)) take the whole of the objective's directions into account
/// at once, and are the sooner at a low error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Slices per pixel and frame (rounded up to whole steps).
    pub slices_per_class: u64,
    /// Sweeps over all samples.
    pub sweeps: u64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// All planned steps were taken.
    Finished,
    /// The rule of [`Until::Converged`] held.
    Converged,
    /// The caller's closure broke it off.
    Stopped,
}
