//! How runs end, and tables of unusual shape.

use std::ops::ControlFlow;
use std::time::Duration;

use fsot::config::{EndReason, Work};
use fsot::optimizer::StepReport;
use fsot::{Config, ConfigError, Optimizer, SampleTable, Until};

use crate::{extent, on, optimized, ratio};

fn small() -> Optimizer {
    Optimizer::new(Config::new(extent([1, 16, 16, 1]), 2)).unwrap()
}

#[test]
fn epochs_and_slices_are_counted() {
    let mut optimizer = small();
    // By default an epoch has 16 slices per pixel, and a step is a sixteenth of it.
    let lattice_share = 0.9;
    let report = optimizer.run_observed(Until::Epochs(3), on).unwrap();
    assert_eq!(report.ended, EndReason::Finished);
    // Steps hold some balancing slices besides.
    let per_class = report.slices as f64 / 256.0;
    assert!((48.0..48.0 / lattice_share).contains(&per_class), "{report:?}");
    assert!((48..=52).contains(&report.steps), "{report:?}");
    assert_eq!(report.work.slices_per_class, 48);
    let report = small().run_observed(Until::SlicesPerClass(48), on).unwrap();
    assert_eq!(report.work.slices_per_class, 48);
    let report = small().run_observed(Until::SlicesPerClass(0), on).unwrap();
    assert_eq!((report.steps, report.slices, report.ended), (0, 0, EndReason::Finished));
}

#[test]
fn step_reports_count_up() {
    let mut seen = Vec::new();
    let report = small()
        .run_observed(Until::SlicesPerClass(16), |step| {
            seen.push((step.step, step.steps, step.displacement, step.slices, step.rate, step.elapsed));
            std::ops::ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(seen.len() as u64, report.steps);
    for (index, &(step, steps, displacement, ..)) in seen.iter().enumerate() {
        assert_eq!((step, steps), (index as u64 + 1, report.steps));
        assert!(displacement > 0.0 && displacement < 1.0);
    }
    assert!(seen.is_sorted_by(|a, b| a.3 < b.3 && a.4 > b.4 && a.5 <= b.5));
    assert_eq!(seen.last().unwrap().3, report.slices);
    // The table gets better: over a run from white noise the displacement falls, most of which is that of
    // subsets of one and two samples and stays.
    let mean =
        |steps: &[(u64, u64, f64, u64, f64, Duration)]| steps.iter().map(|step| step.2).sum::<f64>() / 4.0;
    let (first, last) = (mean(&seen[..4]), mean(&seen[seen.len() - 4..]));
    assert!(last < 0.95 * first, "{first} {last}");
}

#[test]
fn a_run_ends_when_it_no_longer_improves() {
    let until = Until::Converged { improvement: 0.02, window_steps: 16, at_most: 100_000 };
    let report = small().run_observed(until, on).unwrap();
    assert_eq!(report.ended, EndReason::Converged);
    assert!(report.steps.is_multiple_of(16) && report.steps >= 32, "{report:?}");
    assert!(report.slices < 100_000 * 256 / 10, "{report:?}");
    // A rule that never holds leaves the limit.
    let until = Until::Converged { improvement: 0.0, window_steps: 1000, at_most: 16 };
    let report = small().run_observed(until, on).unwrap();
    assert_eq!((report.ended, report.work.slices_per_class), (EndReason::Finished, 16));
}

#[test]
fn bad_ends_are_refused_and_change_nothing() {
    let converged = |improvement, window_steps| Until::Converged { improvement, window_steps, at_most: 9 };
    for (until, words) in [
        (Until::Seconds(0.0), "the number of seconds is 0: give a value above 0, at most 1e9"),
        (Until::Seconds(-1.0), "the number of seconds is -1: give a value above 0, at most 1e9"),
        (Until::Seconds(f64::NAN), "the number of seconds is NaN: give a value above 0, at most 1e9"),
        (Until::Seconds(f64::INFINITY), "the number of seconds is inf: give a value above 0, at most 1e9"),
        (converged(1.0, 5), "the least improvement is 1: give a value in [0, 1)"),
        (converged(f64::NAN, 5), "the least improvement is NaN: give a value in [0, 1)"),
        (converged(-0.1, 5), "the least improvement is -0.1: give a value in [0, 1)"),
        (converged(0.1, 0), "the window is 0: give a value of at least 1 step"),
    ] {
        let mut optimizer = small();
        let error = optimizer.run_observed(until, |_| panic!("no step")).unwrap_err();
        assert_eq!(error.to_string(), words);
        assert_eq!(optimizer.table(), small().table());
    }
}

#[test]
fn seconds_are_kept_about() {
    let report = small().run_observed(Until::Seconds(0.3), on).unwrap();
    let seconds = report.elapsed.as_secs_f64();
    // Wide: other work shares the machine, during calibration or after it.
    assert!((0.03..3.0).contains(&seconds), "{seconds}");
}

/// A run goes on from a table as from its own, and not from one of another shape.
#[test]
fn tables_to_start_from() {
    let config = Config::new(extent([1, 16, 16, 1]), 2);
    let first = optimized(&config, 32).into_table();
    let mut second = Optimizer::from_table(config.clone(), first.clone()).unwrap();
    assert_eq!(second.table(), first);
    let before = ratio(&second, &first, 8192);
    second.run_observed(Until::SlicesPerClass(200), on).unwrap();
    let after = ratio(&second, &second.table(), 8192);
    // A short run stays further from the limit than a long one that goes on from it.
    assert!(after.0 + 4.0 * after.1.hypot(before.1) < before.0, "{before:?} {after:?}");
    for (shape, dims) in [([1, 16, 16, 1], 3), ([1, 16, 15, 1], 2), ([1, 8, 32, 1], 2), ([1, 16, 8, 2], 2)] {
        let other = SampleTable::white_noise(extent(shape), dims, 0).unwrap();
        let error = Optimizer::from_table(config.clone(), other).err().unwrap();
        let words = format!(
            "the table has shape {:?} instead of [1, 16, 16, 1, 2]: \
                 bring one of that [frame, y, x, sample, dim]",
            [&shape[..], &[dims]].concat()
        );
        assert_eq!(error.to_string(), words);
    }
    let bad = config.with_domains(Vec::new());
    let error = Optimizer::from_table(bad, first).err().unwrap();
    assert!(matches!(error, ConfigError::DomainCount { .. }), "{error}");
}

/// Whatever the shape, values stay in `[0, 1)` and the bound falls; the kernel folds where it is wider than
/// the tile.
#[test]
fn unusual_shapes_run() {
    for (shape, dims) in [
        ([1, 1, 1, 1], 1),
        ([1, 1, 1, 1], 2),
        ([1, 1, 1, 1], 5),
        ([1, 1, 1, 16], 2),
        ([3, 2, 1, 1], 2),
        ([2, 3, 5, 4], 4),
        ([20, 1, 1, 1], 2),
        ([1, 1, 50, 1], 3),
        ([1, 4, 4, 1], 16),
    ] {
        let config = Config::new(extent(shape), dims).with_seed(2);
        let optimizer = optimized(&config, 200);
        let table = optimizer.table();
        assert!(table.values().iter().all(|value| (0.0..1.0).contains(value)), "{shape:?}");
        let (ratio, error) = ratio(&optimizer, &table, 2048);
        println!("{shape:?} {dims}: {ratio:.3} ± {error:.3}");
        assert!(ratio + 4.0 * error < 1.0, "{shape:?} {dims}: {ratio} ± {error}");
    }
}

/// A single sample's best place is the middle of the cube.
#[test]
fn one_sample_goes_to_the_middle() {
    let table = optimized(&Config::new(extent([1, 1, 1, 1]), 3), 2000).into_table();
    for value in table.values() {
        assert!((value - 0.5).abs() < 1e-2, "{:?}", table.values());
    }
}

/// Until one says otherwise an animation begins with one frame, displaced.
#[test]
fn animations_begin_with_a_frame() {
    let config = Config::new(extent([4, 8, 8, 1]), 2);
    let work = Work { frame_sweeps: 3, ..Work::default() };
    let table = config.clone().optimize(Until::Work(work)).unwrap();
    let frame: Vec<&[f32]> = table.values().chunks_exact(8 * 8 * 2).collect();
    let sorted = |frame: &[f32]| {
        let mut values: Vec<[u32; 2]> =
            frame.chunks_exact(2).map(|point| [point[0].to_bits(), point[1].to_bits()]).collect();
        values.sort_unstable();
        values
    };
    assert!(frame[1..].iter().all(|other| sorted(other) == sorted(frame[0]) && *other != frame[0]));

    let mut optimizer = Optimizer::new(config.clone()).unwrap();
    let (mut steps, mut seen) = (Vec::new(), Vec::new());
    let report = optimizer
        .run_observed(Until::Sweeps(2), |step| {
            assert!(step.loss().is_finite() && step.table().shape() == [4, 8, 8, 1, 2]);
            steps.push(step.step);
            seen.push(step.steps);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(report.work.frame_sweeps > 0 && report.work.sweeps == 2);
    assert!(steps.iter().copied().eq(1..=report.steps) && seen.iter().all(|&all| all == report.steps));
    // The same work again, and a run that goes on instead of beginning anew.
    assert_eq!(config.optimize(Until::Work(report.work)).unwrap(), optimizer.table());
    assert_eq!(optimizer.run(Until::Sweeps(2)).unwrap().work.frame_sweeps, 0);
}

#[test]
fn a_run_that_ends_in_its_first_frame_keeps_a_whole_table() {
    let mut optimizer = Optimizer::new(Config::new(extent([4, 8, 8, 1]), 2)).unwrap();
    let stop =
        |step: &StepReport| if step.step == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let report = optimizer.run_observed(Until::Sweeps(5), stop).unwrap();
    assert_eq!((report.ended, report.steps), (EndReason::Stopped, 2));
    let table = optimizer.table();
    assert_eq!(table.shape(), [4, 8, 8, 1, 2]);
    assert!(table.values()[..128] != table.values()[128..256]);
}

#[test]
fn the_usual_work_is_that_of_the_shape() {
    let work = |shape, dims| {
        let mut optimizer = Optimizer::new(Config::new(extent(shape), dims)).unwrap();
        let stop = |_: &StepReport| ControlFlow::Break(());
        optimizer.run_observed(Until::Usual, stop).unwrap().work
    };
    assert_eq!(work([1, 16, 16, 1], 2).sweeps, 1000);
    assert_eq!(work([1, 16, 16, 1], 1).sweeps, 10_000);
    assert_eq!(work([2, 16, 16, 16], 2).frame_sweeps.min(1), 1);
    let torus = Config::new(extent([1, 8, 8, 1]), 2).with_domain(fsot::config::Domain::Torus);
    let report = Optimizer::new(torus).unwrap().run(Until::Usual).unwrap();
    assert_eq!((report.work.slices_per_class, report.work.sweeps), (320, 0));
}
