//! Files that cannot be written are found out before the work, by all verbs in the same words.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{command, names, run, texts};

/// Runs that would take hours; the flag that names their file follows.
const LONG: [(&str, &str, &str); 5] = [
    ("table --slices-per-class 100000000", "--out", "npy"),
    ("points two-class --slices 100000000", "--out", "png"),
    ("points progressive --slices 100000000", "--points", "csv"),
    ("points stipple --picture picture.png --slices 100000000", "--points", "npy"),
    ("points color-stipple --picture picture.png --slices 100000000", "--out", "png"),
];

/// A home with a picture in it, and things that stand in the way.
fn home() -> tempfile::TempDir {
    let home = tempdir().unwrap();
    image::GrayImage::from_fn(16, 16, |x, _| image::Luma([8 * x as u8]))
        .save(home.path().join("picture.png"))
        .unwrap();
    for ending in ["npy", "csv", "png"] {
        fs::create_dir(home.path().join(format!("folder.{ending}"))).unwrap();
    }
    home
}

/// One sentence with these words, exit code 1, at once, and nothing is written.
fn refused(home: &Path, arguments: &str, words: &str) {
    let (before, begin) = (names(home), Instant::now());
    let output = command(home, arguments).output().unwrap();
    let (out, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments}: {err}");
    assert!(
        out.is_empty() && err.starts_with("error: ") && err.lines().count() == 1,
        "{arguments}: {out}{err}"
    );
    assert!(err.contains(words), "{arguments}: {err}");
    assert_eq!(names(home), before, "{arguments}");
    assert!(begin.elapsed() < Duration::from_secs(20), "{arguments}");
}

#[test]
fn what_stands_in_the_way_is_found_out_before_the_work() {
    let home = home();
    for (work, flag, ending) in LONG {
        let refused = |name: &str, words: &str| refused(home.path(), &format!("{work} {flag} {name}"), words);
        refused(&format!("missing/a.{ending}"), "there is no directory missing; choose another");
        refused(&format!("folder.{ending}"), "it is a directory, not a file; choose another");
        refused(&format!("picture.png/a.{ending}"), "cannot write");
        for name in ["a.txt", "a", "a.", "/", "..", &format!(".{ending}"), &format!("a.{ending}.gz")] {
            refused(name, "give a file name that ends in .");
            refused(name, flag);
        }
    }
    refused(home.path(), "table --out a.json", "--out a.json: give a file name that ends in .npy");
    refused(home.path(), "points two-class --points a.txt", "ends in .npy or .csv");
}

#[test]
fn the_file_beside_is_checked_as_well() {
    let home = home();
    for name in ["a.json", "a.points.json"] {
        fs::create_dir(home.path().join(name)).unwrap();
    }
    refused(home.path(), "table --slices-per-class 100000000 --out a.npy", "a.json");
    refused(
        home.path(),
        "points stipple --picture picture.png --slices 100000000 --points a.csv",
        "a.points.json",
    );
}

#[test]
fn what_is_read_is_not_overwritten() {
    let home = home();
    let stipple = "points stipple --picture ./picture.png --slices 100000000";
    refused(home.path(), &format!("{stipple} --out picture.png"), "would overwrite what is read");
    let table = SampleTable::white_noise(Extent::still(4, 4), 2, 0).unwrap();
    table.save(home.path().join("table.npy")).unwrap();
    refused(home.path(), "report table.npy --out table.npy", "ends in .html or .htm");
    refused(home.path(), "report table.npy --png table.npy", "ends in .png");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("picture.png", home.path().join("link.png")).unwrap();
        refused(home.path(), &format!("{stipple} --out link.png"), "would overwrite what is read");
        std::os::unix::fs::symlink("table.npy", home.path().join("table.png")).unwrap();
        refused(home.path(), "report table.npy --png table.png", "would overwrite what is read");
        fs::write(home.path().join("same.csv"), "").unwrap();
        std::os::unix::fs::symlink("same.csv", home.path().join("same.png")).unwrap();
        let both = "points two-class --slices 100000000 --out same.png --points same.csv";
        refused(home.path(), both, "are the same file");
    }
}

/// Links that lead to a file that is not there yet are the file.
#[cfg(unix)]
#[test]
fn links_to_one_new_file_are_the_same_file() {
    let home = home();
    for name in ["first.png", "second.csv"] {
        std::os::unix::fs::symlink("goal", home.path().join(name)).unwrap();
    }
    let both = "points two-class --counts 8,8 --slices 4 --out first.png --points second.csv";
    refused(home.path(), both, "--points second.csv and --out first.png are the same file");
    run(home.path(), "points two-class --counts 8,8 --slices 4 --out first.png");
    assert!(home.path().join("first.png").is_symlink());
    assert!(
        image::ImageReader::open(home.path().join("goal"))
            .unwrap()
            .with_guessed_format()
            .unwrap()
            .decode()
            .is_ok()
    );
}

/// A disk that is full after a kilobyte: what was there stays, and nothing is left.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_what_was_there() {
    let home = home();
    run(home.path(), "table --frames 1 --sweeps 1 --no-bound");
    for (verb, files) in [
        ("table --frames 1 --sweeps 2 --no-bound", &["table.npy"][..]),
        ("report table.npy --integrands 2 --bound-slices 64 --out page.html", &["page.html"]),
        (
            "report table.npy --integrands 2 --bound-slices 64 --out page.html --png page.png",
            &["page.html", "page.png"],
        ),
        ("import table.npy --out other.npy", &["other.npy"]),
        ("points two-class --counts 512,512 --slices 4 --no-comparison --out page.png", &["page.png"]),
        ("points stipple --picture picture.png --count 512 --slices 4 --points list.csv", &["list.csv"]),
        ("points stipple --picture picture.png --count 512 --slices 4 --points list.npy", &["list.npy"]),
    ] {
        for file in files.iter().filter(|file| **file != "table.npy") {
            fs::write(home.path().join(file), "what was here before").unwrap();
        }
        let contents = |name: &String| fs::read(home.path().join(name)).unwrap_or_default();
        let before: Vec<(String, Vec<u8>)> =
            names(home.path()).into_iter().map(|name| (name.clone(), contents(&name))).collect();
        let program = env!("CARGO_BIN_EXE_fsot");
        // Without the trap the system would kill the process.
        let line = format!("trap '' XFSZ; ulimit -f 1; exec {program} {verb} --quiet");
        let output = Command::new("sh").args(["-c", &line]).current_dir(home.path()).output().unwrap();
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{verb}: {err}");
        // Of a table the metadata, which are larger than the disk as well.
        let (name, _) = files[0].split_once('.').unwrap();
        assert!(err.contains(name) && err.lines().count() == 1 && !err.contains(".fsot-"), "{verb}: {err}");
        let after: Vec<(String, Vec<u8>)> =
            names(home.path()).into_iter().map(|name| (name.clone(), contents(&name))).collect();
        assert!(after == before, "{verb}: {:?}", names(home.path()));
    }
}

/// A rename onto it would leave a file in place of the device.
#[cfg(unix)]
#[test]
fn devices_are_left_alone() {
    let home = home();
    for (work, flag, ending) in LONG {
        let name = format!("null.{ending}");
        let _ = std::os::unix::fs::symlink("/dev/null", home.path().join(&name));
        refused(home.path(), &format!("{work} {flag} {name}"), "it is a device or a pipe, not a file");
    }
}

#[test]
fn a_picture_is_the_default_and_coordinates_are_enough() {
    let home = tempdir().unwrap();
    run(home.path(), "points two-class --counts 8,8 --slices 4");
    run(home.path(), "points progressive --count 16 --slices 4 --integrands 2");
    assert_eq!(names(home.path()), ["progressive.png", "two_class.png"]);
    let home = tempdir().unwrap();
    run(home.path(), "points two-class --counts 8,8 --slices 4 --points a.CSV");
    assert_eq!(names(home.path()), ["a.CSV", "a.points.json"]);
    run(home.path(), "points two-class --counts 8,8 --slices 4 --points a.npy --out a.PNG");
    assert_eq!(names(home.path()), ["a.CSV", "a.PNG", "a.npy", "a.points.json"]);
}
