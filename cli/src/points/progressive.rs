//! A progressive sequence: its first 2, 4, 8, … points are uniform, each as well as may be.
//!
//! `cargo run --release --example progressive -- --out progressive.png`

use std::path::PathBuf;

use crate::Failure;
use crate::draw::page::Page;
use clap::{Args, ValueEnum};
use fsot::classes::PrefixLengths;
use fsot::metrics::{Integrands, MeasureError, Samples, SetError};
use fsot::{Config, Optimizer, Until};

/// Makes progressive sequences, compares their prefixes with Owen-scrambled Sobol' points, and draws some of them.
#[derive(Args)]
pub struct Arguments {
    /// Points of the sequence.
    #[arg(long, default_value_t = 4096)]
    count: usize,
    /// Which prefixes are classes.
    #[arg(long, value_enum, default_value_t = Prefixes::Powers)]
    prefixes: Prefixes,
    /// Slices per class.
    #[arg(long, default_value_t = 8000)]
    slices: u64,
    /// Sequences to average over.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Integrands per family.
    #[arg(long, default_value_t = 256)]
    integrands: usize,
    /// Where to write the picture.
    #[arg(long, default_value = "progressive.png")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Prefixes {
    Powers,
    Every,
}

const SIDE: usize = 380;
const MARGIN: usize = 20;
const BLACK: [u8; 3] = [20, 20, 24];

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut sequences = Vec::new();
    for seed in 0..arguments.seeds {
        let lengths = match arguments.prefixes {
            Prefixes::Powers => PrefixLengths::PowersOfTwo,
            Prefixes::Every => PrefixLengths::Every,
        };
        let config = Config::progressive(arguments.count, 2, lengths).with_seed(seed);
        let mut optimizer = Optimizer::new(config)?;
        let report = optimizer.run(Until::SlicesPerClass(arguments.slices))?;
        println!("seed {seed}: {:.2} s", report.elapsed.as_secs_f64());
        sequences.push(optimizer.into_table().into_values());
    }

    println!("mean squared integration error, as ratio to white noise of the same length");
    println!("{:>7} {:>12} {:>12} {:>7}", "points", "sequence", "Owen-Sobol'", "ratio");
    let integrands = Integrands::random(2, arguments.integrands, 0)?;
    let sobol = |seed: u32| {
        let point = move |index| [0, 1].map(|dim| sobol_burley::sample(index, dim, seed));
        (0..arguments.count as u32).flat_map(point).collect::<Vec<f32>>()
    };
    let scrambled: Vec<Vec<f32>> = (0..10).map(sobol).collect();
    let mean = |sets: &[Vec<f32>], length: usize| -> Result<f64, MeasureError> {
        let mut sum = 0.0;
        for set in sets {
            let prefix = Samples::points(set, 2)?.select(..length)?;
            sum += SetError::measure(prefix, &[0, 1], &integrands)?.ratios.mean.mean;
        }
        Ok(sum / sets.len() as f64)
    };
    let powers = (0..).map(|power| 1_usize << power).take_while(|&length| length <= arguments.count);
    for length in powers.filter(|&length| length > 2) {
        // Between the powers of two, too.
        for length in [length, length + length / 2].into_iter().filter(|&length| length <= arguments.count) {
            let (ours, theirs) = (mean(&sequences, length)?, mean(&scrambled, length)?);
            println!("{length:>7} {ours:>12.4} {theirs:>12.4} {:>7.2}", ours / theirs);
        }
    }

    let shown: Vec<usize> = [64, 16, 4, 1].into_iter().map(|part| (arguments.count / part).max(1)).collect();
    let mut page = Page::new(MARGIN + shown.len() * (SIDE + MARGIN), SIDE + 2 * MARGIN);
    for (panel, &length) in shown.iter().enumerate() {
        let corner = [MARGIN + panel * (SIDE + MARGIN), MARGIN];
        let radius = (0.25 * SIDE as f64 / (length as f64).sqrt()).clamp(0.7, 5.0);
        let dots = sequences[0].chunks_exact(2).take(length);
        page.scatter(corner, [SIDE, SIDE], radius, dots.map(|dot| (dot, BLACK)));
    }
    page.picture.save(&arguments.out)?;
    println!("{}", arguments.out.display());
    Ok(())
}
