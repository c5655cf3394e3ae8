//! Processes that are killed again and again end with the bits of a process that was left alone.

use std::env;
use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fsot::optimizer::{Checkpoint, StepReport};
use fsot::random::generator;
use rand::RngExt;

use super::{Kind, kinds_of};

/// Names the folder that the other process writes to, and the kind of run.
const FOLDER: &str = "FSOT_RESUME_FOLDER";
const KIND: &str = "FSOT_RESUME_KIND";
/// How many processes are killed; a few of every kind if it is not set.
const KILLS: &str = "FSOT_KILLS";
/// Kills of a run.
const MOST: usize = 3;
/// Makes runs long enough to be killed several times.
const TIMES: u64 = 40;

/// What the process does that is going to be killed: takes a run up where its last checkpoint has it, writes
/// others over it, and the table in the end.
#[test]
fn run_until_killed() {
    let Some(folder) = env::var_os(FOLDER).map(PathBuf::from) else { return };
    let kind: usize = env::var(KIND).unwrap().parse().unwrap();
    let kind: Kind = kinds_of(TIMES).swap_remove(kind);
    let path = folder.join("run.checkpoint");
    let mut optimizer = kind.optimizer();
    let mut last = Instant::now();
    let observe = |step: &StepReport| {
        if last.elapsed() > Duration::from_millis(2) {
            step.checkpoint().save(&path).unwrap();
            last = Instant::now();
        }
        ControlFlow::Continue(())
    };
    if path.exists() {
        optimizer.resume(Checkpoint::load(&path).unwrap()).unwrap();
        optimizer.finish_observed(observe).unwrap();
    } else {
        optimizer.run_observed(kind.until, observe).unwrap();
    }
    optimizer.table().save(folder.join("table.npy")).unwrap();
}

#[test]
fn killed_runs_end_with_the_same_bits() {
    let wanted: usize = env::var(KILLS).ok().and_then(|kills| kills.parse().ok()).unwrap_or(32);
    let home = tempfile::tempdir().unwrap();
    let mut random = generator(15, 4000_u64, 0, 0);
    let kinds = kinds_of(TIMES);
    let (mut kills, mut runs, mut begun_again) = (0, 0, 0);
    while kills < wanted {
        let index = runs % kinds.len();
        let folder = home.path().join(runs.to_string());
        fs::create_dir(&folder).unwrap();
        let (table, checkpoint) = (folder.join("table.npy"), folder.join("run.checkpoint"));
        let allowed = wanted.min(kills + MOST);
        while !table.exists() {
            let mut process = Command::new(env::current_exe().unwrap())
                .args(["--exact", "kills::run_until_killed"])
                .env(FOLDER, &folder)
                .env(KIND, index.to_string())
                // Never as many threads as before.
                .env("RAYON_NUM_THREADS", (1 + kills % 3).to_string())
                .stdout(Stdio::null())
                .spawn()
                .unwrap();
            let patience = Duration::from_micros(random.random_range(4_000..150_000));
            let begin = Instant::now();
            let mut ended = None;
            while ended.is_none() && (kills >= allowed || begin.elapsed() < patience) {
                sleep(Duration::from_micros(200));
                ended = process.try_wait().unwrap();
            }
            match ended {
                Some(status) => assert!(status.success(), "{}: {status}", kinds[index].name),
                None => {
                    process.kill().unwrap();
                    process.wait().unwrap();
                    kills += 1;
                    begun_again += usize::from(checkpoint.exists());
                }
            }
        }
        let mut alone = kinds[index].optimizer();
        alone.run(kinds[index].until).unwrap();
        let found = fsot::SampleTable::load(&table).unwrap();
        assert!(found == alone.table(), "{}", kinds[index].name);
        runs += 1;
    }
    println!("{kills} kills of {runs} runs, {begun_again} of them after a checkpoint");
    assert!(begun_again * 2 > kills, "most were killed before their first checkpoint");
}
