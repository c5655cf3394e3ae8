//! The figures as tables, and what they mean.

use fsot::metrics::Estimate;
use maud::{Markup, html};

use super::page::table;
use super::{Column, Report};
use crate::inspect::figures::{GroupFigures, LOW};

/// To three places, or to fewer of large numbers.
pub fn ratio(value: f64) -> String {
    match value.abs() {
        size if size.is_nan() => "–".into(),
        size if size >= 999.5 => format!("{value:.2e}"),
        size if size >= 99.95 => format!("{value:.0}"),
        size if size >= 9.9995 => format!("{value:.1}"),
        _ => format!("{value:.3}"),
    }
}

fn uncertainty(error: f64) -> String {
    if error < 0.0005 { "<0.001".into() } else { ratio(error) }
}

/// The three rings; small tiles lack some.
pub fn anisotropy(figures: &GroupFigures) -> Option<String> {
    let rings = figures.spectra.anisotropy().map(|ring| ring.along_y_over_along_x);
    rings.iter().all(|ring| ring.is_finite()).then(|| rings.map(ratio).join(", "))
}

/// A cell of the table.
enum Cell {
    Missing,
    Plain(String),
    /// With a bar, since it is an error.
    Ratio(f64, f64),
}

impl From<Estimate> for Cell {
    fn from(estimate: Estimate) -> Self {
        Self::Ratio(estimate.mean, estimate.standard_error)
    }
}

/// A line of the table: where it is explained, what it is called, and what tables have. White noise has 1.
struct Line {
    id: &'static str,
    name: String,
    is_part: bool,
    of: Box<dyn Fn(&GroupFigures) -> Cell>,
}

impl Line {
    fn new(id: &'static str, name: &str, of: impl Fn(&GroupFigures) -> Cell + 'static) -> Self {
        Self { id, name: name.into(), is_part: false, of: Box::new(of) }
    }

    /// The filtered error of a family.
    fn of_family(family: String) -> Self {
        let name = family.clone();
        let of = move |figures: &GroupFigures| {
            figures.errors.spatio_temporal.family(&family).map_or(Cell::Missing, Cell::from)
        };
        Self { is_part: true, ..Self::new("filtered-error", &name, of) }
    }
}

/// All lines of a dimension group.
fn lines(families: impl Iterator<Item = String>, animated: bool) -> Vec<Line> {
    let number = |value: Option<f64>| value.map_or(Cell::Missing, |value| Cell::Ratio(value, f64::NAN));
    let spread = |figures: &GroupFigures| {
        let is_known = figures.dims.len() <= 2 && figures.evenness.per_side > 1;
        is_known.then_some(figures.evenness.spread)
    };
    let errors = [
        Line::new("one-frame", "one frame, filtered in space", |of| of.errors.spatial.mean.into()),
        Line::new("one-pixel", "one pixel, not filtered", |of| of.errors.unfiltered.mean.into()),
        Line::new("bias", "bias of the table", |of| of.bias.table.mean.into()),
        Line::new("bias", "bias of a frame", |of| of.bias.frame.mean.into()),
        Line::new("discrepancy", "discrepancy of a frame", move |of| number(of.discrepancy)),
        Line::new("low", "power at low frequencies", move |of| number(of.low)),
        Line::new("direction", "power along y over x", |of| {
            anisotropy(of).map_or(Cell::Missing, Cell::Plain)
        }),
        Line::new("cells", "spread of cells", move |of| number(spread(of))),
    ];
    // Of a single frame these repeat what is said already.
    let is_said =
        |line: &Line| animated || !["one frame, filtered in space", "bias of a frame"].contains(&&*line.name);
    let filtered = Line::new("filtered-error", "filtered error", |of| of.errors.spatio_temporal.mean.into());
    let families = families.map(Line::of_family);
    std::iter::once(filtered).chain(families).chain(errors.into_iter().filter(is_said)).collect()
}

/// The table of all figures.
pub fn all(report: &Report) -> Markup {
    let mut groups: Vec<&[usize]> = Vec::new();
    for group in report.columns.iter().flat_map(|column| &column.groups) {
        if !groups.contains(&&*group.dims) {
            groups.push(&group.dims);
        }
    }
    let families = report.columns[0].shown().errors.unfiltered.families.iter();
    let lines = lines(families.map(|family| family.name.to_string()), report.is_animated());
    let find = |column: &Column, dims: &[usize]| column.groups.iter().position(|group| group.dims == dims);
    table(
        "figures of all tables",
        &html! {
            thead { tr {
                th scope="col" { "figure" }
                th.number scope="col" { "white noise" }
                @for column in &report.columns { th.number scope="col" { (column.label) } }
            } }
            @for dims in &groups { tbody {
                tr.group { th scope="rowgroup" colspan=(report.columns.len() + 2) { (title(dims)) } }
                @for line in &lines { tr.part[line.is_part] {
                    th scope="row" { a href={ "#" (line.id) } { (line.name) } }
                    td.number { "1" }
                    @for column in &report.columns {
                        (cell(&find(column, dims).map_or(Cell::Missing, |at| (line.of)(&column.groups[at]))))
                    }
                } }
            } }
            tbody {
                tr.group { th scope="rowgroup" colspan=(report.columns.len() + 2) { "all dimensions" } }
                tr {
                    th scope="row" { a href="#bound" { "bound" } }
                    td.number { "1" }
                    @for column in &report.columns {
                        (cell(&bound(column)))
                    }
                }
            }
        },
    )
}

fn bound(column: &Column) -> Cell {
    Cell::Ratio(column.bound.ratio_to_white_noise, column.bound.ratio_standard_error)
}

fn title(dims: &[usize]) -> String {
    match dims {
        [one] => format!("dimension {one}"),
        [a, b] => format!("dimensions {a} and {b}"),
        all => format!("dimensions {} to {} together", all[0], all[all.len() - 1]),
    }
}

fn cell(cell: &Cell) -> Markup {
    match cell {
        Cell::Missing => html! { td.number { "–" } },
        Cell::Plain(text) => html! { td.number { (text) } },
        Cell::Ratio(value, error) => html! {
            td.number.bar style=(format!("--share:{:.1}%", 100.0 * value.clamp(0.0, 1.0))) {
                (ratio(*value))
                // Also where there is none: values stay below each other.
                small.error { @if error.is_finite() { "± " (uncertainty(*error)) } }
            }
        },
    }
}

/// Density next to the faces.
pub fn faces(report: &Report) -> Markup {
    let of = report.columns.iter().flat_map(|column| {
        column.profiles.iter().enumerate().map(move |(dim, profile)| (&column.label, dim, &profile.marginal))
    });
    let all: Vec<_> = of.collect();
    let Some((_, _, first)) = all.first() else { return html! {} };
    table(
        "density next to the faces",
        &html! {
            caption { "Density next to the faces: samples within so much of 0 or 1. Even ones have 1, \
                       independent random ones 1 give or take ±" }
            thead { tr {
                th scope="col" { "table" } th.number scope="col" { "dimension" }
                @for face in first.faces { th.number scope="col" { "within " (face.within) } }
                th.number scope="col" { "values of 0" }
            } }
            tbody { @for (label, dim, marginal) in &all { tr {
                th scope="row" { (label) }
                td.number { (dim) }
                @for face in marginal.faces { td.number {
                    (format!("{:.2}", face.density))
                    small { " ± " (format!("{:.2}", face.standard_error)) }
                } }
                td.number { (marginal.zeros) }
            } } }
        },
    )
}

/// A name for links, the figure, and its convention.
pub fn meanings(report: &Report) -> Vec<(&'static str, &'static str, String)> {
    let effort = report.columns.iter().map(|column| column.inspection.effort);
    let list = |counts: Vec<usize>| {
        let words: Vec<String> = counts.iter().map(usize::to_string).collect();
        if words.windows(2).all(|pair| pair[0] == pair[1]) { words[0].clone() } else { words.join(", ") }
    };
    let integrands = list(effort.clone().map(|effort| effort.integrands).collect());
    let of_bias = list(effort.clone().map(|effort| effort.of_bias).collect());
    let some = effort.clone().any(|effort| effort.frames.is_some());
    let seed = report.columns[0].inspection.seed;
    let frames = if some { " Of long animations two frames are averaged." } else { "" };
    let mut meanings = vec![
        (
            "ratio",
            "ratio to white noise",
            "The figure, divided by what independent uniform random numbers \
            in a table of the same shape have in the mean (an exact expectation, not a draw): 1 is random, \
            0 is no error, and half is worth twice the samples."
                .into(),
        ),
        (
            "filter",
            "filter",
            "Weights of the pixels at a distance r, and of the past frames: perceptual:60 is the eye at 60 \
             frames per second, ema:0.1 temporal antialiasing that keeps nine tenths of its history."
                .into(),
        ),
        (
            "filtered-error",
            "filtered error",
            format!(
                "Squared error of the pixels after the filter in \
            space and time, averaged over pixels and over {integrands} random test functions of each \
            family (seed {seed}): edges of half-planes (half-space), smooth functions, discs (ball) and \
            boxes; families count alike.{frames} The filter wraps at the borders of the table, as the \
            table does."
            ),
        ),
        (
            "one-frame",
            "one frame",
            "The same with the filter in space alone: what is seen of a single \
            frame."
                .into(),
        ),
        (
            "one-pixel",
            "one pixel",
            "The same without any filter. With one sample per pixel no table that \
            fills the square evenly can be better than 1."
                .into(),
        ),
        (
            "bias",
            "bias",
            format!(
                "Squared error of the mean over all samples of the table (or of a frame), \
            with {of_bias} test functions of each family: what no filter takes away, compared with as many \
            random samples."
            ),
        ),
        (
            "discrepancy",
            "discrepancy",
            "Squared L2 star discrepancy of the samples of a frame: how \
            unevenly they fill boxes that begin at 0. Left out where comparing all pairs would take long."
                .into(),
        ),
        (
            "low",
            "power at low frequencies",
            format!(
                "Mean power of the error at up to {LOW} cycles per \
            pixel, without the mean itself."
            ),
        ),
        (
            "direction",
            "power along y over x",
            "Power of frequencies within 15° of the y axis over that \
            within 15° of the x axis, in rings from 0.15 to 0.25, 0.25 to 0.35 and 0.35 to 0.5 cycles per \
            pixel: 1 where no direction is preferred."
                .into(),
        ),
        (
            "cells",
            "spread of cells",
            "χ² of the counts in equal cells of the square (or parts of the \
            interval) per degree of freedom: 1 is random, 0 is the same count in each."
                .into(),
        ),
        (
            "bound",
            "bound",
            "What the optimiser minimises: the mean 1-Wasserstein distance between the \
                            samples that a filter holds, projected on random directions, and uniform ones. \
                            It bounds the filtered error of every function."
                .into(),
        ),
    ];
    if !report.is_animated() {
        meanings.retain(|(id, _, _)| *id != "one-frame");
    }
    meanings
}
