//! Metadata say whether a run of their configuration makes their table again.

use fsot::config::Work;
use fsot::files::{Metadata, RunRecord, RunStart};
use fsot::optimizer::Checkpoint;
use fsot::{Config, Extent, Optimizer, SampleTable, Until};

use super::kinds_of;

const SEED: u64 = 7;

fn config() -> Config {
    Config::new(Extent { frames: 3, height: 12, width: 12, spp: 1 }, 2).with_seed(SEED)
}

fn beginning(metadata: &Metadata) -> RunStart {
    assert!(metadata.run.start.is_some());
    metadata.run.beginning()
}

/// A run of the configuration and the work of metadata.
fn again(metadata: &Metadata) -> SampleTable {
    let RunRecord { frame_sweeps, slices_per_class, sweeps, .. } = metadata.run;
    let config: Config = serde_json::from_value(metadata.configuration.clone()).unwrap();
    config.optimize(Until::Work(Work { frame_sweeps, slices_per_class, sweeps })).unwrap()
}

#[test]
fn only_what_began_with_white_noise_says_so() {
    for until in [Until::Sweeps(3), Until::SlicesPerClass(20)] {
        let mut optimizer = Optimizer::new(config()).unwrap();
        let report = optimizer.run(until).unwrap();
        let (table, first) = (optimizer.table(), optimizer.metadata(&report));
        assert_eq!(beginning(&first), RunStart::WhiteNoise);
        assert_eq!(again(&first), table);

        // A second run of the same optimiser, also by the report of the first.
        let second = optimizer.run(until).unwrap();
        assert_ne!(again(&optimizer.metadata(&second)), optimizer.table());
        assert_eq!(beginning(&optimizer.metadata(&second)), RunStart::Elsewhere);
        assert_eq!(beginning(&optimizer.metadata(&report)), RunStart::Elsewhere);

        // Tables that were given.
        let given = [
            Optimizer::from_table(config(), table.clone()),
            Optimizer::from_table_with(config(), table.clone(), &first),
        ];
        for optimizer in given {
            let mut optimizer = optimizer.unwrap();
            let report = optimizer.run(until).unwrap();
            assert_eq!(beginning(&optimizer.metadata(&report)), RunStart::Elsewhere);
            assert_ne!(again(&optimizer.metadata(&report)), optimizer.table());
        }

        // Steps of one's own, before and after.
        let mut stepped = Optimizer::new(config()).unwrap();
        stepped.step(1.0, 1.0).unwrap();
        let report = stepped.run(until).unwrap();
        assert_eq!(beginning(&stepped.metadata(&report)), RunStart::Elsewhere);
        let mut stepped = Optimizer::new(config()).unwrap();
        let report = stepped.run(until).unwrap();
        stepped.sweep(1.0, 1.0).unwrap();
        assert_eq!(beginning(&stepped.metadata(&report)), RunStart::Elsewhere);
    }
}

#[test]
fn a_refused_run_is_none() {
    let mut optimizer = Optimizer::new(config()).unwrap();
    optimizer.run(Until::Seconds(-1.0)).unwrap_err();
    optimizer.step(-1.0, 1.0).unwrap_err();
    optimizer.sweep(-1.0, 1.0).unwrap_err();
    optimizer.plan(Until::Sweeps(2)).unwrap();
    let report = optimizer.run(Until::Sweeps(2)).unwrap();
    assert_eq!(beginning(&optimizer.metadata(&report)), RunStart::WhiteNoise);
    assert_eq!(again(&optimizer.metadata(&report)), optimizer.table());
}

/// A resumed run began where its checkpoint's did, whatever was demanded.
#[test]
fn resumed_runs_keep_their_beginning() {
    for kind in kinds_of(1) {
        let mut checkpoints = Vec::new();
        let mut optimizer = kind.optimizer();
        let whole = optimizer.run_observed(kind.until, |step| {
            if step.step % 7 == 1 {
                checkpoints.push(step.checkpoint());
            }
            std::ops::ControlFlow::Continue(())
        });
        let expected = optimizer.metadata(&whole.unwrap()).run.beginning();
        let of_demand = if kind.demand.is_some() { RunStart::Demand } else { RunStart::WhiteNoise };
        assert_eq!(expected, of_demand, "{}", kind.name);
        let taken = checkpoints.len();
        for checkpoint in checkpoints.into_iter().step_by(taken / 2) {
            let mut bytes = Vec::new();
            checkpoint.write(&mut bytes).unwrap();
            let mut resumed = kind.optimizer();
            resumed.resume(Checkpoint::read(&mut &bytes[..]).unwrap()).unwrap();
            let report = resumed.finish().unwrap();
            assert_eq!(beginning(&resumed.metadata(&report)), expected, "{}", kind.name);
            // There is nothing left to finish: such a report is of no work.
            let report = resumed.finish().unwrap();
            assert_ne!(beginning(&resumed.metadata(&report)), RunStart::WhiteNoise, "{}", kind.name);
        }
    }
}

/// Files of before 2026-11-28 number what comes next, or not even that.
#[test]
fn numbers_of_older_files_show_that_a_run_went_on() {
    let run = |next_step, next_sweep| RunRecord {
        sweeps: 2,
        steps: 32,
        next_step,
        next_sweep,
        ..Default::default()
    };
    assert_eq!(run(None, None).beginning(), RunStart::WhiteNoise);
    assert_eq!(run(Some(0), Some(2)).beginning(), RunStart::WhiteNoise);
    assert_eq!(run(Some(33), Some(2)).beginning(), RunStart::Elsewhere);
    assert_eq!(run(Some(0), Some(8002)).beginning(), RunStart::Elsewhere);
}
