//! Stippling in colour: every set of inks is spread like its part of the picture, so that dots of different inks avoid each
//! other as well.
//!
//! `cargo run --release --example color_stippling -- --picture data/garden.png --out color_stippling.png`

use std::path::PathBuf;

use crate::Failure;
use crate::draw::page::Page;
use clap::Args;
use fsot::metrics::{DensityMatch, Samples};
use fsot::targets::Inks;
use fsot::{Config, Optimizer, Until};

/// Makes points in cyan, magenta, yellow and black that resemble a picture, and draws them.
#[derive(Args)]
pub struct Arguments {
    /// PNG or EXR file.
    #[arg(long, default_value = "data/garden.png")]
    picture: PathBuf,
    /// Points in all.
    #[arg(long, default_value_t = 24576)]
    count: usize,
    /// Slices per set of inks.
    #[arg(long, default_value_t = 1000)]
    slices: u64,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where to write the picture.
    #[arg(long, default_value = "color_stippling.png")]
    out: PathBuf,
}

const LONGER_SIDE: usize = 1400;
const MARGIN: usize = 20;
const NAMES: [&str; 4] = ["cyan", "magenta", "yellow", "black"];
const INKS: [[u8; 3]; 4] = [[0, 165, 220], [225, 20, 130], [250, 225, 0], [25, 25, 30]];

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let begin = std::time::Instant::now();
    let inks = Inks::open(&arguments.picture)?;
    let config = Config::color_stippling(arguments.count, &inks).with_seed(arguments.seed);
    let sets = config.terms.len();
    let mut optimizer = Optimizer::new(config)?;
    let planned = begin.elapsed().as_secs_f64();
    let report = optimizer.run(Until::SlicesPerClass(arguments.slices))?;
    println!(
        "{sets} sets of inks, planned in {planned:.2} s, optimised in {:.2} s",
        report.elapsed.as_secs_f64()
    );

    let table = optimizer.into_table();
    let counts = inks.counts(arguments.count);
    let mut labelled = Vec::new();
    let mut rest = table.values();
    let mut size = [1, 1];
    for (ink, &count) in counts.iter().enumerate() {
        let (these, others) = rest.split_at(2 * count);
        rest = others;
        labelled.extend(these.chunks_exact(2).map(|dot| (dot, INKS[ink])));
        let Some(density) = inks.density(ink).filter(|_| count > 0) else { continue };
        size = density.size();
        let shape = size[0].min(size[1]) as f64 / size[0].max(size[1]) as f64;
        let sigma = 2.0 * (shape / count as f64).sqrt();
        let found = DensityMatch::measure(Samples::points(these, 2)?, [0, 1], &density, sigma)?;
        println!(
            "{}: {count} points, correlation {:.4}, strays {}",
            NAMES[ink], found.correlation, found.strays
        );
        assert!(count < 1000 || found.correlation > 0.9, "the points don't resemble the picture");
    }

    let longer = size[0].max(size[1]);
    let size = size.map(|len| LONGER_SIDE * len / longer);
    let mut page = Page::new(size[0] + 2 * MARGIN, size[1] + 2 * MARGIN);
    let radius = (0.5 * ((size[0] * size[1]) as f64 / arguments.count as f64).sqrt()).clamp(1.0, 6.0);
    page.scatter([MARGIN; 2], size, radius, labelled);
    page.picture.save(&arguments.out)?;
    println!("{}", arguments.out.display());
    Ok(())
}
