//! The same seed gives the same bits: at any thread count, in pieces, again by the number of slices. And the
//! values themselves are pinned.

use std::ops::ControlFlow;

use fsot::classes::{Demand, PrefixLengths};
use fsot::config::{Descent, EndReason, LabelSubsets, Role, Work};
use fsot::objective::ValueAndGradient;
use fsot::optimizer::{SliceStep, StepReport};
use fsot::{Config, Extent, Optimizer, SampleTable, Until, metrics};

fn config(extent: [usize; 4], dims: usize, descent: Descent, seed: u64) -> Config {
    let [frames, height, width, spp] = extent;
    Config::new(Extent { frames, height, width, spp }, dims).with_descent(descent).with_seed(seed)
}

fn on(_: &StepReport) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn optimizer(config: &Config) -> Optimizer {
    Optimizer::new(config.clone()).unwrap()
}

fn bits(table: &SampleTable) -> Vec<u32> {
    table.values().iter().map(|value| value.to_bits()).collect()
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Shapes whose steps hold many chunks of subsets, long subsets, several groups, and a table large enough for
/// several parts.
fn cases() -> Vec<Config> {
    vec![
        config([1, 64, 64, 1], 2, Descent::barycentric(), 1),
        config([8, 24, 20, 1], 2, Descent::barycentric(), 2),
        config([1, 16, 16, 16], 2, Descent::adam(), 3),
        config([1, 48, 48, 16], 2, Descent::barycentric(), 4),
        config([1, 24, 24, 1], 4, Descent::sgd(), 5),
        config([2, 20, 20, 1], 3, Descent::adam(), 6),
    ]
}

/// Subsets that share their sorts between threads: alone, and in flight with others, where a worker that
/// waits for a part of its sort is lent to another subset. Balanced subsets that are too many to wait, and
/// one that is too large.
#[test]
fn threads_do_not_change_a_bit_of_large_subsets() {
    // More whole tables in a step than wait with the rest of it.
    let mut many = config([1, 64, 64, 16], 2, Descent::barycentric(), 2);
    let balances = many.terms.iter_mut().filter(|term| term.role == Role::Balance);
    balances.for_each(|term| term.weight *= 100.0);
    let drawn = optimizer(&many).objective().draw(many.seed, 0, Role::Balance).len();
    assert!(drawn > (1 << 20) / (64 * 64 * 16), "{drawn}");
    let configs = [
        many,
        Config::classes(&[20_000; 10], 2, &LabelSubsets::EachAndAll),
        Config::progressive(200_000, 2, PrefixLengths::PowersOfTwo),
        config([40, 60, 60, 1], 2, Descent::barycentric(), 1),
    ];
    for config in configs {
        let run = |threads| {
            with_threads(threads, || {
                let mut optimizer = optimizer(&config);
                let SliceStep { displacement, slices, .. } = optimizer.step(1.0, 1.0).unwrap();
                if config.extent.frames > 1 {
                    optimizer.sweep(1.0, 1.0).unwrap();
                }
                (bits(&optimizer.table()), displacement.to_bits(), slices)
            })
        };
        let alone = run(1);
        assert_ne!(alone.0, bits(&optimizer(&config).table()));
        assert!(run(4) == alone, "{:?}", config.extent);
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    for config in cases() {
        let run = |threads| {
            with_threads(threads, || {
                let mut optimizer = optimizer(&config);
                let mut displacements = Vec::new();
                let report = optimizer
                    .run_observed(
                        Until::Work(Work { slices_per_class: 10, sweeps: 2, ..Work::default() }),
                        |step| {
                            displacements.push(step.displacement.to_bits());
                            ControlFlow::Continue(())
                        },
                    )
                    .unwrap();
                let bound =
                    metrics::Bound::measure(&optimizer.table(), optimizer.objective(), 9, 512).unwrap();
                assert_eq!(report.steps as usize, displacements.len());
                (bits(&optimizer.table()), displacements, bound)
            })
        };
        let alone = run(1);
        assert_ne!(alone.0, bits(&optimizer(&config).table()));
        for threads in [2, 3, 8] {
            let (table, displacements, bound) = run(threads);
            assert!(table == alone.0, "{threads} threads, {:?}", config.extent);
            assert!(displacements == alone.1, "{threads} threads, {:?}", config.extent);
            for (one, other) in std::iter::once(&bound.total)
                .chain(&bound.terms)
                .zip(std::iter::once(&alone.2.total).chain(&alone.2.terms))
            {
                assert_eq!(one.value.to_bits(), other.value.to_bits());
                assert_eq!(one.ratio_standard_error.to_bits(), other.ratio_standard_error.to_bits());
            }
        }
    }
}

/// Scattered samples are swept by lists, and one-dimensional subsets transported sixteen abreast.
#[test]
fn threads_do_not_change_a_bit_of_what_is_demanded_here_and_there() {
    for (dims, group, shape) in [(2, vec![0, 1], [1, 96, 96, 2]), (3, vec![2], [3, 64, 64, 1])] {
        let config = config(shape, dims, Descent::barycentric(), 3);
        let [frames, height, width, _] = shape;
        let noise = SampleTable::white_noise(Extent { frames, height, width, spp: 1 }, 1, 9).unwrap();
        let flags: Vec<bool> = noise.values().iter().map(|&value| value < 0.08).collect();
        let demand = Demand::new([frames, height, width], flags.clone(), vec![group.clone()]).unwrap();
        let run = |threads| {
            with_threads(threads, || {
                let mut optimizer = Optimizer::for_demand(config.clone(), &demand).unwrap();
                let work = Work { slices_per_class: 64, sweeps: 3, ..Work::default() };
                optimizer.run(Until::Work(work)).unwrap();
                optimizer.into_table()
            })
        };
        let alone = run(1);
        for threads in [2, 3, 8] {
            assert!(bits(&run(threads)) == bits(&alone), "{threads} threads, {shape:?}");
        }
        // What is not demanded keeps its bits, also the dimensions that nobody asked for.
        let before = optimizer(&config).table();
        let pairs = before.values().iter().zip(alone.values()).enumerate();
        let per_site = shape[3] * dims;
        for (index, (before, after)) in pairs {
            let is_demanded = flags[index / per_site] && group.contains(&(index % dims));
            assert_eq!(before.to_bits() != after.to_bits(), is_demanded, "{shape:?} {index}");
        }
    }
}

#[test]
fn gradients_do_not_depend_on_threads() {
    let config = config([2, 16, 16, 2], 3, Descent::barycentric(), 1);
    let optimizer = optimizer(&config);
    let points: Vec<f64> = optimizer.table().values().iter().map(|&value| value.into()).collect();
    let mut slices = optimizer.objective().draw(1, 0, Role::Descend);
    slices.extend(optimizer.objective().draw(1, 0, Role::Balance));
    let run = |threads| {
        with_threads(threads, || optimizer.objective().value_and_gradient(&points, &slices).unwrap())
    };
    let ValueAndGradient { value, gradient } = run(1);
    for threads in [2, 3, 8] {
        let ValueAndGradient { value: again, gradient: other } = run(threads);
        assert_eq!(value.to_bits(), again.to_bits());
        assert!(gradient.iter().zip(&other).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}

#[test]
fn seeds_differ() {
    let run = |seed| {
        let mut optimizer = optimizer(&config([1, 16, 16, 1], 2, Descent::barycentric(), seed));
        optimizer.run_observed(Until::SlicesPerClass(16), on).unwrap();
        optimizer.into_table()
    };
    assert_eq!(bits(&run(7)), bits(&run(7)));
    assert_ne!(bits(&run(7)), bits(&run(8)));
    // The seed names the slices too, not only the table at the start.
    let start = SampleTable::white_noise(Extent { frames: 1, height: 16, width: 16, spp: 1 }, 2, 0).unwrap();
    let from_start = |seed| {
        let config = config([1, 16, 16, 1], 2, Descent::barycentric(), seed);
        let mut optimizer = Optimizer::from_table(config, start.clone()).unwrap();
        optimizer.step(1.0, 1.0).unwrap();
        bits(&optimizer.into_table())
    };
    assert_ne!(from_start(7), from_start(8));
}

#[test]
fn seconds_are_reproduced_by_slices() {
    for config in [
        config([1, 24, 24, 1], 2, Descent::barycentric(), 4),
        config([4, 16, 16, 1], 2, Descent::adam(), 5),
        config([1, 7, 5, 3], 4, Descent::sgd(), 6),
    ] {
        let mut timed = optimizer(&config);
        let report = timed.run_observed(Until::Seconds(0.1), on).unwrap();
        assert_eq!(report.ended, EndReason::Finished);
        let mut counted = optimizer(&config);
        let again = counted.run_observed(Until::Work(report.work), on).unwrap();
        assert_eq!((again.steps, again.slices), (report.steps, report.slices));
        assert_eq!(again.work, report.work);
        assert!(bits(&timed.table()) == bits(&counted.table()), "{:?}", config.extent);
    }
}

/// The number of slices that a run reports plans the same run again, whatever it was planned by.
#[test]
fn any_run_is_reproduced_by_its_slices() {
    for until in [Until::Epochs(3), Until::SlicesPerClass(37), Until::SlicesPerClass(1), Until::Sweeps(2)] {
        let config = config([1, 12, 10, 1], 3, Descent::barycentric(), 4);
        let (mut first, mut second) = (optimizer(&config), optimizer(&config));
        let report = first.run_observed(until, on).unwrap();
        let again = second.run_observed(Until::Work(report.work), on).unwrap();
        assert_eq!(report.steps, again.steps, "{until:?} {report:?}");
        assert_eq!(bits(&first.table()), bits(&second.table()), "{until:?}");
    }
}

#[test]
fn halves_of_steps_make_the_whole() {
    for descent in [Descent::barycentric(), Descent::adam(), Descent::sgd()] {
        let config = config([2, 12, 12, 1], 2, descent, 11);
        let (mut whole, mut halves) = (optimizer(&config), optimizer(&config));
        for _ in 0..20 {
            whole.step(0.1, 1.0).unwrap();
        }
        for _ in 0..2 {
            for _ in 0..10 {
                halves.step(0.1, 1.0).unwrap();
            }
            let _ = halves.table();
        }
        assert_eq!(bits(&whole.table()), bits(&halves.table()));
    }
}

#[test]
fn halves_of_sweeps_make_the_whole() {
    let config = config([2, 12, 20, 1], 3, Descent::barycentric(), 11);
    let (mut whole, mut halves) = (optimizer(&config), optimizer(&config));
    for _ in 0..4 {
        whole.sweep(1.0, 1.0).unwrap();
    }
    for _ in 0..2 {
        halves.sweep(1.0, 1.0).unwrap();
        // The table may have been replaced in between.
        let table = halves.table();
        halves.start_from(table).unwrap();
        halves.sweep(1.0, 1.0).unwrap();
    }
    assert_eq!(bits(&whole.table()), bits(&halves.table()));
}

/// What is kept is what the steps up to the break made, on the schedule of the whole run.
#[test]
fn a_stopped_run_keeps_what_was_reached() {
    for descent in [Descent::barycentric(), Descent::adam()] {
        let config = config([1, 16, 16, 1], 2, descent, 12);
        let mut stopped = optimizer(&config);
        let mut planned = 0;
        let report = stopped
            .run_observed(Until::SlicesPerClass(64), |step| {
                planned = step.steps;
                if step.step == 17 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .unwrap();
        assert_eq!((report.ended, report.steps), (EndReason::Stopped, 17));
        assert!(planned > 17);
        let mut replayed = optimizer(&config);
        let mut slices = 0;
        for step in 0..17 {
            let progress = step as f64 / planned as f64;
            slices += replayed
                .step(config.descent.rate().at(progress), config.balance.at(progress))
                .unwrap()
                .slices;
        }
        assert_eq!(bits(&stopped.table()), bits(&replayed.table()));
        assert_eq!(slices, report.slices);
    }
}

/// A run of steps of size 0 changes nothing, so the calibration of `Until::Seconds` leaves no trace.
#[test]
fn steps_of_size_zero_leave_the_table() {
    let config = config([2, 12, 12, 1], 4, Descent::barycentric(), 13);
    let mut optimizer = optimizer(&config);
    let before = bits(&optimizer.table());
    for _ in 0..5 {
        optimizer.step(0.0, 0.0).unwrap();
        optimizer.sweep(0.0, 0.0).unwrap();
    }
    assert_eq!(bits(&optimizer.table()), before);
}

/// Value stability. When these move, every table does: a "Value-breaking change" that belongs in the
/// CHANGELOG.
///
/// Compared to 1e-4 only, because the sine and cosine of the directions may differ in the last bit between
/// platforms. Few and small steps, so that such a bit does not grow by the swap of two nearly tied samples.
/// Descent, balance, sweeps.
#[test]
fn values_are_pinned() {
    let after = |extent, dims, descent, work: &dyn Fn(&mut Optimizer)| {
        let mut optimizer = optimizer(&config(extent, dims, descent, 1));
        work(&mut optimizer);
        let table = optimizer.into_table();
        let sum: f64 = table.values().iter().map(|&value| f64::from(value)).sum();
        (table.values()[..4].to_vec(), sum / table.values().len() as f64)
    };
    let steps = |optimizer: &mut Optimizer| (0..4).for_each(|_| _ = optimizer.step(0.05, 0.05).unwrap());
    let balanced = |optimizer: &mut Optimizer| (0..16).for_each(|_| _ = optimizer.step(0.01, 1.0).unwrap());
    let swept = |optimizer: &mut Optimizer| (0..2).for_each(|_| _ = optimizer.sweep(0.1, 0.5).unwrap());
    let barycentric = Descent::barycentric();
    for ((first, mean), (expected, expected_mean)) in [
        (after([1, 8, 8, 1], 2, barycentric, &steps), ([0.04995, 0.67197, 0.59036, 0.85579], 0.486477)),
        (after([3, 5, 7, 1], 2, barycentric, &steps), ([0.05114, 0.66010, 0.59222, 0.85717], 0.498306)),
        (after([1, 6, 6, 2], 4, Descent::adam(), &steps), ([0.00000, 0.55062, 0.74445, 0.69060], 0.518627)),
        (after([3, 5, 7, 1], 2, barycentric, &balanced), ([0.04385, 0.61400, 0.60465, 0.84313], 0.495975)),
        (after([3, 5, 7, 1], 2, barycentric, &swept), ([0.09059, 0.61993, 0.61949, 0.84285], 0.500374)),
        (after([1, 6, 6, 2], 3, barycentric, &swept), ([0.09003, 0.65601, 0.75901, 0.92355], 0.500267)),
    ] {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-4;
        let same = first.iter().zip(&expected).all(|(&a, &b)| close(a.into(), b));
        assert!(same && close(mean, expected_mean), "{first:?} {mean:.6}");
    }
}
