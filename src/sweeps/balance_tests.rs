use pulp::Arch;

use super::*;
use crate::classes::Demand;
use crate::config::{Config, DimensionGroup, Sweeps};
use crate::metrics::{Bias, Integrands, Marginal, Samples};
use crate::random;
use crate::sweeps::Sweeper;
use crate::table::SampleTable;
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

#[test]
fn lines_bring_a_square_in_order() {
    let extent = Extent::animation(3, 48, 48);
    let config = Config::new(extent, 2);
    let mut points = crooked(extent, 2);
    let bias = |points: &[f32]| {
        let table = SampleTable::new(extent, 2, points.to_vec()).unwrap();
        let bias = Bias::measure(&table, &[0, 1], &Integrands::random(2, 32, 0).unwrap()).unwrap();
        [bias.table.mean.mean, bias.frame.mean.mean]
    };
    let before = bias(&points);
    balanced(&config, &mut points, 24);
    let after = bias(&points);
    // Ratios to random: a table of white noise has 1.
    assert!(before[0] > 20.0 && before[1] > 10.0, "{before:?}");
    assert!(after[0] < 0.1 && after[1] < 0.3, "{after:?}");
    for dim in 0..2 {
        let marginal =
            Marginal::measure(&SampleTable::new(extent, 2, points.clone()).unwrap(), dim, 16).unwrap();
        // Bins of a distribution function hold 8 samples or more, of the 432 here.
        assert!(marginal.extremes()[0] > 0.97 && marginal.extremes()[1] < 1.03, "{:?}", marginal.counts);
        assert!(marginal.faces.iter().all(|face| (face.density - 1.0).abs() < 3.0 * face.standard_error));
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
    let held: Vec<f64> = of(true).flat_map(|(point, _)| point.iter().map(|&x| f64::from(x))).collect();
    let marginal = Marginal::measure(Samples::points(&held, 2).unwrap(), 0, 4).unwrap();
    assert!(marginal.extremes()[0] > 0.96 && marginal.extremes()[1] < 1.04, "{:?}", marginal.counts);
}

#[test]
fn settled_coordinates_are_a_grid() {
    let groups = [DimensionGroup::new([0, 1])];
    let config = Config::new(Extent::still(8, 8), 3).with_groups(&groups);
    let balance = Balance::new(&Objective::new(&config).unwrap());
    let mut points = random::uniforms(1, 3 * 64);
    let before = points.clone();
    let samples: Vec<u32> = (0..64).filter(|sample| sample % 2 == 0).collect();
    balance.settle(&mut points, 3, &samples);
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
