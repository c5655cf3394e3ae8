//! The pictures alone, for papers: a row of white noise and one of each table, without words.

use super::Report;
use super::panels::{Dots, Panels};
use crate::draw::page::Page;
use crate::draw::raster::Grey;

/// Pixels of a cell's side.
const SIDE: usize = 256;
const GAP: usize = 12;
const INK: [u8; 3] = [20; 3];

/// The sheet.
pub fn picture(report: &Report) -> Grey {
    let rows: Vec<&Panels> =
        std::iter::once(&report.white).chain(report.columns.iter().map(|column| &column.panels)).collect();
    let is_animated = rows.iter().any(|panels| panels.xt.is_some());
    let columns = if is_animated { 7 } else { 6 };
    let at = |index: usize| GAP + index * (SIDE + GAP);
    let mut page = Page::new(at(columns), at(rows.len()));
    for (row, panels) in rows.into_iter().enumerate() {
        let Panels { texture, block, frame, edge, xy, xt, .. } = panels;
        grey(&mut page, [at(0), at(row)], texture);
        dots(&mut page, [at(1), at(row)], block);
        dots(&mut page, [at(2), at(row)], frame);
        let pictures = [&edge.before, &edge.after, xy].into_iter().chain(xt.as_ref());
        for (column, picture) in pictures.enumerate() {
            grey(&mut page, [at(3 + column), at(row)], picture);
        }
    }
    of_page(&page)
}

/// What may stand in a row.
pub enum Cell {
    Grey(Grey),
    Dots(Dots),
}

impl Cell {
    /// It alone; points as large as they are in a row.
    pub fn picture(self) -> Grey {
        match self {
            Self::Grey(picture) => picture,
            Self::Dots(points) => {
                let mut page = Page::new(SIDE + 2, SIDE + 2);
                dots(&mut page, [1, 1], &points);
                of_page(&page)
            }
        }
    }
}

/// One row.
pub fn row<'a>(cells: impl ExactSizeIterator<Item = &'a Cell>) -> Grey {
    let at = |index: usize| GAP + index * (SIDE + GAP);
    let mut page = Page::new(at(cells.len()), at(1));
    for (column, cell) in cells.enumerate() {
        match cell {
            Cell::Grey(picture) => grey(&mut page, [at(column), GAP], picture),
            Cell::Dots(points) => dots(&mut page, [at(column), GAP], points),
        }
    }
    of_page(&page)
}

/// Paper, ink and frames are grey.
fn of_page(page: &Page) -> Grey {
    let [width, height] = [page.picture.width(), page.picture.height()];
    Grey::from_fn(width, height, |x, y| [page.picture.pixels()[y * width + x][0]])
}

/// In the middle of its cell, enlarged by a whole number.
fn grey(page: &mut Page, [left, top]: [usize; 2], picture: &Grey) {
    let [width, height] = [picture.width(), picture.height()];
    let zoom = (SIDE / width.max(height)).max(1);
    let [left, top] = [(left, width), (top, height)].map(|(at, side)| at + (SIDE - side * zoom) / 2);
    for (i, &[level]) in picture.pixels().iter().enumerate() {
        for (x, y) in (0..zoom * zoom).map(|k| (i % width * zoom + k % zoom, i / width * zoom + k / zoom)) {
            if let Some(pixel) = page.picture.pixel_mut(left + x, top + y) {
                *pixel = [level; 3];
            }
        }
    }
}

fn dots(page: &mut Page, corner: [usize; 2], dots: &Dots) {
    let radius = if dots.points.len() <= 256 { 2.5 } else { 1.0 };
    let points: Vec<[f32; 2]> = dots.points.iter().map(|[x, y]| [*x as f32, 1.0 - *y as f32]).collect();
    page.scatter(corner, [SIDE; 2], radius, points.iter().map(|point| (&point[..], INK)));
}
