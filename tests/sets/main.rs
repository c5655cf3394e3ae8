//! Point sets: labelled classes, prefixes, densities, clouds, and what callers write themselves.

mod classes;
mod custom;
mod density;
#[cfg(feature = "image")]
mod picture_files;
#[cfg(feature = "image")]
mod pictures;
mod progressive;
mod refusals;

use std::ops::ControlFlow;

use fsot::{Config, Optimizer, Until};

/// Coordinates after so many slices per class.
fn optimised(config: Config, slices: u64) -> Vec<f64> {
    let mut optimizer = Optimizer::new(config).unwrap();
    optimizer.run(Until::SlicesPerClass(slices), |_| ControlFlow::Continue(())).unwrap();
    let values = optimizer.into_table().into_values();
    assert!(values.iter().all(|value| (0.0..1.0).contains(value)));
    values.into_iter().map(f64::from).collect()
}
