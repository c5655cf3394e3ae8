//! How long a run is, and how it ended.

use serde::{Deserialize, Serialize};

/// When a run ends. Numbers of slices and of sweeps are 1e9 at most.
///
/// ```
/// use fsot::config::Work;
/// use fsot::{Config, Extent, Until};
///
/// let config = Config::new(Extent::still(16, 16), 2);
/// let soon = config.clone().optimize(Until::Seconds(0.01))?;
/// let work = Work { slices_per_class: 64, sweeps: 8, ..Work::default() };
/// let slices_then_sweeps = config.optimize(Until::Work(work))?;
/// assert_ne!(soon, slices_then_sweeps);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Until {
    /// After as much work as is usually worth it: sweeps for some ten seconds of a core, 1,000 at most
    /// (10,000 where all groups are single dimensions, which take many and take them fast) and 3 at least,
    /// with a frame to begin with as in [`Until::Sweeps`]; 320 slices per pixel and frame, or per class,
    /// where an objective has no closed form. The same work on every machine.
    Usual,
    /// After this many slices per pixel and frame, or per class of a point set (rounded up to whole steps).
    SlicesPerClass(u64),
    /// After this many epochs, of `directions` slices per pixel and frame each.
    Epochs(u64),
    /// After this many sweeps; those of an animation begin with a frame that is swept alone, for about a
    /// quarter of their time (see [`Work::frame_sweeps`]).
    Sweeps(u64),
    /// As much of each.
    Work(Work),
    /// After about this many seconds, with what gets furthest by then: sweeps where the objective has its
    /// closed form, after a fifth of the time for the frame that an animation begins with; slices elsewhere.
    /// A brief calibration, which is a part of that time, fixes how much work fits; schedules follow it, and
    /// [`RunReport::work`](crate::RunReport::work) makes the very same table again, anywhere. Times in which
    /// nothing can be done are refused ([`ConfigError::TooShort`](crate::ConfigError::TooShort)).
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

/// An amount of work: the frame that an animation begins with, then slices, then sweeps.
///
/// Slices hold any class and target, and reach the lower bound; sweeps
/// ([`Optimizer::sweep`](crate::Optimizer::sweep)) take the whole of the objective's directions into account
/// at once, and are the sooner at a low error. An animation gets furthest from a frame that is good by
/// itself.
///
/// ```
/// use fsot::config::Work;
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let report = optimizer.run(Until::Seconds(0.01))?;
/// // The same table again, on any machine.
/// let again = Config::new(Extent::still(16, 16), 2).optimize(Until::Work(report.work))?;
/// assert_eq!(optimizer.into_table(), again);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Sweeps of one frame by itself, under the spatial part of the filters. Displaced from frame to frame by
    /// the R2 sequence, it is what the rest of the work starts from, instead of what was there. Nothing for
    /// stills, for a table that is not demanded whole, and where filters are not a lattice's.
    #[serde(default)]
    pub frame_sweeps: u64,
    /// Slices per pixel and frame (rounded up to whole steps).
    pub slices_per_class: u64,
    /// Sweeps over all samples.
    pub sweeps: u64,
}

/// How a run ended.
///
/// ```
/// use fsot::config::EndReason;
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let until = Until::Converged { improvement: 0.05, window_steps: 16, at_most: 10_000 };
/// assert_eq!(optimizer.run(until)?.ended, EndReason::Converged);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EndReason {
    /// All planned steps were taken.
    Finished,
    /// The rule of [`Until::Converged`] held.
    Converged,
    /// The caller's closure broke it off.
    Stopped,
}
