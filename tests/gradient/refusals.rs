//! What `value_and_gradient` refuses, and how it says so.

use fsot::classes::{Classes, FilterForm};
use fsot::config::{Domain, Short};
use fsot::objective::{ObjectiveError, Slice, SliceError, ValueAndGradient};
use fsot::{Extent, Objective};

use crate::{lattice, objective, term};

const EXTENT: Extent = Extent { frames: 2, height: 3, width: 4, spp: 1 };

fn planned() -> Objective {
    let terms = [term(lattice(FilterForm::LevelSets), &[2, 0]), term(Classes::PerFrame, &[1])];
    objective(EXTENT, &[Domain::Torus; 3], &terms)
}

fn good() -> Slice {
    Slice { term: 0, member: 23, level: 0.5, direction: vec![0.6, 0.8], cut: vec![0.1, 0.9] }
}

fn refusal(points: &[f64], slices: &[Slice], words: &str) -> ObjectiveError {
    let error = planned().value_and_gradient(points, slices).unwrap_err();
    assert_eq!(error.to_string(), words);
    error
}

#[test]
fn points_that_do_not_fit() {
    for count in [0, 71, 73] {
        let words = format!(
            "the list of points holds {count} values, but the table has 72: give one value per coordinate"
        );
        let error = refusal(&vec![0.5; count], &[good()], &words);
        assert!(matches!(error, ObjectiveError::PointCount { expected: 72, .. }));
    }
    for value in [1.0, -1e-300, f64::NAN, f64::INFINITY, 1.5] {
        let mut points = vec![0.5; 72];
        points[17] = value;
        let words = format!("point coordinate 17 is {}: give finite values in [0, 1)", Short::from(value));
        // Also with nothing to do.
        for slices in [&[good()][..], &[]] {
            let error = refusal(&points, slices, &words);
            assert!(matches!(error, ObjectiveError::BadPoint { index: 17, .. }));
        }
    }
}

/// The second slice of two is bad.
fn bad_slice(slice: Slice, words: &str) -> ObjectiveError {
    refusal(&[0.5; 72], &[good(), slice], &format!("slice 1: {words}"))
}

#[test]
fn slices_that_name_what_there_is_not() {
    let error = bad_slice(
        Slice { term: 2, ..good() },
        "term is 2, but the objective has 2: stay below it", //
    );
    assert!(matches!(error, ObjectiveError::Slice { problem: SliceError::NoSuch { what: "term", .. }, .. }));
    bad_slice(
        Slice { term: usize::MAX, ..good() },
        &format!("term is {}, but the objective has 2: stay below it", usize::MAX),
    );
    bad_slice(Slice { member: 24, ..good() }, "member is 24, but the objective has 24: stay below it");
    let frame = Slice { term: 1, member: 2, direction: vec![1.0], cut: vec![0.0], ..good() };
    bad_slice(frame, "member is 2, but the objective has 2: stay below it");
}

#[test]
fn slices_of_another_shape() {
    for length in [0, 1, 3] {
        for (slice, what) in [
            (Slice { direction: vec![0.5; length], ..good() }, "direction"),
            (Slice { cut: vec![0.5; length], ..good() }, "cut"),
        ] {
            let words =
                format!("{what} has {length} components, but its group has 2 dimensions: give one each");
            assert!(matches!(
                bad_slice(slice, &words),
                ObjectiveError::Slice { problem: SliceError::Components { expected: 2, .. }, .. }
            ));
        }
    }
}

#[test]
fn slices_with_unusable_numbers() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e101] {
        for (slice, what) in [
            (Slice { direction: vec![0.5, value], ..good() }, "direction"),
            (Slice { cut: vec![value, 0.5], ..good() }, "cut"),
        ] {
            let value = Short::from(value);
            let words = format!("{what} is {value}: give finite values of reasonable size");
            assert!(matches!(
                bad_slice(slice, &words),
                ObjectiveError::Slice { problem: SliceError::Value { .. }, .. }
            ));
        }
    }
    for value in [f64::NAN, 1.0, -0.1, f64::INFINITY] {
        bad_slice(Slice { level: value, ..good() }, &format!("level is {value}: give a level in [0, 1)"));
    }
}

/// Odd, but well-defined: a zero direction has nothing to transport, a cut may lie anywhere.
#[test]
fn odd_slices_are_served() {
    let points: Vec<f64> = (0..72).map(|i| f64::from(i) / 72.0).collect();
    let objective = planned();
    let zero = Slice { direction: vec![0.0; 2], ..good() };
    let ValueAndGradient { value, gradient } = objective.value_and_gradient(&points, &[zero]).unwrap();
    assert_eq!(value, 0.0);
    assert!(gradient.iter().all(|&g| g == 0.0));
    let [near, far] = [[0.25, 0.5], [-2.75, 3.5]].map(|cut| Slice { cut: cut.to_vec(), ..good() });
    let [near, far] = [near, far].map(|slice| objective.value_and_gradient(&points, &[slice]).unwrap());
    assert!((near.value - far.value).abs() < 1e-14, "{near:?} {far:?}");
}
