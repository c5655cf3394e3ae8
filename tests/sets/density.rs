//! Laws of densities and clouds, and sets that follow them.

use fsot::Config;
use fsot::config::{Domain, Role, Term};
use fsot::metrics::{DensityMatch, Samples};
use fsot::targets::{Density, PointCloud, Projected, Target};

use crate::{distance, optimised};

/// The law along a direction, by brute force: pixels cut into equal masses.
fn brute_force(density: &Density, direction: [f64; 2]) -> Vec<(f64, f64)> {
    let [width, height] = density.size();
    let cuts = if width * height > 100 { 8 } else { 64 };
    let mut atoms = Vec::new();
    for (pixel, &value) in density.values().iter().enumerate().filter(|(_, value)| **value > 0.0) {
        for cut in 0..cuts * cuts {
            let x = ((pixel % width) as f64 + ((cut % cuts) as f64 + 0.5) / cuts as f64) / width as f64;
            let y = ((pixel / width) as f64 + ((cut / cuts) as f64 + 0.5) / cuts as f64) / height as f64;
            let share = f64::from(value) / density.mass() / (cuts * cuts) as f64;
            atoms.push((x * direction[0] + y * direction[1], share));
        }
    }
    atoms.sort_by(|a, b| a.0.total_cmp(&b.0));
    atoms
}

#[test]
fn laws_of_small_pictures_are_exact() {
    let pictures = [
        Density::new(1, 1, vec![3.0]).unwrap(),
        Density::new(1, 3, vec![1.0, 0.0, 2.0]).unwrap(),
        Density::new(4, 2, vec![0.0, 1.0, 0.5, 2.0, 0.0, 0.0, 0.0, 1.0]).unwrap(),
        Density::new(40, 30, (0..1200).map(|i| ((i * 37) % 11) as f32).collect()).unwrap(),
    ];
    for density in pictures {
        let target = Target::Density(density.clone().into());
        for direction in [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8], [-0.8, 0.6], [-0.1, -0.99], [0.7, -0.001]] {
            let law = target.project(&direction);
            let atoms = brute_force(&density, direction);
            let (mut below, mut moment) = (0.0, 0.0);
            let (mut worst, mut worst_integral) = (0.0_f64, 0.0_f64);
            for (at, share) in &atoms {
                // Half of the atom lies below its middle.
                worst = worst.max((law.cdf(*at) - below - 0.5 * share).abs());
                below += share;
                moment += share * at;
                worst_integral = worst_integral.max((law.quantile_integral(below) - moment).abs());
            }
            // The masses are 1/64 of a pixel wide, or 1/8 of a small one; along an axis a column of them
            // coincides.
            assert!(worst < 0.02, "{:?} {direction:?}: {worst}", density.size());
            assert!(worst_integral < 2e-4, "{:?} {direction:?}: {worst_integral}", density.size());
            // A component of 0 is replaced by a millionth of the other.
            assert!((law.mean() - moment).abs() < 1e-6, "{:?} {direction:?}", density.size());
        }
    }
}

/// One pixel, or a constant picture, is the square.
#[test]
fn a_constant_picture_is_the_square() {
    for size in [1, 5, 300] {
        let density = Density::new(size, size, vec![0.25; size * size]).unwrap();
        for direction in [[0.6, 0.8], [0.99, -0.1], [1.0, 0.0]] {
            let (law, cube) = (
                Target::Density(density.clone().into()).project(&direction),
                Target::UniformCube.project(&direction),
            );
            for (a, b) in law.cell_means(500).zip(cube.cell_means(500)) {
                assert!((a - b).abs() < 2e-5, "{size} {direction:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn points_keep_out_of_what_is_empty() {
    // Zero rows between two bars of different weight, in a wide picture.
    let mut values = vec![0.0; 80 * 20];
    values[..80 * 5].fill(1.0);
    values[80 * 15..].fill(3.0);
    let density = Density::new(80, 20, values).unwrap();
    let points = optimised(Config::stippling(800, density.clone()), 2000);
    let rows =
        |from: f64, to: f64| points.chunks_exact(2).filter(|point| (from..to).contains(&point[1])).count();
    assert!(rows(0.0, 0.3) > 190 && rows(0.0, 0.3) < 210, "{}", rows(0.0, 0.3));
    assert!(rows(0.7, 1.0) > 590 && rows(0.7, 1.0) < 610, "{}", rows(0.7, 1.0));
    // Four of the ten empty rows are beyond the blur, which ends after three deviations.
    let measure = |points: &[f64]| {
        DensityMatch::measure(Samples::points(points, 2).unwrap(), [0, 1], &density, 0.0125).unwrap()
    };
    let found = measure(&points);
    assert!(found.correlation > 0.97 && found.strays == 0, "{found:?}");
    let astray: Vec<f64> = points.iter().copied().chain([0.5, 0.5]).collect();
    assert_eq!(measure(&astray).strays, 1);
}

#[test]
fn pictures_of_one_pixel_or_one_row_are_followed() {
    let one = optimised(Config::stippling(64, Density::new(1, 1, vec![0.3]).unwrap()), 2000);
    // A set on the square, alone, reaches 0.018.
    assert!(distance(&one, 2, &Target::UniformCube, 64) < 0.03);
    for (size, along) in [([5, 1], 0), ([1, 5], 1)] {
        let density = Density::new(size[0], size[1], vec![1.0, 0.0, 3.0, 0.0, 0.0]).unwrap();
        let points = optimised(Config::stippling(400, density), 2000);
        let inside = |from: f64, to: f64| {
            points.chunks_exact(2).filter(|point| (from..to).contains(&point[along])).count()
        };
        assert!(inside(0.0, 0.3).abs_diff(100) < 5, "{size:?}: {}", inside(0.0, 0.3));
        assert!(inside(0.3, 0.7).abs_diff(300) < 5, "{size:?}: {}", inside(0.3, 0.7));
    }
}

#[test]
fn what_cannot_be_matched_is_named() {
    let density = Density::new(2, 2, vec![1.0; 4]).unwrap();
    let says = |points: &[f64], sigma, text: &str| {
        let found = Samples::points(points, 2)
            .and_then(|points| DensityMatch::measure(points, [0, 1], &density, sigma));
        let error = found.unwrap_err().to_string();
        assert!(error.contains(text), "{error}");
    };
    says(&[], 0.1, "points is 0");
    says(&[0.5; 3], 0.1, "3 values");
    says(&[0.5, 1.0], 0.1, "point 0 has 1 in dimension 1");
    for sigma in [0.0, 1.5, f64::NAN] {
        says(&[0.5, 0.5], sigma, "sigma is");
    }
    // All in one corner of an even picture: they do not resemble it.
    let corner = Samples::points(&[0.1; 20], 2).unwrap();
    let corner = DensityMatch::measure(corner, [0, 1], &density, 0.1).unwrap();
    assert!(corner.correlation < 0.5, "{corner:?}");
}

/// A picture of 4 : 1 has neighbours as far apart in the picture along both axes.
#[test]
fn spacing_is_even_in_the_picture() {
    let points = optimised(Config::stippling(400, Density::new(4, 1, vec![1.0; 4]).unwrap()), 2000);
    let mut nearest = [0.0; 2];
    for (i, a) in points.chunks_exact(2).enumerate() {
        let others = points.chunks_exact(2).enumerate().filter(|(j, _)| *j != i);
        let offset = others
            .map(|(_, b)| [(a[0] - b[0]).abs(), (a[1] - b[1]).abs() / 4.0])
            .min_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])))
            .unwrap();
        nearest[0] += offset[0];
        nearest[1] += offset[1];
    }
    let ratio = nearest[0] / nearest[1];
    // Ten rows are few: the edges make nearest neighbours lie along them. In units of the square it would be
    // 4.
    assert!((0.6..2.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_set_can_thin_out_a_cloud() {
    // A ring of 3,000 points, thinned to 100.
    let angle = |i: usize| i as f32 / 3000.0 * std::f32::consts::TAU;
    let ring = (0..3000).flat_map(|i| [0.5 + 0.4 * angle(i).cos(), 0.5 + 0.4 * angle(i).sin()]).collect();
    let target = Target::Cloud(PointCloud::new(2, ring).unwrap().into());
    let term = Term {
        classes: fsot::classes::Classes::WholeTable,
        target: target.clone(),
        dims: vec![0, 1],
        weight: 1.0,
        role: Role::Descend,
    };
    let points = optimised(Config::point_set(100, 2, vec![term]), 4000);
    let off: f64 = points.chunks_exact(2).map(|p| ((p[0] - 0.5).hypot(p[1] - 0.5) - 0.4).abs()).sum();
    assert!(off / 100.0 < 0.02, "{}", off / 100.0);
    assert!(distance(&points, 2, &target, 64) < 0.01);
}

#[test]
fn laws_of_the_caller_agree_with_each_other() {
    // The triangle 2x on [0, 1] three ways.
    let samples = (0..200_000).map(|i| ((f64::from(i) + 0.5) / 200_000.0).sqrt()).collect();
    let laws = [
        Projected::from_density(&[0.0, 1.0], &[0.0, 1.0]),
        Projected::from_quantile(f64::sqrt),
        Projected::from_samples(samples),
    ];
    for law in laws {
        for u in [0.0, 0.01, 0.3, 0.77, 1.0] {
            assert!((law.quantile(u) - u.sqrt()).abs() < 2e-3, "{u}: {}", law.quantile(u));
        }
        assert!((law.mean() - 2.0 / 3.0).abs() < 1e-5 && (law.variance() - 1.0 / 18.0).abs() < 1e-5);
    }
}

/// The engine against the textbook path on the same slices: a step of size 1 moves each coordinate by the
/// gradient's mean.
#[test]
fn the_engine_follows_the_gradient_of_a_density() {
    let density = Density::new(3, 2, vec![0.0, 1.0, 2.0, 1.0, 0.0, 4.0]).unwrap();
    for count in [100, 1500] {
        let config = Config::stippling(count, density.clone());
        let mut optimizer = fsot::Optimizer::new(config.clone()).unwrap();
        let before: Vec<f64> = optimizer.table().values().iter().map(|&value| value.into()).collect();
        let slices = optimizer.objective().draw(config.seed, 0, Role::Descend);
        let gradient = optimizer.objective().value_and_gradient(&before, &slices).unwrap().gradient;
        optimizer.step(1.0, 1.0).unwrap();
        let after = optimizer.table();
        let scales = Target::Density(density.clone().into()).scales(2);
        let mut off = Vec::new();
        for (i, (&after, before)) in after.values().iter().zip(&before).enumerate() {
            // d times the mean displacement, in units of the picture; the gradient is -2/N times it.
            let moved = -gradient[i] * count as f64 / scales[i % 2].powi(2);
            let expected = Domain::Interval.admit((before + moved) as f32);
            off.push(f64::from((after - expected).abs()));
        }
        // Where f32 swaps the ranks of two samples in one of 16 directions, both are off by a cell.
        assert!(off.iter().all(|&off| off < 5e-6 + 0.25 / count as f64), "{count}: {off:?}");
        assert!(off.iter().sum::<f64>() / (off.len() as f64) < 3e-6, "{count}: {off:?}");
    }
}
