//! What a run is worth: the bound falls, the table stays unbiased, runs end as they should, and what cannot
//! be optimised is refused in words. Everything random has fixed seeds.

mod bias;
mod bound;
mod promises;
mod refusals;
mod runs;
mod sweeps;

use std::ops::ControlFlow;

use fsot::optimizer::StepReport;
use fsot::{Config, Extent, Optimizer, SampleTable, Until, metrics};

fn extent([frames, height, width, spp]: [usize; 4]) -> Extent {
    Extent { frames, height, width, spp }
}

fn on(_: &StepReport) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn optimized(config: &Config, slices_per_class: u64) -> Optimizer {
    let mut optimizer = Optimizer::new(config.clone()).unwrap();
    optimizer.run_observed(Until::SlicesPerClass(slices_per_class), on).unwrap();
    optimizer
}

/// Ratio of the bound to white noise, with its standard error.
fn ratio(optimizer: &Optimizer, table: &SampleTable, slices: usize) -> (f64, f64) {
    let seed = optimizer.config().seed;
    let total = metrics::Bound::measure(table, optimizer.objective(), seed, slices).unwrap().total;
    (total.ratio_to_white_noise, total.ratio_standard_error)
}
