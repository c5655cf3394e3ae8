//! Tables without spread, on faces, with duplicates, at the upper end, at the seam of a torus.

use std::ops::ControlFlow;

use fsot::config::{BELOW_ONE, Domain, Role};
use fsot::objective::{Slice, ValueAndGradient};
use fsot::targets::Target;
use fsot::{Config, Objective, Until, metrics};
use proptest::prelude::*;

use crate::{alternating, assert_inside, descents, square, start};

/// A start: value of coordinate `index` of a table with `dims` dimensions, given a random number there.
type Start = fn(index: usize, dims: usize, white: f32) -> f32;

/// A few steps of the spacing of f32 below 1.
fn below_one(white: f32) -> f32 {
    BELOW_ONE - (4.0 * white).floor() * f32::EPSILON / 2.0
}

const STARTS: [(&str, Start); 7] = [
    ("white noise", |_, _, white| white),
    ("all equal", |_, _, _| 0.3),
    ("all at the origin", |_, _, _| 0.0),
    ("all on a face", |index, dims, white| if index % dims == 0 { BELOW_ONE } else { white }),
    ("four values", |_, _, white| [0.1, 0.35, 0.6, 0.85][(4.0 * white) as usize]),
    ("a few ulps below 1", |_, _, white| below_one(white)),
    ("at the seam", |index, _, white| if index % 3 == 0 { below_one(white) } else { white * 1e-30 }),
];

/// Whatever the start, the table spreads out, and to the same bound as white noise does.
#[test]
fn every_start_ends_where_white_noise_does() {
    let extent = square(16, 1);
    println!(
        "bound relative to white noise after 256 slices per pixel: \
         least and greatest over domains and descents"
    );
    let mut of_white = Vec::new();
    for (name, value) in STARTS {
        let (mut least, mut greatest) = (f64::INFINITY, 0.0_f64);
        let mut run = 0;
        for (dims, descents) in [(1, &descents()[..]), (2, &descents()), (3, &descents()[..1])] {
            for first in [Domain::Interval, Domain::Torus] {
                for &descent in descents {
                    let mut config = Config::new(extent, dims);
                    config.domains = alternating(dims, first);
                    config.descent = descent;
                    let white = fsot::SampleTable::white_noise(extent, dims, 1).unwrap();
                    let values =
                        white.values().iter().enumerate().map(|(i, &white)| value(i, dims, white)).collect();
                    let mut optimizer = start(config, values);
                    let context = format!("{name}, {dims} dimensions, {first:?} first, {descent:?}");
                    optimizer
                        .run_observed(Until::SlicesPerClass(256), |report| {
                            assert!(report.displacement.is_finite(), "{context}");
                            ControlFlow::Continue(())
                        })
                        .unwrap();
                    let table = optimizer.table();
                    assert_inside(table.values(), &context);
                    let bound = metrics::Bound::measure(&table, optimizer.objective(), 0, 1 << 12).unwrap();
                    let ratio = bound.total.ratio_to_white_noise;
                    (least, greatest) = (least.min(ratio), greatest.max(ratio));
                    if of_white.len() <= run {
                        of_white.push(ratio);
                    }
                    // Measured within 9 % of each other (Adam in one dimension): different local optima.
                    assert!(
                        ratio < 1.15 * of_white[run],
                        "{context}: {ratio}, from white noise {}",
                        of_white[run]
                    );
                    run += 1;
                }
            }
        }
        println!("{name}: {least:.3} to {greatest:.3}");
    }
}

/// Random slices of a configuration, as the optimiser draws them.
fn drawn(config: &Config) -> (Objective, Vec<Slice>) {
    let objective = Objective::new(config).unwrap();
    let slices = objective.draw(3, 1, Role::Descend);
    assert!(slices.len() > 100);
    (objective, slices)
}

/// With all points in one place, W2² is the squared distance to the mean plus the variance, and the
/// displacements of a subset add up to n times the distance to the mean.
#[test]
fn a_single_place_has_its_closed_form() {
    for dims in [1, 2, 3] {
        let mut config = Config::new(square(12, 1), dims);
        config.slicing.batch_slices = Some(400);
        let (objective, slices) = drawn(&config);
        for place in [0.0, 0.3, 1.0 - f64::EPSILON / 2.0] {
            let points = vec![place; 144 * dims];
            let ValueAndGradient { value, gradient } =
                objective.value_and_gradient(&points, &slices).unwrap();
            let (mut expected, mut sums) = (0.0, vec![0.0; dims]);
            let scale = 1.0 / (144.0 * slices.len() as f64);
            for slice in &slices {
                let taps = objective.taps(slice.term).unwrap();
                let n = taps.iter().filter(|tap| tap.weight > slice.level).count() as f64;
                let group = &objective.terms().nth(slice.term).unwrap().dims;
                let law = Target::UniformCube.project(&slice.direction);
                let away = place * slice.direction.iter().sum::<f64>() - law.mean();
                expected += scale * n * (away * away + law.variance());
                for (&dim, component) in group.iter().zip(&slice.direction) {
                    sums[dim] += 2.0 * scale * n * away * component;
                }
            }
            // Sums of a few thousand terms whose total is below 1; quantile cells of three dimensions are
            // good to 2e-12.
            assert!((value - expected).abs() < 1e-11, "{dims} {place}: {value} {expected}");
            for (dim, sum) in sums.iter().enumerate() {
                let found: f64 = gradient.iter().skip(dim).step_by(dims).sum();
                assert!((found - sum).abs() < 1e-11, "{dims} {place}: {found} {sum}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    /// A torus has no place of its own: shifting points and cuts together changes nothing, also when points
    /// cross the seam.
    #[test]
    fn a_torus_may_be_shifted(
        points in prop::collection::vec(
            prop_oneof![4 => 0.0..1.0_f64, 1 => Just(0.0), 1 => Just(1.0 - 1e-16)],
            128,
        ),
        shift in prop::array::uniform2(0.0..1.0_f64),
    ) {
        let mut config = Config::new(square(8, 1), 2);
        config.domains = vec![Domain::Torus; 2];
        config.slicing.batch_slices = Some(128);
        let (objective, mut slices) = drawn(&config);
        let wrap = |value: f64| { let value = value % 1.0; if value < 1.0 { value } else { 0.0 } };
        let ValueAndGradient { value: before, gradient } =
            objective.value_and_gradient(&points, &slices).unwrap();
        let moved: Vec<f64> = points.iter().enumerate().map(|(i, at)| wrap(at + shift[i % 2])).collect();
        for slice in &mut slices {
            slice.cut.iter_mut().zip(shift).for_each(|(cut, shift)| *cut = wrap(*cut + shift));
        }
        let ValueAndGradient { value: after, gradient: moved_gradient } =
            objective.value_and_gradient(&moved, &slices).unwrap();
        // A few roundings of 1e-16 per point. Points do not fall on the f32 cuts, but some come in pairs:
        // exchanging two of equal projection moves their gradients, not the value, nor the sum of gradients.
        prop_assert!((before - after).abs() < 1e-13, "{before} {after}");
        for dim in 0..2 {
            let sum = |gradient: &[f64]| gradient.iter().skip(dim).step_by(2).sum::<f64>();
            prop_assert!((sum(&gradient) - sum(&moved_gradient)).abs() < 1e-13);
        }
    }

    /// The two sides of the seam are one place.
    #[test]
    fn the_seam_is_no_step(points in prop::collection::vec(0.0..1.0_f64, 128), index in 0..128_usize) {
        let mut config = Config::new(square(8, 1), 2);
        config.domains = vec![Domain::Torus; 2];
        config.slicing.batch_slices = Some(128);
        let (objective, slices) = drawn(&config);
        let mut points = points;
        let mut value_at = |place: f64| {
            points[index] = place;
            objective.value_and_gradient(&points, &slices).unwrap().value
        };
        let (left, right) = (value_at(1.0 - 1e-12), value_at(0.0));
        // Slope of one coordinate: at most 2 · displacement · theta / N < 2 · √2 / 64.
        prop_assert!((left - right).abs() < 1e-13, "{left} {right}");
    }
}
