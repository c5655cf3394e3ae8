//! `fsot points`: point sets.

use clap::{Args, Subcommand};

use crate::Failure;

mod color_stipple;
mod progressive;
mod stipple;
mod two_class;

/// Makes point sets.
#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Subcommand)]
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
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.kind {
        Kind::TwoClass(arguments) => two_class::run(arguments),
        Kind::Progressive(arguments) => progressive::run(arguments),
        Kind::Stipple(arguments) => stipple::run(arguments),
        Kind::ColorStipple(arguments) => color_stipple::run(arguments),
    }
}
