//! Runs: steps along the schedules of the configuration, until they are done.

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use super::frame::displaced;
use super::report::{Current, Plateau, RunReport, StepReport};
use super::{Optimizer, SliceStep};
use crate::config::{EndReason, Until, Work};
use crate::error::ConfigError;
use crate::slices::Slices;
use crate::sweeps::Motion;

impl Optimizer {
    /// Takes steps until `until`: see [`Optimizer::run_observed`].
    ///
    /// # Errors
    /// As [`Optimizer::run_observed`].
    pub fn run(&mut self, until: Until) -> Result<RunReport, ConfigError> {
        self.run_observed(until, |_| ControlFlow::Continue(()))
    }

    /// Takes steps until `until`, or until `observe` breaks off, which is called after each step. The table
    /// keeps what was reached.
    ///
    /// A run begins with fresh moments and at the start of the schedules; its slices and sweeps go on where
    /// the last run's ended.
    ///
    /// # Errors
    /// A number of seconds or an improvement outside its range; more than 1e9 slices per class or sweeps;
    /// sweeps of an objective that has no closed form; slices of one whose terms have all too different
    /// weights ([`ConfigError::Uneven`]); fewer seconds than one step or sweep takes
    /// ([`ConfigError::TooShort`]). Nothing is changed then.
    pub fn run_observed(
        &mut self,
        until: Until,
        mut observe: impl FnMut(&StepReport) -> ControlFlow<()> + Send,
    ) -> Result<RunReport, ConfigError> {
        // On a thread of the pool from here on, instead of going there and back for each step.
        rayon::scope(|_| self.run_in_pool(until, &mut observe))
    }

    fn run_in_pool(
        &mut self,
        until: Until,
        observe: &mut dyn FnMut(&StepReport) -> ControlFlow<()>,
    ) -> Result<RunReport, ConfigError> {
        // A closure that panicked in an earlier run may have left one behind.
        self.sweeper = None;
        let work = match self.work_of(until) {
            Ok(work) => work,
            Err(error) => {
                self.sweeper = None;
                return Err(error);
            }
        };
        let Work { frame_sweeps, slices_per_class, sweeps } = work;
        let frame = if frame_sweeps > 0 { self.of_a_frame()? } else { None };
        let frame_sweeps = if frame.is_some() { frame_sweeps } else { 0 };
        let work = Work { frame_sweeps, ..work };
        let batches = self.objective.pace().steps_of(slices_per_class);
        let steps_per_sweep = if sweeps > 0 { self.sweeper()?.steps() } else { 1 };
        let swept = sweeps.saturating_mul(steps_per_sweep as u64);
        let steps = frame_sweeps.saturating_add(batches).saturating_add(swept);
        self.slices = Slices::new(self.config.descent, self.points.len());
        let begin = Instant::now();
        let (mut plateau, loss_slices) = (Plateau::default(), OnceLock::new());
        let (ended, elapsed) = (EndReason::Finished, Duration::ZERO);
        let mut report = RunReport { ended, steps: 0, slices: 0, work, elapsed };
        if let Some(mut frame) = frame {
            let per_sweep = frame.sweeper()?.steps() as u64;
            let work = Work { sweeps: frame_sweeps, ..Work::default() };
            let of_frame = frame.run_in_pool(Until::Work(work), &mut |seen| {
                // A frame's steps are short: one report a sweep.
                if !seen.step.is_multiple_of(per_sweep) {
                    return ControlFlow::Continue(());
                }
                let of_all = Current {
                    config: &self.config,
                    objective: &self.objective,
                    loss_slices: &loss_slices,
                    ..seen.current
                };
                let elapsed = begin.elapsed();
                observe(&StepReport { step: seen.step / per_sweep, steps, elapsed, current: of_all, ..*seen })
            })?;
            report.steps = of_frame.steps / per_sweep;
            report.ended = of_frame.ended;
            self.points = displaced(self.config.extent, frame.points());
            self.fresh = false;
        }
        let rest = if report.ended == EndReason::Finished { batches.saturating_add(swept) } else { 0 };
        for step in 0..rest {
            let (displacement, rate) = if step < batches {
                let progress = step as f64 / batches as f64;
                let rate = self.config.descent.rate().at(progress);
                let SliceStep { displacement, slices } =
                    self.step_in_pool(rate, self.config.balance.at(progress));
                report.slices += slices;
                (displacement, rate)
            } else {
                if step == batches {
                    // Sweeps need the room that batches have taken for themselves.
                    self.slices.release();
                }
                let progress = (step - batches) as f64 / swept as f64;
                let (rates, softening) = self.config.sweeps.of_a_run(work);
                let (rate, balance) = (rates.at(progress), self.config.balance.at(progress));
                let part = (step - batches) as usize % steps_per_sweep;
                (self.sweep_step(part, Motion { rate, softening, balance })?.root(), rate)
            };
            report.steps += 1;
            let current = Current {
                config: &self.config,
                objective: &self.objective,
                points: &self.points,
                sweeper: self.sweeper.as_ref(),
                loss_slices: &loss_slices,
            };
            let (step, slices, elapsed) = (report.steps, report.slices, begin.elapsed());
            let seen = StepReport { step, steps, slices, displacement, rate, elapsed, current };
            if observe(&seen).is_break() {
                report.ended = EndReason::Stopped;
                break;
            }
            if let Until::Converged { improvement, window_steps, .. } = until
                && plateau.reached(displacement * displacement, improvement, window_steps)
            {
                report.ended = EndReason::Converged;
                break;
            }
        }
        if sweeps > 0 && report.ended == EndReason::Finished {
            self.settle(self.config.balance.at(1.0));
        }
        // A run may be broken off between two balances.
        self.fetch();
        if report.slices > 0 {
            self.objective.settle(&mut self.points);
        }
        report.elapsed = begin.elapsed();
        // Nobody needs the buffers until the next run.
        self.slices.release();
        self.sweeper = None;
        Ok(report)
    }
}
