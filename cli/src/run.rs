//! A run of the optimiser under a progress bar, which a signal ends early.

use std::ops::ControlFlow;

use fsot::optimizer::StepReport;
use fsot::{Optimizer, RunReport, Until};

use crate::Failure;
use crate::interrupt::Interrupt;
use crate::progress::Progress;

/// Runs; after a signal it ends with the step that is being taken.
///
/// # Errors
/// As [`Optimizer::run`].
pub fn observed(optimizer: &mut Optimizer, until: Until, progress: &Progress) -> Result<RunReport, Failure> {
    watched(optimizer, until, progress, |_| ControlFlow::Continue(()))
}

/// The same under the eyes of somebody who sees each step, and may break off as well.
///
/// # Errors
/// As [`Optimizer::run`].
pub fn watched(
    optimizer: &mut Optimizer,
    until: Until,
    progress: &Progress,
    mut watch: impl FnMut(&StepReport) -> ControlFlow<()> + Send,
) -> Result<RunReport, Failure> {
    let interrupt = Interrupt::listen()?;
    let report = optimizer.run_observed(until, |step| {
        if !interrupt.came() {
            progress.show(step);
            watch(step)?;
        }
        interrupt.flow()
    });
    progress.clear();
    Ok(report?)
}
