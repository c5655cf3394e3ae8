//! Contact sheets: what every sampler rendered, what is left after the filter, and the spectrum of its error.

use fsot_cli::draw::raster::{Grey, grey};
use fsot_lab::draw::canvas::{Canvas, LINE, MARGIN};
use fsot_lab::render::{Film, ImageFilter, Scales, error_spectrum};

use crate::Failure;
use crate::measure::Setting;

/// Least width of a picture on the sheet: room for every name.
const SIDE: usize = 352;
const COLUMNS: usize = 5;

/// What a sampler rendered.
pub struct Shown {
    pub name: &'static str,
    pub film: Film,
    /// Of its error to white noise.
    pub ratio: f64,
}

/// One cell per sampler: the last frame, its filtered error, its spectrum.
pub fn draw(setting: &Setting, spp: u32, shown: &[Shown]) -> Result<Grey, Failure> {
    let [height, width] = setting.resolution;
    let zoom = SIDE.div_ceil(width);
    let (cell, gap) = (width * zoom, MARGIN / 2);
    let (step_x, step_y) = (cell + MARGIN, 3 * (height * zoom + gap) + 2 * LINE + MARGIN);
    let columns = COLUMNS.min(shown.len());
    let page = MARGIN + columns * step_x;
    let mut out = Canvas::new(page, 4 * LINE + MARGIN + shown.len().div_ceil(COLUMNS) * step_y);
    let last = setting.scene.frames - 1;
    let after = if last > 0 { ", after the eye's filter in space and time" } else { "" };
    let title = format!("{}, {spp} spp; ratio of the error to white noise{after}", setting.scene.name);
    out.write([MARGIN, MARGIN], &title, page - MARGIN);
    let legend = [
        "rows: rendered (the last frame); its error after the filter in space, grey = none;",
        "spectrum of the error, middle = low frequency",
    ];
    for (line, text) in legend.into_iter().enumerate() {
        out.write([MARGIN, MARGIN + (line + 1) * LINE], text, page - MARGIN);
    }

    let filter = ImageFilter::gaussian(2.1)?;
    let reference = &setting.reference;
    let scales = Scales::new(reference, &filter, spp)?;
    for (i, Shown { name, film, ratio }) in shown.iter().enumerate() {
        let (x, y) = (MARGIN + i % COLUMNS * step_x, 4 * LINE + MARGIN + i / COLUMNS * step_y);
        out.write([x, y], name, cell);
        out.write([x, y + LINE], &format!("{ratio:.3}"), cell);
        let error = film.minus(&reference.mean)?;
        let filtered = filter.apply(&error)?;
        let rows: [Vec<u8>; 3] = [
            film.to_grey(last, scales.exposure())?.samples().to_vec(),
            filtered.frame(last)?.iter().map(|&error| grey(scales.error(error))).collect(),
            error_spectrum(&error, &reference.variance, spp).iter().map(|power| grey(power / 2.0)).collect(),
        ];
        for (row, levels) in rows.iter().enumerate() {
            out.picture([x, y + 2 * LINE + row * (height * zoom + gap)], width, [zoom; 2], levels);
        }
    }
    Ok(out.into_picture())
}
