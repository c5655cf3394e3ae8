//! A labelled contact sheet: grey pictures in a grid.

use fsot_cli::draw::canvas::{Canvas, LETTER, LINE, MARGIN, grey};
use fsot_cli::draw::raster::Grey;
use fsot_lab::render::{Film, RenderError};
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

const ROWS: usize = 4;

/// One picture of a column.
pub struct Cell {
    caption: String,
    /// 8-bit grey, or lines of text instead.
    content: Result<Vec<u8>, Vec<String>>,
}

impl Cell {
    /// Linear luminance times an exposure, through the sRGB curve.
    pub fn linear(caption: &str, values: &[f64], exposure: f64) -> Self {
        let curve = |value: f64| {
            let value = (value * exposure).clamp(0.0, 1.0);
            if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
        };
        let shown: Vec<f64> = values.iter().map(|&value| curve(value)).collect();
        Self::levels(caption, &shown)
    }

    /// Grey levels in `[0, 1]` as they are to be shown; others are clamped.
    pub fn levels(caption: &str, values: &[f64]) -> Self {
        let levels = values.iter().map(|&value| grey(value)).collect();
        Self { caption: caption.into(), content: Ok(levels) }
    }

    /// Lines of text.
    pub fn blank(lines: &[&str]) -> Self {
        Self { caption: String::new(), content: Err(lines.iter().map(|&line| line.into()).collect()) }
    }
}

/// The sheet: columns of square pictures under a title.
pub struct Sheet {
    side: usize,
    zoom: usize,
    title: String,
    columns: Vec<(String, [String; 2], [Cell; ROWS])>,
}

impl Sheet {
    /// A sheet for pictures of `side` × `side` pixels, enlarged to at least 384.
    pub fn new(side: usize, title: &str) -> Self {
        Self { side, zoom: 384_usize.div_ceil(side), title: title.into(), columns: Vec::new() }
    }

    /// Adds a column with a heading of one or two lines and two notes.
    pub fn column(&mut self, heading: &str, notes: [&str; 2], cells: [Cell; ROWS]) {
        self.columns.push((heading.into(), notes.map(String::from), cells));
    }

    /// The finished picture.
    pub fn picture(&self) -> Grey {
        let cell = self.side * self.zoom;
        let (step_x, step_y) = (cell + MARGIN, cell + LINE + MARGIN);
        let top = MARGIN + 5 * LINE + 2 * MARGIN;
        let width = MARGIN + self.columns.len() * step_x;
        let mut out = Canvas::new(width, top + ROWS * step_y);
        out.write([MARGIN; 2], &self.title, width - MARGIN);
        for (column, (heading, notes, cells)) in self.columns.iter().enumerate() {
            let x = MARGIN + column * step_x;
            let letters: Vec<char> = heading.chars().collect();
            let (first, rest) = letters.split_at(letters.len().min(cell / LETTER));
            let lines = [first.iter().collect(), rest.iter().collect()].into_iter().chain(notes.clone());
            for (line, text) in lines.enumerate() {
                let text: &str = &text;
                out.write([x, 2 * MARGIN + (line + 1) * LINE], text, cell);
            }
            for (row, Cell { caption, content }) in cells.iter().enumerate() {
                let y = top + row * step_y;
                out.write([x, y], caption, cell);
                match content {
                    Err(lines) => {
                        for (line, text) in lines.iter().enumerate() {
                            out.write([x, y + (line + 1) * LINE], text, cell);
                        }
                    }
                    Ok(levels) => out.picture([x, y + LINE], self.side, [self.zoom; 2], levels),
                }
            }
        }
        out.into_picture()
    }
}

/// Power of the error over spatial frequencies, mean over frames, zero frequency in the middle; half of it is
/// shown, so white noise is mid-grey.
///
/// Errors are first divided by their standard deviation under white noise, else the brightest penumbra would
/// be all that shows. A hundredth of the mean variance is added, because one rare event in an otherwise quiet
/// pixel would be many such deviations. A 3 × 3 box calms the speckle of a single image.
pub fn spectrum(error: &Film, variance: &Film, spp: u32) -> Result<Vec<f64>, RenderError> {
    let [frames, height, width] = error.shape();
    let mut planner = FftPlanner::new();
    let (rows, columns) = (planner.plan_fft_forward(width), planner.plan_fft_forward(height));
    let mut power = vec![0.0; height * width];
    let variances = variance.values();
    let quiet = 0.01 * variances.iter().sum::<f64>() / variances.len() as f64;
    // White noise has this total power at every frequency.
    let white: f64 = variances.iter().filter(|&&v| v > 0.0).map(|v| v / (v + quiet)).sum::<f64>().max(1e-12);
    for frame in 0..frames {
        let pairs = error.frame(frame)?.iter().zip(variance.frame(frame)?);
        let normalised =
            pairs.map(|(&e, &v)| if v > 0.0 { e * (f64::from(spp) / (v + quiet)).sqrt() } else { 0.0 });
        let mut data: Vec<Complex<f64>> = normalised.map(|value| Complex::new(value, 0.0)).collect();
        rows.process(&mut data);
        let mut turned: Vec<Complex<f64>> =
            (0..height * width).map(|i| data[i % height * width + i / height]).collect();
        columns.process(&mut turned);
        for (i, value) in turned.iter().enumerate() {
            let (x, y) = (i / height, i % height);
            let at = (y + height / 2) % height * width + (x + width / 2) % width;
            power[at] += value.norm_sqr() / white;
        }
    }
    Ok(calmed(&power, height, width).into_iter().map(|power| power / 2.0).collect())
}

/// Mean over 3 × 3 neighbours; frequencies wrap.
fn calmed(power: &[f64], height: usize, width: usize) -> Vec<f64> {
    let at = |y: usize, x: usize| power[y % height * width + x % width];
    (0..height * width)
        .map(|i| {
            let (y, x) = (i / width + height, i % width + width);
            let rows = y - 1..=y + 1;
            rows.map(|y| at(y, x - 1) + at(y, x) + at(y, x + 1)).sum::<f64>() / 9.0
        })
        .collect()
}
