//! `--dry-run`: what a run would take.

use serde_json::Value;
use tempfile::tempdir;

use crate::{names, output, succeed, texts};

#[test]
fn a_dry_run_writes_nothing_and_says_what_the_run_then_does() {
    let home = tempdir().unwrap();
    for flags in [
        "--width 16 --height 12 --frames 3 --sweeps 3",
        "--width 16 --height 16 --frames 1 --slices-per-class 40 --sweeps 2 --dims 3",
        "--width 16 --height 16 --frames 1 --domain torus --slices-per-class 20",
    ] {
        let (out, _) = succeed(home.path(), &format!("{flags} --dry-run --json"));
        assert!(names(home.path()).is_empty());
        let plan: Value = serde_json::from_str(&out).unwrap();
        let (words, _) = succeed(home.path(), &format!("{flags} --dry-run"));
        for part in ["descended: filter of each pixel", "s expected", "MB of memory", " steps"] {
            assert!(words.contains(part), "{words}");
        }
        let (out, _) = succeed(home.path(), &format!("{flags} --json --no-bound --out table.npy"));
        let run: Value = serde_json::from_str(&out).unwrap();
        for figure in ["shape", "seed", "steps", "frame_sweeps", "slices_per_class", "sweeps"] {
            assert_eq!(plan[figure], run[figure], "{flags} {figure}");
        }
        assert!(plan["expected_seconds"].as_f64().unwrap() > 0.0);
        assert!(plan["bytes"].as_u64() > plan["table_bytes"].as_u64());
        std::fs::remove_file(home.path().join("table.npy")).unwrap();
        std::fs::remove_file(home.path().join("table.json")).unwrap();
    }
}

#[test]
fn what_cannot_run_is_refused_before_it() {
    let home = tempdir().unwrap();
    for (flags, words) in [
        ("--seconds 0", "(--seconds)"),
        ("--domain torus --sweeps 1", "(--slices-per-class instead of --sweeps)"),
        ("--width 0", "(--width)"),
        ("--out a.txt", "ends in .npy"),
    ] {
        let output = output(home.path(), &format!("{flags} --dry-run"));
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{flags}: {err}");
        assert!(err.contains(words), "{err}");
    }
}
