//! A table for an animation behind temporal antialiasing: errors cancel over pixels and over frames.
//!
//! `cargo run --release --example animation`

use std::ops::ControlFlow;

use fsot::kernel::TemporalKernel;
use fsot::metrics::{FilteredError, Integrands};
use fsot::{Config, Extent, Kernel, Optimizer, Until};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A history that keeps 0.8 of the last frame, times the eye's blur.
    let taa = Kernel::gaussian(2.1).with_temporal(TemporalKernel::Ema { alpha: 0.2 });
    let config = Config::new(Extent::animation(16, 32, 32), 2).with_kernel(taa.clone());
    let mut optimizer = Optimizer::new(config)?;
    let report = optimizer.run_observed(Until::Sweeps(40), |step| {
        if step.step.is_multiple_of(160) {
            println!("step {} of {}: loss {:.3e}", step.step, step.steps, step.loss());
        }
        // Break(()) would end the run here and keep what was reached.
        ControlFlow::Continue(())
    })?;
    println!("{:.2} s", report.elapsed.as_secs_f64());

    let table = optimizer.table();
    let error = FilteredError::measure(&table, &[0, 1], &Integrands::random(2, 32, 0)?, &taa)?;
    let [space, both] = [&error.spatial, &error.spatio_temporal].map(|ratios| ratios.mean.mean);
    println!("of white noise: {space:.3} in each frame, {both:.3} after the history");
    assert!(both < space && both < 0.3);

    // The table, and how it was made, in table.json beside it.
    let folder = tempfile::tempdir()?;
    table.save_with(folder.path().join("table.npy"), &optimizer.metadata(&report))?;
    Ok(())
}
