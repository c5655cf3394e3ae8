//! The mean of the last tables of a run.

use std::ops::ControlFlow;
use std::time::Instant;

use fsot::config::BELOW_ONE;
use fsot::{Optimizer, SampleTable, Until};

use crate::case::Failure;

/// Follows the configured schedules and returns the mean of the tables after the last steps, a `share` of
/// all; and the slices per class and the seconds.
pub fn run(mut optimizer: Optimizer, until: Until, share: f64) -> Result<(SampleTable, f64, f64), Failure> {
    let config = optimizer.config().clone();
    let (steps, slices_per_class) = plan(&mut optimizer, until)?;
    let mut optimizer = Optimizer::new(config.clone())?;
    let averaged = ((share * steps as f64) as u64).max(1);
    let mut sums = vec![0.0; config.extent.samples() * config.dims];
    let begin = Instant::now();
    for step in 0..steps {
        let progress = step as f64 / steps as f64;
        optimizer.step(config.descent.rate().at(progress), config.balance.at(progress))?;
        if step + averaged >= steps {
            let table = optimizer.table();
            sums.iter_mut().zip(table.values()).for_each(|(sum, &value)| *sum += f64::from(value));
        }
    }
    let seconds = begin.elapsed().as_secs_f64();
    let mean = |sum: f64| ((sum / averaged as f64) as f32).min(BELOW_ONE);
    let table = SampleTable::new(config.extent, config.dims, sums.into_iter().map(mean).collect())?;
    Ok((table, slices_per_class, seconds))
}

/// Steps and slices per class of a run, by taking its first step.
fn plan(optimizer: &mut Optimizer, until: Until) -> Result<(u64, f64), Failure> {
    let mut steps = 0;
    let report = optimizer.run_observed(until, |first| {
        steps = first.steps;
        ControlFlow::Break(())
    })?;
    Ok((steps, report.work.slices_per_class as f64))
}
