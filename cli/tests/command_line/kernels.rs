//! `--kernel`: filters of given weights.

use std::fs;
use std::path::Path;

use fsot::files::Metadata;
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Config, Extent, Kernel};
use ndarray::{Array2, Array3, array};
use ndarray_npy::write_npy;
use tempfile::tempdir;

use crate::{output, succeed, texts};

const SMALL: &str = "--width 8 --height 7 --frames 4 --sweeps 1 --no-bound";

fn config(home: &Path, flags: &str) -> Config {
    succeed(home, &format!("{SMALL} {flags}"));
    serde_json::from_value(Metadata::load(home.join("table.npy")).unwrap().configuration).unwrap()
}

/// Offsets and weights, relative to the largest.
fn taps(kernel: &Kernel, extent: &Extent) -> Vec<(i32, i32, i32, f64)> {
    let taps = kernel.taps(extent).unwrap();
    let mut taps: Vec<_> = taps.iter().map(|tap| (tap.dt, tap.dy, tap.dx, tap.weight)).collect();
    taps.sort_by(|one, other| one.partial_cmp(other).unwrap());
    taps
}

#[test]
fn arrays_of_every_type_and_rows_of_text_are_the_same_kernel() {
    let home = tempdir().unwrap();
    let at = |name: &str| home.path().join(name);
    let weights: Array2<f64> = array![[1.0, 2.0, 1.0], [2.0, 4.0, 2.0], [1.0, 2.0, 1.0]];
    write_npy(at("f8.npy"), &weights).unwrap();
    write_npy(at("f4.npy"), &weights.mapv(|weight| weight as f32)).unwrap();
    write_npy(at("u1.npy"), &weights.mapv(|weight| weight as u8)).unwrap();
    write_npy(at("i8.npy"), &weights.mapv(|weight| weight as i64)).unwrap();
    write_npy(at("fortran.npy"), &weights.t()).unwrap();
    fs::write(at("rows.csv"), "# binomial\n1, 2,1\n2,4,2\n\n1,2,1\n").unwrap();
    fs::write(at("rows.toml"), "kernel = [[1, 2, 1], [2, 4, 2], [1, 2, 1]]\n").unwrap();
    fs::create_dir(at("folder")).unwrap();
    fs::copy(at("rows.csv"), at("folder/rows.csv")).unwrap();
    fs::write(at("folder/file.toml"), "kernel = \"rows.csv\"\n").unwrap();
    let extent = Extent::animation(4, 7, 8);
    let binomial = SpatialKernel::Binomial { size_px: 3 };
    let temporal = TemporalKernel::Perceptual { fps: 60.0 };
    let expected = taps(&Kernel::product(binomial, temporal), &extent);
    for flags in [
        "--kernel f8.npy",
        "--kernel f4.npy",
        "--kernel u1.npy",
        "--kernel i8.npy",
        "--kernel fortran.npy",
        "--kernel rows.csv",
        "--config rows.toml",
        "--config folder/file.toml",
    ] {
        let kernels = config(home.path(), flags).kernels();
        let [kernel] = kernels.as_slice() else { panic!("{flags}: {kernels:?}") };
        let found = taps(kernel, &extent);
        assert_eq!(found.len(), expected.len(), "{flags}");
        for (found, expected) in found.iter().zip(&expected) {
            let offsets = |tap: &(i32, i32, i32, f64)| (tap.0, tap.1, tap.2);
            assert_eq!(offsets(found), offsets(expected), "{flags}");
            assert!((found.3 - expected.3).abs() < 1e-12, "{flags}");
        }
    }
}

/// As a box has it: one pixel further right and down.
#[test]
fn even_sides_stand_as_documented() {
    let home = tempdir().unwrap();
    fs::write(home.path().join("even.csv"), "1,1,1,1\n1,1,1,1\n").unwrap();
    let config = config(home.path(), "--kernel even.csv --temporal none");
    let extent = Extent::animation(4, 7, 8);
    let found = taps(&config.kernels()[0], &extent);
    let offsets: Vec<(i32, i32)> = found.iter().map(|tap| (tap.1, tap.2)).collect();
    assert_eq!(offsets, [(0, -1), (0, 0), (0, 1), (0, 2), (1, -1), (1, 0), (1, 1), (1, 2)]);
}

#[test]
fn three_axes_are_a_filter_over_frames() {
    let home = tempdir().unwrap();
    // The current frame sharp, the last one wide; the one between them unseen.
    let mut weights = Array3::<f64>::zeros((3, 3, 3));
    weights[[0, 1, 1]] = 2.0;
    weights.index_axis_mut(ndarray::Axis(0), 2).fill(0.5);
    write_npy(home.path().join("k.npy"), &weights).unwrap();
    let config = config(home.path(), "--kernel k.npy");
    let extent = Extent::animation(4, 7, 8);
    let found = taps(&config.kernels()[0], &extent);
    let mut expected = vec![(0, 0, 0, 1.0)];
    expected.extend((-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (-2, dy, dx, 0.25))));
    expected.sort_by(|one, other| one.partial_cmp(other).unwrap());
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((found.0, found.1, found.2), (expected.0, expected.1, expected.2));
        assert!((found.3 - expected.3).abs() < 1e-12, "{found:?}");
    }
    // Written down whole: the file is not needed again, and the work is the same.
    fs::remove_file(home.path().join("k.npy")).unwrap();
    succeed(home.path(), "--config table.json --no-bound --out again.npy");
    let bytes = |name: &str| fs::read(home.path().join(name)).unwrap();
    assert!(bytes("table.npy") == bytes("again.npy"));
}

#[test]
fn what_is_no_kernel_is_refused() {
    let home = tempdir().unwrap();
    let at = |name: &str| home.path().join(name);
    let csv = [
        ("negative.csv", "1,2\n-3,4", "negative.csv has weight -3 at [y 1, x 0]: weights must be finite"),
        ("nan.csv", "1,NaN", "has weight NaN at [y 0, x 1]"),
        ("inf.csv", "inf", "has weight inf at [y 0, x 0]"),
        ("zero.csv", "0,0\n0,0", "has weights whose sum is 0: give a sum that is above 0"),
        ("ragged.csv", "1,2\n3", "row 2 has 1 weights, but row 1 has 2: give rows of equal lengths"),
        ("words.csv", "1,2\n3,four", "line 2 has 'four' among its numbers: write weights between commas"),
        ("empty.csv", "", "holds no weights: give at least one above 0"),
        ("wide.csv", "1,1,1,1,1,1,1,1,1", "has 9 × 1 weights, more than the 8 × 7 pixels of a frame"),
        ("kernel.txt", "1", "give a file name that ends in .npy or .csv"),
        ("text.npy", "1,2", "cannot be read"),
    ];
    for (name, text, _) in csv {
        fs::write(at(name), text).unwrap();
    }
    write_npy(at("line.npy"), &array![1.0, 2.0]).unwrap();
    write_npy(at("minus.npy"), &array![[[1.0, 2.0]], [[1.0, -2.0]]]).unwrap();
    write_npy(at("frames.npy"), &Array3::<f64>::ones((2, 1, 1))).unwrap();
    write_npy(at("bool.npy"), &array![[true]]).unwrap();
    fs::create_dir(at("folder.npy")).unwrap();
    let others = [
        ("line.npy", "", "has shape [2]: give two axes [y, x] or three [frame, y, x]"),
        ("minus.npy", "", "has weight -2 at [frame 1, y 0, x 1]"),
        (
            "frames.npy --temporal none",
            "",
            "has weights for each frame already: leave out the temporal kernel",
        ),
        ("bool.npy", "", "holds no plain numbers: save it with numpy.save"),
        ("folder.npy", "", "is not an ordinary file"),
        ("missing.npy", "", "cannot be read"),
    ];
    for (name, _, words) in csv.into_iter().chain(others) {
        let output = output(home.path(), &format!("{SMALL} --kernel {name}"));
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{name}: {err}");
        assert!(err.starts_with("error: ") && err.lines().count() == 1, "{name}: {err}");
        assert!(err.contains(words), "{name}: {err}");
        assert!(!at("table.npy").exists());
    }
}

/// A configuration that holds a kernel is not a way around what is refused of its file.
#[test]
fn kernels_in_configurations_are_checked_as_those_in_files() {
    let home = tempdir().unwrap();
    let at = |name: &str| home.path().join(name);
    write_npy(at("deep.npy"), &Array3::<f64>::ones((2, 9, 5))).unwrap();
    write_npy(at("flat.npy"), &array![[1.0, 2.0, 1.0]]).unwrap();
    let shape = "--width 12 --height 10 --frames 4 --sweeps 1 --no-bound";
    succeed(home.path(), &format!("{shape} --kernel deep.npy"));
    fs::write(
        at("taps.toml"),
        "kernel = { taps = [{ dy = 0, dx = -9, weight = 1 }, { dy = 0, dx = 3, weight = 1 }] }",
    )
    .unwrap();
    for (flags, words) in [
        ("--config table.json --width 4", "has 5 × 9 weights, more than the 4 × 10 pixels of a frame"),
        ("--config table.json --height 8", "has 5 × 9 weights, more than the 12 × 8 pixels of a frame"),
        ("--config table.json --temporal ema:0.1", "leave out the temporal kernel (--temporal)"),
        ("--config taps.toml --width 12", "has 13 × 1 weights, more than the 12 × 64 pixels"),
    ] {
        let (out, err) = texts(&output(home.path(), &format!("{flags} --dry-run --out new.npy")));
        assert!(out.is_empty() && err.contains(words) && err.lines().count() == 1, "{flags}: {out}{err}");
    }
    // Another kernel does not inherit those weights, and one with frames needs no other.
    for flags in ["--kernel flat.npy --temporal ema:0.1", "--sigma 1.5", "--kernel deep.npy", "--width 5"] {
        succeed(home.path(), &format!("--config table.json {flags} --dry-run --out new.npy"));
    }
    succeed(home.path(), &format!("{shape} --temporal ema:0.2 --out ema.npy"));
    succeed(home.path(), "--config ema.json --kernel deep.npy --dry-run --out new.npy");
}
