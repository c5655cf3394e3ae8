//! `--log`, and `fsot plot`, which draws it.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::tempdir;

use crate::{command, names, output, run, succeed, texts};

const SMALL: &str = "--width 16 --height 16 --frames 3 --no-bound";
const HEADER: &str = "step,steps,seconds,rate,displacement,loss,filtered_error,bias";

/// Rows by column; empty fields are NaN.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(HEADER));
    assert!(text.ends_with('\n'));
    let number = |field: &str| if field.is_empty() { f64::NAN } else { field.parse().unwrap() };
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(number).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == 8));
    rows
}

#[test]
fn a_log_says_how_a_run_went_and_changes_no_bits() {
    let home = tempdir().unwrap();
    for work in
        ["--slices-per-class 400", "--frame-sweeps 30 --sweeps 20", "--slices-per-class 32 --sweeps 2"]
    {
        succeed(home.path(), &format!("{SMALL} {work} --out plain.npy"));
        succeed(home.path(), &format!("{SMALL} {work} --out logged.npy --log run.csv"));
        let bytes = |name: &str| fs::read(home.path().join(name)).unwrap();
        assert!(bytes("plain.npy") == bytes("logged.npy"), "{work}");
        let rows = rows(&home.path().join("run.csv"));
        let last = rows.last().unwrap();
        // The first step, the last one, and the table that came of them.
        assert!(rows.len() >= 3 && rows[0][0] == 1.0, "{work}: {rows:?}");
        assert!(last[0] == last[1] && last[0] == rows[rows.len() - 2][0], "{work}: {rows:?}");
        assert!(rows.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[0][2] <= pair[1][2]));
        assert!(rows[..rows.len() - 1].iter().all(|row| row[3] > 0.0 && row[4] > 0.0), "{work}: {rows:?}");
        // As ratios to white noise.
        assert!((0.05..0.6).contains(&last[6]) && (0.0..3.0).contains(&last[7]), "{work}: {last:?}");
    }
}

/// Rows become rarer, whatever the number of steps; a killed run leaves whole rows.
#[test]
fn a_log_is_short_and_whole_at_any_time() {
    let home = tempdir().unwrap();
    let path = home.path().join("run.csv");
    let long = format!("table {SMALL} --width 4 --height 4 --slices-per-class 100000000 --log run.csv");
    let long = long.replacen("--width 16 --height 16 ", "", 1);
    let mut child = command(home.path(), &long).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(2) || !path.exists() {
        assert!(child.try_wait().unwrap().is_none() && begin.elapsed() < Duration::from_secs(60));
        if path.exists() {
            rows(&path);
        }
        sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let rows = rows(&path);
    // One in 10 ms, and from half a second on one in 2 % of the time: 50 + ln(60 / 0.5) / ln(1.02).
    assert!((3..300).contains(&rows.len()), "{}", rows.len());
    assert!(rows.iter().any(|row| row[5] > 0.0) && rows.iter().any(|row| row[6] > 0.0), "{rows:?}");
    run(home.path(), "plot run.csv --out curves.svg");
}

#[test]
fn a_run_that_is_refused_leaves_no_log() {
    let home = tempdir().unwrap();
    for (flags, words) in [
        ("--log run.txt", "--log run.txt: give a file name that ends in .csv"),
        ("--log missing/run.csv", "there is no directory missing"),
        ("--seconds 0 --log run.csv", "(--seconds)"),
        ("--domain torus --sweeps 1 --log run.csv", "(--slices-per-class instead of --sweeps)"),
    ] {
        let output = output(home.path(), &format!("{SMALL} {flags}"));
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{flags}: {err}");
        assert!(err.contains(words), "{flags}: {err}");
        assert!(names(home.path()).is_empty(), "{flags}");
    }
}

/// The table does not suffer from a log that cannot be written on.
#[cfg(unix)]
#[test]
fn a_full_disk_costs_the_log_alone() {
    let home = tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_fsot");
    let table = "table --width 2 --height 2 --frames 1 --slices-per-class 5000000 --no-bound --threads 1";
    // 6 KiB hold the table and its metadata, or a hundred rows, which are those of a second and a half.
    // Without the trap the system would kill the process.
    let line = format!("trap '' XFSZ; ulimit -f 12; exec {program} {table} --quiet --log run.csv");
    let output =
        std::process::Command::new("sh").args(["-c", &line]).current_dir(home.path()).output().unwrap();
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("cannot write run.csv") && err.contains("all else is written"), "{err}");
    assert!(fsot::SampleTable::load_with(home.path().join("table.npy")).is_ok(), "{err}");
}

#[test]
fn logs_are_drawn_side_by_side() {
    let home = tempdir().unwrap();
    succeed(home.path(), &format!("{SMALL} --slices-per-class 300 --log slices.csv"));
    succeed(home.path(), &format!("{SMALL} --sweeps 30 --log sweeps.csv"));
    let (out, _) = run(home.path(), "plot slices.csv sweeps.csv --out curves.svg");
    assert!(out.contains("curves.svg: filtered_error"), "{out}");
    let svg = fs::read_to_string(home.path().join("curves.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for text in ["slices.csv", "sweeps.csv", "filtered error / white noise", "displacement"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    let (out, _) = run(home.path(), "plot slices.csv --json --out one.svg");
    let line: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(line["out"], "one.svg");

    fs::write(home.path().join("header.csv"), format!("{HEADER}\n")).unwrap();
    fs::write(home.path().join("points.csv"), "x,y,label\n0.5,0.5,0\n").unwrap();
    for (files, words) in [
        ("points.csv", "points.csv is no log: give a file that `fsot table --log` has written"),
        ("table.npy", "table.npy is no log"),
        ("header.csv", "there is nothing to draw yet"),
        ("missing.csv", "cannot read missing.csv"),
        ("slices.csv --out a.png", "ends in .svg"),
    ] {
        let output = command(home.path(), &format!("plot {files}")).output().unwrap();
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{files}: {err}");
        assert!(err.contains(words) && err.lines().count() == 1, "{files}: {err}");
    }
    assert!(!home.path().join("curves.png").exists());
}

/// Of a point set there is no filter, but a loss.
#[test]
fn point_sets_are_logged() {
    let home = tempdir().unwrap();
    for verb in
        ["two-class --counts 64,64 --no-comparison", "progressive --count 64 --integrands 2 --seeds 2"]
    {
        let verb = format!("points {verb} --slices 2000");
        run(home.path(), &format!("{verb} --points plain.csv"));
        run(home.path(), &format!("{verb} --points logged.csv --log run.csv"));
        let bytes = |name: &str| fs::read(home.path().join(name)).unwrap();
        assert!(bytes("plain.csv") == bytes("logged.csv"), "{verb}");
        let rows = rows(&home.path().join("run.csv"));
        assert!(rows.len() >= 3 && rows.iter().all(|row| row[6].is_nan()), "{verb}: {rows:?}");
        run(home.path(), "plot run.csv");
    }
    assert!(names(home.path()).contains(&"curves.svg".to_owned()));
}

/// A full disk or a power cut leaves half a row; what is spoiled is left out, and said.
#[test]
fn half_rows_and_spoiled_ones_cost_no_others() {
    let home = tempdir().unwrap();
    let at = |name: &str| home.path().join(name);
    let row = |step: usize| format!("{step},9,0.{step},1e-1,2e-2,3e-1,4e-1,5e-1\n");
    let whole: String = (1..9).map(row).collect();
    let text = |rows: &str| format!("{HEADER}\n{rows}");
    let spoiled = whole.replace(&row(4), "4,9,0.4,1e-\u{0}?\n").replace(&row(6), "6,9\n");
    for (rows, lines) in [
        (whole.as_str(), 0),
        // Half a row that something else follows.
        (&whole.replace(&row(4), "4,9,0.45,9,0.5,1e-1,2e-2,3e-1,4e-1,5e-1\n"), 1),
        (&spoiled, 2),
        (&format!("{whole}9,9,0.9,1e-"), 0),
    ] {
        fs::write(at("a.csv"), text(rows)).unwrap();
        let (out, _) = run(home.path(), "plot a.csv --json");
        let line: serde_json::Value = serde_json::from_str(&out).unwrap();
        assert_eq!(line["spoiled_lines"], serde_json::json!([lines]), "{rows}");
        assert_eq!(line["panels"].as_array().unwrap().len(), 3, "{rows}");
        let (out, _) = run(home.path(), "plot a.csv");
        assert_eq!(out.contains("no row of a log"), lines > 0, "{out}");
    }
    // No rows are lost: the curve ends where it did.
    let drawn = |rows: &str| {
        fs::write(at("a.csv"), text(rows)).unwrap();
        run(home.path(), "plot a.csv");
        fs::read_to_string(at("curves.svg")).unwrap()
    };
    let points = |svg: &str| svg.split("<polyline").map(|line| line.matches(',').count()).sum::<usize>();
    assert!(points(&drawn(&whole)) > points(&drawn(&spoiled)));

    let run_flags = "--width 8 --height 8 --frames 1 --slices-per-class 40000 --no-bound --every 1ms";
    succeed(home.path(), &format!("{run_flags} --checkpoint a.ck --log a.csv"));
    let log = fs::read(at("a.csv")).unwrap();
    fs::write(at("b.csv"), &log[..log.len() - 25]).unwrap();
    succeed(home.path(), "--resume a.ck --no-bound --log b.csv");
    assert!(rows(&at("b.csv")).len() >= 2);
}

/// Measuring a large table takes longer than a short run may spend.
#[test]
fn what_a_table_is_worth_is_left_out_where_it_takes_too_long() {
    let home = tempdir().unwrap();
    succeed(home.path(), "--frames 64 --sweeps 1 --frame-sweeps 0 --no-bound --log run.csv");
    let rows = rows(&home.path().join("run.csv"));
    let last = rows.last().unwrap();
    assert!(last[0] == last[1] && last[6].is_nan(), "{last:?}");
}
