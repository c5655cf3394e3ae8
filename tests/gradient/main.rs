//! `Objective::value_and_gradient` on explicit lists of slices: against brute force, against central
//! differences, at ties, and what it refuses.

mod brute_force;
mod differences;
mod refusals;
mod ties;
mod values;

use fsot::classes::{Classes, FilterForm};
use fsot::config::{Domain, Role, Term};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::targets::Target;
use fsot::{Config, Extent, Kernel, Objective};

/// A term of weight 1 that is descended.
fn term(classes: Classes, dims: &[usize]) -> Term {
    Term { classes, target: Target::UniformCube, dims: dims.to_vec(), weight: 1.0, role: Role::Descend }
}

/// The papers' spatial Gaussian times a moving average, of which a table of several frames sees the past.
fn lattice(form: FilterForm) -> Classes {
    let spatial = SpatialKernel::Gaussian { sigma_px: 2.1 };
    Classes::Lattice { kernel: Kernel::product(spatial, TemporalKernel::Ema { alpha: 0.4 }), form }
}

fn objective(extent: Extent, domains: &[Domain], terms: &[Term]) -> Objective {
    let config = Config::new(extent, domains.len()).with_domains(domains.to_vec());
    Objective::new(&config.with_terms(terms.to_vec())).unwrap()
}

/// Unit vector; components of exactly 0 stay 0.
fn unit(direction: &[f64]) -> Vec<f64> {
    let length = direction.iter().map(|component| component * component).sum::<f64>().sqrt();
    direction.iter().map(|component| component / length).collect()
}

/// Fixed numbers in `[0, 1)` without a generator: fractional parts of multiples of an irrational number.
fn spread(count: usize, start: f64) -> Vec<f64> {
    (0..count).map(|i| (start + 0.754_877_666_246_692_8 * (i * i + i + 1) as f64).fract()).collect()
}
