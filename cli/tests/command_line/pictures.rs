//! Pictures that are refused, until the advice is followed.

use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::{command, run, texts};

const WORK: &str = "--count 20 --slices 2 --points a.csv";

/// Refuses, with this flag in its advice; succeeds with it.
fn follow(home: &Path, kind: &str, flags: &str, advice: &str) {
    let arguments = format!("points {kind} --picture picture {WORK} {flags}");
    let output = command(home, &arguments).output().unwrap();
    let (_, err) = texts(&output);
    let flag = advice.split(' ').next().unwrap();
    assert!(output.status.code() == Some(1) && err.contains(flag), "{arguments}: {err}");
    assert!(err.lines().count() == 1 && !err.contains('`') && !home.join("a.csv").exists(), "{err}");
    let flags = if flags.starts_with(flag) { "" } else { flags };
    run(home, &format!("points {kind} --picture picture {WORK} {flags} {advice}"));
    fs::remove_file(home.join("a.csv")).unwrap();
}

/// A grey ramp; `chunk` stands before the pixels.
fn ramp(home: &Path, chunk: Option<([u8; 4], &[u8])>) {
    let file = fs::File::create(home.join("picture")).unwrap();
    let mut writer = png::Encoder::new(file, 60, 40).write_header().unwrap();
    if let Some((name, data)) = chunk {
        writer.write_chunk(png::chunk::ChunkType(name), data).unwrap();
    }
    let levels: Vec<u8> = (0..2400).map(|i| (i % 60) as u8).collect();
    writer.write_image_data(&levels).unwrap();
}

#[test]
fn curves_are_said_and_limits_raised() {
    let home = tempdir().unwrap();
    ramp(home.path(), None);
    for kind in ["stipple", "color-stipple"] {
        follow(home.path(), kind, "--limit-pixels 2399", "--limit-pixels 2400");
    }
    ramp(home.path(), Some((*b"cICP", &[9, 18, 0, 1])));
    for flag in ["--linear", "--srgb"] {
        follow(home.path(), "stipple", "", flag);
        follow(home.path(), "color-stipple", "", flag);
    }
    run(home.path(), &format!("points stipple --picture picture --linear --most-pixels 100 {WORK}"));
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(home.path().join("a.points.json")).unwrap()).unwrap();
    let reading = &record["flags"]["reading"];
    assert_eq!((&reading["linear"], &reading["most_pixels"]), (&true.into(), &100.into()));
}

/// 100 megapixels take 400 MB when they are all kept.
#[cfg(target_os = "linux")]
#[test]
fn short_memory_is_a_refusal() {
    let home = tempdir().unwrap();
    let path = home.path().join("picture.png");
    image::GrayImage::from_fn(20_000, 5000, |x, _| image::Luma([(x / 100) as u8])).save(&path).unwrap();
    let limited = |flags: &str| {
        let work = format!("points stipple --picture picture.png --threads 1 {WORK} {flags}");
        let line = format!("ulimit -v 300000; exec {} {work}", env!("CARGO_BIN_EXE_fsot"));
        let output =
            std::process::Command::new("sh").current_dir(home.path()).args(["-c", &line]).output().unwrap();
        (output.status.code(), texts(&output).1)
    };
    let (code, err) = limited("--most-pixels 0");
    assert!(code == Some(1) && err.contains("400000000 bytes") && err.contains("--most-pixels"), "{err}");
    let (code, err) = limited("--most-pixels 10000");
    assert_eq!(code, Some(0), "{err}");
}
