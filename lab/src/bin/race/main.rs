//! Error against time: our optimisers and the published loop, in one run.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin race                               # some 15 minutes
//! cargo run --release -p fsot-lab --bin race -- animated --out docs        # one case, files not in target/
//! cargo run --release -p fsot-lab --bin race -- --published-seconds 1000
//! ```
//!
//! Ours make a new table for each budget, since their steps shrink over a run; budgets are doublings of the
//! work, and what is plotted is the measured time of the steps ([`fsot::RunReport::elapsed`]), the median of
//! three interleaved runs where they are short. The published loop has no schedule: one run with checkpoints
//! is all of its curve. Its time excludes the measuring as well. Both use all cores. Tables are measured as
//! in the README: ratios to white noise of the same shape.
//!
//! With `--quick` everything runs once on small tables and is checked.

mod cases;
mod chart;
mod methods;
mod speed_up;

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;
use fsot::Config;
use fsot_lab::judge::{Judge, Quality};
use fsot_lab::published::{Levels, Published};

use crate::cases::Case;
use crate::methods::{Effort, METHODS, Method};

type Failure = Box<dyn std::error::Error>;

/// Error against time: our optimisers and the published loop.
#[derive(Parser)]
struct Arguments {
    /// Only cases whose name contains this.
    filter: Option<String>,
    /// Directory of the CSV file and the plot.
    #[arg(long, default_value = "target")]
    out: PathBuf,
    /// Seconds that the published loop gets in each case; twice as many in the animated one.
    #[arg(long, default_value_t = 140.0)]
    published_seconds: f64,
    /// Let the published loop draw levels up to the greatest weight of an animated kernel, as it should.
    #[arg(long)]
    published_to_peak: bool,
    /// Run everything once, small, and check it.
    #[arg(long)]
    quick: bool,
}

/// A table on its way, or one of a row of tables of growing effort.
#[derive(Clone, Copy, Debug)]
struct Point {
    seconds: f64,
    slices: u64,
    quality: Quality,
}

/// Quality of a method over time, in the order of time.
struct Curve {
    method: &'static str,
    points: Vec<Point>,
}

/// What was measured of a case.
struct Outcome {
    case: Case,
    ours: Vec<Curve>,
    published: Curve,
}

/// Runs shorter than this are repeated; their median counts.
const SHORT_SECONDS: f64 = 1.0;
const REPEATS: usize = 3;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let test = arguments.quick;
    let scratch = tempfile::tempdir()?;
    let out = if test { scratch.path() } else { &arguments.out };
    let mut cases = if test { cases::tiny() } else { cases::full(arguments.published_seconds) };
    if let Some(filter) = &arguments.filter {
        cases.retain(|case| case.name.contains(filter.as_str()));
    }
    if arguments.published_to_peak {
        cases.iter_mut().for_each(|case| case.published.levels = Levels::Peak);
    }
    if cases.is_empty() {
        return Ok(()); // the filter is meant for another bench
    }
    fs::create_dir_all(out)?;
    let mut outcomes = Vec::new();
    for case in cases {
        outcomes.push(measure(case)?);
        // After each case, so that a run that is cut off keeps what it has.
        write_csv(&out.join("time_against_error.csv"), &outcomes)?;
        chart::write(&out.join("time_against_error.svg"), &outcomes)?;
        if let Some(outcome) = outcomes.last() {
            speed_up::print(outcome);
            check(outcome);
        }
    }
    Ok(())
}

fn measure(case: Case) -> Result<Outcome, Failure> {
    eprintln!("{}: ours", case.name);
    let judge = Judge::new(case.extent, case.integrands, case.bound_slices)?;
    let ours = measure_ours(&case, &judge)?;
    eprintln!("{}: the published loop, for {} s", case.name, case.published_seconds);
    let published = measure_published(&case, &judge)?;
    Ok(Outcome { ours, published, case })
}

/// All methods, effort by effort, so that a disturbance of the machine meets them alike.
fn measure_ours(case: &Case, judge: &Judge) -> Result<Vec<Curve>, Failure> {
    let config = Config::new(case.extent, 2);
    // Starts the threads.
    (METHODS[0].run)(&config, Effort { slices: case.least_effort, sweeps: 1 })?;
    let mut curves: Vec<Curve> =
        METHODS.iter().map(|method| Curve { method: method.name, points: Vec::new() }).collect();
    for doubling in 0.. {
        let effort = Effort { slices: case.least_effort << doubling, sweeps: 1 << doubling };
        let unfinished = |curve: &Curve| {
            curve.points.last().is_none_or(|point| 1.5 * point.seconds < case.longest_seconds)
        };
        let mut active: Vec<(&Method, &mut Curve)> =
            METHODS.iter().zip(&mut curves).filter(|(_, curve)| unfinished(curve)).collect();
        if active.is_empty() {
            break;
        }
        let mut runs: Vec<Vec<methods::Made>> = active.iter().map(|_| Vec::new()).collect();
        for _ in 0..REPEATS {
            for ((method, _), runs) in active.iter().zip(&mut runs) {
                if runs.first().is_none_or(|first| first.seconds < SHORT_SECONDS) {
                    runs.push((method.run)(&config, effort)?);
                }
            }
        }
        for ((_, curve), runs) in active.iter_mut().zip(runs) {
            let first = &runs[0];
            assert!(runs.iter().all(|run| run.table == first.table), "the same seed gave another table");
            let seconds = median(runs.iter().map(|run| run.seconds).collect());
            curve.points.push(Point { seconds, slices: first.slices, quality: judge.judge(&first.table)? });
        }
    }
    Ok(curves)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One run, looked at whenever its time has doubled.
fn measure_published(case: &Case, judge: &Judge) -> Result<Curve, Failure> {
    let mut published = Published::new(case.published.clone())?;
    let mut points = Vec::new();
    let mut seconds = 0.0;
    let mut next = case.published_first_seconds;
    while seconds < case.published_seconds {
        let begin = Instant::now();
        published.iterate();
        seconds += begin.elapsed().as_secs_f64();
        if seconds >= next.min(case.published_seconds) {
            let quality = judge.judge(&published.table())?;
            points.push(Point { seconds, slices: published.slices(), quality });
            next *= 2.0;
        }
    }
    Ok(Curve { method: "published loop", points })
}

fn write_csv(path: &Path, outcomes: &[Outcome]) -> Result<(), Failure> {
    let mut file = BufWriter::new(File::create(path)?);
    writeln!(file, "case,method,seconds,slices,filtered,bound,bias")?;
    for Outcome { case, ours, published } in outcomes {
        for curve in ours.iter().chain([published]) {
            for Point { seconds, slices, quality: Quality { filtered, bound, bias } } in &curve.points {
                let Curve { method, .. } = curve;
                writeln!(
                    file,
                    "{},{method},{seconds:.6},{slices},{filtered:.5},{bound:.5},{bias:.5}",
                    case.name
                )?;
            }
        }
    }
    file.flush()?;
    Ok(())
}

/// What must hold on any machine.
fn check(Outcome { case, ours, published }: &Outcome) {
    for curve in ours.iter().chain([published]) {
        let [Some(first), Some(last)] = [curve.points.first(), curve.points.last()] else {
            panic!("{}: {} made no table", case.name, curve.method);
        };
        let [first, last] = [first, last].map(|point| point.quality);
        let finite = |quality: Quality| (quality.filtered + quality.bound + quality.bias).is_finite();
        assert!(finite(first) && finite(last), "{}: {first:?} {last:?}", case.name);
        // Not the bound: with several samples per pixel, long sweeps trade it for a smaller filtered error.
        let better = last.filtered <= first.filtered && last.bound < 1.0;
        assert!(better, "{}: {} went from {first:?} to {last:?}", case.name, curve.method);
    }
}
