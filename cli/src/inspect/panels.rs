//! One panel of the page: a captioned square with a picture, dots, curves or text.

use fsot::metrics::RadialBin;
use ndarray::Array2;

use super::integrand::LARGEST_SIDE;
use crate::draw::canvas::{Canvas, LETTER, LINE, MARGIN, grey};

/// Side of a panel's square.
pub const SIDE: usize = LARGEST_SIDE;
/// Height of a panel with its captions.
pub const HEIGHT: usize = 2 * LINE + SIDE + MARGIN;

const FRAME: u8 = 90;
const FIELD: u8 = 12;

/// What a panel shows under its two captions.
pub struct Panel {
    pub captions: [String; 2],
    pub content: Content,
}

pub enum Content {
    /// Grey levels, row by row; stretched to fill the square, or enlarged as they are.
    Picture { columns: usize, levels: Vec<u8>, stretch: bool },
    /// Points of the unit square, the second coordinate upwards.
    Dots { points: Vec<[f64; 2]>, size: usize },
    /// Power over frequency; a panel of double width.
    Curves(Curves),
    /// Lines of text.
    Text(Vec<String>),
}

pub struct Curves {
    pub table: Vec<RadialBin>,
    pub white: Vec<RadialBin>,
    /// Where the spatial filter halves the power, in cycles per pixel.
    pub half_power: f64,
}

impl Panel {
    pub fn new(captions: [&str; 2], content: Content) -> Self {
        Self { captions: captions.map(String::from), content }
    }

    pub fn width(&self) -> usize {
        if matches!(self.content, Content::Curves(_)) { 2 * SIDE + MARGIN } else { SIDE }
    }

    pub fn draw(&self, canvas: &mut Canvas, [x, y]: [usize; 2]) {
        let width = self.width();
        for (line, caption) in self.captions.iter().enumerate() {
            canvas.write([x, y + line * LINE], caption, width);
        }
        let y = y + 2 * LINE;
        match &self.content {
            Content::Picture { columns, levels, stretch } => {
                let rows = levels.len() / columns;
                if *stretch {
                    let nearest =
                        |i: usize| levels[i / SIDE * rows / SIDE * columns + i % SIDE * columns / SIDE];
                    let filled: Vec<u8> = (0..SIDE * SIDE).map(nearest).collect();
                    canvas.picture([x, y], SIDE, [1; 2], &filled);
                } else {
                    let zoom = (SIDE / rows.max(*columns)).max(1);
                    canvas.picture([x, y], *columns, [zoom; 2], levels);
                }
            }
            Content::Dots { points, size } => {
                framed(canvas, [x, y], [SIDE; 2]);
                let at = |u: f64| (u * (SIDE - size) as f64) as usize;
                for [u, v] in points {
                    canvas.block([x + at(*u), y + at(1.0 - v)], [*size; 2], 235);
                }
            }
            Content::Curves(curves) => curves.draw(canvas, [x, y]),
            Content::Text(lines) => {
                for (line, text) in lines.iter().enumerate() {
                    canvas.write([x, y + line * LINE], text, width);
                }
            }
        }
    }
}

/// Values that are black at 0 and white at 2, over all frequencies of either axis; what is larger than a
/// panel is averaged.
pub fn spectrum(values: &Array2<f64>) -> Content {
    let (height, width) = values.dim();
    let [down, across] = [height, width].map(|side| side.div_ceil(SIDE));
    let (rows, columns) = (height.div_ceil(down), width.div_ceil(across));
    let mean = |row: usize, column: usize| {
        let cells = (row * down..((row + 1) * down).min(height))
            .flat_map(|y| (column * across..((column + 1) * across).min(width)).map(move |x| [y, x]));
        let (sum, count) = cells.fold((0.0, 0.0), |(sum, count), at| (sum + values[at], count + 1.0));
        sum / count
    };
    let levels = (0..rows * columns).map(|i| grey(0.5 * mean(i / columns, i % columns))).collect();
    Content::Picture { columns, levels, stretch: true }
}

/// An empty field with a frame around it.
fn framed(canvas: &mut Canvas, [x, y]: [usize; 2], [width, height]: [usize; 2]) {
    canvas.block([x, y], [width, height], FRAME);
    canvas.block([x + 1, y + 1], [width - 2, height - 2], FIELD);
}

impl Curves {
    /// The largest frequency and the largest power of the plot.
    const ENDS: [f64; 2] = [0.5, 2.0];

    fn draw(&self, canvas: &mut Canvas, [x, y]: [usize; 2]) {
        let left = x + 2 * LETTER;
        let [width, height] = [x + 2 * SIDE + MARGIN - left, SIDE - LINE];
        framed(canvas, [left, y], [width, height]);
        let column = |frequency: f64| left + (frequency / Self::ENDS[0] * (width - 4) as f64) as usize;
        let row =
            |power: f64| y + ((1.0 - power / Self::ENDS[1]).clamp(0.0, 1.0) * (height - 4) as f64) as usize;
        for power in [0.0, 1.0, 2.0] {
            let middle = row(power).saturating_sub(LETTER / 2).clamp(y, y + height - LETTER);
            canvas.write([x, middle], &format!("{power:.0}"), LETTER);
        }
        for tenth in 0..5_u32 {
            let frequency = 0.1 * f64::from(tenth);
            let at = column(frequency);
            canvas.write([at, y + height + 6], &format!("{frequency:.1}"), 3 * LETTER);
            canvas.block([at, y + height - 8], [2, 8], FRAME);
        }
        for dash in (left..left + width).step_by(12) {
            canvas.block([dash, row(1.0)], [6, 2], 150);
        }
        if self.half_power < Self::ENDS[0] {
            for dash in (y..y + height).step_by(12) {
                canvas.block([column(self.half_power), dash], [2, 6], 150);
            }
        }
        for (bins, level, thickness) in [(&self.white, 130, 2), (&self.table, 255, 4)] {
            let inside = bins.iter().filter(|bin| bin.frequency <= Self::ENDS[0]);
            let points: Vec<[usize; 2]> = inside.map(|bin| [column(bin.frequency), row(bin.power)]).collect();
            for pair in points.windows(2) {
                line(canvas, pair[0], pair[1], thickness, level);
            }
            // A tile of two pixels has a single ring.
            if let [point] = points[..] {
                canvas.block(point, [2 * thickness; 2], level);
            }
        }
    }
}

/// A straight line, drawn in steps of a pixel.
fn line(canvas: &mut Canvas, from: [usize; 2], to: [usize; 2], thickness: usize, level: u8) {
    let steps = from[0].abs_diff(to[0]).max(from[1].abs_diff(to[1])).max(1);
    for step in 0..=steps {
        let at = |axis: usize| (from[axis] * (steps - step) + to[axis] * step) / steps;
        canvas.block([at(0), at(1)], [thickness; 2], level);
    }
}
