//! Choices that the engine does not offer: what a sample moves towards, and how slices are drawn.
//!
//! A plain loop in `f64`: the barycentric descent with the default schedule on the slices of
//! [`Objective::draw`], one after the other.

use std::fmt::Write;

use fsot::config::{BELOW_ONE, Role};
use fsot::objective::Slice;
use fsot::targets::Projected;
use fsot::{Config, Extent, Objective, SampleTable};
use fsot_lab::judge::{Judge, Quality};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::case::{Case, Failure};

pub const TITLE: &str = "Targets and draws";

/// What the sample of rank `i` among `n` moves towards.
#[derive(Clone, Copy)]
enum Targets {
    /// The mean of the quantile function over `[i/n, (i+1)/n]`.
    CellMeans,
    /// The quantile at `(i + ½)/n`.
    MidQuantiles,
    /// Of so many times `n` random points of the target, by rank, the mean of as many.
    Random(usize),
}

/// How slices are drawn: what is independent from slice to slice.
#[derive(Clone, Copy)]
enum Draws {
    /// Nothing: classes by permutation, levels and angles in strata, sixteen directions per subset.
    Stratified,
    /// Directions.
    Directions,
    /// Classes and levels, of subsets with sixteen directions each.
    LabelSubsets,
    /// All of them: sixteen times as many subsets, with a direction each.
    Slices,
}

const VARIANTS: [(&str, Targets, Draws); 7] = [
    ("cell means, stratified (the defaults)", Targets::CellMeans, Draws::Stratified),
    ("mid-quantiles", Targets::MidQuantiles, Draws::Stratified),
    ("3n random points (as published)", Targets::Random(3), Draws::Stratified),
    ("n random points", Targets::Random(1), Draws::Stratified),
    ("independent directions", Targets::CellMeans, Draws::Directions),
    ("independent classes and levels", Targets::CellMeans, Draws::LabelSubsets),
    ("independent slices, each of its own subset (as published)", Targets::CellMeans, Draws::Slices),
];

/// Measures all variants, and writes them as a section.
pub fn section(case: &Case) -> Result<String, Failure> {
    let judge = Judge::new(case.extent, case.integrands, case.bound_slices)?;
    let mut text = String::new();
    writeln!(text, "\n## {TITLE}\n")?;
    writeln!(
        text,
        "A plain loop in `f64` on {}, {} slices per pixel, mean of {} seeds.\n",
        case.name, case.slices_per_class, case.seeds
    )?;
    writeln!(text, "| | filtered | bound | bias |\n|---|---|---|---|")?;
    for (name, targets, draws) in VARIANTS {
        let tables: Result<Vec<_>, Failure> = (0..case.seeds)
            .into_par_iter()
            .map(|seed| optimise(case.extent, seed, case.slices_per_class, targets, draws))
            .collect();
        let qualities = tables?.iter().map(|table| judge.judge(table)).collect::<Result<Vec<_>, _>>()?;
        let mean =
            |figure: fn(&Quality) -> f64| qualities.iter().map(figure).sum::<f64>() / case.seeds as f64;
        let [filtered, bound, bias] =
            [mean(|quality| quality.filtered), mean(|quality| quality.bound), mean(|quality| quality.bias)];
        writeln!(text, "| {name} | {filtered:.4} | {bound:.4} | {bias:.2} |")?;
        if !(bound < 1.0 && filtered < 1.0) {
            return Err(format!("{name} is no better than white noise: {qualities:?}").into());
        }
    }
    Ok(text)
}

fn optimise(
    extent: Extent,
    seed: u64,
    slices_per_class: u64,
    targets: Targets,
    draws: Draws,
) -> Result<SampleTable, Failure> {
    let mut config = Config::new(extent, 2).with_companions(false).with_seed(seed);
    config.terms.retain(|term| term.dims.len() == 2);
    let objective = Objective::new(&config)?;
    let mut points: Vec<f64> =
        SampleTable::white_noise(extent, 2, seed)?.values().iter().map(|&value| value.into()).collect();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    // A step has about as many slices as there are pixels and frames.
    for step in 0..slices_per_class {
        let progress = step as f64 / slices_per_class as f64;
        let mut slices = objective.draw(seed, step, Role::Descend);
        redraw(&mut slices, draws, extent, &mut random);
        let rate = 2.0 * config.descent.rate().at(progress);
        move_points(&objective, &slices, rate, targets, &mut random, &mut points);
        let slices = objective.draw(seed, step, Role::Balance);
        let rate = config.balance.at(progress);
        move_points(&objective, &slices, rate, Targets::CellMeans, &mut random, &mut points);
    }
    Ok(SampleTable::new(extent, 2, points.into_iter().map(|value| value as f32).collect())?)
}

/// Replaces a part of the slices' coordinates by independent ones.
fn redraw(slices: &mut [Slice], draws: Draws, extent: Extent, random: &mut Xoshiro256PlusPlus) {
    let subset = |random: &mut Xoshiro256PlusPlus| (random.random_range(0..extent.sites()), random.random());
    if let Draws::Directions | Draws::Slices = draws {
        for slice in slices.iter_mut() {
            let angle = std::f64::consts::PI * random.random::<f64>();
            slice.direction = vec![angle.cos(), angle.sin()];
        }
    }
    match draws {
        Draws::Stratified | Draws::Directions => {}
        Draws::Slices => {
            slices.iter_mut().for_each(|slice| (slice.member, slice.level) = subset(random));
        }
        Draws::LabelSubsets => {
            for slices in slices.chunk_by_mut(|a, b| (a.member, a.level) == (b.member, b.level)) {
                let (member, level) = subset(random);
                slices.iter_mut().for_each(|slice| (slice.member, slice.level) = (member, level));
            }
        }
    }
}

/// Moves every sample by `rate` times its mean displacement over the slices that hold it.
fn move_points(
    objective: &Objective,
    slices: &[Slice],
    rate: f64,
    targets: Targets,
    random: &mut Xoshiro256PlusPlus,
    points: &mut [f64],
) {
    let mut sums = vec![0.0; points.len()];
    let mut hits = vec![0.0; points.len() / 2];
    for slice in slices {
        let along = |sample: usize| {
            points[2 * sample] * slice.direction[0] + points[2 * sample + 1] * slice.direction[1]
        };
        let mut subset = subset(objective, slice);
        subset.sort_unstable_by(|&a, &b| along(a).total_cmp(&along(b)));
        let law =
            objective.terms().nth(slice.term).expect("the slice is drawn").target.project(&slice.direction);
        for (&sample, target) in subset.iter().zip(positions(&law, subset.len(), targets, random)) {
            let displacement = target - along(sample);
            sums[2 * sample] += displacement * slice.direction[0];
            sums[2 * sample + 1] += displacement * slice.direction[1];
            hits[sample] += 1.0;
        }
    }
    for ((point, sum), hits) in points.chunks_exact_mut(2).zip(sums.chunks_exact(2)).zip(hits) {
        for (value, sum) in point.iter_mut().zip(sum) {
            *value = (*value + rate * sum / f64::max(hits, 1.0)).clamp(0.0, BELOW_ONE.into());
        }
    }
}

/// The samples of a slice of a table with one frame and one sample per pixel.
fn subset(objective: &Objective, slice: &Slice) -> Vec<usize> {
    let extent = objective.extent();
    let centre = extent.site(slice.member);
    match objective.taps(slice.term) {
        None => (0..extent.sites()).collect(),
        Some(taps) => taps
            .iter()
            .take_while(|tap| tap.weight > slice.level)
            .map(|tap| {
                extent.site_index(extent.wrapped(centre, (tap.dt.into(), tap.dy.into(), tap.dx.into())))
            })
            .collect(),
    }
}

/// Where `n` samples should be along a direction, in rising order.
fn positions(law: &Projected, n: usize, targets: Targets, random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    match targets {
        Targets::CellMeans => law.cell_means(n).collect(),
        Targets::MidQuantiles => (0..n).map(|rank| law.quantile((rank as f64 + 0.5) / n as f64)).collect(),
        Targets::Random(each) => {
            let mut points: Vec<f64> = (0..each * n).map(|_| law.quantile(random.random())).collect();
            points.sort_unstable_by(f64::total_cmp);
            points.chunks_exact(each).map(|points| points.iter().sum::<f64>() / each as f64).collect()
        }
    }
}
