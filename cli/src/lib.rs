//! The command `fsot`, as a library: what its verbs do, and what other programs of the project share with it.
//!
//! | verb | makes |
//! |---|---|
//! | [`table`] | a sample table, and its metadata |
//! | [`inspect`] | figures of a table |
//! | [`report`] | a page about one table or several, or a sheet of their pictures |
//! | [`export`] | textures and other files that engines read |
//! | [`import`] | a sample table of somebody else's file |
//! | [`points`] | point sets: labelled classes, progressive sequences, stipplings |
//! | [`plot`] | curves of the logs of runs |
//!
//! # Exit codes
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | refused or failed: nothing is written, or what is written is whole |
//! | 2 | the command line cannot be understood |
//! | 3 | SIGINT, SIGTERM or SIGHUP ended the run early; what it had reached is written, and says so |
//!
//! A signal before the first step, or during `fsot inspect` and `fsot report`, finds nothing to keep and
//! kills the process as signals do (130, 143 and 129 to a shell). One that ends `fsot export` before all
//! files are complete is a failure, since nothing is written then. A reader of the output who goes away (`|
//! head -1`) is no failure.
//!
//! # Shared with other programs
//!
//! [`interrupt`] for signals, [`checkpoint`] for runs that may be killed, [`output`] for files that are
//! checked before the work, [`progress`] for bars, [`console`] for what is printed, [`run`] for a run with
//! all of them, [`log`] for what is written of it, [`draw`] for pictures, [`temporal`] for kernels as they
//! are written on a command line.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

mod advice;
pub mod checkpoint;
pub mod console;
pub mod draw;
pub mod export;
mod flags;
pub mod import;
pub mod inspect;
pub mod interrupt;
pub mod log;
pub mod output;
pub mod plot;
pub mod points;
pub mod progress;
pub mod report;
pub mod run;
pub mod table;
pub mod temporal;

pub use self::flags::Shared;

/// Whatever went wrong, in one sentence.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// How a verb ended that has not failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All is done.
    Done,
    /// A signal came; what was reached is written.
    Stopped,
}

impl Ended {
    /// [`Ended::Stopped`] if a signal has cut something short.
    pub fn stopped_if(stopped: bool) -> Self {
        if stopped { Self::Stopped } else { Self::Done }
    }
}

impl Ended {
    fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Stopped => 3,
        }
    }
}

/// Filtered sliced optimal transport: sample tables whose Monte Carlo error is blue noise, and point sets.
#[derive(Debug, Parser)]
#[command(name = "fsot", version, after_help = TOUR)]
struct Command {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Table(table::Arguments),
    Inspect(inspect::Arguments),
    Report(report::Arguments),
    Export(export::Arguments),
    Import(import::Arguments),
    Points(points::Arguments),
    Plot(plot::Arguments),
}

const TOUR: &str = "\
A tour:
  fsot table
      64 x 64 pixels and 10 frames in a second, to table.npy and table.json
  fsot inspect table.npy
      what the table is worth, in figures
  fsot report table.npy
      the same to look at, in report.html; several tables stand side by side
  fsot table --frames 1 --spp 4 --dims 4 --seconds 10 --out render.npy
      a still table for a renderer that takes 4 samples of 4 numbers per pixel
  fsot export table.npy --to slices --out stbn.png
      textures for an engine, one PNG a frame; or ktx2, exr and others
  fsot import mask.npy --out table.npy
      a table of somebody else's array, texture or text
  fsot points two-class --counts 682,683,683 --every --points classes.csv
      three sets of points; each of them, and all their unions, are uniform
  fsot points stipple --picture face.png --count 20000 --out dots.png
      a picture in dots
  fsot table --config table.json --seed 8 --log run.csv
      as that table was made but for the seed, with a log of how it went; fsot plot run.csv draws it
  fsot table --json --quiet
      one line of JSON for a script, and no progress bar; so does every verb
'fsot VERB --help' says more about each.

Exit codes:
  0  done
  1  refused or failed; nothing is written, or what is written is whole
  2  the command line cannot be understood
  3  a signal (Ctrl-C, SIGTERM, SIGHUP) ended the run early; what it had reached is written, and says so";

/// Runs the command with the arguments of this process.
pub fn main() -> ExitCode {
    command(std::env::args_os()).into()
}

/// Runs the command with these arguments, of which the first is its own name, and gives back the exit code.
///
/// ```
/// assert_eq!(fsot_cli::command(["fsot", "--version"]), 0);
/// assert_eq!(fsot_cli::command(["fsot", "table", "--spp", "few"]), 2);
/// ```
pub fn command<T: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = T>) -> u8 {
    let command = match Command::try_parse_from(arguments) {
        Ok(command) => command,
        Err(help_or_error) => {
            // Nobody is left to be told.
            let _ = help_or_error.print();
            return u8::try_from(help_or_error.exit_code()).unwrap_or(2);
        }
    };
    let ended = match command.verb {
        Verb::Table(arguments) => table::run(&arguments),
        Verb::Inspect(arguments) => inspect::run(&arguments),
        Verb::Report(arguments) => report::run(&arguments),
        Verb::Export(arguments) => export::run(&arguments),
        Verb::Import(arguments) => import::run(&arguments),
        Verb::Points(arguments) => points::run(&arguments),
        Verb::Plot(arguments) => plot::run(&arguments),
    };
    match ended {
        Ok(ended) => ended.exit_code(),
        Err(error) => {
            console::complain(&*error);
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        <Command as clap::CommandFactory>::command().debug_assert();
    }
}
