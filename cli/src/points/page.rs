//! How points are drawn.

use crate::draw::page::Page;
use crate::draw::raster::Color;

/// A point and its ink.
pub type Dot<'a> = (&'a [f32], [u8; 3]);

/// Where there is only one ink.
pub const BLACK: [u8; 3] = [20, 20, 24];

const MARGIN: usize = 20;

/// Pixels of a stippling's longer side.
pub const LONGER_SIDE: usize = 1400;

/// Squares of so many pixels side by side, each with the radius of its dots.
pub fn squares(side: usize, panels: Vec<(f64, Vec<Dot>)>) -> Color {
    let mut page = Page::new(MARGIN + panels.len() * (side + MARGIN), side + 2 * MARGIN);
    for (panel, (radius, dots)) in panels.into_iter().enumerate() {
        page.scatter([MARGIN + panel * (side + MARGIN), MARGIN], [side, side], radius, dots);
    }
    page.picture
}

/// Pixels of a sheet for a picture of so many columns and rows.
pub fn sheet_size(picture: [usize; 2]) -> [usize; 2] {
    let longer = picture[0].max(picture[1]);
    picture.map(|len| (LONGER_SIDE * len / longer).max(1))
}

/// One sheet of so many pixels.
pub fn sheet<'a>(size: [usize; 2], radius: f64, dots: impl Iterator<Item = Dot<'a>>) -> Color {
    let mut page = Page::new(size[0] + 2 * MARGIN, size[1] + 2 * MARGIN);
    page.scatter([MARGIN; 2], size, radius, dots);
    page.picture
}
