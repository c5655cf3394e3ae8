//! A hundred thousand steps at full size.

use std::time::Instant;

use fsot::config::{Descent, Domain, Schedule};
use fsot::{Config, Extent, Optimizer};

use crate::{alternating, assert_inside};

#[test]
fn a_hundred_thousand_steps_stay_inside() {
    let extent = Extent { frames: 1, height: 3, width: 3, spp: 1 };
    let rate = Schedule::constant(1.0);
    let cases = [
        (Descent::Barycentric { rate }, 1.0),
        // Steps that never become small, and a momentum that adds up to a hundred of them.
        (Descent::Sgd { rate, momentum: 0.99 }, 1.0),
        (Descent::Adam { rate, beta1: 0.9, beta2: 0.999, epsilon: 1e-30 }, 0.1),
        (Descent::Barycentric { rate }, 1e6),
    ];
    for (descent, rate) in cases {
        for first in [Domain::Interval, Domain::Torus] {
            let mut config = Config::new(extent, 2);
            config.domains = alternating(2, first);
            config.descent = descent;
            config.slicing.batch_slices = Some(48);
            let mut optimizer = Optimizer::new(config).unwrap();
            let begin = Instant::now();
            let mut mean = [0.0; 2];
            for step in 1..=100_000 {
                let displacement = optimizer.step(rate, 1.0).unwrap().displacement;
                assert!(
                    displacement.is_finite() && displacement < 2.0,
                    "{descent:?} step {step}: {displacement}"
                );
                if step % 100 == 0 {
                    let table = optimizer.table();
                    assert_inside(table.values(), format_args!("{descent:?} step {step}"));
                    for point in table.values().chunks_exact(2) {
                        mean.iter_mut()
                            .zip(point)
                            .for_each(|(mean, &value)| *mean += f64::from(value) / 9000.0);
                    }
                }
            }
            println!(
                "10⁵ steps of size {rate}, {first:?} first: \
                 mean position ({:.3}, {:.3}); {:.1} s; {descent:?}",
                mean[0],
                mean[1],
                begin.elapsed().as_secs_f64()
            );
        }
    }
}
