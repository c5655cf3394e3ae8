//! Our ways to make a table. Another one is another line of [`METHODS`].

use std::ops::ControlFlow;

use fsot::{Config, ConfigError, Descent, Optimizer, SampleTable, Until};

/// A way to make a table with a given effort.
pub struct Method {
    pub name: &'static str,
    /// Makes the table of this configuration with an effort of so many slices per pixel and frame, or what costs
    /// about as much: the harness doubles it until the time is up.
    pub run: fn(&Config, u64) -> Result<Made, ConfigError>,
}

/// A table and what it took.
pub struct Made {
    pub table: SampleTable,
    /// Time of the optimisation, without the planning before it.
    pub seconds: f64,
    pub slices: u64,
}

pub const METHODS: &[Method] = &[
    Method { name: "barycentric", run: |config, effort| slices(Descent::barycentric(), config, effort) },
    Method { name: "SGD", run: |config, effort| slices(Descent::sgd(), config, effort) },
    Method { name: "Adam", run: |config, effort| slices(Descent::adam(), config, effort) },
];

fn slices(descent: Descent, config: &Config, slices_per_class: u64) -> Result<Made, ConfigError> {
    let mut optimizer = Optimizer::new(Config { descent, ..config.clone() })?;
    let report = optimizer.run(Until::SlicesPerClass(slices_per_class), |_| ControlFlow::Continue(()))?;
    Ok(Made { table: optimizer.into_table(), seconds: report.elapsed.as_secs_f64(), slices: report.slices })
}
