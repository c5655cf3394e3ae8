//! Numbers at the ends of their ranges: what is accepted ends in time and does what it says, the rest is
//! refused in words.

mod sizes;

use std::ops::ControlFlow;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use fsot::classes::{Classes, FilterForm};
use fsot::config::{Descent, Domain, Role, Schedule, Slicing, Sweeps, Term};
use fsot::kernel::{SpatialKernel, SpatialTap, Tap, TemporalKernel, autocorrelation};
use fsot::targets::{Density, Measure, PointCloud, Projected, Target};
use fsot::{Config, ConfigError, Extent, Kernel, Optimizer, Until};

const TILE: Extent = Extent::still(8, 8);

/// What a call returns, if it does within some seconds: generous, since other work may share the machine.
fn in_time<T: Send + 'static>(seconds: u64, call: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || sender.send(call()));
    receiver.recv_timeout(Duration::from_secs(seconds)).expect("an answer, in time")
}

fn term(classes: Classes, role: Role, weight: f64) -> Term {
    Term { classes, target: Target::UniformCube, dims: vec![0, 1], weight, role }
}

fn lattice(kernel: Kernel) -> Classes {
    Classes::Lattice { kernel, form: FilterForm::LevelSets }
}

fn taps(in_space: f64, in_time: f64) -> Kernel {
    let tap = |dx, share: f64| SpatialTap { dy: 0, dx, weight: share * in_space };
    let spatial = SpatialKernel::Taps(vec![tap(0, 1.0), tap(1, 0.5)]);
    Kernel::product(spatial, TemporalKernel::Taps(vec![in_time, 0.25 * in_time]))
}

/// Only ratios of weights matter, however large their products are.
#[test]
fn kernels_of_any_scale_are_the_same_kernel() {
    let extent = Extent::animation(4, 8, 8);
    let plain = taps(1.0, 1.0).taps(&extent).unwrap();
    assert_eq!(plain.len(), 4);
    for [in_space, in_time] in [[2.0_f64.powi(700); 2], [2.0_f64.powi(-700); 2], [1.1e308, 1.4e308]] {
        let kernel = taps(in_space, in_time);
        let scaled = kernel.taps(&extent).unwrap();
        for (a, b) in scaled.iter().zip(&plain) {
            assert!((a.weight - b.weight).abs() < 1e-12, "{in_space:e} {in_time:e}: {a:?} {b:?}");
        }
        let config = Config::new(extent, 2).with_kernel(kernel);
        for until in [Until::Sweeps(2), Until::SlicesPerClass(2)] {
            let mut optimizer = Optimizer::new(config.clone()).unwrap();
            optimizer
                .run_observed(until, |step| {
                    assert!(step.displacement.is_finite() && step.loss().is_finite(), "{step:?}");
                    ControlFlow::Continue(())
                })
                .unwrap();
        }
    }
    // Also where the smallest numbers lose digits.
    for weight in [5e-324, 1e-310, 1e-200, 1e200, f64::MAX / 2.0] {
        assert!(!taps(weight, weight).taps(&extent).unwrap().is_empty(), "{weight}");
    }
}

#[test]
fn autocorrelations_that_overflow_are_refused() {
    let tap = |weight| Tap { dt: 0, dy: 0, dx: 0, weight };
    for weight in [1e200, f64::INFINITY, f64::NAN, -1.0] {
        let error = autocorrelation(&[tap(weight)], &TILE, 0.0).unwrap_err().to_string();
        assert!(error.contains(": "), "{error}");
    }
    let far = Tap { dt: i32::MIN, dy: i32::MAX, dx: i32::MIN, weight: 1.0 };
    assert_eq!(
        autocorrelation(&[far, tap(1.0)], &TILE, 0.0).unwrap().iter().map(|tap| tap.weight).sum::<f64>(),
        4.0
    );
    assert!(autocorrelation(&[tap(1.0)], &Extent::still(0, 8), 0.0).is_err());
    assert!(autocorrelation(&[tap(1.0)], &TILE, f64::NAN).is_err());
}

#[test]
fn steps_and_rates_must_be_steps() {
    let mut optimizer = Optimizer::new(Config::new(TILE, 2)).unwrap();
    let before = optimizer.table();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-9, 1e7, f64::MAX] {
        for [rate, balance] in [[bad, 1.0], [1.0, bad]] {
            let of_step = optimizer.step(rate, balance).unwrap_err();
            let of_sweep = optimizer.sweep(rate, balance).unwrap_err();
            assert!(
                matches!(of_step, ConfigError::Range(_)) && of_step == of_sweep || bad.is_nan(),
                "{of_step}"
            );
        }
    }
    assert_eq!(optimizer.table(), before);
    for [rate, balance] in [[0.0, 0.0], [1e6, 1e6], [1e-300, 0.0]] {
        optimizer.step(rate, balance).unwrap();
        optimizer.sweep(rate, balance).unwrap();
        assert!(optimizer.points().iter().all(|value| (0.0..1.0).contains(value)));
    }
}

/// Every setting that is a number, at values that it cannot have.
#[test]
fn settings_must_be_numbers_in_their_range() {
    let refused = |config: Config| Optimizer::new(config).unwrap_err().to_string();
    let config = || Config::new(TILE, 2);
    for bad in [f64::NAN, f64::INFINITY, -1.0, 5e-324] {
        let schedule = Schedule::geometric(bad, 1.0);
        let momentum = if bad == 5e-324 { 1.0 - 1e-12 } else { bad };
        let softening = if bad == 5e-324 { 1e30 } else { bad };
        let adam =
            |beta1, beta2| Descent::Adam { rate: Schedule::constant(0.1), beta1, beta2, epsilon: 1e-8 };
        for config in [
            config().with_balance(schedule),
            config().with_descent(Descent::Barycentric { rate: schedule }),
            config().with_descent(Descent::Sgd { rate: Schedule::constant(0.1), momentum }),
            config().with_descent(adam(momentum, 0.9)),
            config().with_descent(adam(0.9, momentum)),
            config().with_sweeps(Sweeps { rate: schedule, ..Sweeps::default() }),
            config().with_sweeps(Sweeps { polish: schedule, ..Sweeps::default() }),
            config().with_sweeps(Sweeps { softening, ..Sweeps::default() }),
            config().with_terms(vec![term(Classes::WholeTable, Role::Descend, bad)]),
        ] {
            let words = refused(config);
            assert!(words.contains(": give a value"), "{words}");
        }
    }
}

/// The runs whose plans took 2^64 and 49 million steps, and the one that took none.
#[test]
fn terms_of_very_different_weights_are_refused() {
    for (first, second) in [
        (
            term(lattice(Kernel::gaussian(2.1)), Role::Descend, 1e-30),
            term(Classes::WholeTable, Role::Balance, 1.0),
        ),
        (
            term(lattice(Kernel::gaussian(2.1)), Role::Descend, 0.0035),
            term(Classes::PerPixel, Role::Descend, 191.0),
        ),
        (
            term(lattice(Kernel::gaussian(2.1)), Role::Descend, 5e-324),
            term(Classes::PerPixel, Role::Descend, 5e-324),
        ),
    ] {
        let config = Config::new(TILE, 2).with_terms(vec![first, second]);
        for until in [Until::SlicesPerClass(64), Until::Epochs(4), Until::Seconds(0.1)] {
            let config = config.clone();
            let ended = in_time(20, move || {
                let (mut steps, mut optimizer) = (0, Optimizer::new(config)?);
                let before = optimizer.table();
                optimizer.run_observed(until, |step| {
                    steps = step.steps;
                    ControlFlow::Continue(())
                })?;
                Ok::<_, ConfigError>((optimizer.table() != before, steps))
            });
            match ended {
                Ok((moved, steps)) => assert!(moved && steps < 1 << 20, "{until:?}: {steps} steps, {moved}"),
                Err(error) => assert!(error.to_string().contains(": "), "{error}"),
            }
        }
    }
}

/// Few classes, of which a step draws less than one subset.
#[test]
fn work_that_is_asked_for_is_done() {
    for (extent, spp, batch_slices) in [([1, 2, 2], 1, None), ([1, 1, 1], 1, None), ([1, 8, 8], 2, Some(1))] {
        let [frames, height, width] = extent;
        let extent = Extent { frames, height, width, spp };
        for terms in [
            Config::new(extent, 2).terms,
            vec![term(lattice(Kernel::gaussian(2.1)), Role::Descend, 1.0)],
            vec![term(Classes::WholeTable, Role::Balance, 1.0)],
        ] {
            let slicing = Slicing { batch_slices, ..Slicing::default() };
            let config = Config::new(extent, 2).with_slicing(slicing).with_terms(terms);
            let mut optimizer = Optimizer::new(config).unwrap();
            let before = optimizer.table();
            let report = optimizer.run(Until::SlicesPerClass(1)).unwrap();
            assert!(
                report.slices > 0 && optimizer.table() != before,
                "{extent:?} {batch_slices:?}: {report:?}"
            );
        }
    }
}

#[test]
fn large_batches_report_in_time_or_are_refused() {
    for slices in [1 << 31, i32::MAX as usize, 1 << 24] {
        in_time(20, move || {
            let slicing = Slicing { batch_slices: Some(slices), ..Slicing::default() };
            let config = Config::new(Extent::still(64, 64), 2).with_slicing(slicing);
            match Optimizer::new(config) {
                Ok(mut optimizer) => {
                    optimizer.run_observed(Until::SlicesPerClass(1), |_| ControlFlow::Break(())).unwrap();
                }
                Err(error) => assert!(error.to_string().contains(": give"), "{error}"),
            }
        });
    }
}

/// Kernels as wide as the table: each filter holds every sample.
#[test]
fn a_run_of_some_seconds_keeps_them_also_under_wide_kernels() {
    for (extent, domain) in [
        (Extent::still(64, 64), Domain::Interval),
        (Extent::animation(10, 64, 64), Domain::Interval),
        (Extent::still(64, 64), Domain::Torus),
        (Extent::still(256, 256), Domain::Interval),
        (Extent::still(256, 256), Domain::Torus),
    ] {
        let (first, all) = in_time(100, move || {
            let begin = Instant::now();
            let config = Config::new(extent, 2).with_kernel(Kernel::gaussian(1000.0)).with_domain(domain);
            let mut first = None;
            let ended = Optimizer::new(config).unwrap().run_observed(Until::Seconds(0.5), |_| {
                first.get_or_insert(begin.elapsed());
                ControlFlow::Continue(())
            });
            match ended {
                Ok(report) => println!("{} steps", report.steps),
                Err(error) => assert!(matches!(error, ConfigError::TooShort { .. }), "{error}"),
            }
            (first.unwrap_or(begin.elapsed()), begin.elapsed())
        });
        println!("{extent:?}, {domain:?}: first step or refusal after {first:?}, all after {all:?}");
        // A few times as long at the most, on a machine that does other work besides.
        assert!(all < Duration::from_secs(5), "{extent:?}, {domain:?}: {first:?}, {all:?}");
    }
}

/// Directions are to be finite; what others have is no panic.
#[test]
fn laws_along_no_direction_are_no_panic() {
    let density = Target::Density(Density::new(2, 2, vec![1.0; 4]).unwrap().into());
    let cloud = Target::Cloud(PointCloud::new(2, vec![0.5; 4]).unwrap().into());
    for target in [Target::UniformCube, density, cloud] {
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 1e300, 5e-324, 0.0] {
            for direction in [[odd, 0.5], [odd, odd], [0.5, -odd]] {
                let law = target.project(&direction);
                _ = (law.support(), law.mean(), law.cdf(0.5), law.quantile(0.5), law.cell_mean(0.2, 0.4));
                _ = (law.cell_means(3).count(), law.w1_cell(0.1, 0.9, 0.5));
            }
        }
    }
}

/// The law of a measure that is none on the unit cube.
#[derive(Debug)]
struct At(f64);

impl Measure for At {
    fn name(&self) -> &str {
        "elsewhere"
    }
    fn dims(&self) -> usize {
        2
    }
    fn project(&self, _: &[f64]) -> Projected {
        let place = self.0;
        Projected::from_quantile(move |_| place)
    }
}

#[test]
fn a_measure_outside_of_the_cube_is_refused() {
    for place in [1e300, -1e300, 3.0, f64::NAN, f64::INFINITY] {
        let mut terms = vec![term(Classes::WholeTable, Role::Descend, 1.0)];
        terms[0].target = Target::custom(At(place));
        let error = Optimizer::new(Config::point_set(16, 2, terms)).unwrap_err().to_string();
        assert!(error.contains("no finite law") || error.contains("cube"), "{error}");
        assert!(error.len() < 200, "{error}");
    }
}

/// Messages are for people: no float has more digits than say something.
#[test]
fn numbers_in_messages_are_short() {
    let digits = |words: &str| {
        let runs = words.split(|c: char| !(c.is_ascii_digit() || c == '.'));
        runs.map(|run| run.trim_matches('0').chars().filter(char::is_ascii_digit).count()).max()
    };
    for sigma in [1e300, -1.0 / 3.0, 1e17 / 3.0, -f64::MAX, -5e-324, -0.1 - 0.2] {
        let error = Kernel::gaussian(sigma).taps(&TILE).unwrap_err().to_string();
        assert!(digits(&error) <= Some(6) && error.len() < 80, "{error}");
    }
    // What is just out of range does not look as if it were inside.
    let error = Kernel::gaussian(1e6 + 0.1).taps(&TILE).unwrap_err().to_string();
    assert!(!error.starts_with("sigma_px is 1e6:") && !error.starts_with("sigma_px is 1000000:"), "{error}");
}
