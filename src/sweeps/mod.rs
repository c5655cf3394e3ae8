//! All slices at once: the objective of a lattice term in closed form, without directions, sorting or
//! randomness.
//!
//! With Cramér's distance `∫ (F − G)²` in place of Wasserstein's as the cost of a slice, the mean over *all*
//! directions is the energy distance (Székely and Rizzo 2013, "Energy statistics"), times the mean length
//! `c_d` of a projected unit vector:
//!
//! ```text
//! Σ_p (Σ_j w_p(j))² · E_theta ∫ (F_p − F_mu)² ds
//!     = c_d · (Σ_i (Σ_j F_ij) φ(x_i) − ½ Σ_ij F_ij |x_i − x_j| − ½ Σ_p (Σ_j w_p(j))² E|u − u'|),
//! F_ij = Σ_p w_p(i) w_p(j),     φ(x) = E|x − u|,     u, u' ~ mu independent.
//! ```
//!
//! It is the squared filtered error of a random half-space, meant over half-spaces and pixels. A sweep visits
//! every sample once and moves it along its exact gradient; that costs one pass over the pairs that some
//! filter holds together, sixteen at a time and without any search.

mod axis;
mod balance;
mod cut;
mod exact;
mod field;
mod lines;
mod modes;
mod pairs;
mod scattered;
mod sweeper;
mod tiles;

pub(crate) use sweeper::{MeanSquare, Motion, Sweeper};

use crate::config::Role;
use crate::error::ConfigError;
use crate::objective::Objective;
use crate::table::domain::{BELOW_ONE, Domain};
use crate::targets::Target;

/// Refuses an objective with a descended term for which the closed form does not hold.
pub(crate) fn check(objective: &Objective) -> Result<(), ConfigError> {
    for (index, term) in objective.terms.iter().enumerate() {
        let why = if term.spec.role != Role::Descend {
            continue;
        } else if term.family.taps().is_none() {
            "its classes are not the pixels of a lattice"
        } else if term.spec.target != Target::UniformCube {
            "its target is not the uniform cube"
        } else if term.spec.dims.iter().any(|&dim| objective.domains[dim] == Domain::Torus) {
            "it sees a dimension that is a torus"
        } else {
            continue;
        };
        return Err(ConfigError::NotInClosedForm { term: index, why });
    }
    Ok(())
}

/// Brings a coordinate that has left `[0, 1)` back by the way it went, as a mirror would.
#[inline(always)]
#[allow(clippy::manual_clamp)] // `clamp` would let NaN through
fn reflect(coordinate: f32) -> f32 {
    let above = coordinate.abs();
    let inside = 1.0 - (1.0 - above).abs();
    // Farther than a mirror reaches, or 1 itself.
    inside.max(0.0).min(BELOW_ONE)
}

/// Mean length of the projection of a unit vector in `dims` dimensions on a random direction:
/// `Γ(d/2) / (√π Γ((d+1)/2))`.
fn mean_projection(dims: usize) -> f64 {
    // c_1 = 1, c_2 = 2/π, c_{d+2} = c_d · d / (d + 1).
    let (start, mut mean) = if dims % 2 == 1 { (1, 1.0) } else { (2, std::f64::consts::FRAC_2_PI) };
    for d in (start..dims).step_by(2) {
        mean *= d as f64 / (d + 1) as f64;
    }
    mean
}

#[cfg(test)]
mod tests;
