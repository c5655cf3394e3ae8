//! A progressive sequence: its first 2, 4, 8, … points are uniform, each as well as may be.

use std::io::{self, Write};

use clap::{Args, ValueEnum};
use fsot::classes::PrefixLengths;
use fsot::metrics::{Integrands, MeasureError, Samples, SetError};
use fsot::{Config, SampleTable};
use serde::Serialize;
use serde_json::json;

use super::files::{Files, Record};
use super::making::{Figures, Work, make, tell};
use super::page::{BLACK, squares};
use super::set::PointSet;
use super::usual;
use crate::interrupt::Interrupt;
use crate::log::Log;
use crate::progress::Progress;
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot points progressive
      4096 points, compared with Owen-scrambled Sobol' points, in progressive.png
  fsot points progressive --count 1024 --prefixes every --points sequence.csv
      every prefix is a class, not only those of 2, 4, 8, ... points
  fsot points progressive --seeds 10 --points ten.npy
      ten sequences; the label of a point is the seed of its sequence

Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, points written.";

/// Makes progressive sequences, compares their prefixes with Owen-scrambled Sobol' points, and draws some.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// Points of the sequence.
    #[arg(long, default_value_t = usual::PROGRESSIVE_COUNT, value_parser = crate::flags::count())]
    count: usize,
    /// Which prefixes are classes.
    #[arg(long, value_enum, default_value_t = Prefixes::Powers)]
    prefixes: Prefixes,
    /// Slices per class.
    #[arg(long, default_value_t = usual::PROGRESSIVE_SLICES)]
    slices: u64,
    /// Sequences to make and to average over: those of the seeds 0, 1, …
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    seeds: u32,
    /// Integrands per family.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: u32,
    #[command(flatten)]
    files: Files,
    #[command(flatten)]
    shared: Shared,
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
enum Prefixes {
    Powers,
    Every,
}

const SIDE: usize = 380;

/// Scramblings of Sobol' points to average over, and the longest of their sequences.
const SCRAMBLINGS: u32 = 10;
const LONGEST_SOBOL: usize = 1 << 16;

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { count, prefixes, slices, seeds, integrands, files, shared } = arguments;
    let places = files.check("progressive.png", &[])?;
    shared.start_threads()?;
    let progress = Progress::new(shared);
    let mut work = Work::default();
    let mut sequences: Vec<SampleTable> = Vec::new();
    let mut set = PointSet::empty(2);
    let mut log = None;
    for seed in 0..*seeds {
        let lengths = match prefixes {
            Prefixes::Powers => PrefixLengths::PowersOfTwo,
            Prefixes::Every => PrefixLengths::Every,
        };
        if *seeds > 1 {
            progress.begin(&format!("seed {seed} of {seeds}"));
        }
        let config = Config::progressive(*count, 2, lengths).with_seed(seed.into());
        let made = make(config, *slices, &progress, places.log().filter(|_| seed == 0))?;
        log = log.or(made.log);
        set.append(made.table.clone(), seed);
        sequences.push(made.table);
        work = work.and(made.work);
        if work.run.ended_early {
            break;
        }
        if seed + 1 < *seeds && Interrupt::listen()?.came() {
            work.run.ended_early = true;
            break;
        }
    }
    let record = Record {
        kind: "progressive",
        flags: json!({ "count": count, "prefixes": prefixes, "slices": slices, "seeds": seeds }),
        labels: (0..sequences.len()).map(|seed| format!("seed {seed}")).collect(),
        run: work,
    };
    places.write(&set, &record, || {
        let panel = |part: usize| {
            let length = (count / part).max(1);
            let radius = (0.25 * SIDE as f64 / (length as f64).sqrt()).clamp(0.7, 5.0);
            (radius, set.iter().take(length).map(|(dot, _)| (dot, BLACK)).collect())
        };
        squares(SIDE, [64, 16, 4, 1].into_iter().map(panel).collect())
    })?;
    log.map_or(Ok(()), Log::end)?;

    let (count, integrands) = (*count, *integrands as usize);
    let measure = move || PrefixErrors::measure(&sequences, count, integrands);
    let figures = Interrupt::listen()?.unless_it_comes(measure).transpose()?;
    tell(shared, set.count(), &work, &places, &figures)
}

/// Errors of prefixes beside those of Sobol' points.
#[derive(Serialize)]
struct PrefixErrors {
    sequences: usize,
    prefixes: Vec<PrefixError>,
}

#[derive(Serialize)]
struct PrefixError {
    points: usize,
    /// Mean squared integration error, as ratio to white noise of the same length.
    error: f64,
    /// The same of Owen-scrambled Sobol' points, as far as their sequence goes.
    sobol: Option<f64>,
}

impl PrefixErrors {
    fn measure(sequences: &[SampleTable], count: usize, integrands: usize) -> Result<Self, Failure> {
        let integrands = Integrands::random(2, integrands, 0)?;
        let sobol = |seed: u32| {
            let point = move |index| [0, 1].map(|dim| sobol_burley::sample(index, dim, seed));
            (0..count.min(LONGEST_SOBOL) as u32).flat_map(point).collect::<Vec<f32>>()
        };
        let scrambled: Vec<Vec<f32>> = (0..SCRAMBLINGS).map(sobol).collect();
        let mean = |sets: &mut dyn Iterator<Item = &[f32]>, length: usize| -> Result<f64, MeasureError> {
            let (mut sum, mut sets_summed) = (0.0, 0.0);
            for set in sets {
                let prefix = Samples::points(set, 2)?.select(..length)?;
                sum += SetError::measure(prefix, &[0, 1], &integrands)?.ratios.mean.mean;
                sets_summed += 1.0;
            }
            Ok(sum / sets_summed)
        };
        let powers = (2..usize::BITS).map(|power| 1_usize << power).take_while(|&length| length <= count);
        // Between the powers of two, too.
        let lengths = powers.flat_map(|length| [length, length + length / 2]);
        let mut prefixes = Vec::new();
        for points in lengths.filter(|&length| length <= count) {
            let error = mean(&mut sequences.iter().map(SampleTable::values), points)?;
            let sobol = match points {
                ..=LONGEST_SOBOL => Some(mean(&mut scrambled.iter().map(Vec::as_slice), points)?),
                _ => None,
            };
            prefixes.push(PrefixError { points, error, sobol });
        }
        Ok(Self { sequences: sequences.len(), prefixes })
    }
}

impl Figures for PrefixErrors {
    fn words(&self, out: &mut dyn Write) -> io::Result<()> {
        if self.sequences > 1 {
            writeln!(out, "mean over {} sequences", self.sequences)?;
        }
        writeln!(out, "mean squared integration error, as ratio to white noise of the same length")?;
        writeln!(out, "{:>7} {:>12} {:>12} {:>7}", "points", "sequence", "Owen-Sobol'", "ratio")?;
        for &PrefixError { points, error, sobol } in &self.prefixes {
            write!(out, "{points:>7} {error:>12.4}")?;
            match sobol {
                Some(sobol) => writeln!(out, " {sobol:>12.4} {:>7.2}", error / sobol)?,
                None => writeln!(out, " {:>12} {:>7}", "-", "-")?,
            }
        }
        Ok(())
    }
}
