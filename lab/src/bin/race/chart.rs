//! The plot: a panel per case and figure, time across, error up, both logarithmic.

use std::path::Path;

use fsot_cli::draw::chart::{Area, COLOURS, Frame, TEXT_PX, spread, write_text};
use fsot_lab::judge::Quality;
use fsot_lab::program;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::outcome::{Curve, Failure, Outcome, Point};

const PANEL: (u32, u32) = (460, 340);
/// Room for the labels of curves.
const RIGHT: f64 = 100.0;

/// A row of panels: its title, and how to get its figure.
type Row = (&'static str, fn(&Quality) -> f64);
const ROWS: [Row; 2] = [("filtered error", |quality| quality.filtered), ("bound", |quality| quality.bound)];

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
        PANEL,
        RIGHT,
        points().map(|point| point.seconds.log10()),
        // Below the curves there is room for their labels.
        points().map(|point| figure(&point.quality).log10()).chain([0.0]),
    );
    let title = format!("{}: {title} / white noise", outcome.case.name);
    frame.draw_axes(panel, &title, "time of the optimisation")?;
    let mut labels = Vec::new();
    // The last colour is that of the published loop.
    let (published, colours) = COLOURS.split_last().ok_or("there are no colours")?;
    let colours = colours.iter().cycle().take(outcome.ours.len()).chain([published]);
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
    spread(&mut labels, frame.lowest() - TEXT_PX / 2);
    for (x, y, label, colour) in labels {
        write_text(panel, label, (x, y), colour, (HPos::Left, VPos::Center))?;
    }
    Ok(())
}

fn place(frame: &Frame, Curve { points, .. }: &Curve, figure: fn(&Quality) -> f64) -> Vec<(i32, i32)> {
    let at = |Point { seconds, quality, .. }: &Point| frame.at(seconds.log10(), figure(quality).log10());
    points.iter().map(at).collect()
}
