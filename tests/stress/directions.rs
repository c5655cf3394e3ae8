//! Directions with components of any size, and sixteen dimensions.

use std::sync::LazyLock;

use fsot::config::{DimensionGroup, Domain};
use fsot::objective::{Slice, ValueAndGradient};
use fsot::{Config, Objective, SampleTable, Until, metrics};
use proptest::prelude::*;

use crate::{alternating, assert_inside, square};

/// Planned once: many dimensions take a while.
static OBJECTIVES: LazyLock<[Objective; 5]> = LazyLock::new(|| [2, 3, 5, 9, 16].map(objective));

/// One term over all `dims` dimensions on an interval.
fn objective(dims: usize) -> Objective {
    let group = DimensionGroup::new((0..dims).collect::<Vec<_>>());
    let mut config = Config::new(square(6, 1), dims).with_groups(&[group]);
    config.terms.truncate(1);
    Objective::new(&config).unwrap()
}

fn slice(direction: Vec<f64>) -> Slice {
    Slice { term: 0, member: 7, level: 0.2, cut: vec![0.0; direction.len()], direction }
}

/// Components between 1e-30 and 1, of any sign, or 0.
fn component() -> impl Strategy<Value = f64> {
    let sized = (-30.0..0.0_f64, any::<bool>()).prop_map(|(exponent, negative)| {
        if negative { -(10.0_f64.powf(exponent)) } else { 10.0_f64.powf(exponent) }
    });
    prop_oneof![6 => sized, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1e-30)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    /// What tiny components contribute is tiny, their gradients are those of the large one scaled down, and
    /// nothing is lost when all are tiny.
    #[test]
    fn components_may_be_tiny(
        size in 0..5_usize,
        small in prop::collection::vec(component(), 15),
        seed in any::<u64>(),
    ) {
        let objective = &OBJECTIVES[size];
        let dims = objective.dims();
        let table = SampleTable::white_noise(objective.extent(), dims, seed).unwrap();
        let points: Vec<f64> = table.values().iter().map(|&value| value.into()).collect();
        let mut direction = vec![1.0];
        direction.extend(&small[..dims - 1]);
        let ValueAndGradient { value, gradient } =
            objective.value_and_gradient(&points, &[slice(direction.clone())]).unwrap();
        prop_assert!(value.is_finite() && value >= 0.0);

        for (dim, component) in direction.iter().enumerate() {
            for sample in gradient.chunks_exact(dims) {
                // Both are the same displacement times a component: one rounding each.
                let expected = sample[0] * component;
                prop_assert!((sample[dim] - expected).abs() <= 1e-15 * expected.abs());
            }
        }

        let kept = |&component: &f64| if component.abs() < 1e-9 { 0.0 } else { component };
        let limit = direction.iter().map(kept).collect();
        let limit = objective.value_and_gradient(&points, &[slice(limit)]).unwrap().value;
        // Fifteen components of 1e-9 move projections and quantiles by 1.5e-8, and the square of a distance
        // below 2 by four times that; the law itself is good to 5e-8 of a sum of up to 16 when its components
        // span many magnitudes.
        prop_assert!((value - limit).abs() < 5e-6, "{value} {limit}");

        // Squared distances scale with the square of the direction, without underflow on the way; rounding of
        // the scaled components shows as in the law above.
        let shrunk = direction.iter().map(|component| component * 1e-30).collect();
        let shrunk = objective.value_and_gradient(&points, &[slice(shrunk)]).unwrap().value;
        prop_assert!((shrunk * 1e60 - value).abs() < 5e-6, "{shrunk} {value}");
    }
}

/// Directions on coordinate axes only, where all other components are 0, and sixteen dimensions all at once.
#[test]
fn sixteen_dimensions_improve() {
    for (axis_share, first) in [(0.0, Domain::Torus), (1.0, Domain::Interval)] {
        let mut config = Config::new(square(16, 1), 16);
        config.domains = alternating(16, first);
        config.slicing.axis_share = axis_share;
        let mut optimizer = fsot::Optimizer::new(config).unwrap();
        let bound = |optimizer: &fsot::Optimizer| {
            metrics::Bound::measure(&optimizer.table(), optimizer.objective(), 0, 1 << 11).unwrap()
        };
        let before = bound(&optimizer).total;
        optimizer.run(Until::SlicesPerClass(256)).unwrap();
        let after = bound(&optimizer).total;
        assert_inside(optimizer.table().values(), format_args!("axis share {axis_share}"));
        println!(
            "16 dimensions, {first:?} first, axis share {axis_share}: bound {:.3} of white noise, from {:.3}",
            after.ratio_to_white_noise, before.ratio_to_white_noise
        );
        let error = before.standard_error.hypot(after.standard_error);
        assert!(after.value < before.value - 5.0 * error, "{before:?} {after:?}");
    }
}
