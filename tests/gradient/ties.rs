//! Exact ties: the distance is continuous there, but has a corner, of which the gradient is one side.

use fsot::Extent;
use fsot::classes::{Classes, FilterForm};
use fsot::config::Domain;
use fsot::objective::{Slice, ValueAndGradient};

use crate::{lattice, objective, spread, term, unit};

const EXTENT: Extent = Extent { frames: 1, height: 3, width: 3, spp: 1 };
const DOMAINS: [Domain; 2] = [Domain::Interval, Domain::Torus];

fn slices(direction: [f64; 2]) -> Vec<Slice> {
    let slice = |(term, member, level)| Slice {
        term,
        member,
        level,
        direction: unit(&direction),
        cut: vec![0.0, 0.93],
    };
    [(0, 4, 0.1), (0, 0, 0.5), (1, 0, 0.0), (2, 4, 0.0)].into_iter().map(slice).collect()
}

fn planned() -> fsot::Objective {
    let terms = [
        term(lattice(FilterForm::LevelSets), &[0, 1]),
        term(Classes::WholeTable, &[0, 1]),
        term(lattice(FilterForm::Weighted), &[0, 1]),
    ];
    objective(EXTENT, &DOMAINS, &terms)
}

/// Samples 3 and 5 stand at the same place, samples 1 and 7 differ but tie along the second axis.
fn tied() -> Vec<f64> {
    let mut points = spread(18, 0.4);
    points.copy_within(10..12, 6);
    points[15] = points[3];
    points
}

#[test]
fn tied_samples_have_one_finite_gradient() {
    let objective = planned();
    for direction in [[0.0, 1.0], [0.6, -0.8], [1.0, 0.0]] {
        let ValueAndGradient { value, gradient } =
            objective.value_and_gradient(&tied(), &slices(direction)).unwrap();
        assert!(value > 0.0 && gradient.iter().all(|g| g.is_finite()), "{value} {gradient:?}");
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let again = pool.install(|| objective.value_and_gradient(&tied(), &slices(direction)).unwrap());
            assert_eq!(again.value.to_bits(), value.to_bits());
            assert!(again.gradient.iter().zip(&gradient).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

/// Samples that move together stay tied, and along that way the value is smooth: its derivative is the sum of
/// their gradients.
#[test]
fn duplicates_that_move_together_have_a_derivative() {
    let (objective, slices) = (planned(), slices([0.6, -0.8]));
    let gradient = objective.value_and_gradient(&tied(), &slices).unwrap().gradient;
    for dim in 0..2 {
        let at = |by: f64| {
            let mut points = tied();
            points[6 + dim] += by;
            points[10 + dim] += by;
            objective.value_and_gradient(&points, &slices).unwrap().value
        };
        let numeric = (at(1e-6) - at(-1e-6)) / 2e-6;
        let analytic = gradient[6 + dim] + gradient[10 + dim];
        assert!((numeric - analytic).abs() < 1e-6 * analytic.abs(), "dim {dim}: {analytic} {numeric}");
    }
}

/// One of two tied samples moves away: the slope differs on the two sides, the gradient lies between them
/// (here: is one of them), and the value has no jump.
#[test]
fn a_tie_is_a_corner_and_not_a_jump() {
    let objective = planned();
    let slices = &slices([0.6, -0.8])[2..3];
    let at = |by: f64| {
        let mut points = tied();
        points[6] += by;
        objective.value_and_gradient(&points, slices).unwrap()
    };
    let ValueAndGradient { value, gradient } = at(0.0);
    // A central difference on either side, clear of the corner and of all other samples.
    let slope = |from: f64, to: f64| (at(to).value - at(from).value) / (to - from);
    let (left, right) = (slope(-2e-6, -1e-6), slope(1e-6, 2e-6));
    // The two samples swap neighbouring cells of ninths of the mass: |left - right| = 2/9 · 0.6 · (cell
    // distance).
    assert!(left - right > 1e-3, "{left} {right}");
    let near = |slope: f64| (gradient[6] - slope).abs() < 1e-5; // curvature times the distance of 1e-6
    assert!(near(left) || near(right), "{} {left} {right}", gradient[6]);
    for by in [1e-12, 1e-9, 1e-6] {
        let slope = 2.0 * left.abs().max(right.abs());
        for by in [by, -by] {
            // 1e-15: rounding of a value of about 0.01.
            assert!((at(by).value - value).abs() <= slope * by.abs() + 1e-15, "{by}");
        }
    }
}

/// All samples at one place: every rank is a tie, and the mean displacement is that of the whole subset.
#[test]
fn a_table_of_one_place_is_pulled_as_one() {
    let objective = planned();
    let points = [0.2, 0.7].repeat(9);
    let slices = &slices([1.0, 0.0])[2..3];
    let ValueAndGradient { value, gradient } = objective.value_and_gradient(&points, slices).unwrap();
    // ∫ (u − 0.2)² du, and its derivative −2 (1/2 − 0.2).
    assert!((value - (0.8_f64.powi(3) + 0.2_f64.powi(3)) / 3.0).abs() < 1e-14, "{value}");
    let sum: f64 = gradient.iter().step_by(2).sum();
    assert!((sum + 0.6).abs() < 1e-14, "{sum}");
    assert!(gradient.iter().skip(1).step_by(2).all(|&g| g == 0.0), "{gradient:?}");
}
