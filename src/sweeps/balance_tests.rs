use pulp::Arch;

use super::*;
use crate::classes::Demand;
use crate::config::{Config, DimensionGroup, Sweeps};
use crate::random;
use crate::sweeps::Sweeper;
use crate::table::extent::Extent;

/// Turns of the balance alone.
fn balanced(config: &Config, points: &mut [f32], turns: u64) {
    let objective = Objective::new(config).unwrap();
    let mut sweeper = Sweeper::new(&objective, &Sweeps::default()).unwrap();
    sweeper.load(points);
    (0..turns).for_each(|turn| sweeper.balance(turn, 1.0));
    sweeper.write_to(points);
}

/// A table that keeps away from the upper faces and from one corner, and differs from frame to frame.
fn crooked(extent: Extent, dims: usize) -> Vec<f32> {
    let mut points = random::uniforms(4, extent.samples() * dims);
    let per_frame = points.len() / extent.frames;
    for (index, value) in points.iter_mut().enumerate() {
        *value = 0.97 * value.powf(1.0 + 0.1 * (index / per_frame) as f32);
    }
    points
}

/// Samples of a coordinate in 16 equal bins, relative to the mean.
fn densities(points: &[f32], dim: usize) -> [f64; 16] {
    let mut counts = [0.0; 16];
    points.chunks_exact(2).for_each(|point| counts[(point[dim] * 16.0) as usize] += 1.0);
    counts.map(|count| 16.0 * count / (points.len() / 2) as f64)
}

/// Largest error of the area of some corners and bands, in standard deviations of as many random samples.
fn worst(points: &[f32]) -> f64 {
    let samples = (points.len() / 2) as f64;
    let share = |is_in: &dyn Fn(f32, f32) -> bool| {
        points.chunks_exact(2).filter(|point| is_in(point[0], point[1])).count() as f64 / samples
    };
    let errors = [
        (share(&|x, y| x + y < 0.4), 0.08),
        (share(&|x, y| x + y > 1.7), 0.045),
        (share(&|x, y| x - y > 0.5), 0.125),
        (share(&|x, y| y - x > 0.2), 0.32),
    ];
    errors
        .map(|(found, area)| (found - area).abs() / (area * (1.0 - area) / samples).sqrt())
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn lines_bring_a_square_in_order() {
    let extent = Extent::animation(3, 48, 48);
    let mut points = crooked(extent, 2);
    let frames = |points: &[f32]| points.chunks_exact(2 * 48 * 48).map(worst).fold(0.0, f64::max);
    let before = [worst(&points), frames(&points)];
    balanced(&Config::new(extent, 2), &mut points, 24);
    let after = [worst(&points), frames(&points)];
    assert!(before[0] > 5.0 && before[1] > 5.0, "{before:?}");
    assert!(after[0] < 0.5 && after[1] < 1.0, "{after:?}");
    for dim in 0..2 {
        // Bins of a distribution function hold 8 samples or more, of the 432 here.
        let densities = densities(&points, dim);
        assert!(densities.iter().all(|density| (density - 1.0).abs() < 0.03), "{densities:?}");
    }
}

#[test]
fn modes_bring_a_cube_in_order() {
    for dims in [3, 4, 6] {
        let extent = Extent::still(64, 64);
        let config = Config::new(extent, dims);
        let mut points = crooked(extent, dims);
        // Products of three coordinates are too large on one side.
        for point in points.chunks_exact_mut(dims).step_by(9) {
            let least = point.iter().copied().fold(1.0, f32::min);
            point[..3].fill(least);
        }
        balanced(&config, &mut points, 16);
        let mean = |of: &dyn Fn(&[f32]) -> f64| {
            points.chunks_exact(dims).map(of).sum::<f64>() / extent.samples() as f64
        };
        let wave = |k: f64, x: f32| (std::f64::consts::PI * k * f64::from(x)).cos();
        for (a, b, c) in [(1.0, 1.0, 0.0), (2.0, 2.0, 2.0), (0.0, 2.0, 2.0), (2.0, 0.0, 0.0)] {
            let found = mean(&|x: &[f32]| wave(a, x[0]) * wave(b, x[1]) * wave(c, x[2]));
            // White noise has 1 / √4096 = 0.016, or half of that where two factors are not 1.
            assert!(found.abs() < 1e-3, "{dims} {a} {b} {c}: {found}");
        }
    }
}

#[test]
fn what_nobody_demands_does_not_count() {
    let extent = Extent::still(32, 32);
    let pixels: Vec<bool> = (0..1024).map(|site| site % 3 != 0).collect();
    let demand = Demand::new([1, 32, 32], pixels.clone(), vec![vec![0, 1]]).unwrap();
    let objective = Objective::for_demand(&Config::new(extent, 2), &demand).unwrap();
    let mut points = crooked(extent, 2);
    // Would drag a mean far away.
    points.chunks_exact_mut(2).step_by(3).for_each(|point| point.fill(0.01));
    let mut sweeper = Sweeper::new(&objective, &Sweeps::default()).unwrap();
    sweeper.load(&points);
    (0..16).for_each(|turn| sweeper.balance(turn, 1.0));
    sweeper.write_to(&mut points);
    let of = |wanted: bool| points.chunks_exact(2).zip(&pixels).filter(move |(_, flag)| **flag == wanted);
    assert!(of(false).all(|(point, _)| point == [0.01; 2]));
    let held: Vec<f32> = of(true).flat_map(|(point, _)| point.to_vec()).collect();
    // 43 samples a bin, moved 8 together.
    let densities = densities(&held, 0);
    assert!(densities.iter().all(|density| (density - 1.0).abs() < 0.15), "{densities:?}");
}

#[test]
fn settled_coordinates_are_a_grid() {
    let groups = [DimensionGroup::new([0, 1])];
    let config = Config::new(Extent::still(8, 8), 3).with_groups(&groups);
    let balance = Balance::new(&Objective::new(&config).unwrap());
    let mut points = random::uniforms(1, 3 * 64);
    let before = points.clone();
    let samples: Vec<u32> = (0..64).filter(|sample| sample % 2 == 0).collect();
    balance.settle(&mut points, 3, &samples, 1.0);
    for (sample, (point, before)) in points.chunks_exact(3).zip(before.chunks_exact(3)).enumerate() {
        assert_eq!(point[2], before[2], "no group has it");
        assert!(sample % 2 == 0 || point == before, "nobody demands it");
    }
    for dim in 0..2 {
        let mut order = samples.clone();
        order.sort_by(|&a, &b| before[a as usize * 3 + dim].total_cmp(&before[b as usize * 3 + dim]));
        for (rank, &sample) in order.iter().enumerate() {
            assert_eq!(points[sample as usize * 3 + dim], (rank as f32 + 0.5) / 32.0);
        }
    }
}

/// The same bits with and without the processor's vectors, and at any number of threads.
#[test]
fn instruction_sets_and_threads_agree() {
    let of = |threads: usize, arch: Arch| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let config = Config::new(Extent::animation(3, 24, 20), 5);
            let objective = Objective::new(&config).unwrap();
            let mut sweeper = Sweeper::with_arch(&objective, &Sweeps::default(), arch).unwrap();
            let mut points = crooked(config.extent, 5);
            sweeper.load(&points);
            (0..3).for_each(|turn| sweeper.balance(turn, 1.0));
            sweeper.write_to(&mut points);
            points
        })
    };
    let plain = of(1, Arch::Scalar);
    assert!(plain == of(1, Arch::new()) && plain == of(3, Arch::new()));
}
