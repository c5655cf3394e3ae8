//! Numerical stress: inputs that break floating-point code, and what the crate promises about them.
//!
//! `cargo test --release --test stress -- --nocapture` prints the figures of `docs/numerical-stress.md`. The
//! `f32` engine against its `f64` twin is a unit test of the engine, distances against brute force one of the
//! transport.

mod decay;
mod degenerate;
mod directions;
mod drift;
mod kernels;
mod large;

use fsot::config::{Descent, Domain};
use fsot::{Config, Extent, Optimizer, SampleTable};

fn square(side: usize, spp: usize) -> Extent {
    Extent { frames: 1, height: side, width: side, spp }
}

/// Interval and torus dimensions by turns, beginning with `first`.
fn alternating(dims: usize, first: Domain) -> Vec<Domain> {
    let other = if first == Domain::Torus { Domain::Interval } else { Domain::Torus };
    (0..dims).map(|dim| if dim % 2 == 0 { first } else { other }).collect()
}

fn descents() -> [Descent; 3] {
    [Descent::barycentric(), Descent::sgd(), Descent::adam()]
}

/// Fails where a value is outside `[0, 1)` or not a number.
fn assert_inside(values: &[f32], context: impl std::fmt::Display) {
    if let Some(index) = values.iter().position(|value| !(0.0..1.0).contains(value)) {
        panic!("{context}: value {index} is {}", values[index]);
    }
}

/// An optimiser that starts from these values.
fn start(config: Config, values: Vec<f32>) -> Optimizer {
    let table = SampleTable::new(config.extent, config.dims, values).unwrap();
    Optimizer::from_table(config, table).unwrap()
}
