//! Panels of curves in an SVG file: both axes logarithmic, a label for each curve.

use fsot::config::Short;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::Failure;

const FONT: &str = "sans-serif";
/// Height of the letters.
pub const TEXT_PX: i32 = 14;
const INK: RGBColor = RGBColor(60, 60, 60);
const GRID: RGBColor = RGBColor(225, 225, 225);
/// Okabe and Ito's colours, which colour-blind readers can tell apart.
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
];

/// Where a panel is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Where data lie in a panel: from and to, as decimal logarithms.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    width: f64,
    height: f64,
}

/// Room around the curves, on the right for their labels.
const LEFT: f64 = 62.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 44.0;

impl Frame {
    /// Around these logarithms, in a panel of this size of which the rightmost pixels are for labels.
    pub fn around(
        (width, height): (u32, u32),
        right: f64,
        x: impl Iterator<Item = f64>,
        y: impl Iterator<Item = f64>,
    ) -> Self {
        let (width, height) = (f64::from(width) - LEFT - right, f64::from(height) - TOP - BOTTOM);
        Self { x: range(x), y: range(y), width, height }
    }

    /// Pixel of a point, given by its logarithms.
    pub fn at(&self, x: f64, y: f64) -> (i32, i32) {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let across = LEFT + self.width * share(x, self.x);
        let down = TOP + self.height * (1.0 - share(y, self.y));
        (across.round() as i32, down.round() as i32)
    }

    /// The lowest pixel of a curve.
    pub fn lowest(&self) -> i32 {
        (TOP + self.height) as i32
    }

    /// The rightmost pixel of a curve.
    pub fn rightmost(&self) -> i32 {
        (LEFT + self.width) as i32
    }

    /// Draws a title, axes and a grid.
    ///
    /// # Errors
    /// The file cannot be drawn.
    pub fn draw_axes(&self, panel: &Area, title: &str, across: &str) -> Result<(), Failure> {
        write_text(panel, title, (LEFT as i32, 16), BLACK, (HPos::Left, VPos::Center))?;
        let ([left, right], [bottom, top]) = (self.x, self.y);
        for value in ticks(self.x) {
            let (from, to) = (self.at(value.log10(), bottom), self.at(value.log10(), top));
            panel.draw(&PathElement::new(vec![from, to], GRID))?;
            write_text(panel, &seconds(value), (from.0, from.1 + 6), INK, (HPos::Center, VPos::Top))?;
        }
        for value in ticks(self.y) {
            let (from, to) = (self.at(left, value.log10()), self.at(right, value.log10()));
            panel.draw(&PathElement::new(vec![from, to], GRID))?;
            let label = Short::from(value).to_string();
            write_text(panel, &label, (from.0 - 6, from.1), INK, (HPos::Right, VPos::Center))?;
        }
        let corner = vec![self.at(left, top), self.at(left, bottom), self.at(right, bottom)];
        panel.draw(&PathElement::new(corner, INK))?;
        let middle = self.at(0.5 * (left + right), bottom);
        write_text(panel, across, (middle.0, middle.1 + 24), INK, (HPos::Center, VPos::Top))
    }
}

/// The range of the values, and a little more.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let margin = 0.05 * (high - low) + 1e-3;
    [low - margin, high + margin]
}

/// Round numbers inside a range of logarithms: from two or three to a dozen of them.
fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let multiples: &[f64] = match high - low {
        2.5.. => &[1.0],
        1.0.. => &[1.0, 2.0, 5.0],
        0.6.. => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
        _ => return even_ticks(10_f64.powf(low), 10_f64.powf(high)),
    };
    let decades = low.floor() as i32..=high.ceil() as i32;
    let all = decades.flat_map(|decade| multiples.iter().map(move |multiple| multiple * 10_f64.powi(decade)));
    all.filter(|value| (low..=high).contains(&value.log10())).collect()
}

/// The same in even steps, where a range is too short for powers of ten.
fn even_ticks(low: f64, high: f64) -> Vec<f64> {
    let power = 10_f64.powf(((high - low) / 3.0).log10().floor());
    let fits = |step: &f64| (high - low) / step >= 3.0;
    let step = [5.0, 2.0, 1.0].map(|multiple| multiple * power).into_iter().find(fits).unwrap_or(power);
    let first = (low / step).ceil() as i64;
    (first..).map(|k| k as f64 * step).take_while(|value| *value <= high).collect()
}

/// A time as it is labelled.
fn seconds(value: f64) -> String {
    if value < 0.999 {
        format!("{} ms", Short::from(value * 1e3))
    } else {
        format!("{} s", Short::from(value))
    }
}

/// Moves labels that would overlap down, and those that would lie below `lowest` up again.
pub fn spread(labels: &mut [(i32, i32, &str, RGBColor)], lowest: i32) {
    labels.sort_by_key(|&(_, y, ..)| y);
    let mut least = 0;
    for (_, y, ..) in labels.iter_mut() {
        *y = least.max(*y);
        least = *y + TEXT_PX;
    }
    let mut most = lowest;
    for (_, y, ..) in labels.iter_mut().rev() {
        *y = most.min(*y);
        most = *y - TEXT_PX;
    }
}

/// Writes a line of text.
///
/// # Errors
/// The file cannot be drawn.
pub fn write_text(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_range_has_some_ticks() {
        for (low, high) in
            [(1e-9, 1e9), (0.001, 5.0), (0.02, 0.2), (0.1, 0.5), (0.0021, 0.0023), (1.0, 1.001)]
        {
            let ticks = ticks([f64::log10(low), f64::log10(high)]);
            assert!((2..20).contains(&ticks.len()), "{low} to {high}: {ticks:?}");
            assert!(ticks.iter().all(|tick| (low * 0.999..=high * 1.001).contains(tick)), "{ticks:?}");
        }
    }

    #[test]
    fn labels_stay_apart_and_above_the_axis() {
        let mut labels = [100, 104, 298, 299, 299].map(|y| (0, y, "", BLACK));
        spread(&mut labels, 300);
        let heights = labels.map(|(_, y, ..)| y);
        assert_eq!(heights, [100, 114, 272, 286, 300]);
    }
}
