//! Runs that are stopped or killed, and resumed.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use ndarray::Array3;
use tempfile::tempdir;

#[cfg(unix)]
use super::signals::{listening, signal};
use super::{command, output, succeed, texts};

fn waits_for(path: &Path) {
    for _ in 0..2000 {
        if path.exists() {
            return;
        }
        sleep(Duration::from_millis(5));
    }
    panic!("{} never came", path.display());
}

/// The table, and what its metadata say of it but for seconds and the bound.
fn result(home: &Path, name: &str) -> (Vec<u8>, serde_json::Value) {
    let read = |ending: &str| fs::read(home.join(name).with_extension(ending)).unwrap();
    let mut metadata: serde_json::Value = serde_json::from_slice(&read("json")).unwrap();
    metadata["run"]["seconds"] = 0.into();
    (read("npy"), metadata)
}

#[test]
fn a_killed_run_is_resumed_with_the_same_bits() {
    let home = tempdir().unwrap();
    let home = home.path();
    for (flags, threads) in [
        ("--frames 6 --width 24 --height 24 --sweeps 300 --frame-sweeps 200", 1),
        ("--frames 1 --width 32 --height 32 --optimizer adam --slices-per-class 3000", 2),
    ] {
        succeed(home, &format!("{flags} --no-bound --out whole.npy"));
        let path = home.join("run.checkpoint");
        let mut arguments = format!("table {flags} --checkpoint run.checkpoint --every 5ms");
        for _ in 0..3 {
            let mut process = command(home, &format!("{arguments} --no-bound --quiet --out killed.npy"))
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            waits_for(&path);
            sleep(Duration::from_millis(20));
            process.kill().unwrap();
            process.wait().unwrap();
            arguments = "table --resume run.checkpoint --every 5ms".into();
        }
        succeed(home, &format!("--resume run.checkpoint --threads {threads} --no-bound --out killed.npy"));
        assert_eq!(result(home, "killed.npy"), result(home, "whole.npy"), "{flags}");
        fs::remove_file(&path).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn a_stopped_run_leaves_a_checkpoint_of_its_last_step() {
    let home = tempdir().unwrap();
    let home = home.path();
    let flags = "--frames 1 --width 32 --height 32 --sweeps 30000 --no-bound";
    succeed(home, &format!("{flags} --out whole.npy"));
    // The first one comes with the signal.
    let process =
        command(home, &format!("table {flags} --checkpoint run.checkpoint --every 1h --out half.npy"))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
    listening(&process);
    signal(&process, "INT");
    let stopped = process.wait_with_output().unwrap();
    let (out, err) = texts(&stopped);
    assert_eq!(stopped.status.code(), Some(3), "{out}{err}");
    assert!(out.contains("the run goes on with --resume run.checkpoint"), "{out}");
    succeed(home, "--resume run.checkpoint --no-bound --out half.npy");
    assert_eq!(result(home, "half.npy"), result(home, "whole.npy"));
}

/// Metadata of such a run are longer than its table.
#[test]
fn a_run_with_a_large_kernel_is_resumed() {
    let home = tempdir().unwrap();
    let home = home.path();
    let kernel = Array3::from_shape_fn([16, 31, 31], |(t, y, x)| ((t * 7 + y * 3 + x) % 11) as f64);
    ndarray_npy::write_npy(home.join("kernel.npy"), &kernel).unwrap();
    let flags = "--frames 16 --width 32 --height 32 --kernel kernel.npy --slices-per-class 2 --no-bound";
    succeed(home, &format!("{flags} --checkpoint run.checkpoint --every 1ms --out whole.npy"));
    // By another spelling of the same file.
    succeed(home, "--resume ./run.checkpoint --checkpoint run.checkpoint --no-bound --out again.npy");
    assert_eq!(result(home, "again.npy"), result(home, "whole.npy"));
}

#[test]
fn what_cannot_be_resumed_is_told() {
    let home = tempdir().unwrap();
    let home = home.path();
    let error = |arguments: &str, code: i32| {
        let output = output(home, arguments);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments}: {err}");
        err
    };
    let missing = error("--resume nothing.checkpoint", 1);
    assert!(missing.contains("cannot read the checkpoint nothing.checkpoint"), "{missing}");
    fs::write(home.join("other"), "something else").unwrap();
    let other = error("--resume other", 1);
    assert!(other.contains("starts with \"something else\""), "{other}");
    let twice = error("--resume other --sigma 3", 2);
    assert!(twice.contains("--sigma"), "{twice}");
    let time = error("--checkpoint run --every soon", 2);
    assert!(time.contains("--every"), "{time}");
    let same = error("--checkpoint table.npy", 1);
    assert!(same.contains("are the same file"), "{same}");
    let read = error("--resume other.npy --out other.npy", 1);
    assert!(read.contains("cannot read") || read.contains("overwrite"), "{read}");
    assert_eq!(super::names(home), ["other"]);
}
