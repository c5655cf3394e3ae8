//! What a run takes is known before it.

use fsot::config::{Descent, Work};
use fsot::{Config, Extent, Optimizer, Until};

fn cases() -> Vec<(Config, Until)> {
    let still = || Config::new(Extent::still(24, 20), 2).with_seed(3);
    let animation = || Config::new(Extent::animation(4, 16, 16), 3);
    let work = Work { frame_sweeps: 3, slices_per_class: 20, sweeps: 2 };
    vec![
        (still(), Until::Sweeps(5)),
        (still(), Until::SlicesPerClass(70)),
        (still().with_descent(Descent::adam()), Until::Epochs(3)),
        (animation(), Until::Sweeps(4)),
        (animation(), Until::Work(work)),
        (still(), Until::Work(work)),
        (Config::progressive(64, 2, fsot::classes::PrefixLengths::PowersOfTwo), Until::SlicesPerClass(30)),
        (still(), Until::SlicesPerClass(0)),
    ]
}

#[test]
fn a_plan_is_what_the_run_does() {
    for (config, until) in cases() {
        let mut optimizer = Optimizer::new(config.clone()).unwrap();
        let plan = optimizer.plan(until).unwrap();
        let report = optimizer.run(until).unwrap();
        assert_eq!((plan.steps, plan.work), (report.steps, report.work), "{until:?}");
        if report.slices > 0 {
            let slices = report.slices as f64;
            // Subsets are drawn at random, hundreds of them at the least.
            assert!((plan.slices / slices - 1.0).abs() < 0.1, "{until:?}: {} {slices}", plan.slices);
        }
        assert_eq!(plan.slices > 0.0, report.slices > 0, "{until:?}");
        assert_eq!(plan.pairs > 0.0, report.work.sweeps > 0, "{until:?}");
        assert_eq!(plan.seconds > 0.0, report.steps > 0, "{until:?}: {plan:?}");
    }
}

/// Of memory, the same with many dimensions as with few: peaks that the allocator has seen on one thread,
/// which does all the work.
#[test]
fn a_plan_foresees_the_memory_of_a_run() {
    let sweeps = |frame_sweeps, sweeps| Work { frame_sweeps, slices_per_class: 0, sweeps };
    let slices = Work { slices_per_class: 1, ..Work::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut far = Vec::new();
    for (extent, dims, work) in [
        (Extent::still(64, 64), 16, sweeps(0, 3)),
        (Extent::still(64, 64), 2, sweeps(0, 3)),
        (Extent::animation(16, 64, 64).with_spp(2), 8, sweeps(5, 1)),
        (Extent::animation(16, 64, 64).with_spp(2), 8, sweeps(0, 1)),
        (Extent::animation(32, 64, 64), 4, sweeps(0, 1)),
        (Extent::animation(16, 64, 64), 2, slices),
        (Extent::still(64, 64), 16, slices),
    ] {
        let config = Config::new(extent, dims);
        let (planned, peak) = pool.install(|| {
            let planned = Optimizer::new(config.clone()).unwrap().plan(Until::Work(work)).unwrap().bytes;
            let run = || _ = Optimizer::new(config.clone()).unwrap().run(Until::Work(work)).unwrap();
            (planned as f64 / 1e6, allocation_counter::measure(run).bytes_max as f64 / 1e6)
        });
        println!("{extent:?}, {dims} dimensions, {work:?}: {planned:.1} of {peak:.1} MB");
        // Small buffers of each term are not counted; tabulated laws and what a thread needs are guessed at
        // 3 MB, which small runs don't take.
        if !(0.88 * peak..1.25 * peak + 3.0).contains(&planned) {
            far.push(format!("{extent:?}, {dims} dimensions, {work:?}: {planned:.1} of {peak:.1} MB"));
        }
    }
    assert!(far.is_empty(), "{}", far.join("\n"));
}

/// Nothing moves while a plan is made, between runs and between steps alike.
#[test]
fn planning_changes_no_bits() {
    for (config, until) in cases() {
        let made = |planned: bool| {
            let mut optimizer = Optimizer::new(config.clone()).unwrap();
            let plan = |optimizer: &mut Optimizer| {
                if planned {
                    let before = optimizer.points().to_vec();
                    optimizer.plan(until).unwrap();
                    assert!(optimizer.points() == before);
                }
            };
            plan(&mut optimizer);
            optimizer.step(0.3, 1.0).unwrap();
            plan(&mut optimizer);
            optimizer.step(0.2, 1.0).unwrap();
            if optimizer.sweep(0.2, 1.0).is_ok() {
                plan(&mut optimizer);
                optimizer.sweep(0.1, 1.0).unwrap();
            }
            optimizer.run(until).unwrap();
            plan(&mut optimizer);
            optimizer.run(Until::SlicesPerClass(16)).unwrap();
            optimizer.into_table()
        };
        assert!(made(false) == made(true), "{until:?}");
    }
}

/// Before anything is done, and in the same words as a run.
#[test]
fn plans_of_what_cannot_run_are_refused() {
    let torus = || Config::new(Extent::still(8, 8), 2).with_domain(fsot::config::Domain::Torus);
    for (config, until) in [
        (torus(), Until::Sweeps(1)),
        (torus(), Until::Seconds(0.0)),
        (torus(), Until::Seconds(f64::NAN)),
        (torus(), Until::SlicesPerClass(u64::MAX)),
        (torus(), Until::Converged { improvement: 2.0, window_steps: 1, at_most: 1 }),
    ] {
        let mut optimizer = Optimizer::new(config).unwrap();
        let planned = optimizer.plan(until).unwrap_err();
        // NaN is not itself.
        assert_eq!(planned.to_string(), optimizer.run(until).unwrap_err().to_string());
    }
}
