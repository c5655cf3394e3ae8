//! Stippling: points as dense as a picture is dark.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use fsot::Config;
use fsot::targets::{Density, Tone};
use serde_json::json;

use super::files::{Files, Record};
use super::likeness::{Likeness, blur};
use super::making::{Figures, make, tell};
use super::page::{BLACK, LONGER_SIDE, sheet, sheet_size};
use super::picture::{Reading, refusal};
use super::set::PointSet;
use super::usual;
use crate::interrupt::Interrupt;
use crate::log::Log;
use crate::progress::Progress;
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot points stipple --picture face.png --count 20000 --out dots.png
      a picture in 20000 dots
  fsot points stipple --picture face.png --points dots.csv
      the dots as a list, not drawn: x from left to right, y from top to bottom, each from 0 to 1
  fsot points stipple --picture stars.exr --bright --count 4096 --slices 32000 --seed 3
      bright where the picture is bright, with twice the work, in stippling.png

All labels are 0.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, points written.";

/// Makes points that resemble a picture, measures how well they do, and draws them.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// PNG or EXR file; the default is a lantern that comes with the source code.
    #[arg(long, default_value = "data/lantern.png")]
    picture: PathBuf,
    /// Points.
    #[arg(long, default_value_t = usual::STIPPLE_COUNT, value_parser = crate::flags::count())]
    count: usize,
    /// Bright instead of dark.
    #[arg(long)]
    bright: bool,
    /// Slices.
    #[arg(long, default_value_t = usual::STIPPLE_SLICES)]
    slices: u64,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    files: Files,
    #[command(flatten)]
    shared: Shared,
}

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { picture, count, bright, slices, seed, reading, files, shared } = arguments;
    let places = files.check("stippling.png", &[picture])?;
    shared.start_threads()?;
    let tone = if *bright { Tone::Bright } else { Tone::Dark };
    let density = Density::open_with(picture, tone, &reading.options()).map_err(refusal)?;
    let config = Config::stippling(*count, density.clone()).with_seed(*seed);
    let made = make(config, *slices, &Progress::new(shared), places.log())?;
    let set = PointSet::new(made.table, vec![0; *count]);
    let flags = json!({
        "picture": picture.display().to_string(),
        "count": count,
        "bright": bright,
        "slices": slices,
        "seed": seed,
        "reading": reading,
    });
    let record = Record { kind: "stipple", flags, labels: vec!["ink".into()], run: made.work };
    places.write(&set, &record, || {
        let radius = (0.3 * blur(*count, &density) * LONGER_SIDE as f64 / 2.0).clamp(0.8, 6.0);
        sheet(sheet_size(density.size()), radius, set.iter().map(|(dot, _)| (dot, BLACK)))
    })?;
    made.log.map_or(Ok(()), Log::end)?;

    let measure = move || Likeness::measure(&set.with_labels(&[0]), &density);
    let figures = Interrupt::listen()?.unless_it_comes(measure).transpose()?;
    tell(shared, *count, &made.work, &places, &figures)
}

impl Figures for Likeness {
    fn words(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { correlation, strays, blur, worst, advice, .. } = self;
        writeln!(out, "correlation {correlation:.4}, strays {strays}, blurred by {blur:.4}")?;
        writeln!(out, "largest deviation {worst}")?;
        advice.iter().try_for_each(|advice| writeln!(out, "{advice}"))
    }
}
