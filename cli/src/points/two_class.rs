//! Point sets in several classes: every class is uniform, and so is their union.

use std::collections::BTreeMap;
use std::io::{self, Write};

use clap::Args;
use fsot::Config;
use fsot::classes::{Classes, LabelSet};
use fsot::config::LabelSubsets;
use fsot::metrics::{MeasureError, Samples, SlicedDistance};
use fsot::targets::Target;
use serde::Serialize;
use serde_json::json;

use super::files::{Files, Record};
use super::making::{Figures, make, tell};
use super::page::squares;
use super::set::PointSet;
use super::usual;
use crate::console;
use crate::interrupt::Interrupt;
use crate::log::Log;
use crate::progress::Progress;
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot points two-class
      two classes of 512 points, in two_class.png
  fsot points two-class --counts 682,683,683 --every --out three.png --points three.csv
      three classes and all their unions, drawn and as a list
  fsot points two-class --counts 131072,131072 --slices 100 --no-comparison --points large.npy --json
      many points, not drawn; one line of JSON for a script

Labels are the numbers of the classes, from 0, and points lie in their order.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, points written.";

/// Makes a point set of several classes, measures it, and draws each class beside the union.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// Points of each class, one number per class.
    #[arg(long, value_delimiter = ',', default_value = "512,512")]
    counts: Vec<usize>,
    /// Make all sets of classes uniform, not only each class and their union.
    #[arg(long)]
    every: bool,
    /// Slices per class.
    #[arg(long, default_value_t = usual::CLASSES_SLICES)]
    slices: u64,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Do not compare with sets of the same sizes that are optimised alone.
    #[arg(long)]
    no_comparison: bool,
    #[command(flatten)]
    files: Files,
    #[command(flatten)]
    shared: Shared,
}

const SIDE: usize = 420;
/// Of the classes, over and over.
pub const INKS: [[u8; 3]; 7] = [
    [205, 55, 45],
    [35, 95, 190],
    [40, 140, 70],
    [190, 130, 20],
    [130, 60, 160],
    [20, 140, 150],
    [90, 90, 90],
];

/// Times the distance of a set that is optimised alone, from which on a class is a poor one.
const POOR: f64 = 2.0;

/// Makes it.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { counts, every, slices, seed, no_comparison, files, shared } = arguments;
    let places = files.check("two_class.png", &[])?;
    if counts.iter().all(|&count| count == 0) {
        return Err("there are no points: give --counts of which one is above 0".into());
    }
    shared.start_threads()?;
    let subsets = if *every { LabelSubsets::Every } else { LabelSubsets::EachAndAll };
    let config = Config::classes(counts, 2, &subsets).with_seed(*seed);
    let Some(Classes::Labelled { labels, subsets }) = config.terms.first().map(|term| term.classes.clone())
    else {
        return Err("there are no classes: give --counts of at least one number".into());
    };
    let progress = Progress::new(shared);
    let made = make(config, *slices, &progress, places.log())?;
    let set = PointSet::new(made.table, labels.to_vec());
    let record = Record {
        kind: "two-class",
        flags: json!({ "counts": counts, "every": every, "slices": slices, "seed": seed }),
        labels: (0..counts.len()).map(|class| format!("class {class}")).collect(),
        run: made.work,
    };
    places.write(&set, &record, || {
        let radius = (0.22 * SIDE as f64 / (set.count() as f64).sqrt()).clamp(0.8, 6.0);
        let shown = |panel: usize, label: u32| panel == counts.len() || label as usize == panel;
        let panel = |panel: usize| {
            let dots = set.iter().filter(|&(_, label)| shown(panel, label));
            (radius, dots.map(|(dot, label)| (dot, INKS[label as usize % INKS.len()])).collect())
        };
        squares(SIDE, (0..=counts.len()).map(panel).collect())
    })?;
    made.log.map_or(Ok(()), Log::end)?;

    let points = set.count();
    let (slices, seed, compared) = (*slices, *seed, !no_comparison);
    let bar = progress.clone();
    let measure = move || Distances::measure(&set, &subsets, compared.then_some((slices, seed)), &bar);
    let figures = Interrupt::listen()?.unless_it_comes(measure).transpose()?;
    progress.clear();
    tell(shared, points, &made.work, &places, &figures)
}

/// How far each class is from uniform.
#[derive(Serialize)]
struct Distances {
    classes: Vec<ClassDistance>,
}

#[derive(Serialize)]
struct ClassDistance {
    labels: Vec<u32>,
    points: usize,
    sliced_w2: f64,
    /// Relative to a set of the size that is optimised alone.
    of_alone: Option<f64>,
}

impl Distances {
    fn measure(
        set: &PointSet,
        subsets: &[LabelSet],
        comparison: Option<(u64, u64)>,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let mut alone = BTreeMap::new();
        let mut classes = Vec::new();
        for LabelSet { labels, .. } in subsets {
            let class = set.with_labels(labels);
            let points = class.len() / 2;
            if points == 0 {
                continue;
            }
            let sliced_w2 = distance_to_uniform(&class)?;
            let best = match (alone.get(&points), comparison) {
                (Some(&best), _) => Some(best),
                (None, None) => None,
                (None, Some((slices, seed))) => {
                    let single = Config::classes(&[points], 2, &LabelSubsets::Every);
                    progress.begin(&format!("{} alone", console::points(points)));
                    let single = make(single.with_seed(seed.wrapping_add(1)), slices, progress, None)?;
                    let best = distance_to_uniform(single.table.values())?;
                    alone.insert(points, best);
                    Some(best)
                }
            };
            let of_alone = best.map(|best| sliced_w2 / best);
            classes.push(ClassDistance { labels: labels.clone(), points, sliced_w2, of_alone });
        }
        Ok(Self { classes })
    }
}

impl Figures for Distances {
    fn words(&self, out: &mut dyn Write) -> io::Result<()> {
        for ClassDistance { labels, points, sliced_w2, of_alone } in &self.classes {
            let ratio = of_alone.map_or(String::new(), |ratio| format!(", {ratio:.2} of alone"));
            let points = console::points(*points);
            writeln!(out, "labels {labels:?}, {points}: sliced W2 {sliced_w2:.6}{ratio}")?;
        }
        if self.classes.iter().any(|class| class.of_alone.is_some_and(|ratio| ratio >= POOR)) {
            writeln!(out, "a class is twice as far from uniform as it should be: give more --slices")?;
        }
        Ok(())
    }
}

/// Sliced distance of points in the plane.
fn distance_to_uniform(points: &[f32]) -> Result<f64, MeasureError> {
    let points = Samples::points(points, 2)?;
    Ok(SlicedDistance::measure(points, &[0, 1], &Target::UniformCube, 256)?.w2)
}
