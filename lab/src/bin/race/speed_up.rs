//! How much sooner ours are at equal error.

use std::io;

use fsot_lab::judge::Quality;
use fsot_lab::{program, say};

use crate::outcome::{Curve, Outcome, Point};

/// A figure of merit.
type Figure = fn(&Quality) -> f64;

/// When a curve first gets down to an error.
#[derive(Clone, Copy, Debug)]
enum Reach {
    /// Its shortest run is below already.
    Sooner {
        seconds: f64,
        bias: f64,
    },
    /// Between two runs, on straight lines in logarithms.
    At {
        seconds: f64,
        bias: f64,
    },
    Never,
}

/// Checkpoints of the published loop to compare at, from the last on.
const CHECKPOINTS: usize = 4;

pub fn print(Outcome { case, ours, published }: &Outcome) -> io::Result<()> {
    say!("\n## {}\n", case.name)?;
    let Some(last) = published.points.last() else { return Ok(()) };
    let pace = last.seconds / last.slices as f64 * 1e6;
    program::print(format_args!(
        "The published loop, {pace:.1} µs per slice on {} threads",
        rayon::current_num_threads()
    ))?;
    match case.published_program_us {
        Some(program) => say!(
            " (the published program: {program} µs on two; at that pace the speed-ups below are {:.2} times \
             as large).",
            program / pace
        )?,
        None => say!(".")?,
    }
    say!(
        "It is compared at the errors that it reached; its last was {:.3} filtered, bound {:.3}, \
         bias {:.2}.\n",
        last.quality.filtered,
        last.quality.bound,
        last.quality.bias
    )?;
    say!(
        "| published loop: s | filtered | bound | bias | ours | s to its filtered error | speed-up \
         | our bias | s to its bound | speed-up | our bias |"
    )?;
    say!("|---|---|---|---|---|---|---|---|---|---|---|")?;
    let skipped = published.points.len().saturating_sub(CHECKPOINTS);
    for checkpoint in &published.points[skipped..] {
        for curve in ours {
            print_row(checkpoint, curve)?;
        }
    }
    Ok(())
}

fn print_row(Point { seconds, quality, .. }: &Point, curve: &Curve) -> io::Result<()> {
    let Quality { filtered, bound, bias } = quality;
    program::print(format_args!(
        "| {} | {filtered:.3} | {bound:.3} | {bias:.2} | {} |",
        significant(*seconds),
        curve.method
    ))?;
    let figures: [Figure; 2] = [|quality| quality.filtered, |quality| quality.bound];
    for figure in figures {
        match reach(&curve.points, figure, figure(quality)) {
            Reach::Sooner { seconds: ours, bias } => {
                program::print(format_args!(
                    " < {} | > {:.0} | {bias:.2} |",
                    significant(ours),
                    seconds / ours
                ))?;
            }
            Reach::At { seconds: ours, bias } => {
                program::print(format_args!(" {} | {:.0} | {bias:.2} |", significant(ours), seconds / ours))?;
            }
            Reach::Never => program::print(format_args!(" not reached | | |"))?,
        }
    }
    say!("")
}

/// Three digits.
fn significant(value: f64) -> String {
    let decimals = (2 - value.log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}

fn reach(points: &[Point], figure: Figure, error: f64) -> Reach {
    let Some(after) = points.iter().position(|point| figure(&point.quality) <= error) else {
        return Reach::Never;
    };
    let to = &points[after];
    if after == 0 {
        return Reach::Sooner { seconds: to.seconds, bias: to.quality.bias };
    }
    let from = &points[after - 1];
    let [above, below] = [from, to].map(|point| figure(&point.quality).ln());
    let share = (above - error.ln()) / (above - below);
    let between = |from: f64, to: f64| (from.ln() + share * (to.ln() - from.ln())).exp();
    Reach::At {
        seconds: between(from.seconds, to.seconds),
        bias: between(from.quality.bias, to.quality.bias),
    }
}
