//! How many samples a step selects: the unit of the benches' throughput.

use fsot::Objective;
use fsot::config::{Role, Term};

/// Samples that the slices of a step select, in the mean, for objectives that descend kernels alone.
pub fn per_step(objective: &Objective) -> f64 {
    let terms: Vec<&Term> = objective.terms().collect();
    let weight = |descended: bool| {
        let counted = terms.iter().filter(|term| !descended || term.role == Role::Descend);
        counted.map(|term| term.weight).sum::<f64>()
    };
    // A random level selects each tap as often as it weighs.
    let subset = |term: usize| {
        let taps = objective.taps(term).expect("kernels are descended");
        taps.iter().map(|tap| tap.weight).sum::<f64>() * objective.extent().spp as f64
    };
    let descended: f64 = objective.draw(0, 0, Role::Descend).iter().map(|slice| subset(slice.term)).sum();
    // The others select as many as they weigh.
    descended * weight(false) / weight(true)
}
