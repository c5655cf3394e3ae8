//! Point sets: labelled classes, prefixes, densities, clouds, and what callers write themselves.

mod classes;
mod custom;
mod density;
#[cfg(feature = "image")]
mod exr_files;
mod importance;
#[cfg(feature = "image")]
mod picture_files;
#[cfg(feature = "image")]
mod pictures;
#[cfg(feature = "image")]
mod png_files;
mod progressive;
mod refusals;

use fsot::metrics::{Samples, SlicedDistance};
use fsot::targets::Target;
use fsot::{Config, Optimizer, Until};

/// Coordinates after so many slices per class.
fn optimised(config: Config, slices: u64) -> Vec<f64> {
    let mut optimizer = Optimizer::new(config).unwrap();
    optimizer.run(Until::SlicesPerClass(slices)).unwrap();
    let values = optimizer.into_table().into_values();
    assert!(values.iter().all(|value| (0.0..1.0).contains(value)));
    values.into_iter().map(f64::from).collect()
}

/// Sliced distance of points of `dims` coordinates from a target.
fn distance(points: &[f64], dims: usize, target: &Target, directions: usize) -> f64 {
    let group: Vec<usize> = (0..dims).collect();
    let points = Samples::points(points, dims).unwrap();
    SlicedDistance::measure(points, &group, target, directions).unwrap().w2
}
