//! What each choice of the optimiser is worth: the defaults, and one thing changed at a time.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin ablation -- --out docs --machine "AMD EPYC, 2 cores, 2026-11-22"
//! cargo run --release -p fsot-lab --bin ablation -- schedule    # prints some of it
//! ```
//!
//! Choices that don't change the cost of a slice are compared at equal slices, the others at equal time: that
//! of the defaults, as told by short runs of both right before each. Tables are measured as in the README;
//! all figures are ratios to white noise of the same shape. Some minutes.
//!
//! With `--quick` everything runs once on small tables.

mod averaged;
mod case;
mod factors;
mod measure;
mod plain;
mod report;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use fsot_lab::{program, say};

use crate::case::{Failure, Row};
use crate::factors::Factor;
use crate::measure::rows;

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
    /// Run everything once, on small tables.
    #[arg(long)]
    quick: bool,
}

fn main() -> ExitCode {
    program::main(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { filter, out, machine, quick } = arguments;
    let (cases, plain_case) = if *quick { case::tiny() } else { case::full() };
    let wanted = |title: &str| filter.as_ref().is_none_or(|filter| title.contains(filter.as_str()));
    let mut titles: Vec<&str> = factors::all().iter().map(|factor| factor.title).collect();
    titles.push(plain::TITLE);
    if !titles.iter().any(|title| wanted(title)) {
        let named = filter.as_deref().unwrap_or_default();
        return Err(format!("no factor's title contains '{named}': name one of {}", titles.join(", ")).into());
    }
    if let Some(out) = out {
        if filter.is_some() {
            return Err(
                "a part of the factors would replace the whole page: leave out --out, or the filter".into()
            );
        }
        program::make_folder(out)?;
    }

    // Starts the threads.
    rows(&cases[..1], vec![factors::defaults()])?;
    let mut sections = vec![("Defaults", rows(&cases, vec![factors::defaults()])?)];
    for Factor { title, variants } in factors::all() {
        if wanted(title) {
            eprintln!("{title}");
            sections.push((title, rows(&cases, variants)?));
        }
    }
    let mut report = report::markdown(machine, &cases, &sections);
    if wanted(plain::TITLE) {
        eprintln!("{}", plain::TITLE);
        report += &plain::section(&plain_case)?;
    }
    let printed = say!("{report}");
    if let Some(out) = out {
        program::save(&out.join("ablation.md"), report.as_bytes())?;
    }
    for (title, rows) in &sections {
        rows.iter().try_for_each(Row::check).map_err(|error| format!("{title}: {error}"))?;
    }
    Ok(printed?)
}
