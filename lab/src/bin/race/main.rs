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
//! Writes `time_against_error.csv` and `time_against_error.svg`, and prints how much sooner ours are. With
//! `--quick` everything runs once on small tables.

mod cases;
mod chart;
mod measure;
mod methods;
mod outcome;
mod speed_up;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use fsot_lab::program;
use fsot_lab::published::Levels;

use crate::outcome::{Failure, Outcome};

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
    /// Run everything once, on small tables.
    #[arg(long)]
    quick: bool,
}

fn main() -> ExitCode {
    program::main(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { filter, out, published_seconds, published_to_peak, quick } = arguments;
    let mut cases = if *quick { cases::tiny() } else { cases::full(*published_seconds) };
    if let Some(filter) = filter {
        let names: Vec<&str> = cases.iter().map(|case| case.name).collect();
        let unknown = format!("no case has {filter:?} in its name; there are {}", names.join(", "));
        cases.retain(|case| case.name.contains(filter.as_str()));
        if cases.is_empty() {
            return Err(unknown.into());
        }
    }
    if *published_to_peak {
        cases.iter_mut().for_each(|case| case.published.levels = Levels::Peak);
    }
    program::make_folder(out)?;
    let mut outcomes: Vec<Outcome> = Vec::new();
    for case in cases {
        let outcome = measure::measure(case)?;
        let printed = speed_up::print(&outcome);
        outcomes.push(outcome);
        // After each case, so that a run that is cut off keeps what it has.
        outcome::save_csv(&out.join("time_against_error.csv"), &outcomes)?;
        chart::save(&out.join("time_against_error.svg"), &outcomes)?;
        printed?;
    }
    outcomes.iter().try_for_each(Outcome::check)
}
