//! Stippling in colour: every set of inks is spread like its part of the picture, so that dots of different
//! inks avoid each other as well.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use fsot::Config;
use fsot::targets::Inks;
use serde::Serialize;
use serde_json::json;

use super::files::{Files, Record};
use super::likeness::Likeness;
use super::making::{Figures, make, tell};
use super::page::{sheet, sheet_size};
use super::picture::{Reading, refusal};
use super::set::PointSet;
use super::usual;
use crate::console;
use crate::interrupt::Interrupt;
use crate::log::Log;
use crate::progress::Progress;
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot points color-stipple --picture garden.png --out dots.png
      a picture in dots of cyan, magenta, yellow and black
  fsot points color-stipple --picture garden.png --count 50000 --points dots.csv
      the dots as a list, not drawn: x from left to right, y from top to bottom, each from 0 to 1

Labels are 0 for cyan, 1 for magenta, 2 for yellow, 3 for black, and points lie in their order.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, points written.";

/// Makes points in cyan, magenta, yellow and black that resemble a picture, and draws them.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// PNG or EXR file; the default is a garden that comes with the source code.
    #[arg(long, default_value = "data/garden.png")]
    picture: PathBuf,
    /// Points in all.
    #[arg(long, default_value_t = usual::COLOR_COUNT, value_parser = crate::flags::count())]
    count: usize,
    /// Slices per set of inks.
    #[arg(long, default_value_t = usual::COLOR_SLICES)]
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

/// Of the labels.
pub const NAMES: [&str; 4] = ["cyan", "magenta", "yellow", "black"];
/// How they are drawn.
pub const INKS: [[u8; 3]; 4] = [[0, 165, 220], [225, 20, 130], [250, 225, 0], [25, 25, 30]];

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { picture, count, slices, seed, reading, files, shared } = arguments;
    let places = files.check("color_stippling.png", &[picture])?;
    shared.start_threads()?;
    let inks = Inks::open_with(picture, &reading.options()).map_err(refusal)?;
    let config = Config::color_stippling(*count, &inks).with_seed(*seed);
    let sets = config.terms.len();
    let made = make(config, *slices, &Progress::new(shared), places.log())?;
    let labels = (0..).zip(inks.counts(*count)).flat_map(|(ink, count)| vec![ink; count]).collect();
    let set = PointSet::new(made.table, labels);
    let flags = json!({
        "picture": picture.display().to_string(),
        "count": count,
        "slices": slices,
        "seed": seed,
        "reading": reading,
    });
    let record =
        Record { kind: "color-stipple", flags, labels: NAMES.map(String::from).into(), run: made.work };
    places.write(&set, &record, || {
        // Inks are of one size, and there is at least one.
        let density = (0..NAMES.len()).find_map(|ink| inks.density(ink));
        let size = sheet_size(density.map_or([1, 1], |density| density.size()));
        let radius = (0.5 * ((size[0] * size[1]) as f64 / *count as f64).sqrt()).clamp(1.0, 6.0);
        sheet(size, radius, set.iter().map(|(dot, ink)| (dot, INKS[ink as usize % INKS.len()])))
    })?;
    made.log.map_or(Ok(()), Log::end)?;

    let measure = move || InkLikenesses::measure(&set, &inks, sets);
    let figures = Interrupt::listen()?.unless_it_comes(measure).transpose()?;
    tell(shared, *count, &made.work, &places, &figures)
}

/// How the points of each ink resemble it.
#[derive(Serialize)]
struct InkLikenesses {
    /// Sets of inks that were optimised.
    sets: usize,
    inks: Vec<InkLikeness>,
}

#[derive(Serialize)]
struct InkLikeness {
    ink: &'static str,
    #[serde(flatten)]
    likeness: Likeness,
}

impl InkLikenesses {
    fn measure(set: &PointSet, inks: &Inks, sets: usize) -> Result<Self, Failure> {
        let mut found = Vec::new();
        for (label, ink) in NAMES.into_iter().enumerate() {
            let points = set.with_labels(&[label as u32]);
            let Some(density) = inks.density(label).filter(|_| !points.is_empty()) else { continue };
            found.push(InkLikeness { ink, likeness: Likeness::measure(&points, &density)? });
        }
        Ok(Self { sets, inks: found })
    }
}

impl Figures for InkLikenesses {
    fn words(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{} sets of inks", self.sets)?;
        for InkLikeness { ink, likeness } in &self.inks {
            let Likeness { points, correlation, strays, worst, advice, .. } = likeness;
            let points = console::points(*points);
            writeln!(out, "{ink}: {points}, correlation {correlation:.4}, strays {strays}")?;
            writeln!(out, "  largest deviation {worst}")?;
            advice.iter().try_for_each(|advice| writeln!(out, "  {advice}"))?;
        }
        Ok(())
    }
}
