//! Contact sheets: what every sampler rendered, what is left after the filter, and the spectrum of its error.

use fsot::metrics::Spectra;
use fsot_cli::draw::canvas::{Canvas, LINE, MARGIN, grey};
use fsot_cli::draw::raster::Grey;
use fsot_lab::render::{Film, ImageFilter};
use ndarray::ArrayView3;

use crate::Failure;
use crate::contenders::Contender;
use crate::measure::Setting;

/// Least width of a picture on the sheet: room for every name.
const SIDE: usize = 352;
const COLUMNS: usize = 5;

/// One cell per sampler: the last frame, its filtered error, its spectrum.
pub fn draw(setting: &Setting, spp: u32, shown: &[(Contender, Film, f64)]) -> Result<Grey, Failure> {
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

    let reference = &setting.reference;
    let noisy = reference.mean.values().iter().zip(reference.variance.values()).filter(|pair| *pair.1 > 0.0);
    let mut bright: Vec<f64> = noisy.map(|pair| *pair.0).collect();
    bright.sort_by(f64::total_cmp);
    let exposure =
        0.9 / bright.get(bright.len().saturating_sub(1) * 99 / 100).copied().unwrap_or(1.0).max(1e-9);
    let filter = ImageFilter::gaussian(2.1)?;
    // The ends of the scale are three standard deviations of filtered white noise.
    let white = filter.apply_to_variance(&reference.variance)?;
    let mean = white.values().iter().sum::<f64>() / white.values().len() as f64;
    let three = 3.0 * (mean / f64::from(spp)).sqrt().max(1e-12);

    for (i, (contender, film, ratio)) in shown.iter().enumerate() {
        let (x, y) = (MARGIN + i % COLUMNS * step_x, 4 * LINE + MARGIN + i / COLUMNS * step_y);
        out.write([x, y], contender.name(), cell);
        out.write([x, y + LINE], &format!("{ratio:.3}"), cell);
        let error = setting.error(film)?;
        let filtered = filter.apply(&error)?;
        let rows: [Vec<u8>; 3] = [
            film.to_grey(last, exposure)?.samples().to_vec(),
            filtered.frame(last)?.iter().map(|error| grey(0.5 + 0.5 * error / three)).collect(),
            spectrum(&error, &reference.variance, spp)?.iter().map(|power| grey(power / 2.0)).collect(),
        ];
        for (row, levels) in rows.iter().enumerate() {
            out.picture([x, y + 2 * LINE + row * (height * zoom + gap)], width, [zoom; 2], levels);
        }
    }
    Ok(out.into_picture())
}

/// Power over spatial frequencies, 1 for white noise, calmed by a 3 × 3 box. Errors are first divided by
/// their standard deviation under white noise, with a hundredth of the mean variance added, else the noisiest
/// pixels are all that shows.
fn spectrum(error: &Film, variance: &Film, spp: u32) -> Result<Vec<f64>, Failure> {
    let variances = variance.values();
    let count = variances.len() as f64;
    let quiet = 0.01 * variances.iter().sum::<f64>() / count;
    let white = variances.iter().filter(|&&v| v > 0.0).map(|v| v / (v + quiet)).sum::<f64>() / count;
    let scaled =
        error.values().iter().zip(variances).map(|(error, v)| error * (f64::from(spp) / (v + quiet)).sqrt());
    let scaled: Vec<f64> = scaled.map(|value| if value.is_finite() { value } else { 0.0 }).collect();
    let [frames, height, width] = error.shape();
    let image = ArrayView3::from_shape((frames, height, width), &scaled)?;
    let power = Spectra::of_image(image, white.max(1e-12)).xy;
    let at = |y: usize, x: usize| power[[y % height, x % width]];
    let calmed = (0..height * width).map(|i| {
        let (y, x) = (i / width + height - 1, i % width + width - 1);
        let row = |y: usize| at(y, x) + at(y, x + 1) + at(y, x + 2);
        (row(y) + row(y + 1) + row(y + 2)) / 9.0
    });
    Ok(calmed.collect())
}
