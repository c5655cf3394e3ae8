//! Point sets in several classes: every class is uniform, and so is their union.
//!
//! `cargo run --release --example two_class -- --out two_class.png`

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use crate::Failure;
use crate::draw::page::Page;
use clap::Args;
use fsot::classes::Classes;
use fsot::config::LabelSubsets;
use fsot::metrics::{MeasureError, Samples, SlicedDistance};
use fsot::targets::Target;
use fsot::{Config, ConfigError, Optimizer, Until};

/// Makes a point set of several classes, measures it, and draws each class beside the union.
#[derive(Args)]
pub struct Arguments {
    /// Points of each class, one number per class.
    #[arg(long, value_delimiter = ',', default_value = "512,512")]
    counts: Vec<usize>,
    /// Make all sets of classes uniform, not only each class and their union.
    #[arg(long)]
    every: bool,
    /// Slices per class.
    #[arg(long, default_value_t = 4000)]
    slices: u64,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Do not compare with sets of the same sizes that are optimised alone.
    #[arg(long)]
    no_comparison: bool,
    /// Where to write the picture.
    #[arg(long, default_value = "two_class.png")]
    out: PathBuf,
}

const SIDE: usize = 420;
const MARGIN: usize = 20;
const INKS: [[u8; 3]; 7] = [
    [205, 55, 45],
    [35, 95, 190],
    [40, 140, 70],
    [190, 130, 20],
    [130, 60, 160],
    [20, 140, 150],
    [90, 90, 90],
];

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { counts, slices, seed, .. } = arguments;
    let subsets = if arguments.every { LabelSubsets::Every } else { LabelSubsets::EachAndAll };
    let config = Config::classes(counts, 2, &subsets);
    let Classes::Labelled { labels, subsets } = &config.terms[0].classes else { return Ok(()) };
    let (labels, subsets) = (labels.clone(), subsets.clone());
    let (points, elapsed) = optimised(config.with_seed(*seed), *slices)?;
    println!("{} points in {} classes: {:.2} s", labels.len(), subsets.len(), elapsed.as_secs_f64());

    // How far each class is from uniform, and how far a set of its size could be.
    let mut alone = BTreeMap::new();
    for set in subsets.iter().filter(|_| !arguments.no_comparison) {
        let class: Vec<f32> = (0..labels.len())
            .filter(|&i| set.labels.contains(&labels[i]))
            .flat_map(|i| points[2 * i..2 * i + 2].iter().copied())
            .collect();
        let size = class.len() / 2;
        if size == 0 {
            continue;
        }
        let distance = distance_to_uniform(&class)?;
        let best = match alone.get(&size) {
            Some(&best) => best,
            None => {
                let single = Config::classes(&[size], 2, &LabelSubsets::Every).with_seed(seed + 1);
                let best = distance_to_uniform(&optimised(single, *slices)?.0)?;
                alone.insert(size, best);
                best
            }
        };
        let ratio = distance / best;
        println!("labels {:?}, {size} points: sliced W2 {distance:.6}, {ratio:.2} of alone", set.labels);
        assert!(ratio < 2.0, "a class is twice as far from uniform as it should be: give more --slices");
    }

    let panels = counts.len() + 1;
    let mut page = Page::new(MARGIN + panels * (SIDE + MARGIN), SIDE + 2 * MARGIN);
    let radius = (0.22 * SIDE as f64 / (labels.len() as f64).sqrt()).clamp(0.8, 6.0);
    for panel in 0..panels {
        let corner = [MARGIN + panel * (SIDE + MARGIN), MARGIN];
        let shown = |label: u32| panel == counts.len() || label as usize == panel;
        let dots = points.chunks_exact(2).zip(labels.iter()).filter(|(_, label)| shown(**label));
        page.scatter(corner, [SIDE, SIDE], radius, dots.map(|(dot, &label)| (dot, INKS[label as usize % 7])));
    }
    page.picture.save(&arguments.out)?;
    println!("{}", arguments.out.display());
    Ok(())
}

/// Sliced distance of points in the plane.
fn distance_to_uniform(points: &[f32]) -> Result<f64, MeasureError> {
    let points = Samples::points(points, 2)?;
    Ok(SlicedDistance::measure(points, &[0, 1], &Target::UniformCube, 256)?.w2)
}

fn optimised(config: Config, slices: u64) -> Result<(Vec<f32>, Duration), ConfigError> {
    let mut optimizer = Optimizer::new(config)?;
    let report = optimizer.run(Until::SlicesPerClass(slices))?;
    Ok((optimizer.into_table().into_values(), report.elapsed))
}
