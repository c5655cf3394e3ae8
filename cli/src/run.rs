//! A run of the optimiser under a progress bar, which a signal ends early.

use fsot::{Optimizer, RunReport, Until};

use crate::Failure;
use crate::interrupt::Interrupt;
use crate::progress::Progress;

/// Runs; after a signal it ends with the step that is being taken.
///
/// # Errors
/// As [`Optimizer::run`].
pub fn observed(optimizer: &mut Optimizer, until: Until, progress: &Progress) -> Result<RunReport, Failure> {
    let interrupt = Interrupt::listen()?;
    let report = optimizer.run_observed(until, |step| {
        if !interrupt.came() {
            progress.show(step);
        }
        interrupt.flow()
    });
    progress.clear();
    Ok(report?)
}
