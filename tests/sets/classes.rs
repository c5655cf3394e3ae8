//! Labelled classes and ramps.

use fsot::classes::{Classes, Demand, PrefixLength, PrefixLengths, PrefixOf, Ramp};
use fsot::config::{LabelSubsets, Role, Term};
use fsot::targets::Target;
use fsot::{Config, ConfigError, Extent, Optimizer, Until};

use crate::optimised;

fn distance(points: &[f64]) -> f64 {
    crate::distance(points, 2, &Target::UniformCube, 128)
}

fn alone(count: usize) -> f64 {
    distance(&optimised(Config::classes(&[count], 2, &LabelSubsets::Every), 2000))
}

/// Measured: 1.05 to 1.08 after 2,000 slices. The allowance is for other platforms' rounding.
#[test]
fn two_classes_and_their_union_are_as_good_as_alone() {
    let points = optimised(Config::classes(&[512, 512], 2, &LabelSubsets::EachAndAll), 2000);
    let (single, both) = (alone(512), alone(1024));
    for class in points.chunks_exact(1024) {
        assert!(distance(class) < 1.2 * single, "{} {single}", distance(class));
    }
    assert!(distance(&points) < 1.2 * both, "{} {both}", distance(&points));
}

#[test]
fn every_set_of_three_labels_is_a_class() {
    let config = Config::classes(&[60, 100, 140], 2, &LabelSubsets::Every);
    let Classes::Labelled { subsets, .. } = &config.terms[0].classes else { panic!() };
    assert_eq!(subsets.len(), 7);
    let points = optimised(config, 2000);
    let (first, rest) = points.split_at(120);
    let (second, third) = rest.split_at(200);
    for (class, count) in [(first, 60), (second, 100), (third, 140), (rest, 240), (&points[..320], 160)] {
        assert!(distance(class) < 1.45 * alone(count), "{count}");
    }
}

#[test]
fn degenerate_labels_are_classes_too() {
    // An empty class beside others, a single point, and equal labels throughout.
    for counts in [vec![0, 40], vec![1], vec![1, 1, 1], vec![40]] {
        let points = optimised(Config::classes(&counts, 2, &LabelSubsets::EachAndAll), 1000);
        let count = counts.iter().sum();
        assert_eq!(points.len(), 2 * count);
        assert!(distance(&points) < 1.5 * alone(count), "{counts:?}: {}", distance(&points));
        if counts == [1] {
            assert!(points.iter().all(|value| (value - 0.5).abs() < 0.02), "{points:?}");
        }
    }
    let one_label = Config::classes(&[64, 0], 2, &LabelSubsets::Every);
    let unlabelled = Config::classes(&[64], 2, &LabelSubsets::Every);
    assert!(distance(&optimised(one_label, 1000)) < 1.1 * distance(&optimised(unlabelled, 1000)));
}

#[test]
fn one_and_three_dimensions_work() {
    for dims in [1, 3] {
        let points = optimised(Config::classes(&[50, 70], dims, &LabelSubsets::EachAndAll), 1000);
        let noise = fsot::SampleTable::white_noise(Extent::points(120), dims, 3).unwrap();
        let noise: Vec<f64> = noise.values().iter().map(|&value| value.into()).collect();
        let of = |points: &[f64]| crate::distance(points, dims, &Target::UniformCube, 64);
        assert!(of(&points) < 0.5 * of(&noise), "{dims}");
        assert!(of(&points[..50 * dims]) < 0.5 * of(&noise[..50 * dims]), "{dims}");
    }
}

/// Any part of a ramp is uniform: here the upper and the lower half.
#[test]
fn the_ends_of_a_ramp_are_uniform() {
    let coordinates: Vec<f64> = (0..400).map(|i| f64::from(i) / 399.0).collect();
    let classes =
        Classes::Ramps { coordinates: coordinates.into(), ramps: vec![Ramp::Rising, Ramp::Falling] };
    let term =
        Term { classes, target: Target::UniformCube, dims: vec![0, 1], weight: 1.0, role: Role::Descend };
    let points = optimised(Config::point_set(400, 2, vec![term]), 4000);
    let best = alone(200);
    for half in points.chunks_exact(400) {
        assert!(distance(half) < 2.0 * best, "{} {best}", distance(half));
    }
}

/// Terms whose classes hold nothing of what is demanded are left out, and do not stand in the way of the
/// others.
#[test]
fn terms_that_nobody_demands_are_left_out() {
    let term = |classes| Term {
        classes,
        target: Target::UniformCube,
        dims: vec![0, 1],
        weight: 1.0,
        role: Role::Descend,
    };
    let labels: Vec<u32> = (0..80).map(|point| u32::from(point >= 30)).collect();
    let only = |label: u32| term(Classes::labelled(labels.clone(), [vec![label]]));
    let short = PrefixLength { length: 24, weight: 1.0 };
    let prefix = term(Classes::Prefixes { of: PrefixOf::Table, lengths: PrefixLengths::Given(vec![short]) });
    let demand = |first: usize| {
        let flags = (0..80).map(|point| point >= first).collect();
        Demand::new([1, 1, 80], flags, vec![vec![0, 1]]).unwrap()
    };
    for batch_slices in [None, Some(64)] {
        for terms in [vec![only(0), only(1)], vec![prefix.clone(), term(Classes::WholeTable)]] {
            let mut config = Config::point_set(80, 2, terms);
            config.slicing.batch_slices = batch_slices;
            let mut optimizer = Optimizer::for_demand(config, &demand(30)).unwrap();
            assert_eq!(optimizer.objective().terms().count(), 1);
            let before = optimizer.table();
            optimizer.step(1.0, 1.0).unwrap();
            let after = optimizer.table();
            assert_eq!(before.values()[..60], after.values()[..60]);
            assert!((60..160).all(|i| before.values()[i] != after.values()[i]));
        }
    }
    let refused = Optimizer::for_demand(Config::point_set(80, 2, vec![prefix]), &demand(30));
    assert_eq!(refused.err(), Some(ConfigError::NoDemand));
}

#[test]
fn more_labels_than_have_sets_are_classes_still() {
    let config = Config::classes(&[4; 70], 2, &LabelSubsets::Every);
    let Classes::Labelled { subsets, .. } = &config.terms[0].classes else { panic!() };
    assert_eq!((subsets.len(), subsets[70].labels.len()), (71, 70));
}

/// A number of slices is meant per class, however many a step draws.
#[test]
fn slices_are_counted_per_class() {
    let mut config = Config::classes(&[40, 60], 2, &LabelSubsets::EachAndAll);
    for batch_slices in [None, Some(96)] {
        config.slicing.batch_slices = batch_slices;
        let mut optimizer = Optimizer::new(config.clone()).unwrap();
        let report = optimizer.run(Until::SlicesPerClass(320)).unwrap();
        assert!(report.slices.abs_diff(3 * 320) <= 96, "{batch_slices:?}: {}", report.slices);
    }
}

#[test]
fn a_class_that_nobody_demands_is_left_alone() {
    let config = Config::classes(&[30, 50], 2, &LabelSubsets::EachAndAll);
    let flags = (0..80).map(|point| point < 30).collect();
    let demand = Demand::new([1, 1, 80], flags, vec![vec![0, 1]]).unwrap();
    let mut optimizer = Optimizer::for_demand(config, &demand).unwrap();
    let before = optimizer.table();
    let slices = optimizer.step(1.0, 1.0).unwrap().slices;
    // Two classes hold demanded points: the first label, and the union, which is the same set now.
    assert_eq!(slices, 32);
    let after = optimizer.table();
    assert_eq!(before.values()[60..], after.values()[60..]);
    assert_ne!(before.values()[..60], after.values()[..60]);
}

#[test]
fn threads_change_nothing() {
    let config = || Config::classes(&[300, 1100], 2, &LabelSubsets::EachAndAll);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| optimised(config(), 100))
    };
    assert_eq!(run(1), run(3));
}
