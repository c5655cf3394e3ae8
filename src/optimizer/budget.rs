//! How much work a run is: as told, or as much as fits into a time.

use std::time::{Duration, Instant};

use super::Optimizer;
use crate::config::{Until, Work};
use crate::error::{ConfigError, RangeError};
use crate::sweeps;

/// Slices per pixel and frame from which on it is worth beginning with them.
const ENOUGH_SLICES: f64 = 64.0;

impl Optimizer {
    /// The work of a run.
    pub(super) fn plan(&mut self, until: Until) -> Result<Work, ConfigError> {
        let slices = |slices_per_class| Work { slices_per_class, sweeps: 0 };
        let work = match until {
            Until::SlicesPerClass(slices_per_class) => slices(slices_per_class),
            Until::Epochs(epochs) => slices(epochs.saturating_mul(self.config.slicing.directions as u64)),
            Until::Sweeps(sweeps) => Work { slices_per_class: 0, sweeps },
            Until::Work(work) => work,
            Until::Converged { improvement, window_steps, at_most } => {
                let is_share = (0.0..1.0).contains(&improvement);
                RangeError::check(is_share, "the least improvement", improvement, "in [0, 1)")?;
                RangeError::check(window_steps > 0, "the window", 0.0, "of at least 1 step")?;
                slices(at_most)
            }
            Until::Seconds(seconds) => {
                let is_time = seconds > 0.0 && seconds <= 1e9;
                RangeError::check(is_time, "the number of seconds", seconds, "above 0, at most 1e9")?;
                self.fit(seconds)?
            }
        };
        if work.sweeps > 0 {
            sweeps::check(&self.objective)?;
        }
        Ok(work)
    }

    /// The work that fits into a time: all of it sweeps, unless half of it is enough for a good number of
    /// slices.
    fn fit(&mut self, seconds: f64) -> Result<Work, ConfigError> {
        let per_step = self.objective.slices_per_class_and_step();
        if sweeps::check(&self.objective).is_err() {
            let slices = seconds / self.seconds_per_batch() * per_step;
            return Ok(Work { slices_per_class: slices.max(1.0) as u64, sweeps: 0 });
        }
        let seconds_per_sweep = self.seconds_per_sweep()?;
        let slices = 0.5 * seconds / self.seconds_per_batch() * per_step;
        let (slices, share) = if slices >= ENOUGH_SLICES { (slices as u64, 0.5) } else { (0, 1.0) };
        let sweeps = (share * seconds / seconds_per_sweep).max(1.0) as u64;
        Ok(Work { slices_per_class: slices, sweeps })
    }

    /// Times a few steps that leave the table as it is.
    fn seconds_per_batch(&mut self) -> f64 {
        let steps = self.steps;
        // The first step grows the buffers and does not count.
        self.step_in_pool(0.0, 0.0);
        let seconds = mean_seconds(|| {
            self.step_in_pool(0.0, 0.0);
        });
        self.steps = steps;
        seconds
    }

    /// Times a few sweeps that leave the table as it is.
    fn seconds_per_sweep(&mut self) -> Result<f64, ConfigError> {
        let swept = self.swept;
        self.sweep_step(0, 0.0, 0.0)?;
        let mut outcome = Ok(0.0);
        let seconds = mean_seconds(|| outcome = self.sweep_in_pool(0.0, 0.0));
        self.swept = swept;
        self.sweeper = None;
        outcome.map(|_| seconds)
    }
}

/// Mean time of a call, over as many as make a reliable figure: the median of three windows, since other work
/// may share the machine.
fn mean_seconds(mut call: impl FnMut()) -> f64 {
    const WINDOW: Duration = Duration::from_millis(8);
    let mut means = Vec::with_capacity(3);
    while means.len() < 3 {
        let (begin, mut timed) = (Instant::now(), 0);
        while begin.elapsed() < WINDOW {
            call();
            timed += 1;
        }
        means.push(begin.elapsed().as_secs_f64() / f64::from(timed));
        if means[0] > 0.1 {
            break; // long enough not to be disturbed
        }
    }
    means.sort_unstable_by(f64::total_cmp);
    means[means.len() / 2]
}
