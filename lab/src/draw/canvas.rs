//! A dark page to draw on: grey pictures, blocks and lines of text in a tiny bitmap font.

use font8x8::{BASIC_FONTS, UnicodeFonts};
use fsot_cli::draw::raster::Grey;

/// Glyphs have 8 × 8 pixels and are drawn at this scale.
const TEXT: usize = 2;
/// Width of a letter.
pub const LETTER: usize = 8 * TEXT;
/// Height of a line of text.
pub const LINE: usize = 8 * TEXT + 6;
/// Between what stands side by side.
pub const MARGIN: usize = 12;
const INK: u8 = 235;
const PAPER: u8 = 24;

/// The page.
#[derive(Clone, Debug)]
pub struct Canvas {
    picture: Grey,
}

impl Canvas {
    /// An empty page of so many pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self { picture: Grey::filled(width, height, [PAPER]) }
    }

    /// A rectangle of one level; what lies outside the page is left out.
    pub fn block(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], level: u8) {
        for row in y..y + height {
            for column in x..x + width {
                if let Some(pixel) = self.picture.pixel_mut(column, row) {
                    *pixel = [level];
                }
            }
        }
    }

    /// A picture of so many columns, each of its pixels enlarged to a block.
    pub fn picture(&mut self, [x, y]: [usize; 2], columns: usize, zoom: [usize; 2], levels: &[u8]) {
        for (i, &level) in levels.iter().enumerate() {
            self.block([x + i % columns * zoom[0], y + i / columns * zoom[1]], zoom, level);
        }
    }

    /// One line of text; what does not fit into `room` pixels ends in `..`.
    pub fn write(&mut self, [x, y]: [usize; 2], text: &str, room: usize) {
        let fits = room / LETTER;
        let mut text: Vec<char> = text.chars().collect();
        if text.len() > fits {
            text.truncate(fits.saturating_sub(2));
            text.extend(['.', '.']);
        }
        for (at, c) in text.into_iter().enumerate() {
            let glyph = BASIC_FONTS.get(c).or_else(|| BASIC_FONTS.get('?')).unwrap_or_default();
            for (row, bits) in glyph.into_iter().enumerate() {
                for column in (0..8).filter(|column| bits >> column & 1 == 1) {
                    self.block([x + (8 * at + column) * TEXT, y + row * TEXT], [TEXT; 2], INK);
                }
            }
        }
    }

    /// The page as a picture.
    pub fn into_picture(self) -> Grey {
        self.picture
    }
}
