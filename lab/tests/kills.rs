//! Processes that are killed while they write leave whole files, and no pair that does not belong together
//! without saying so.

#![cfg(unix)]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use fsot::files::{FormatError, Metadata, TableError};
use fsot::metrics::{RadialBin, Spectra};
use fsot::{Extent, SampleTable};
use fsot_lab::draw::{write_exr, write_gray_png, write_radial_csv};
use fsot_lab::program;
use ndarray::{Array2, Array3};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tempfile::tempdir;

/// Names the folder that the other process writes to.
const FOLDER: &str = "FSOT_KILLS_FOLDER";
/// How many processes are killed; a dozen if it is not set.
const KILLS: &str = "FSOT_KILLS";

const EXTENT: Extent = Extent { frames: 1, height: 32, width: 32, spp: 1 };

fn table(seed: u64) -> SampleTable {
    SampleTable::white_noise(EXTENT, 2, seed).unwrap()
}

/// The spectrum of noise of this variance.
fn rings(variance: f64) -> Vec<RadialBin> {
    let values: Vec<f64> = table(0).values().iter().map(|value| f64::from(*value) - 0.5).collect();
    let image = Array3::from_shape_vec((2, 32, 32), values).unwrap();
    Spectra::of_image(image.view(), variance).radial()
}

/// What the process writes that is going to be killed: everything, over and over, always different.
#[test]
fn write_until_killed() {
    let Some(folder) = env::var_os(FOLDER).map(PathBuf::from) else { return };
    for seed in 0.. {
        let metadata = Metadata::new(EXTENT, 2, seed, "white noise".into());
        table(seed).save_with(folder.join("pair.npy"), &metadata).unwrap();
        // Without its metadata every now and then, as people do.
        if seed % 8 == 7 {
            table(seed + 1).save(folder.join("pair.npy")).unwrap();
        }
        let shade = (seed % 64) as f64;
        write_gray_png(&folder.join("picture.png"), &Array2::from_elem((64, 64), shade), 64.0).unwrap();
        write_exr(&folder.join("picture.exr"), [32, 32], |_, _| [shade as f32; 3]).unwrap();
        write_radial_csv(&folder.join("radial.csv"), &rings(1.0 + shade)).unwrap();
        program::save(&folder.join("figures.csv"), format!("{seed}\n").repeat(500).as_bytes()).unwrap();
    }
}

/// Whether metadata were told to be another table's.
fn check(folder: &Path) -> bool {
    let inside = |name: &str| folder.join(name);
    let is_there = |name: &str| inside(name).exists();
    let mut told = false;
    if is_there("pair.npy") {
        let table_alone = SampleTable::load(inside("pair.npy")).unwrap();
        match SampleTable::load_with(inside("pair.npy")) {
            Ok((found, metadata)) => {
                assert_eq!(found, table(metadata.seed), "a pair that is none");
                assert_eq!(found, table_alone);
            }
            Err(TableError::Format { problem: FormatError::OtherValues { .. }, .. }) => {
                let metadata = Metadata::load(inside("pair.npy")).unwrap();
                assert_ne!(table_alone, table(metadata.seed), "a pair that is one");
                told = true;
            }
            Err(error) => panic!("{error}"),
        }
    }
    for name in ["picture.png", "picture.exr"] {
        if is_there(name) {
            let picture = image::open(inside(name)).unwrap().to_rgb32f();
            let first = *picture.get_pixel(0, 0);
            assert!(picture.pixels().all(|pixel| *pixel == first), "{name} is of two pictures");
        }
    }
    for (name, lines) in [("radial.csv", rings(1.0).len() + 1), ("figures.csv", 500)] {
        if is_there(name) {
            let text = fs::read_to_string(inside(name)).unwrap();
            assert!(text.ends_with('\n') && text.lines().count() == lines, "{name}");
            let first = text.lines().next();
            assert!(name == "radial.csv" || text.lines().all(|line| Some(line) == first), "{name} is of two");
        }
    }
    told
}

#[test]
fn what_killed_processes_leave_is_whole_or_told() {
    let kills: u32 = env::var(KILLS).ok().and_then(|kills| kills.parse().ok()).unwrap_or(12);
    let home = tempdir().unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(14);
    let mut told = 0;
    for _ in 0..kills {
        let mut process = Command::new(env::current_exe().unwrap())
            .args(["--exact", "write_until_killed"])
            .env(FOLDER, home.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        // Until it has begun to write, which is now and again before its first file is there.
        sleep(Duration::from_micros(random.random_range(2_000..120_000)));
        process.kill().unwrap();
        let status = process.wait().unwrap();
        assert_eq!(std::os::unix::process::ExitStatusExt::signal(&status), Some(9), "{status}");
        told += u32::from(check(home.path()));
    }
    let entries: Vec<String> = fs::read_dir(home.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let forgotten = entries.iter().filter(|name| name.starts_with(".fsot-")).count();
    println!("{kills} kills: {told} pairs did not match and were told, {forgotten} temporary files are left");
    assert!(entries.iter().any(|name| name == "pair.npy"), "{entries:?}");
}
