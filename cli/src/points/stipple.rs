//! Stippling: points as dense as a picture is dark.
//!
//! `cargo run --release --example stippling -- --picture data/lantern.png --out stippling.png`

use std::path::PathBuf;

use crate::Failure;
use crate::draw::page::Page;
use clap::Args;
use fsot::metrics::DensityMatch;
use fsot::targets::{Density, Tone};
use fsot::{Config, Optimizer, Until};

/// Makes points that resemble a picture, measures how well they do, and draws them.
#[derive(Args)]
pub struct Arguments {
    /// PNG or EXR file.
    #[arg(long, default_value = "data/lantern.png")]
    picture: PathBuf,
    /// Points.
    #[arg(long, default_value_t = 8192)]
    count: usize,
    /// Bright instead of dark.
    #[arg(long)]
    bright: bool,
    /// Slices.
    #[arg(long, default_value_t = 16000)]
    slices: u64,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where to write the picture.
    #[arg(long, default_value = "stippling.png")]
    out: PathBuf,
}

const LONGER_SIDE: usize = 1400;
const MARGIN: usize = 20;
const BLACK: [u8; 3] = [20, 20, 24];

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let begin = std::time::Instant::now();
    let tone = if arguments.bright { Tone::Bright } else { Tone::Dark };
    let density = Density::open(&arguments.picture, tone)?;
    let config = Config::stippling(arguments.count, density.clone()).with_seed(arguments.seed);
    let mut optimizer = Optimizer::new(config)?;
    let planned = begin.elapsed();
    let report = optimizer.run(Until::SlicesPerClass(arguments.slices))?;
    println!("planned in {:.2} s, optimised in {:.2} s", planned.as_secs_f64(), report.elapsed.as_secs_f64());

    let table = optimizer.into_table();
    // Two distances between neighbours, if all of the picture were equally dark.
    let [width, height] = density.size();
    let shape = width.min(height) as f64 / width.max(height) as f64;
    let sigma = 2.0 * (shape / arguments.count as f64).sqrt();
    let found = DensityMatch::measure(&table, [0, 1], &density, sigma)?;
    println!("correlation {:.4}, strays {}, blurred by {sigma:.4}", found.correlation, found.strays);
    assert!(arguments.count < 1000 || found.correlation > 0.9, "the points don't resemble the picture");

    let side = |len: usize| LONGER_SIDE * len / width.max(height);
    let size = [side(width), side(height)];
    let mut page = Page::new(size[0] + 2 * MARGIN, size[1] + 2 * MARGIN);
    let radius = (0.3 * sigma * LONGER_SIDE as f64 / 2.0).clamp(0.8, 6.0);
    page.scatter([MARGIN; 2], size, radius, table.values().chunks_exact(2).map(|dot| (dot, BLACK)));
    page.picture.save(&arguments.out)?;
    println!("{}", arguments.out.display());
    Ok(())
}
