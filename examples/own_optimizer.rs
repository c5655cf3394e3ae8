//! An optimiser of one's own on the objective's value and gradient: plain gradient descent with momentum.
//!
//! `cargo run --release --example own_optimizer`

use fsot::config::Role;
use fsot::{Config, Extent, Objective, SampleTable};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let config = Config::new(Extent::still(32, 32), 2);
    let objective = Objective::new(&config)?;
    let white = SampleTable::white_noise(config.extent, 2, 0)?;
    let mut points: Vec<f64> = white.values().iter().map(|&value| value.into()).collect();
    // The mean over all slices at once, exactly: what is compared before and after.
    let before = objective.cramer(&points)?.value;

    let mut velocity = vec![0.0; points.len()];
    // A coordinate is in a few slices of each batch; this brings the gradient of the mean to its scale.
    let scale = 0.3 * config.extent.samples() as f64;
    for step in 0..300 {
        // Random slices (pixel, level, direction), named by seed and step: always the same ones.
        let mut slices = objective.draw(7, step, Role::Descend);
        slices.extend(objective.draw(7, step, Role::Balance));
        let gradient = objective.value_and_gradient(&points, &slices)?.gradient;
        for ((x, v), slope) in points.iter_mut().zip(&mut velocity).zip(gradient) {
            *v = 0.9 * *v - scale * slope;
            *x = (*x + *v).clamp(0.0, 1.0 - f64::EPSILON);
        }
    }

    let after = objective.cramer(&points)?.value;
    println!("objective {before:.3e} of white noise, {after:.3e} after 300 steps");
    assert!(after < 0.5 * before);
    Ok(())
}
