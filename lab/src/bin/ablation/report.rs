//! The results as markdown.

use std::fmt::Write;

use crate::case::{Case, Outcome, Row};

const COMMAND: &str = "cargo run --release -p fsot-lab --bin ablation -- --out docs --machine …";

/// A heading, and a section for each title. Cases are columns.
pub fn markdown(machine: &str, cases: &[Case], sections: &[(&str, Vec<Row>)]) -> String {
    let mut text = String::new();
    write_all(&mut text, machine, cases, sections).expect("a string takes everything");
    text
}

fn write_all(
    text: &mut String,
    machine: &str,
    cases: &[Case],
    sections: &[(&str, Vec<Row>)],
) -> std::fmt::Result {
    writeln!(text, "# What each choice is worth\n")?;
    writeln!(text, "Written by `{COMMAND}`; {machine}.\n")?;
    writeln!(
        text,
        "One thing at a time is changed from the defaults, at equal slices where that does not change \
         the cost of a slice, else at equal time (that of the defaults, as told by short runs of both right \
         before). *Slices* are per pixel and frame; *filtered* error, *bound* and *bias* are ratios to white \
         noise, as in the README.\n"
    )?;
    for case in cases {
        writeln!(
            text,
            "* {}: {} slices, {}",
            case.name,
            case.slices_per_class,
            if case.seeds == 1 { "one seed".into() } else { format!("mean of {} seeds", case.seeds) }
        )?;
    }
    for (title, rows) in sections {
        writeln!(text, "\n## {title}\n")?;
        write!(text, "| |")?;
        for case in cases {
            write!(text, " {}: slices | s | filtered | bound | bias |", case.name)?;
        }
        writeln!(text, "\n|---|{}", "---|".repeat(5 * cases.len()))?;
        for Row { name, outcomes } in rows {
            write!(text, "| {name} |")?;
            outcomes.iter().try_for_each(|outcome| write_cells(text, outcome))?;
            writeln!(text)?;
        }
    }
    Ok(())
}

fn write_cells(
    text: &mut String,
    Outcome { slices_per_class, seconds, quality }: &Outcome,
) -> std::fmt::Result {
    let (filtered, bound, bias) = (quality.filtered, quality.bound, quality.bias);
    write!(text, " {slices_per_class:.0} | {seconds:.2} | {filtered:.4} | {bound:.4} | {bias:.2} |")
}
