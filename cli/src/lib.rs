//! The command `fsot`, as a library: what its verbs do, and what other programs of the project share with it.

use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub mod draw;
pub mod inspect;
pub mod points;
pub mod table;
pub mod temporal;

/// Whatever went wrong, in one sentence.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Filtered sliced optimal transport: sample tables and point sets.
#[derive(Parser)]
#[command(name = "fsot", version)]
struct Command {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Table(table::Arguments),
    Inspect(inspect::Arguments),
    Points(points::Arguments),
}

/// Runs the command with the arguments of this process.
pub fn main() -> ExitCode {
    let done = match Command::parse().verb {
        Verb::Table(arguments) => table::run(&arguments),
        Verb::Inspect(arguments) => inspect::run(&arguments),
        Verb::Points(arguments) => points::run(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
