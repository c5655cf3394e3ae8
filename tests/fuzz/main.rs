//! Damaged files of every kind that is read: none panics, none takes long, and what is read is what it
//! promises.
//!
//! Some seconds; `FSOT_FUZZ=50` makes fifty times as many inputs, more than half a million. `fuzz/` has the
//! same readers for libFuzzer.

mod mutate;
mod seeds;

use std::env;
use std::fs::File;
use std::io::Write;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

use fsot::files::{ImportOptions, Metadata};
use fsot::optimizer::{Checkpoint, StepReport};
use fsot::targets::{Density, Picture, Tone};
use fsot::{Optimizer, SampleTable};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use mutate::Random;

/// Longest that any input may take; most take microseconds.
const PATIENCE: Duration = Duration::from_secs(2);

/// Writes `count` damaged files, or as many times more as is asked for, and reads them. `read` says whether
/// it could.
fn fuzz(
    name: &str,
    count: u64,
    make: impl Fn(&mut Random) -> Vec<u8>,
    read: impl Fn(&Path, &mut Random) -> bool,
) {
    let times: u64 = env::var("FSOT_FUZZ").ok().and_then(|times| times.parse().ok()).unwrap_or(1);
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join(name);
    let (mut taken, mut longest) = (0_u64, Duration::ZERO);
    let begin = Instant::now();
    for input in 0..count * times {
        // Any input can be made again by its number.
        let mut random = Xoshiro256PlusPlus::seed_from_u64(input);
        let bytes = make(&mut random);
        // Not emptied first, after which some file systems wait for the disk.
        let mut file = File::options().write(true).create(true).truncate(false).open(&path).unwrap();
        file.write_all(&bytes).unwrap();
        file.set_len(bytes.len() as u64).unwrap();
        drop(file);
        let begin = Instant::now();
        let result = catch_unwind(AssertUnwindSafe(|| read(&path, &mut random)));
        let took = begin.elapsed();
        let tell = || format!("{name}, input {input}: {}", bytes.escape_ascii());
        taken += u64::from(result.unwrap_or_else(|_| panic!("{}", tell())));
        assert!(took < PATIENCE, "{took:?}: {}", tell());
        longest = longest.max(took);
    }
    let seconds = begin.elapsed().as_secs_f64();
    println!("{name}: {} inputs in {seconds:.1} s, {taken} of them read, longest {longest:?}", count * times);
    // A fuzzer whose inputs are all refused alike, or all taken, finds nothing.
    assert!(taken > 0 && taken < count * times, "{taken} of {}", count * times);
}

fn is_table(table: &SampleTable) -> bool {
    assert!(table.values().iter().all(|value| (0.0..1.0).contains(value)));
    assert_eq!(table.values().len(), table.shape().iter().product::<usize>());
    true
}

#[test]
fn tables() {
    let seeds = seeds::arrays();
    fuzz(
        "table.npy",
        3000,
        |random| mutate::array(random, &seeds),
        |path, _| SampleTable::load(path).is_ok_and(|table| is_table(&table)),
    );
}

#[test]
fn arrays_that_are_imported() {
    let seeds = seeds::arrays();
    fuzz(
        "array.npy",
        3000,
        |random| mutate::array(random, &seeds),
        |path, random| {
            let options = mutate::options(random);
            SampleTable::import(path, &options).is_ok_and(|imported| is_table(&imported.table))
        },
    );
}

#[test]
fn text_that_is_imported() {
    let seeds = seeds::texts();
    fuzz(
        "text.dat",
        2000,
        |random| mutate::text(random, &seeds),
        |path, random| {
            let usual = SampleTable::import(path, &ImportOptions::default());
            let chosen = SampleTable::import(path, &mutate::options(random));
            [usual, chosen].into_iter().flatten().any(|imported| is_table(&imported.table))
        },
    );
}

#[test]
fn sources_that_are_imported() {
    let seeds = seeds::sources();
    fuzz(
        "mask.h",
        3000,
        |random| mutate::source(random, &seeds),
        |path, random| {
            let usual = SampleTable::import(path, &ImportOptions::default());
            let chosen = SampleTable::import(path, &mutate::options(random));
            [usual, chosen].into_iter().flatten().any(|imported| is_table(&imported.table))
        },
    );
}

/// What stands beside files is no safer than what is in them.
#[test]
fn descriptions_and_records() {
    let home = tempfile::tempdir().unwrap();
    let [text, record] = seeds::exported(home.path());
    for (name, seed, file) in [("alone.raw.txt", text, "alone.raw"), ("mask.bin.json", record, "mask.bin")] {
        fuzz(
            name,
            2000,
            |random| mutate::json(random, &seed),
            |path, random| {
                // The damaged one among the sound files.
                let place = home.path().join(name);
                std::fs::copy(path, &place).unwrap();
                let options = mutate::options(random);
                let options = if name.ends_with("json") { ImportOptions::default() } else { options };
                let imported = SampleTable::import(home.path().join(file), &options);
                imported.is_ok_and(|imported| is_table(&imported.table))
            },
        );
    }
}

#[test]
fn metadata() {
    let home = tempfile::tempdir().unwrap();
    let (table, json) = seeds::metadata(home.path());
    fuzz(
        "table.json",
        2000,
        |random| mutate::json(random, &json),
        |path, _| {
            let path = path.with_extension("npy");
            if !path.exists() {
                table.save(&path).unwrap();
            }
            let read = Metadata::load(&path);
            let pair = SampleTable::load_with(&path);
            assert_eq!(read.is_ok_and(|metadata| metadata.check(&table).is_ok()), pair.is_ok());
            pair.is_ok_and(|(found, _)| found == table)
        },
    );
}

/// With the right hash too, which is no signature.
#[test]
fn checkpoints() {
    let (config, seeds) = seeds::checkpoints();
    fuzz(
        "run.checkpoint",
        2000,
        |random| mutate::checkpoint(random, &seeds),
        |path, _| {
            let Ok(checkpoint) = Checkpoint::load(path) else { return false };
            let (_, _) = (is_table(&checkpoint.table()), checkpoint.config());
            let mut optimizer = Optimizer::new(config.clone()).unwrap();
            if optimizer.resume(checkpoint).is_ok() {
                let mut steps = 0;
                let few = |_: &StepReport| {
                    steps += 1;
                    if steps < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
                };
                optimizer.finish_observed(few).unwrap();
                is_table(&optimizer.table());
            }
            true
        },
    );
}

/// A picture that was read can be looked at, and may still be no density.
fn is_picture(path: &Path) -> bool {
    let Ok(picture) = Picture::open(path) else { return false };
    assert_eq!(picture.pixels().len(), picture.width() * picture.height());
    // Larger ones take their time.
    if picture.pixels().len() < 1 << 14 {
        for tone in [Tone::Dark, Tone::Bright] {
            let _ = Density::from_picture(&picture, tone);
        }
    }
    true
}

#[test]
fn png() {
    let seeds = seeds::pngs();
    fuzz("picture.png", 1500, |random| mutate::png(random, &seeds), |path, _| is_picture(path));
}

#[test]
fn exr() {
    let seeds = seeds::exrs();
    fuzz("picture.exr", 1500, |random| mutate::bytes(random, &seeds), |path, _| is_picture(path));
}
