//! `fsot inspect`, run as a person runs it: on tables of awkward shapes and on what is no table.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use fsot::files::Metadata;
use fsot::{Extent, SampleTable};
use tempfile::{TempDir, tempdir};

/// Enough to see that it works.
const FEW: [&str; 4] = ["--integrands", "3", "--bound-slices", "64"];

fn inspect(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fsot")).arg("inspect").args(arguments).output().unwrap()
}

/// A folder with `table.npy` in it.
fn table([frames, height, width, spp]: [usize; 4], dims: usize) -> (TempDir, PathBuf) {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let extent = Extent { frames, height, width, spp };
    SampleTable::white_noise(extent, dims, 5).unwrap().save(&path).unwrap();
    (home, path)
}

/// Runs; the exit code is 0 and nothing is complained of.
fn figures(path: &Path, more: &[&str]) -> String {
    let output = inspect(&[&[path.to_str().unwrap()], more].concat());
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && complaints.is_empty(), "{more:?}: {complaints}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs; the exit code is a failure's, the complaint is one line that contains the words.
fn refusal(arguments: &[&str], words: &[&str]) {
    let output = inspect(arguments);
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{arguments:?}");
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {complaint}");
    assert_eq!(complaint.lines().count(), 1, "{complaint}");
    assert!(complaint.starts_with("error: "), "{complaint}");
    for word in words {
        assert!(complaint.contains(word), "{word} is missing in: {complaint}");
    }
}

#[test]
fn awkward_shapes_have_figures() {
    let shapes = [
        ([1, 1, 1, 1], 1),
        ([1, 1, 1, 1], 16),
        ([1, 1, 1, 300], 2),
        ([3, 1, 1, 2], 2),
        ([1, 2, 2, 1], 2),
        ([1, 5, 7, 3], 1),
        ([1, 3, 500, 1], 2),
        ([2, 400, 2, 1], 3),
        ([17, 4, 3, 2], 5),
    ];
    for (shape, dims) in shapes {
        let (_home, path) = table(shape, dims);
        let text = figures(&path, &FEW);
        let groups = dims.div_ceil(2) + usize::from(dims > 2);
        assert_eq!(text.matches("filtered in space").count(), groups, "{shape:?} {dims}: {text}");
        assert_eq!(text.matches("in space and time").count(), if shape[0] > 1 { groups } else { 0 });
        assert!(text.contains("metadata: none"), "{text}");
        assert!(text.contains(" of white noise\n"), "{text}");
        assert!(!text.contains("NaN") && !text.contains("inf "), "{shape:?} {dims}: {text}");
    }
}

#[test]
fn white_noise_is_called_white_noise() {
    let (_home, path) = table([2, 16, 16, 1], 2);
    let text = figures(
        &path,
        &["--integrands", "64", "--temporal", "box:2", "--sigma", "1.5", "--bound-slices", "64"],
    );
    let mean = |row: &str| -> f64 {
        let line = text.lines().find(|line| line.trim_start().starts_with(row)).unwrap();
        let (before, _) = line.split_once('±').unwrap();
        before.split_whitespace().last().unwrap().parse().unwrap()
    };
    // 512 samples vary by 1 / sqrt(512) = 4 % before the filter; after it, of which some 40 independent blurs
    // fit into the table, by 20 %. Integrands add their 2 %. Four deviations.
    assert!((mean("error, not filtered") - 1.0).abs() < 0.2, "{text}");
    assert!((mean("in space and time") - 1.0).abs() < 0.8, "{text}");
    assert!(text.contains("exp(-r^2/1.5^2) in pixels, box:2 in frames"), "{text}");
}

#[test]
fn metadata_are_summed_up_and_damage_is_said() {
    let (_home, path) = table([1, 4, 4, 1], 2);
    let values = SampleTable::load(&path).unwrap();
    let mut metadata = Metadata::new(values.extent(), values.dims(), 77, serde_json::Value::Null);
    metadata.run.slices_per_class = 123;
    values.save_with(&path, &metadata).unwrap();
    let text = figures(&path, &FEW);
    assert!(text.contains("seed 77") && text.contains("123 slices"), "{text}");
    // A figure of another table, then no JSON at all: the table itself can still be inspected.
    let beside = Metadata::path_beside(&path);
    SampleTable::white_noise(Extent { width: 5, ..values.extent() }, 2, 0).unwrap().save(&path).unwrap();
    assert!(figures(&path, &FEW).contains("metadata: NOT OF THIS TABLE"));
    let other = SampleTable::white_noise(values.extent(), 2, 9).unwrap();
    other.save(&path).unwrap();
    let text = figures(&path, &FEW);
    assert!(text.contains("metadata: NOT OF THIS TABLE") && !text.contains("seed 77"), "{text}");
    assert!(text.contains("bound "), "the figures of the table follow");
    // Metadata of before do not say of which values they are.
    let known = Metadata { sha256: None, ..metadata };
    fs::write(&beside, serde_json::to_vec(&known).unwrap()).unwrap();
    let text = figures(&path, &FEW);
    assert!(text.contains("seed 77") && text.contains("does not say of which values it is"), "{text}");
    fs::write(beside, "{\"format\": ").unwrap();
    let text = figures(&path, &FEW);
    assert!(text.contains("metadata: unusable") && text.contains("table.json"), "{text}");
}

#[test]
fn bad_input_is_one_sentence() {
    let (home, path) = table([1, 4, 4, 1], 2);
    let path = path.to_str().unwrap();
    let inside = |name: &str| home.path().join(name).to_str().unwrap().to_owned();
    refusal(&[&inside("absent.npy")], &["absent.npy", "cannot read"]);
    refusal(&[home.path().to_str().unwrap()], &[]);
    fs::write(inside("text.npy"), "once upon a time").unwrap();
    refusal(&[&inside("text.npy")], &["text.npy", "NUMPY"]);
    fs::write(inside("empty.npy"), "").unwrap();
    refusal(&[&inside("empty.npy")], &["empty.npy"]);
    let whole = fs::read(path).unwrap();
    fs::write(inside("short.npy"), &whole[..whole.len() - 1]).unwrap();
    refusal(&[&inside("short.npy")], &["short.npy"]);
    for sigma in ["-1", "0", "NaN", "inf"] {
        refusal(&[path, &format!("--sigma={sigma}")], &["sigma_px"]);
    }
    refusal(&[path, "--temporal", "box:0"], &["box"]);
    assert_eq!(fs::read(path).unwrap(), whole);
    // What the command line itself refuses: several lines with a hint, code 2.
    for arguments in [&[path, "--temporal", "sometimes"][..], &[path, "--integrands", "0"], &[]] {
        assert_eq!(inspect(arguments).status.code(), Some(2), "{arguments:?}");
    }
}

/// What a histogram of 16 × 16 cells and a radial average hide.
#[test]
fn empty_faces_and_a_direction_are_shown() {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    let extent = Extent::still(32, 32);
    // Nothing within 0.015 of a face; the rows differ more than the columns.
    let values = (0..1024).flat_map(|i| {
        let even = |k: usize| 0.015 + 0.97 * ((k as f32 * 0.618_034).fract());
        [even(i / 32 * 7 + i % 32 / 8), even(i)]
    });
    SampleTable::new(extent, 2, values.collect()).unwrap().save(&path).unwrap();
    let text = figures(&path, &FEW);
    for dim in ["dimension 0: density", "dimension 1: density"] {
        let line = text.lines().find(|line| line.contains(dim)).unwrap_or_else(|| panic!("{dim}: {text}"));
        // 1024 samples: one standard error of random is √(0.98 / 20.48).
        assert!(line.contains("0.00 (random 1 ± 0.22) within 0.01,"), "{line}");
    }
    let along = text.lines().find(|line| line.contains("power along y over along x")).unwrap();
    let first: f64 = along.split_whitespace().nth(6).unwrap().parse().unwrap();
    assert!(first > 1.3, "{along}");
    // And a table of white noise has neither.
    let (_home, path) = table([1, 32, 32, 1], 2);
    let text = figures(&path, &["--integrands", "32", "--bound-slices", "64"]);
    assert!(!text.contains("within 0.01,") || !text.contains("0.00 (random"), "{text}");
}
