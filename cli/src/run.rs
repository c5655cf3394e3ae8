//! A run of the optimiser under a progress bar, which a signal ends early.

use std::ops::ControlFlow;

use fsot::optimizer::StepReport;
use fsot::{Optimizer, RunReport, Until};

use crate::Failure;
use crate::interrupt::Interrupt;
use crate::progress::Progress;

/// What is run.
#[derive(Clone, Copy, Debug)]
pub enum Course {
    /// A new run.
    New(Until),
    /// The run of the checkpoint that was resumed.
    Resumed,
}

/// Runs; after a signal it ends with the step that is being taken.
///
/// # Errors
/// As [`Optimizer::run`].
pub fn observed(optimizer: &mut Optimizer, until: Until, progress: &Progress) -> Result<RunReport, Failure> {
    watched(optimizer, Course::New(until), progress, |_, _| ControlFlow::Continue(()))
}

/// The same under the eyes of somebody who sees each step, is told whether a signal has made it the last one,
/// and may break off as well.
///
/// # Errors
/// As [`Optimizer::run`].
pub fn watched(
    optimizer: &mut Optimizer,
    course: Course,
    progress: &Progress,
    mut watch: impl FnMut(&StepReport, bool) -> ControlFlow<()> + Send,
) -> Result<RunReport, Failure> {
    let interrupt = Interrupt::listen()?;
    let observe = |step: &StepReport| {
        let came = interrupt.came();
        if !came {
            progress.show(step);
        }
        watch(step, came)?;
        if came { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let report = match course {
        Course::New(until) => optimizer.run_observed(until, observe),
        Course::Resumed => optimizer.finish_observed(observe),
    };
    progress.clear();
    Ok(report?)
}
