//! What a run will take, found out by a part of a second of it.

use std::time::Duration;

use super::Optimizer;
use crate::config::{Until, Work};
use crate::error::ConfigError;
use crate::slices::Slices;

/// What a run will take: see [`Optimizer::plan`].
///
/// ```
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(64, 64), 2))?;
/// let plan = optimizer.plan(Until::Usual)?;
/// println!("{} sweeps, {:.1} s, {} MB", plan.work.sweeps, plan.seconds, plan.bytes / 1_000_000);
/// assert!(plan.seconds > 0.0 && plan.steps >= plan.work.sweeps);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Plan {
    /// What the run is planned for; as [`Until::Work`] it gives the same steps.
    pub work: Work,
    /// Steps that the run takes.
    pub steps: u64,
    /// Slices that are drawn, over all terms, in the mean.
    pub slices: f64,
    /// Pairs of samples that all sweeps look at together, those of the frame that an animation begins with
    /// included.
    pub pairs: f64,
    /// Seconds that the run takes here, as far as a calibration of some tenths of a second tells: within some
    /// tenths of that, if nothing else comes to run on this machine.
    pub seconds: f64,
    /// Bytes that the run holds at its peak, within a quarter and 3 MB: the table and all buffers that grow
    /// with it, tabulated laws, and what threads need. Targets other than the cube are not counted.
    pub bytes: usize,
}

/// Each of the calibrations, of which there are up to six, measures three of these.
const WINDOW: Duration = Duration::from_millis(16);
/// Tabulated laws, and what a thread needs for the subsets that it transports.
const LAWS: usize = 1 << 21;
const THREAD: usize = 1 << 19;

impl Optimizer {
    /// What a run until `until` will take. The table, the moments of the descent and the numbers of steps
    /// stay as they are; a few steps that move nothing are timed.
    ///
    /// Takes less than half a second, or some steps where one takes longer. [`Until::Converged`] is planned
    /// for its whole length.
    ///
    /// # Errors
    /// As [`Optimizer::run`].
    pub fn plan(&mut self, until: Until) -> Result<Plan, ConfigError> {
        let fresh = Slices::new(self.config.descent, self.points.len());
        let kept = std::mem::replace(&mut self.slices, fresh);
        // On a thread of the pool, as the run will be.
        let plan = rayon::scope(|_| self.plan_in_pool(until));
        self.slices = kept;
        self.sweeper = None;
        plan
    }

    fn plan_in_pool(&mut self, until: Until) -> Result<Plan, ConfigError> {
        self.sweeper = None;
        let work = self.work_of(until)?;
        let Work { frame_sweeps, slices_per_class, sweeps } = work;
        let frame = if frame_sweeps > 0 { self.of_a_frame()? } else { None };
        let work = Work { frame_sweeps: if frame.is_some() { frame_sweeps } else { 0 }, ..work };
        let table = size_of::<f32>() * self.points.len();
        let (mut seconds, mut pairs, mut slices, mut peak) = (0.0, 0.0, 0.0, 0);
        let batches = self.objective.pace().steps_of(slices_per_class);
        let mut steps = work.frame_sweeps.saturating_add(batches);
        if let Some(mut frame) = frame {
            seconds += frame_sweeps as f64 * frame.seconds_per_sweep(WINDOW)?;
            let sweeper = frame.sweeper()?;
            pairs += frame_sweeps as f64 * sweeper.pairs();
            peak = sweeper.bytes();
        }
        // As in a run, sweeps are planned before slices are drawn, and take their copy after.
        if batches > 0 {
            seconds += batches as f64 * self.seconds_per_batch(WINDOW);
            slices = batches as f64 * self.objective.terms.iter().map(|term| term.slices()).sum::<f64>();
            peak = peak.max(self.slices.bytes());
            self.slices.release();
        }
        if sweeps > 0 {
            seconds += sweeps as f64 * self.seconds_per_sweep(WINDOW)?;
            let besides = self.slices.bytes();
            let sweeper = self.sweeper()?;
            pairs += sweeps as f64 * sweeper.pairs();
            steps = steps.saturating_add(sweeps.saturating_mul(sweeper.steps() as u64));
            // Samples and their ranks, by which marginals are settled at the end.
            let ranks = 3 * size_of::<u32>() * self.config.extent.samples();
            peak = peak.max(self.sweeper()?.bytes() + besides.max(ranks));
        }
        let fixed = LAWS + THREAD * rayon::current_num_threads();
        Ok(Plan { work, steps, slices, pairs, seconds, bytes: table + peak + fixed })
    }
}
