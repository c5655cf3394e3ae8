//! `fsot points`: point sets, drawn and as coordinates.

mod color_stipple;
mod files;
mod likeness;
mod making;
mod page;
mod picture;
mod progressive;
mod set;
mod stipple;
mod two_class;

pub use color_stipple::{INKS as PRINTERS_INKS, NAMES as PRINTERS_NAMES};
pub use files::{record_path, record_text};
pub use making::Work;
pub use page::{BLACK, Dot, sheet, sheet_size, squares};
pub use set::PointSet;
pub use two_class::INKS as CLASS_INKS;

use clap::{Args, Subcommand};

use crate::{Ended, Failure};

/// How much work is done if nothing is said of it.
pub mod usual {
    /// Slices per class of a set of classes.
    pub const CLASSES_SLICES: u64 = 4000;
    /// Points of a sequence.
    pub const PROGRESSIVE_COUNT: usize = 4096;
    /// Slices per prefix of a sequence.
    pub const PROGRESSIVE_SLICES: u64 = 8000;
    /// Points of a stippling.
    pub const STIPPLE_COUNT: usize = 8192;
    /// Slices of a stippling.
    pub const STIPPLE_SLICES: u64 = 16000;
    /// Points of a stippling in colour.
    pub const COLOR_COUNT: usize = 24576;
    /// Slices per set of inks.
    pub const COLOR_SLICES: u64 = 1000;
}

const EXAMPLES: &str = "\
Examples:
  fsot points two-class --counts 512,512
      two classes, drawn side by side in two_class.png
  fsot points progressive --count 4096 --points sequence.npy
      a sequence whose first 2, 4, 8, ... points are uniform, for numpy.load
  fsot points stipple --picture face.png --points dots.csv --out dots.png
      a picture in dots, drawn and as a list with the header x,y,label
'fsot points KIND --help' says more about each.

A signal (Ctrl-C, SIGTERM, SIGHUP) ends a run with the step that is being taken, and keeps the points as
they are then.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, points written.";

/// Makes point sets: labelled classes, progressive sequences, stipplings.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    TwoClass(two_class::Arguments),
    Progressive(progressive::Arguments),
    Stipple(stipple::Arguments),
    ColorStipple(color_stipple::Arguments),
}

/// Makes the point set that was asked for.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    match &arguments.kind {
        Kind::TwoClass(arguments) => two_class::run(arguments),
        Kind::Progressive(arguments) => progressive::run(arguments),
        Kind::Stipple(arguments) => stipple::run(arguments),
        Kind::ColorStipple(arguments) => color_stipple::run(arguments),
    }
}
