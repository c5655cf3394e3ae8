//! A labelled contact sheet: grey pictures in a grid.

use fsot_cli::draw::raster::{Grey, grey};
use fsot_lab::draw::canvas::{Canvas, LETTER, LINE, MARGIN};
use fsot_lab::draw::srgb;

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
        let levels = values.iter().map(|value| srgb(value * exposure)).collect();
        Self { caption: caption.into(), content: Ok(levels) }
    }

    /// Grey levels in `[0, 1]` as they are to be shown; others are clamped.
    pub fn levels(caption: &str, values: impl Iterator<Item = f64>) -> Self {
        let levels = values.map(grey).collect();
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
