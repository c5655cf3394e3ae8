//! Drawings of point sets, as the command draws them.

use std::io;

use fsot_cli::draw::raster::Color;
use fsot_cli::points::{self, PointSet};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::points::set_of;
use crate::work::left_alone;

/// A PNG of points: of each label and of all where these are few classes, of prefixes of a sequence, or of a
/// sheet.
#[pyfunction]
pub fn draw_points<'py>(
    py: Python<'py>,
    points: &Bound<'_, PyAny>,
    labels: Option<&Bound<'_, PyAny>>,
    kind: &str,
    aspect: f64,
) -> PyResult<Bound<'py, PyBytes>> {
    let set = set_of(points, labels)?;
    let inks: &'static [[u8; 3]] = match (labels.is_some(), kind) {
        (true, "color-stipple") => &points::PRINTERS_INKS,
        (true, _) => &points::CLASS_INKS,
        (false, _) => &[points::BLACK],
    };
    let kind = kind.to_owned();
    let work = move || -> io::Result<_> { draw(&Spot::all(&set, inks), &kind, aspect).to_png() };
    let png = left_alone(py, None, work)??;
    Ok(PyBytes::new(py, &png))
}

/// A point of the unit square.
struct Spot {
    at: [f32; 2],
    label: u32,
    ink: [u8; 3],
}

impl Spot {
    /// Of the first two coordinates; a line of points is drawn as a sequence, from the top.
    fn all(set: &PointSet, inks: &[[u8; 3]]) -> Vec<Self> {
        let count = set.count().min(SHOWN);
        let line = |index: usize| (index as f32 + 0.5) / count as f32;
        let dot = |(index, (point, label)): (usize, (&[f32], u32))| Self {
            at: [point[0], point.get(1).copied().unwrap_or_else(|| line(index))],
            label,
            ink: inks[label as usize % inks.len()],
        };
        set.iter().take(SHOWN).enumerate().map(dot).collect()
    }
}

/// Points that are drawn at most, and classes that are drawn side by side.
const SHOWN: usize = 1 << 20;
const PANELS: u32 = 5;

/// Pixels of a panel's side, and of a sheet's longer one.
const SIDE: usize = 300;
const SHEET: f64 = 720.0;

fn draw(dots: &[Spot], kind: &str, aspect: f64) -> Color {
    let classes = dots.iter().map(|dot| dot.label.saturating_add(1)).max().unwrap_or(0);
    match kind {
        "two-class" if (2..=PANELS).contains(&classes) => {
            let of = |class: u32| dots.iter().filter(move |dot| dot.label == class).collect();
            let each = (0..classes).map(|class| panel(of(class), 0.22));
            points::squares(SIDE, each.chain([panel(dots.iter().collect(), 0.22)]).collect())
        }
        "progressive" => {
            let prefix = |part: usize| dots.iter().take((dots.len() / part).max(1)).collect();
            points::squares(SIDE, [64, 16, 4, 1].map(|part| panel(prefix(part), 0.25)).into())
        }
        _ => {
            let sides = [aspect.min(1.0), aspect.recip().min(1.0)];
            let size = sides.map(|side| (SHEET * side).max(1.0) as usize);
            let each = (size[0] * size[1]) as f64 / dots.len().max(1) as f64;
            let radius = (0.35 * each.sqrt()).clamp(0.7, 6.0);
            points::sheet(size, radius, dots.iter().map(|dot| (dot.at.as_slice(), dot.ink)))
        }
    }
}

/// Dots of a radius that is this share of the distance between neighbours.
fn panel(dots: Vec<&Spot>, share: f64) -> (f64, Vec<points::Dot<'_>>) {
    let radius = (share * SIDE as f64 / (dots.len().max(1) as f64).sqrt()).clamp(0.7, 6.0);
    (radius, dots.into_iter().map(|dot| (dot.at.as_slice(), dot.ink)).collect())
}
