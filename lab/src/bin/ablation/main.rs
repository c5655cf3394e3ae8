//! What each choice of the optimiser is worth: the defaults, and one thing changed at a time.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin ablation -- --out docs --machine "AMD EPYC, 2 cores, 2026-11-22"    # some minutes
//! cargo run --release -p fsot-lab --bin ablation -- schedule                                                # prints some of it
//! ```
//!
//! Choices that don't change the cost of a slice are compared at equal slices, the others at equal time: that
//! of the defaults, as told by short runs of both right before each. Tables are measured as in the README;
//! all figures are ratios to white noise of the same shape.
//!
//! With `--quick` everything runs once on small tables and is checked.

mod averaged;
mod factors;
mod plain;
mod report;

use std::fs;
use std::path::PathBuf;

use clap::Parser;
use fsot::{Config, Extent, Optimizer, SampleTable, Until};
use fsot_lab::judge::{Judge, Quality};

use crate::factors::{Effort, Factor, Making, Variant};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// What each choice of the optimiser is worth.
#[derive(Parser)]
struct Arguments {
    /// Only factors whose title contains this, beside the defaults.
    filter: Option<String>,
    /// Directory of `ablation.md`; nothing is written without it.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Machine and date, for the heading.
    #[arg(long, default_value = "an unnamed machine")]
    machine: String,
    /// Run everything once, small, and check it.
    #[arg(long)]
    quick: bool,
}

/// A table shape, and the work that the defaults do on it.
struct Case {
    name: &'static str,
    extent: Extent,
    slices_per_class: u64,
    seeds: u64,
    integrands: usize,
    bound_slices: usize,
}

/// What became of a variant on a case: means over seeds.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    slices_per_class: f64,
    seconds: f64,
    quality: Quality,
}

/// The outcomes of a variant, one per case.
struct Row {
    name: String,
    outcomes: Vec<Outcome>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let test = arguments.quick;
    let (cases, plain_case) = if test { tiny() } else { full() };
    let wanted = |title: &str| arguments.filter.as_ref().is_none_or(|filter| title.contains(filter.as_str()));

    // Starts the threads.
    rows(&cases[..1], vec![factors::defaults()])?;
    let mut sections = vec![("Defaults", rows(&cases, vec![factors::defaults()])?)];
    for Factor { title, variants } in factors::all() {
        if wanted(title) {
            eprintln!("{title}");
            sections.push((title, rows(&cases, variants)?));
        }
    }
    let mut report = report::markdown(&arguments.machine, &cases, &sections);
    if wanted(plain::TITLE) {
        eprintln!("{}", plain::TITLE);
        report += &plain::section(&plain_case)?;
    }
    println!("{report}");
    for (title, rows) in &sections {
        check(title, rows);
    }
    if let (Some(out), false) = (arguments.out, test) {
        fs::create_dir_all(&out)?;
        fs::write(out.join("ablation.md"), report)?;
    }
    Ok(())
}

/// The two cases of the engine, and that of the plain loop.
fn full() -> ([Case; 2], Case) {
    let extent = |frames, side| Extent { frames, height: side, width: side, spp: 1 };
    let case = |name, extent, slices_per_class, seeds, integrands| Case {
        name,
        extent,
        slices_per_class,
        seeds,
        integrands,
        bound_slices: 1 << 15,
    };
    let engine = [
        case("static 64×64×1", extent(1, 64), 512, 4, 128),
        case("animated 64×64×10", extent(10, 64), 128, 1, 64),
    ];
    (engine, case("static 32×32×1", extent(1, 32), 256, 4, 128))
}

fn tiny() -> ([Case; 2], Case) {
    let (mut engine, mut plain) = full();
    for case in engine.iter_mut().chain([&mut plain]) {
        case.extent = Extent { frames: case.extent.frames.min(3), height: 12, width: 12, spp: 1 };
        case.slices_per_class = 16;
        case.seeds = 1;
        case.integrands = 4;
        case.bound_slices = 512;
    }
    (engine, plain)
}

fn rows(cases: &[Case], variants: Vec<Variant>) -> Result<Vec<Row>, Failure> {
    let row = |variant: Variant| {
        let outcomes = cases.iter().map(|case| measure(case, &variant)).collect::<Result<_, _>>()?;
        Ok(Row { name: variant.name, outcomes })
    };
    variants.into_iter().map(row).collect()
}

/// The mean over the seeds of a case.
fn measure(case: &Case, variant: &Variant) -> Result<Outcome, Failure> {
    let judge = Judge::new(case.extent, case.integrands, case.bound_slices)?;
    let outcomes = (0..case.seeds).map(|seed| -> Result<Outcome, Failure> {
        let default = Config::new(case.extent, 2).with_seed(seed);
        let mut config = default.clone();
        (variant.change)(&mut config);
        let slices_per_class = match variant.effort {
            Effort::Slices => case.slices_per_class,
            Effort::Seconds => {
                let calibration = case.slices_per_class.div_ceil(8);
                let share = quickest(&default, calibration)? / quickest(&config, calibration)?;
                (case.slices_per_class as f64 * share).round().max(1.0) as u64
            }
        };
        let until = Until::SlicesPerClass(slices_per_class);
        let (table, slices_per_class, seconds) = make(config, variant.making, until)?;
        Ok(Outcome { slices_per_class, seconds, quality: judge.judge(&table)? })
    });
    Ok(mean(&outcomes.collect::<Result<Vec<_>, _>>()?))
}

/// Seconds of the quickest of three interludes: other work on the machine comes and goes.
fn quickest(config: &Config, slices_per_class: u64) -> Result<f64, Failure> {
    let mut quickest = f64::INFINITY;
    for _ in 0..3 {
        let until = Until::SlicesPerClass(slices_per_class);
        quickest = quickest.min(make(config.clone(), Making::Last, until)?.2);
    }
    Ok(quickest)
}

/// A table, its slices per class and its seconds.
fn make(config: Config, making: Making, until: Until) -> Result<(SampleTable, f64, f64), Failure> {
    let mut optimizer = Optimizer::new(config)?;
    if let Making::MeanOfLast(share) = making {
        return averaged::run(optimizer, until, share);
    }
    let report = optimizer.run(until)?;
    Ok((optimizer.into_table(), report.work.slices_per_class as f64, report.elapsed.as_secs_f64()))
}

fn mean(outcomes: &[Outcome]) -> Outcome {
    let mean = |figure: fn(&Outcome) -> f64| outcomes.iter().map(figure).sum::<f64>() / outcomes.len() as f64;
    Outcome {
        slices_per_class: mean(|outcome| outcome.slices_per_class),
        seconds: mean(|outcome| outcome.seconds),
        quality: Quality {
            filtered: mean(|outcome| outcome.quality.filtered),
            bound: mean(|outcome| outcome.quality.bound),
            bias: mean(|outcome| outcome.quality.bias),
        },
    }
}

/// Every variant makes something better than white noise.
fn check(title: &str, rows: &[Row]) {
    for Row { name, outcomes } in rows {
        for Outcome { quality, .. } in outcomes {
            assert!(quality.bound < 1.0 && quality.filtered < 1.0, "{title}, {name}: {quality:?}");
        }
    }
}
