//! The value is the mean over slices of `(n / N) W2²`.

use fsot::Extent;
use fsot::classes::{Classes, FilterForm};
use fsot::config::Domain;
use fsot::objective::{Slice, ValueAndGradient};

use crate::brute_force::Law;
use crate::{lattice, objective, spread, term, unit};

/// A tile so much larger than the kernel that its images weigh less than 1e-12, so that the filter weight is
/// its formula at the toroidal distance.
const EXTENT: Extent = Extent { frames: 1, height: 17, width: 16, spp: 2 };
const SIGMA: f64 = 2.1;
const DIRECTION: [f64; 5] = [0.8, -0.5, 0.3, -0.9, 0.6];

/// Weight of a sample under the filter of pixel `member`, from the definition; 0 below the documented
/// truncation.
fn weight(member: usize, sample: usize) -> f64 {
    let [centre, site] = [member, sample / EXTENT.spp].map(|index| EXTENT.site(index));
    let apart = |a: usize, b: usize, len: usize| a.abs_diff(b).min(len - a.abs_diff(b)) as f64;
    let (dy, dx) = (apart(centre.y, site.y, EXTENT.height), apart(centre.x, site.x, EXTENT.width));
    let weight = (-(dy * dy + dx * dx) / (SIGMA * SIGMA)).exp();
    if weight >= 1e-3 { weight } else { 0.0 }
}

/// What the documentation of the objective says, by dense loops over all samples.
fn by_definition(points: &[f64], dims: usize, torus: bool, form: FilterForm, slice: &Slice) -> f64 {
    let coordinate = |value: f64, cut: f64| {
        let shifted = value - cut;
        if torus { shifted - shifted.floor() } else { value }
    };
    let mut subset = Vec::new();
    for (sample, point) in points.chunks_exact(dims).enumerate() {
        let weight = weight(slice.member, sample);
        let mass = match form {
            FilterForm::Weighted => weight,
            FilterForm::LevelSets => f64::from(u8::from(weight > slice.level)),
        };
        if mass > 0.0 {
            let along = (0..dims).map(|dim| coordinate(point[dim], slice.cut[dim]) * slice.direction[dim]);
            subset.push((along.sum::<f64>(), mass));
        }
    }
    let mass: f64 = subset.iter().map(|(_, mass)| mass).sum();
    mass / EXTENT.samples() as f64 * Law::new(&slice.direction).w2_squared(&subset)
}

#[test]
fn the_value_is_that_of_the_definition() {
    for dims in 1..=5 {
        for (torus, form) in
            [(false, FilterForm::LevelSets), (true, FilterForm::LevelSets), (true, FilterForm::Weighted)]
        {
            let domains = vec![if torus { Domain::Torus } else { Domain::Interval }; dims];
            let all: Vec<usize> = (0..dims).collect();
            let objective = objective(EXTENT, &domains, &[term(lattice(form), &all)]);
            let points = spread(EXTENT.samples() * dims, 0.1);
            // Subsets of 97, 13, 1 and 5 pixels; next to the centre, taps weigh 0.797.
            let slices: Vec<Slice> = [(0, 0.0), (77, 0.4), (271, 0.8), (60, 0.7)]
                .into_iter()
                .map(|(member, level)| Slice {
                    term: 0,
                    member,
                    level,
                    direction: unit(&DIRECTION[..dims]),
                    cut: spread(dims, 0.3),
                })
                .collect();
            let value = objective.value_and_gradient(&points, &slices).unwrap().value;
            let expected = slices.iter().map(|slice| by_definition(&points, dims, torus, form, slice));
            let expected = expected.sum::<f64>() / slices.len() as f64;
            // The midpoint rule is good to (cell / 2000)² relative, the crate's law to 5e-9 from five
            // dimensions on.
            assert!(
                (value - expected).abs() < 1e-6 * expected,
                "{dims} {torus} {form:?}: {value} {expected}"
            );
        }
    }
}

/// One sample at `a` in one dimension: `∫ (u − a)² du = ((1 − a)³ + a³) / 3`, and its derivative `2a − 1`.
#[test]
fn one_sample_on_the_line() {
    let extent = Extent { frames: 1, height: 1, width: 1, spp: 1 };
    let objective = objective(extent, &[Domain::Interval], &[term(Classes::WholeTable, &[0])]);
    let slice = Slice { term: 0, member: 0, level: 0.5, direction: vec![1.0], cut: vec![0.0] };
    for a in [0.0, 0.25, 0.5, 0.9] {
        let ValueAndGradient { value, gradient } =
            objective.value_and_gradient(&[a], std::slice::from_ref(&slice)).unwrap();
        assert!((value - ((1.0 - a).powi(3) + a.powi(3)) / 3.0).abs() < 1e-14, "{a}: {value}");
        assert!((gradient[0] - (2.0 * a - 1.0)).abs() < 1e-14, "{a}: {gradient:?}");
    }
}

/// Two samples of a pixel against the cells `[0, 1/2]` and `[1/2, 1]`, whose means are 1/4 and 3/4; among
/// four samples, so the mass of the slice is 1/2.
#[test]
fn two_samples_on_the_line() {
    let extent = Extent { frames: 1, height: 1, width: 2, spp: 2 };
    let objective = objective(extent, &[Domain::Interval], &[term(Classes::PerPixel, &[0])]);
    let slice = Slice { term: 0, member: 1, level: 0.0, direction: vec![1.0], cut: vec![0.0] };
    let ValueAndGradient { value, gradient } =
        objective.value_and_gradient(&[0.1, 0.2, 0.9, 0.4], &[slice]).unwrap();
    // Each cell spreads by (1/2)² / 12 around its mean.
    let expected = 0.5 * (0.5 * (0.15_f64.powi(2) + 0.15_f64.powi(2)) + 1.0 / 48.0);
    assert!((value - expected).abs() < 1e-14, "{value} {expected}");
    for (given, expected) in gradient.iter().zip([0.0, 0.0, 0.5 * 0.15, 0.5 * 0.15]) {
        assert!((given - expected).abs() < 1e-14, "{gradient:?}");
    }
}

#[test]
fn no_slices_weigh_nothing() {
    let objective = objective(EXTENT, &[Domain::Torus; 2], &[term(Classes::WholeTable, &[0, 1])]);
    let points = spread(EXTENT.samples() * 2, 0.0);
    let ValueAndGradient { value, gradient } = objective.value_and_gradient(&points, &[]).unwrap();
    assert_eq!(value, 0.0);
    assert_eq!(gradient, vec![0.0; points.len()]);
}

/// The mean over a list is the mean over its parts, also beyond the chunks in which it is summed.
#[test]
fn long_lists_are_means_too() {
    let extent = Extent { frames: 1, height: 2, width: 3, spp: 1 };
    let objective =
        objective(extent, &[Domain::Interval; 2], &[term(lattice(FilterForm::LevelSets), &[0, 1])]);
    let points = spread(12, 0.2);
    let slice = |i: usize| Slice {
        term: 0,
        member: i % 6,
        level: (i as f64 * 0.618).fract(),
        direction: unit(&[(i as f64).cos(), (i as f64).sin()]),
        cut: vec![0.0; 2],
    };
    let slices: Vec<Slice> = (0..10_000).map(slice).collect();
    let ValueAndGradient { value, gradient } = objective.value_and_gradient(&points, &slices).unwrap();
    let parts = slices.chunks(2500).map(|part| objective.value_and_gradient(&points, part).unwrap());
    let (mut expected, mut sum) = (0.0, vec![0.0; 12]);
    for ValueAndGradient { value, gradient } in parts {
        expected += value / 4.0;
        sum.iter_mut().zip(gradient).for_each(|(sum, part)| *sum += part / 4.0);
    }
    // Two orders of summing 10⁴ numbers.
    assert!((value - expected).abs() < 1e-12, "{value} {expected}");
    assert!(gradient.iter().zip(&sum).all(|(a, b)| (a - b).abs() < 1e-12), "{gradient:?} {sum:?}");
}
