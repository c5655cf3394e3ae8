//! Signals: a run ends tidily, keeps what it has reached, and says so by words, files and exit code.

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fsot::files::Metadata;
use fsot::{Extent, SampleTable};
use serde_json::Value;
use tempfile::tempdir;

use crate::{command, names, texts};

const SIGNALS: [&str; 3] = ["INT", "TERM", "HUP"];
const STOPPED: Option<i32> = Some(3);
const SMALL: &str = "--width 12 --height 10 --frames 3";

/// Long enough for a machine that has much else to do.
const PATIENCE: Duration = Duration::from_secs(60);

fn start(home: &Path, arguments: &str) -> Child {
    let mut run = command(home, arguments);
    run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

pub(super) fn signal(child: &Child, signal: &str) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success());
}

fn wait_until(what: &str, done: impl Fn() -> bool) {
    let begin = Instant::now();
    while !done() {
        assert!(begin.elapsed() < PATIENCE, "{what}");
        sleep(Duration::from_millis(1));
    }
}

/// Waits until signals are listened to: where the system tells, and else for long enough.
pub(super) fn listening(child: &Child) {
    if !cfg!(target_os = "linux") {
        return sleep(Duration::from_secs(5));
    }
    wait_until("no handler", || listens(child));
}

/// As far as the system tells.
fn listens(child: &Child) -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap_or("0").trim();
    // SIGHUP, the last to be listened to.
    u64::from_str_radix(caught, 16).unwrap_or(0) & 1 == 1
}

/// What comes of a run of hours that a signal ends.
fn stopped(home: &Path, arguments: &str, name: &str) -> (String, Output) {
    let child = start(home, arguments);
    listening(&child);
    signal(&child, name);
    let begin = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(begin.elapsed() < PATIENCE, "{arguments}");
    let (out, err) = texts(&output);
    assert_eq!((output.status.code(), err.as_str()), (STOPPED, ""), "{arguments}: {out}");
    (out, output)
}

#[test]
fn a_table_is_kept_as_it_is() {
    for name in SIGNALS {
        let home = tempdir().unwrap();
        let (out, _) = stopped(home.path(), &format!("table {SMALL} --seconds 3600"), name);
        assert!(out.contains("stopped after") && out.contains("bound not measured"), "{out}");
        assert_eq!(names(home.path()), ["table.json", "table.npy"]);
        let (table, metadata) = SampleTable::load_with(home.path().join("table.npy")).unwrap();
        assert_ne!(table, SampleTable::white_noise(table.extent(), 2, 0).unwrap());
        assert!(metadata.run.steps > 0 && metadata.run.ended_early && metadata.bound.is_none());
    }
}

#[test]
fn points_of_all_kinds_are_kept() {
    let picture = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/garden.png");
    for (kind, name) in [
        ("two-class".to_owned(), "INT"),
        ("progressive".to_owned(), "TERM"),
        ("progressive --seeds 3".to_owned(), "INT"),
        (format!("stipple --picture {picture}"), "HUP"),
        (format!("color-stipple --picture {picture}"), "INT"),
    ] {
        let home = tempdir().unwrap();
        let work = format!("points {kind} --slices 1000000000 --points a.csv --out a.png");
        let (out, _) = stopped(home.path(), &work, name);
        assert!(out.contains("stopped early after") && out.contains("not measured"), "{kind}: {out}");
        assert_eq!(names(home.path()), ["a.csv", "a.png", "a.points.json"], "{kind}");
        let record: Value =
            serde_json::from_slice(&fs::read(home.path().join("a.points.json")).unwrap()).unwrap();
        assert_eq!(record["run"]["ended_early"], true, "{kind}");
        assert!(record["run"]["steps"].as_u64() > Some(0), "{kind}");
        // A header, and as many lines as there are points.
        let lines = fs::read_to_string(home.path().join("a.csv")).unwrap().lines().count();
        assert_eq!(record["points"], lines - 1, "{kind}");
        image::open(home.path().join("a.png")).unwrap();
    }
}

#[test]
fn json_says_so() {
    let home = tempdir().unwrap();
    for work in [format!("table {SMALL} --seconds 3600"), "points two-class --slices 1000000000".into()] {
        let (out, _) = stopped(home.path(), &format!("{work} --json"), "TERM");
        let line: Value = serde_json::from_str(&out).unwrap();
        assert_eq!((out.lines().count(), &line["ended_early"]), (1, &true.into()), "{out}");
    }
}

/// One signal stops what is measured after a run, whose files are whole by then.
#[test]
fn figures_are_left_out_and_the_result_is_not() {
    let home = tempdir().unwrap();
    let (table, points) = (home.path().join("table.npy"), home.path().join("a.npy"));
    let large = "--width 128 --height 128 --frames 16";
    let child = start(home.path(), &format!("table {large} --sweeps 1"));
    wait_until("no table", || table.exists());
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let (out, _) = texts(&output);
    assert_eq!(output.status.code(), STOPPED, "{out}");
    assert!(out.contains("bound not measured") && !out.contains("stopped after"), "{out}");
    let (made, metadata) = SampleTable::load_with(&table).unwrap();
    assert_eq!((metadata.bound, metadata.run.ended_early), (None, false));
    fs::remove_file(&table).unwrap();
    crate::succeed(home.path(), &format!("{large} --sweeps 1 --no-bound --quiet"));
    assert!(SampleTable::load(&table).unwrap() == made);

    let child = start(home.path(), "points two-class --counts 20000,20001 --slices 500 --points a.npy");
    let record = home.path().join("a.points.json");
    wait_until("no points", || record.exists());
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let (out, _) = texts(&output);
    assert_eq!(output.status.code(), STOPPED, "{out}");
    assert!(out.contains("not measured, since a signal came") && !out.contains("stopped early"), "{out}");
    assert!(points.exists());
}

/// Impatience does no harm.
#[test]
fn many_signals_are_as_good_as_one() {
    let home = tempdir().unwrap();
    let child = start(home.path(), &format!("table {SMALL} --seconds 3600"));
    listening(&child);
    for name in SIGNALS.repeat(4) {
        // The process may be gone already.
        let _ = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).output();
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), STOPPED);
    assert!(Metadata::load(home.path().join("table.npy")).unwrap().run.ended_early);
}

/// There is nothing to keep, so signals do what they always do.
#[test]
fn an_inspection_ends_at_once() {
    let home = tempdir().unwrap();
    crate::succeed(home.path(), &format!("{SMALL} --sweeps 1 --quiet --no-bound"));
    let mut child = start(home.path(), "inspect table.npy --integrands 65536");
    let mut first = [0];
    std::io::Read::read_exact(child.stdout.as_mut().unwrap(), &mut first).unwrap();
    signal(&child, "TERM");
    assert_eq!(child.wait_with_output().unwrap().status.signal(), Some(15));
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
}

/// Many files, and one that takes long: nothing of them is left, and what was there stays.
#[test]
fn an_export_that_is_broken_off_leaves_nothing() {
    let home = tempdir().unwrap();
    let table = SampleTable::white_noise(Extent::animation(48, 256, 256), 4, 0).unwrap();
    table.save(home.path().join("table.npy")).unwrap();
    fs::write(home.path().join("a.csv"), "old").unwrap();
    let is_pending = |name: &String| name.starts_with(".fsot-");
    for (to, name) in SIGNALS.iter().zip(["slices --out a.png", "csv --out a.csv", "c --bits 16 --out a.h"]) {
        let child = start(home.path(), &format!("export table.npy --to {name}"));
        wait_until("no file", || names(home.path()).iter().any(is_pending) && listens(&child));
        signal(&child, to);
        let begin = Instant::now();
        let output = child.wait_with_output().unwrap();
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{name}: {err}");
        assert!(err.contains("a signal came before all files were complete: nothing is written"), "{err}");
        assert!(begin.elapsed() < PATIENCE / 6, "{name}");
        assert_eq!(names(home.path()), ["a.csv", "table.npy"], "{name}");
        assert_eq!(fs::read_to_string(home.path().join("a.csv")).unwrap(), "old");
    }
    // Files that are complete are kept, and what they cost is not waited for.
    let child = start(home.path(), "export table.npy --to ktx2 --out a.ktx2");
    wait_until("no texture", || home.path().join("a.ktx2.json").exists());
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let (out, _) = texts(&output);
    assert_eq!(output.status.code(), STOPPED, "{out}");
    assert!(out.ends_with("what the numbers cost: not measured, since a signal came\n"), "{out}");
    assert_eq!(names(home.path()), ["a.csv", "a.ktx2", "a.ktx2.json", "table.npy"]);
}

/// `nohup` asks for a run that outlives its terminal.
#[cfg(target_os = "linux")]
#[test]
fn a_run_under_nohup_goes_on() {
    let home = tempdir().unwrap();
    let mut run = Command::new("nohup");
    run.current_dir(home.path()).arg(env!("CARGO_BIN_EXE_fsot")).arg("table");
    run.args(SMALL.split_whitespace()).args(["--seconds", "1.5", "--no-bound"]);
    let child = run.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_until("no fsot", || {
        let name = fs::read_to_string(format!("/proc/{}/comm", child.id())).unwrap_or_default();
        name.trim() == "fsot"
    });
    signal(&child, "HUP");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{:?}", texts(&output));
    assert!(!Metadata::load(home.path().join("table.npy")).unwrap().run.ended_early);
}
