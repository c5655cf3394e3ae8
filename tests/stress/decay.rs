//! The bound along a run whose step decays.

use fsot::{Config, Extent, Optimizer, metrics};

use crate::{descents, square};

const CHECKPOINTS: u64 = 10;

/// Measured with the same slices at ten checkpoints, the bound never increases by more than its standard
/// error: of a measurement, not of the difference, which is far smaller because the slices are the same.
#[test]
fn the_bound_falls_along_a_run() {
    let animated = Extent { frames: 6, height: 12, width: 12, spp: 1 };
    for (extent, dims, descents) in [
        (square(32, 1), 2, &descents()[..]),
        (square(12, 4), 2, &descents()[..1]),
        (animated, 2, &descents()[..1]),
        (square(16, 1), 4, &descents()[..1]),
    ] {
        for &descent in descents {
            let mut config = Config::new(extent, dims);
            config.descent = descent;
            let balance = config.balance;
            let mut optimizer = Optimizer::new(config).unwrap();
            let steps = 40 * CHECKPOINTS;
            let measure = |optimizer: &Optimizer| {
                metrics::Bound::measure(&optimizer.table(), optimizer.objective(), 7, 1 << 13).unwrap().total
            };
            let mut last = measure(&optimizer);
            let (mut trace, mut greatest_rise) =
                (format!("{:.3}", last.ratio_to_white_noise), f64::NEG_INFINITY);
            for step in 0..steps {
                let progress = step as f64 / steps as f64;
                optimizer.step(descent.rate().at(progress), balance.at(progress)).unwrap();
                if (step + 1) % (steps / CHECKPOINTS) == 0 {
                    let now = measure(&optimizer);
                    trace += &format!(" {:.3}", now.ratio_to_white_noise);
                    greatest_rise = greatest_rise.max((now.value - last.value) / now.standard_error);
                    last = now;
                }
            }
            println!(
                "{extent:?} × {dims}, {descent:?}\n  {trace}; \
                 greatest rise {greatest_rise:.2} standard errors"
            );
            assert!(greatest_rise <= 1.0, "{extent:?} {descent:?}: {trace}");
        }
    }
}
