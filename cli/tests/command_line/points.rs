//! Point sets: their coordinates, how they were made, and figures that are poor.

use std::fs;
use std::path::Path;

use fsot::config::LabelSubsets;
use fsot::{Config, Until};
use ndarray::Array2;
use ndarray_npy::ReadNpyExt;
use serde_json::Value;
use sha2::Digest;
use tempfile::tempdir;

use crate::{command, names, run, texts};

/// Rows of x, y and label.
fn npy(path: &Path) -> Vec<[f32; 3]> {
    let array = Array2::<f32>::read_npy(fs::File::open(path).unwrap()).unwrap();
    assert_eq!(array.ncols(), 3);
    array.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect()
}

fn csv(path: &Path) -> Vec<[f32; 3]> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    assert_eq!(reader.headers().unwrap(), vec!["x", "y", "label"]);
    reader
        .deserialize()
        .map(|row: Result<(f32, f32, u32), _>| row.map(|(x, y, label)| [x, y, label as f32]).unwrap())
        .collect()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn both_forms_hold_the_points_of_the_library_to_the_last_bit() {
    let home = tempdir().unwrap();
    let work = "points two-class --counts 20,30,10 --every --slices 64 --seed 5 --no-comparison";
    run(home.path(), &format!("{work} --points a.npy"));
    run(home.path(), &format!("{work} --points a.csv"));
    let points = npy(&home.path().join("a.npy"));
    assert_eq!(csv(&home.path().join("a.csv")), points);
    let config = Config::classes(&[20, 30, 10], 2, &LabelSubsets::Every).with_seed(5);
    let table = config.optimize(Until::SlicesPerClass(64)).unwrap();
    let labels = [0.0; 20].into_iter().chain([1.0; 30]).chain([2.0; 10]);
    let expected: Vec<_> =
        table.values().chunks(2).zip(labels).map(|(at, label)| [at[0], at[1], label]).collect();
    assert_eq!(points, expected);
}

#[test]
fn how_they_were_made_lies_beside() {
    let home = tempdir().unwrap();
    run(home.path(), "points two-class --counts 20,30 --slices 64 --seed 5 --points a.npy");
    let record = json(&home.path().join("a.points.json"));
    assert_eq!(record["format"], "fsot point set 1");
    // Of the file, so that a record of another one is found out.
    let hash = sha2::Sha256::digest(fs::read(home.path().join("a.npy")).unwrap());
    assert_eq!(record["sha256"], hash.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
    assert_eq!((&record["kind"], &record["points"]), (&"two-class".into(), &50.into()));
    assert_eq!(record["columns"], serde_json::json!(["x", "y", "label"]));
    assert_eq!((&record["flags"]["counts"][1], &record["flags"]["seed"]), (&30.into(), &5.into()));
    let run = &record["run"];
    assert_eq!((&run["slices_per_class"], &run["ended_early"]), (&64.into(), &false.into()));
    assert!(run["steps"].as_u64() > Some(0) && run["seconds"].as_f64() > Some(0.0));
}

#[test]
fn labels_name_sequences_and_inks() {
    let home = tempdir().unwrap();
    run(home.path(), "points progressive --count 16 --seeds 3 --slices 8 --integrands 2 --points a.csv");
    let labels: Vec<f32> = csv(&home.path().join("a.csv")).iter().map(|row| row[2]).collect();
    assert_eq!(labels, [[0.0; 16], [1.0; 16], [2.0; 16]].concat());
    // Half pure red, which is magenta and yellow, and half black.
    let picture = home.path().join("picture.png");
    let red = |x, _| image::Rgb(if x < 8 { [255, 0, 0] } else { [0, 0, 0] });
    image::RgbImage::from_fn(16, 16, red).save(&picture).unwrap();
    run(home.path(), "points color-stipple --picture picture.png --count 300 --slices 100 --points b.npy");
    let rows = npy(&home.path().join("b.npy"));
    for (label, count, left) in [(0.0, 0, true), (1.0, 100, true), (2.0, 100, true), (3.0, 100, false)] {
        let ink: Vec<_> = rows.iter().filter(|row| row[2] == label).collect();
        assert_eq!(ink.len(), count, "ink {label}");
        let home = ink.iter().filter(|row| (row[0] < 0.5) == left).count();
        assert!(home >= count * 9 / 10, "{home} of ink {label} are where it is");
    }
}

/// A picture without anything to correlate with is no reason to lose twenty thousand points.
#[test]
fn a_flat_grey_picture_is_stippled_and_the_figure_has_a_word_of_advice() {
    let home = tempdir().unwrap();
    image::GrayImage::from_pixel(64, 64, image::Luma([128])).save(home.path().join("grey.png")).unwrap();
    let work = "points stipple --picture grey.png --count 20000";
    let (out, err) = run(home.path(), &format!("{work} --slices 100 --out a.png --points a.npy"));
    assert_eq!(err, "");
    assert!(out.contains("correlation ") && out.contains("almost even"), "{out}");
    assert!(out.contains("largest deviation ") && out.contains(" standard errors: "), "{out}");
    assert_eq!(names(home.path()), ["a.npy", "a.png", "a.points.json", "grey.png"]);
    assert_eq!(npy(&home.path().join("a.npy")).len(), 20000);
    let (out, _) = run(home.path(), &format!("{work} --slices 100 --json"));
    let line: Value = serde_json::from_str(&out).unwrap();
    assert!(line["figures"]["advice"].as_str().unwrap().contains("almost even"), "{out}");
}

#[test]
fn poor_figures_are_printed_like_good_ones() {
    let home = tempdir().unwrap();
    // A step of slices leaves points about where random ones are.
    let (out, _) =
        run(home.path(), "points two-class --counts 600,600 --slices 1 --points a.npy --no-comparison");
    assert!(out.contains("sliced W2") && !out.contains("of alone"), "{out}");
    image::GrayImage::from_fn(64, 4, |x, _| image::Luma([if x % 8 == 0 { 0 } else { 255 }]))
        .save(home.path().join("bars.png"))
        .unwrap();
    for count in [1, 2, 3, 4, 2000] {
        let (out, _) =
            run(home.path(), &format!("points stipple --picture bars.png --count {count} --slices 1"));
        assert!(out.contains("correlation"), "{out}");
    }
}

#[test]
fn the_seed_and_not_the_threads_decide() {
    let home = tempdir().unwrap();
    let points = |flags: &str| {
        run(home.path(), &format!("points two-class --counts 50,50 --slices 64 --points a.npy {flags}"));
        npy(&home.path().join("a.npy"))
    };
    let alone = points("--threads 1");
    assert_eq!(points("--threads 3"), alone);
    assert_ne!(points("--seed 1"), alone);
}

#[test]
fn no_points_are_refused_by_the_name_of_the_flag() {
    let home = tempdir().unwrap();
    let all =
        ["stipple --count", "color-stipple --count", "progressive --count", "two-class --counts 0 --counts"];
    for arguments in all {
        let output = command(home.path(), &format!("points {arguments} 0")).output().unwrap();
        let (_, err) = texts(&output);
        assert!(!output.status.success() && err.contains("--count"), "{arguments}: {err}");
    }
    assert_eq!(names(home.path()), [""; 0]);
}

#[test]
fn one_point_is_one() {
    let home = tempdir().unwrap();
    let (made, _) = run(home.path(), "points two-class --counts 1,2 --slices 16 --no-comparison");
    assert!(made.contains("labels [0], 1 point:") && made.contains("labels [1], 2 points:"), "{made}");
}
