//! The plot: a panel per case and figure, time across, error up, both logarithmic.

use std::path::Path;

use fsot_lab::judge::Quality;
use fsot_lab::program;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::outcome::{Curve, Failure, Outcome, Point};

const PANEL: (u32, u32) = (460, 340);
const FONT: &str = "sans-serif";
const TEXT_PX: i32 = 14;
const INK: RGBColor = RGBColor(60, 60, 60);
const GRID: RGBColor = RGBColor(225, 225, 225);
/// Okabe and Ito's colours, which colour-blind readers can tell apart; the published loop gets the last.
const COLOURS: [RGBColor; 5] = [
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
const PUBLISHED: RGBColor = RGBColor(213, 94, 0);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A row of panels: its title, and how to get its figure.
type Row = (&'static str, fn(&Quality) -> f64);
const ROWS: [Row; 2] = [("filtered error", |quality| quality.filtered), ("bound", |quality| quality.bound)];

/// Where data lie in a panel: from and to, as decimal logarithms.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    width: f64,
    height: f64,
}

const LEFT: f64 = 50.0;
const TOP: f64 = 34.0;
const RIGHT: f64 = 100.0; // room for the labels of curves
const BOTTOM: f64 = 44.0;

/// Draws all outcomes into an SVG file.
pub fn save(path: &Path, outcomes: &[Outcome]) -> Result<(), Failure> {
    let mut text = String::new();
    write(&mut text, outcomes)?;
    program::save(path, text.as_bytes())
}

fn write(text: &mut String, outcomes: &[Outcome]) -> Result<(), Failure> {
    let size = (PANEL.0 * outcomes.len() as u32, PANEL.1 * ROWS.len() as u32);
    let root = SVGBackend::with_string(text, size).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((ROWS.len(), outcomes.len()));
    for (index, panel) in panels.iter().enumerate() {
        draw(panel, &outcomes[index % outcomes.len()], ROWS[index / outcomes.len()])?;
    }
    root.present()?;
    Ok(())
}

fn draw(panel: &Area, outcome: &Outcome, (title, figure): Row) -> Result<(), Failure> {
    let points = || outcome.curves().flat_map(|curve| &curve.points);
    let frame = Frame::around(
        points().map(|point| point.seconds.log10()),
        points().map(|point| figure(&point.quality).log10()),
    );
    draw_axes(panel, &frame, &format!("{}: {title} / white noise", outcome.case.name))?;
    let mut labels = Vec::new();
    let colours = COLOURS.iter().cycle().take(outcome.ours.len()).chain([&PUBLISHED]);
    for (curve, colour) in outcome.curves().zip(colours) {
        let line = place(&frame, curve, figure);
        panel.draw(&PathElement::new(line.clone(), colour.stroke_width(2)))?;
        for &at in &line {
            panel.draw(&Circle::new(at, 3, colour.filled()))?;
        }
        if let Some(&(x, y)) = line.last() {
            labels.push((x + 8, y, curve.method, *colour));
        }
    }
    spread(&mut labels);
    for (x, y, label, colour) in labels {
        write_text(panel, label, (x, y), colour, (HPos::Left, VPos::Center))?;
    }
    Ok(())
}

fn place(frame: &Frame, Curve { points, .. }: &Curve, figure: fn(&Quality) -> f64) -> Vec<(i32, i32)> {
    let at = |Point { seconds, quality, .. }: &Point| frame.at(seconds.log10(), figure(quality).log10());
    points.iter().map(at).collect()
}

/// Moves labels that would overlap down, and those that would leave the frame up again.
fn spread(labels: &mut [(i32, i32, &str, RGBColor)]) {
    labels.sort_unstable_by_key(|&(_, y, ..)| y);
    let mut least = 0;
    for (_, y, ..) in labels.iter_mut() {
        *y = least.max(*y);
        least = *y + TEXT_PX;
    }
    let mut most = PANEL.1 as i32 - BOTTOM as i32 - TEXT_PX / 2;
    for (_, y, ..) in labels.iter_mut().rev() {
        *y = most.min(*y);
        most = *y - TEXT_PX;
    }
}

impl Frame {
    fn around(x: impl Iterator<Item = f64>, y: impl Iterator<Item = f64>) -> Self {
        Self {
            x: range(x),
            // Below the curves there is room for their labels.
            y: range(y.chain([0.0])),
            width: f64::from(PANEL.0) - LEFT - RIGHT,
            height: f64::from(PANEL.1) - TOP - BOTTOM,
        }
    }

    /// Pixel of a point, given by its logarithms.
    fn at(&self, x: f64, y: f64) -> (i32, i32) {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let across = LEFT + self.width * share(x, self.x);
        let down = TOP + self.height * (1.0 - share(y, self.y));
        (across.round() as i32, down.round() as i32)
    }
}

fn draw_axes(panel: &Area, frame: &Frame, title: &str) -> Result<(), Failure> {
    write_text(panel, title, (LEFT as i32, 16), BLACK, (HPos::Left, VPos::Center))?;
    let ([left, right], [bottom, top]) = (frame.x, frame.y);
    for value in ticks(frame.x, &[1.0]) {
        let (from, to) = (frame.at(value.log10(), bottom), frame.at(value.log10(), top));
        panel.draw(&PathElement::new(vec![from, to], GRID))?;
        write_text(panel, &seconds(value), (from.0, from.1 + 6), INK, (HPos::Center, VPos::Top))?;
    }
    for value in ticks(frame.y, &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]) {
        let (from, to) = (frame.at(left, value.log10()), frame.at(right, value.log10()));
        panel.draw(&PathElement::new(vec![from, to], GRID))?;
        write_text(
            panel,
            format!("{value:.3}").trim_end_matches('0').trim_end_matches('.'),
            (from.0 - 6, from.1),
            INK,
            (HPos::Right, VPos::Center),
        )?;
    }
    panel.draw(&PathElement::new(
        vec![frame.at(left, top), frame.at(left, bottom), frame.at(right, bottom)],
        INK,
    ))?;
    let middle = frame.at(0.5 * (left + right), bottom);
    write_text(panel, "time of the optimisation", (middle.0, middle.1 + 24), INK, (HPos::Center, VPos::Top))
}

/// The range of the values, and a little more.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let margin = 0.05 * (high - low) + 1e-3;
    [low - 2.0 * margin, high + margin]
}

/// The multiples of powers of ten inside a range of logarithms.
fn ticks([low, high]: [f64; 2], multiples: &[f64]) -> Vec<f64> {
    let decades = low.floor() as i32..=high.ceil() as i32;
    let all = decades.flat_map(|decade| multiples.iter().map(move |multiple| multiple * 10_f64.powi(decade)));
    all.filter(|value| (low..=high).contains(&value.log10())).collect()
}

fn seconds(value: f64) -> String {
    if value < 0.999 { format!("{:.0} ms", value * 1e3) } else { format!("{value:.0} s") }
}

fn write_text(
    panel: &Area,
    text: &str,
    at: (i32, i32),
    colour: RGBColor,
    (horizontal, vertical): (HPos, VPos),
) -> Result<(), Failure> {
    let style =
        TextStyle::from((FONT, TEXT_PX).into_font()).color(&colour).pos(Pos::new(horizontal, vertical));
    panel.draw(&Text::new(text.to_owned(), at, style))?;
    Ok(())
}
