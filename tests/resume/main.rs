//! Runs that are resumed from a checkpoint end with the bits of runs that nothing has stopped.

mod anew;
mod damage;
mod kills;
mod origin;

use std::ops::ControlFlow;

use fsot::classes::{Classes, Demand, PrefixLengths};
use fsot::config::{Descent, Domain, LabelSubsets, Role, Term, Work};
use fsot::kernel::TemporalKernel;
use fsot::optimizer::{Checkpoint, StepReport};
use fsot::targets::Density;
use fsot::{Config, Extent, Kernel, Optimizer, RunReport, SampleTable, Until};

/// A kind of run.
struct Kind {
    name: &'static str,
    config: Config,
    demand: Option<Demand>,
    until: Until,
}

impl Kind {
    fn new(name: &'static str, config: Config, until: Until) -> Self {
        Self { name, config, demand: None, until }
    }

    fn optimizer(&self) -> Optimizer {
        let config = self.config.clone();
        match &self.demand {
            Some(demand) => Optimizer::for_demand(config, demand),
            None => Optimizer::new(config),
        }
        .unwrap()
    }
}

fn slices(slices_per_class: u64) -> Until {
    Until::SlicesPerClass(slices_per_class)
}

/// All engines, descents and kinds of classes, of a few hundred steps at most, or of so many times the work.
fn kinds_of(times: u64) -> Vec<Kind> {
    let slices = |slices_per_class: u64| slices(slices_per_class * times);
    let sweeps = |sweeps: u64| Until::Sweeps(sweeps * times);
    let still = |dims| Config::new(Extent::still(24, 20), dims).with_seed(3);
    let film = Config::new(Extent { frames: 6, height: 16, width: 20, spp: 2 }, 2).with_seed(4);
    let ema = Kernel::gaussian(1.5).with_temporal(TemporalKernel::Ema { alpha: 0.2 });
    let work =
        |frame_sweeps, slices_per_class, sweeps| Until::Work(Work { frame_sweeps, slices_per_class, sweeps });
    let disc = |site: usize| {
        let (y, x) = (site / 20 % 24, site % 20);
        (y as f64 - 12.0).hypot(x as f64 - 9.0) < 6.0
    };
    let demand = |wants: &dyn Fn(usize) -> bool| {
        Some(Demand::new([1, 24, 20], (0..480).map(wants).collect(), vec![vec![0, 1]]).unwrap())
    };
    let ramp = Density::new(8, 8, (0..64_u8).map(f32::from).collect()).unwrap();
    let mut kinds = vec![
        Kind::new("barycentric", still(2), slices(96)),
        Kind::new("adam", still(2).with_descent(Descent::adam()), slices(96)),
        Kind::new("sgd", still(2).with_descent(Descent::sgd()), slices(96)),
        Kind::new("torus", still(3).with_domain(Domain::Torus), slices(48)),
        Kind::new("sweeps", still(4), sweeps(5)),
        Kind::new("scalar sweeps", still(1), sweeps(5)),
        Kind::new("animation", film.clone().with_kernel(ema), work(4, 0, 3)),
        Kind::new("slices then sweeps", film.clone(), work(3, 16, 2)),
        Kind::new(
            "until it converges",
            still(2),
            Until::Converged { improvement: 0.05, window_steps: 16, at_most: 10_000 },
        ),
        Kind::new("labels", Config::classes(&[30, 31, 40], 2, &LabelSubsets::Every), slices(640)),
        Kind::new("sequence", Config::progressive(200, 2, PrefixLengths::PowersOfTwo), slices(640)),
        Kind::new("stippling", Config::stippling(300, ramp), slices(640)),
    ];
    let mut balanced = still(2);
    let of_pixels = Term { classes: Classes::PerPixel, role: Role::Balance, ..balanced.terms[0].clone() };
    balanced.extent.spp = 4;
    balanced.terms.push(of_pixels);
    kinds.push(Kind::new("balances beside sweeps", balanced, sweeps(4)));
    kinds.push(Kind { demand: demand(&disc), ..Kind::new("disc in sweeps", still(4), sweeps(5)) });
    let here_and_there = |site: usize| (site * site + site / 7).is_multiple_of(11);
    kinds.push(Kind {
        demand: demand(&here_and_there),
        ..Kind::new("scattered in sweeps", still(4), sweeps(5))
    });
    kinds.push(Kind { demand: demand(&disc), ..Kind::new("disc in slices", still(4), slices(48)) });
    kinds
}

fn kinds() -> Vec<Kind> {
    kinds_of(1)
}

/// Through the bytes of a file.
fn through_a_file(checkpoint: &Checkpoint) -> Checkpoint {
    let mut bytes = Vec::new();
    checkpoint.write(&mut bytes).unwrap();
    Checkpoint::read(&mut bytes.as_slice()).unwrap()
}

fn bits(optimizer: &Optimizer) -> Vec<u32> {
    optimizer.points().iter().map(|value| value.to_bits()).collect()
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Checkpoints of a run, each with the steps that it was taken after.
fn checkpoints(kind: &Kind, at: impl Fn(u64, u64) -> bool + Sync) -> (Optimizer, RunReport, Vec<Checkpoint>) {
    let mut optimizer = kind.optimizer();
    let mut taken = Vec::new();
    let observe = |step: &StepReport| {
        if at(step.step, step.steps) {
            taken.push(step.checkpoint());
        }
        ControlFlow::Continue(())
    };
    let report = optimizer.run_observed(kind.until, observe).unwrap();
    (optimizer, report, taken)
}

#[test]
fn a_resumed_run_ends_with_the_same_bits() {
    for kind in kinds() {
        // The first steps, in the middle of sweeps and of batches, and the last.
        let few = |step: u64, steps: u64| step <= 3 || step % 13 == 5 || step + 1 >= steps;
        let (whole, report, taken) = checkpoints(&kind, few);
        let mut unwatched = kind.optimizer();
        unwatched.run(kind.until).unwrap();
        assert_eq!(bits(&unwatched), bits(&whole), "{}: checkpoints leave a trace", kind.name);
        assert!(taken.len() > 6, "{}: {}", kind.name, taken.len());
        for (number, checkpoint) in taken.iter().enumerate() {
            let at = checkpoint.progress().unwrap().1;
            let name = format!("{} after step {at} of {}", kind.name, report.steps);
            let mut resumed = kind.optimizer();
            resumed.resume(through_a_file(checkpoint)).unwrap();
            let of_rest = with_threads(1 + number % 3, || resumed.finish().unwrap());
            assert_eq!(bits(&resumed), bits(&whole), "{name}");
            let figures = |report: &RunReport| (report.ended, report.steps, report.slices, report.work);
            assert_eq!(figures(&of_rest), figures(&report), "{name}");
            // What comes after the run, too.
            if number == 0 {
                let mut whole = kind.optimizer();
                whole.run(kind.until).unwrap();
                for optimizer in [&mut whole, &mut resumed] {
                    optimizer.run(slices(8)).unwrap();
                }
                assert_eq!(bits(&resumed), bits(&whole), "{name}, and another run");
            }
        }
    }
}

/// Killed twice; and what the second checkpoint holds is what the first one's run would hold there.
#[test]
fn a_resumed_run_can_be_resumed() {
    for kind in kinds() {
        let (whole, report, taken) = checkpoints(&kind, |step, steps| step == steps.min(40) / 4);
        let mut second = None;
        let mut resumed = kind.optimizer();
        resumed.resume(through_a_file(&taken[0])).unwrap();
        // Nothing was done yet.
        let mut same = kind.optimizer();
        same.resume(through_a_file(&resumed.checkpoint())).unwrap();
        let stopped = same
            .finish_observed(|step| {
                second = Some(step.checkpoint());
                if step.step < step.steps.min(40) / 2 {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            })
            .unwrap();
        assert!(stopped.steps < report.steps, "{}", kind.name);
        let mut third = kind.optimizer();
        third.resume(through_a_file(&second.unwrap())).unwrap();
        third.finish().unwrap();
        assert_eq!(bits(&third), bits(&whole), "{}", kind.name);
    }
}

#[test]
fn a_checkpoint_holds_its_table_and_configuration() {
    for kind in kinds() {
        let mut optimizer = kind.optimizer();
        let mut kept = None;
        let observe = |step: &StepReport| {
            kept = Some((step.table(), step.checkpoint()));
            if step.step < 5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        optimizer.run_observed(kind.until, observe).unwrap();
        let (table, checkpoint) = kept.unwrap();
        let checkpoint = through_a_file(&checkpoint);
        assert_eq!(checkpoint.table(), table, "{}", kind.name);
        assert_eq!(checkpoint.config().unwrap(), kind.config, "{}", kind.name);
    }
}

/// Between runs and steps of one's own; with moments.
#[test]
fn an_optimiser_between_steps_is_resumed() {
    for kind in kinds() {
        let mut optimizer = kind.optimizer();
        let mut again = kind.optimizer();
        for _ in 0..3 {
            optimizer.step(0.9, 1.0).unwrap();
        }
        again.resume(through_a_file(&optimizer.checkpoint())).unwrap();
        assert_eq!(again.finish().unwrap().steps, 0, "{}: there is no run", kind.name);
        for optimizer in [&mut optimizer, &mut again] {
            optimizer.step(0.8, 1.0).unwrap();
            if optimizer.sweep(0.5, 1.0).is_ok() {
                optimizer.sweep(0.4, 1.0).unwrap();
            }
        }
        assert_eq!(bits(&again), bits(&optimizer), "{}", kind.name);
    }
}

/// Repeating the slices of the first run is what `from_table` is left with.
#[test]
fn slices_go_on_from_a_table_with_metadata() {
    let config = Config::new(Extent::still(24, 24), 2).with_seed(5);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.npy");
    for until in [slices(64), Until::Sweeps(3)] {
        let mut whole = Optimizer::new(config.clone()).unwrap();
        let report = whole.run(until).unwrap();
        whole.table().save_with(&path, &whole.metadata(&report)).unwrap();
        let (table, metadata) = SampleTable::load_with(&path).unwrap();
        let mut on = Optimizer::from_table_with(config.clone(), table.clone(), &metadata).unwrap();
        let mut anew = Optimizer::from_table(config.clone(), table).unwrap();
        for optimizer in [&mut whole, &mut on, &mut anew] {
            optimizer.run(until).unwrap();
        }
        assert_eq!(bits(&on), bits(&whole));
        assert_ne!(bits(&anew), bits(&whole));
    }
}
