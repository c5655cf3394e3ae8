//! The program `lecture`, run as a person runs it.

use std::process::{Command, Output};

fn lecture(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lecture")).args(arguments).output().unwrap()
}

#[test]
fn a_quick_run_has_a_table_figures_and_sheets() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("lecture");
    let output = lecture(&["--quick", "--out", out.to_str().unwrap()]);
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{complaints}");
    let text = String::from_utf8(output.stdout).unwrap();
    for name in [
        "white noise",
        "dither mask",
        "FAST, space",
        "STBN",
        "seed permutation",
        "ours, space + eye",
        "denoised",
    ] {
        assert!(text.contains(name), "{name} is missing in: {text}");
    }
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    let csv = std::fs::read_to_string(out.join("lecture.csv")).unwrap();
    // Two pictures with 11 samplers and 2 stages, an animation with 15 and 2, each at two numbers of samples.
    assert_eq!(csv.lines().count(), 1 + 2 * (2 * 2 * 11 + 2 * 15), "{csv}");
    for sheet in ["soft_shadow-still-1spp", "glossy-still-4spp", "animated_soft_shadow-animated-4spp"] {
        let page = image::open(out.join(format!("{sheet}.png"))).unwrap();
        assert!(page.width() > 1000 && page.height() > 1000, "{sheet}");
    }
}

#[test]
fn a_place_that_cannot_be_written_to_is_named() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("taken");
    std::fs::write(&file, "").unwrap();
    let output = lecture(&["--quick", "--out", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert!(complaint.starts_with("error: cannot create"), "{complaint}");
}
