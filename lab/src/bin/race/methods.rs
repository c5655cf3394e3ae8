//! Our ways to make a table. Another one is another line of [`METHODS`].

use fsot::config::{Descent, Work};
use fsot::{Config, ConfigError, Optimizer, SampleTable, Until};

/// A way to make a table with a given effort.
pub struct Method {
    pub name: &'static str,
    /// Makes the table of this configuration; the harness doubles the effort until the time is up.
    pub run: fn(&Config, Effort) -> Result<Made, ConfigError>,
}

/// How much a method may do, in the unit that it uses.
#[derive(Clone, Copy)]
pub struct Effort {
    /// Slices per pixel and frame.
    pub slices: u64,
    pub sweeps: u64,
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
    Method { name: "sweeps", run: |config, effort| made(config, Until::Sweeps(effort.sweeps)) },
    Method {
        name: "slices, then sweeps",
        run: |config, Effort { sweeps, .. }| work(config, 2 * sweeps, sweeps),
    },
];

fn slices(descent: Descent, config: &Config, effort: Effort) -> Result<Made, ConfigError> {
    work(&config.clone().with_descent(descent), effort.slices, 0)
}

fn work(config: &Config, slices_per_class: u64, sweeps: u64) -> Result<Made, ConfigError> {
    made(config, Until::Work(Work { slices_per_class, sweeps, ..Work::default() }))
}

fn made(config: &Config, until: Until) -> Result<Made, ConfigError> {
    let mut optimizer = Optimizer::new(config.clone())?;
    let report = optimizer.run(until)?;
    Ok(Made { table: optimizer.into_table(), seconds: report.elapsed.as_secs_f64(), slices: report.slices })
}
