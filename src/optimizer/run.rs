//! Runs: steps along the schedules of the configuration, until they are done.

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::time::Instant;

use super::course::Course;
use super::frame::displaced;
use super::record::Past;
use super::report::{Current, RunReport, StepReport};
use super::{Optimizer, SliceStep};
use crate::config::{EndReason, Until, Work};
use crate::error::ConfigError;
use crate::objective::Slice;
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

    /// Goes on with the run that was [resumed](Optimizer::resume), to its end: see
    /// [`Optimizer::finish_observed`].
    ///
    /// # Errors
    /// As [`Optimizer::finish_observed`].
    pub fn finish(&mut self) -> Result<RunReport, ConfigError> {
        self.finish_observed(|_| ControlFlow::Continue(()))
    }

    /// Goes on with the run that was [resumed](Optimizer::resume), to its end or until `observe` breaks off.
    /// Steps, slices and time are counted from where that run began. Without one there is nothing to do.
    ///
    /// # Errors
    /// What [`Optimizer::new`] refuses of the frame that an animation begins with: nothing, if the checkpoint
    /// was made by this version.
    pub fn finish_observed(
        &mut self,
        mut observe: impl FnMut(&StepReport) -> ControlFlow<()> + Send,
    ) -> Result<RunReport, ConfigError> {
        rayon::scope(|_| {
            let Some((course, of_frame)) = self.resumed.take() else {
                // Its report is of no work.
                self.past = if self.past == Past::Nothing { Past::Nothing } else { Past::Other };
                let nothing = Course::new(Work::default(), Until::Sweeps(0));
                return self.follow(nothing, None, &mut observe);
            };
            let frame = match of_frame {
                Some(points) => self.of_a_frame()?.map(|frame| frame.swept_to(points, course.step)),
                None => None,
            };
            self.follow(course, frame, &mut observe)
        })
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
        let frame = if work.frame_sweeps > 0 { self.of_a_frame()? } else { None };
        let work = if frame.is_some() { work } else { Work { frame_sweeps: 0, ..work } };
        self.resumed = None;
        self.slices = Slices::new(self.config.descent, self.points.len());
        self.past = self.past.and_a_run();
        self.follow(Course::new(work, until), frame, observe)
    }

    /// Goes from where a course is to its end; at first with the frame that an animation begins with, if that
    /// is not done.
    fn follow(
        &mut self,
        mut course: Course,
        frame: Option<Optimizer>,
        observe: &mut dyn FnMut(&StepReport) -> ControlFlow<()>,
    ) -> Result<RunReport, ConfigError> {
        let Work { frame_sweeps, slices_per_class, sweeps } = course.work;
        let batches = self.objective.pace().steps_of(slices_per_class);
        let steps_per_sweep = if sweeps > 0 { self.sweeper()?.steps() } else { 1 };
        let swept = sweeps.saturating_mul(steps_per_sweep as u64);
        let steps = frame_sweeps.saturating_add(batches).saturating_add(swept);
        let (begin, before) = (Instant::now(), course.spent);
        let elapsed = || before + begin.elapsed();
        let loss_slices = OnceLock::new();
        let mut ended = if course.has_converged() { EndReason::Converged } else { EndReason::Finished };
        if let Some(frame) = frame {
            ended = self.follow_frame(&mut course, frame, steps, &loss_slices, observe)?;
        }
        let first = course.step.saturating_sub(frame_sweeps);
        let rest = if ended == EndReason::Finished { first..batches.saturating_add(swept) } else { 0..0 };
        for step in rest {
            let (displacement, rate) = if step < batches {
                let progress = step as f64 / batches as f64;
                let rate = self.config.descent.rate().at(progress);
                let SliceStep { displacement, slices } =
                    self.step_in_pool(rate, self.config.balance.at(progress));
                course.slices += slices;
                (displacement, rate)
            } else {
                if step == batches {
                    // Sweeps need the room that batches have taken for themselves.
                    self.slices.release();
                }
                let progress = (step - batches) as f64 / swept as f64;
                let (rates, softening) = self.config.sweeps.of_a_run(course.work);
                let (rate, balance) = (rates.at(progress), self.config.balance.at(progress));
                let part = (step - batches) as usize % steps_per_sweep;
                if step == first && part > 0 {
                    self.begin_again()?;
                }
                (self.sweep_step(part, Motion { rate, softening, balance })?.root(), rate)
            };
            course.step += 1;
            if let Some(plateau) = &mut course.plateau {
                plateau.add(displacement * displacement);
            }
            let current = Current {
                config: &self.config,
                objective: &self.objective,
                points: &self.points,
                sweeper: self.sweeper.as_ref(),
                loss_slices: &loss_slices,
                course: &course,
                place: self.place(),
                identity: &self.identity,
            };
            let Course { step, slices, .. } = course;
            let seen = StepReport { step, steps, slices, displacement, rate, elapsed: elapsed(), current };
            if observe(&seen).is_break() {
                ended = EndReason::Stopped;
                break;
            }
            if course.has_converged() {
                ended = EndReason::Converged;
                break;
            }
        }
        if sweeps > 0 && ended == EndReason::Finished {
            self.settle(self.config.balance.at(1.0));
        }
        // A run may be broken off between two balances.
        self.fetch();
        if course.slices > 0 {
            self.objective.settle(&mut self.points);
        }
        let Course { work, step: steps, slices, .. } = course;
        let report = RunReport { ended, steps, slices, work, elapsed: elapsed() };
        // Nobody needs the buffers until the next run.
        self.slices.release();
        self.sweeper = None;
        Ok(report)
    }

    /// Sweeps the frame that an animation begins with, and makes all frames of it.
    fn follow_frame(
        &mut self,
        course: &mut Course,
        mut frame: Optimizer,
        steps: u64,
        loss_slices: &OnceLock<Vec<Slice>>,
        observe: &mut dyn FnMut(&StepReport) -> ControlFlow<()>,
    ) -> Result<EndReason, ConfigError> {
        let per_sweep = frame.sweeper()?.steps() as u64;
        let sweeps = course.work.frame_sweeps;
        let of_frame = Course {
            step: course.step * per_sweep,
            spent: course.spent,
            ..Course::new(Work { sweeps, ..Work::default() }, Until::Sweeps(sweeps))
        };
        let (place, of_all) = (self.place(), course.clone());
        let report = frame.follow(of_frame, None, &mut |seen| {
            // A frame's steps are short: one report a sweep.
            if !seen.step.is_multiple_of(per_sweep) {
                return ControlFlow::Continue(());
            }
            let step = seen.step / per_sweep;
            let current = Current {
                config: &self.config,
                objective: &self.objective,
                course: &Course { step, ..of_all.clone() },
                identity: &self.identity,
                loss_slices,
                place,
                ..seen.current
            };
            observe(&StepReport { step, steps, current, ..*seen })
        })?;
        course.step = report.steps / per_sweep;
        self.points = displaced(self.config.extent, frame.points());
        self.fresh = false;
        Ok(report.ended)
    }
}
