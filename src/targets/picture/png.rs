//! PNG: 1 to 16 bits, grey, colours or a palette, with or without alpha, row by row.

use std::io::{self, BufRead, Seek};
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Reader, Transformations};

use super::canvas::{Canvas, Raster, check_size, reserve};
use super::exif::Orientation;
use super::levels::Levels;
use super::light::Light;
use super::options::PictureOptions;
use crate::error::PictureError;

/// The first bytes of any PNG file.
pub(super) const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// For what is not the pixels themselves, such as profiles.
const MOST_BYTES: usize = 64 << 20;

/// The passes of an interlaced file: their first column and row, and the steps between columns and rows.
const PASSES: [[usize; 4]; 7] =
    [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

pub(super) fn read<const N: usize>(
    file: impl BufRead + Seek,
    path: &Path,
    options: &PictureOptions,
    convert: impl Fn([f32; 4]) -> Result<[f32; N], f32>,
) -> Result<Raster<N>, PictureError> {
    let refused = |source: DecodingError| PictureError::Png { path: path.into(), source };
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MOST_BYTES });
    decoder.set_ignore_text_chunk(true);
    // Palettes to colours, `tRNS` to alpha, fewer bits than 8 to 8.
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(refused)?;
    let [width, height] = [header.width as usize, header.height as usize];
    check_size(path, [width, height], options)?;
    let mut reader = decoder.read_info().map_err(refused)?;
    // The decoder does not look, and would read beyond the end.
    if reader.info().palette.as_ref().is_some_and(|palette| !palette.len().is_multiple_of(3)) {
        let cut = io::Error::new(io::ErrorKind::InvalidData, "its palette ends within a colour");
        return Err(refused(DecodingError::IoError(cut)));
    }
    let (color, depth) = reader.output_color_type();
    let light = Light::of_png(reader.info(), options.transfer)
        .map_err(|what| PictureError::Encoding { path: path.into(), what })?;
    let mut canvas = Canvas::new(path, [width, height], aspect(reader.info()), options, convert)?;

    let light = Samples::new(&light, color, depth);
    let mut pixels = Vec::new();
    reserve(path, &mut pixels, width)?;
    let mut bytes = vec![0; reader.output_line_size(width as u32).unwrap_or(0)];
    let whole = [[0, 0, 1, 1]];
    let passes: &[_] = if reader.info().interlaced { &PASSES } else { &whole };
    for &[left, top, step, row_step] in passes {
        let columns = width.saturating_sub(left).div_ceil(step);
        if columns == 0 {
            continue;
        }
        for row in (top..height).step_by(row_step) {
            if reader.read_row(&mut bytes).map_err(refused)?.is_none() {
                return Err(refused(DecodingError::LimitsExceeded));
            }
            pixels.clear();
            light.extend(&mut pixels, &bytes[..columns * light.pixel_bytes]);
            canvas.put(row, [left, step], &pixels)?;
        }
    }
    // What follows the last row is checked too.
    reader.read_row(&mut bytes).map_err(refused)?;
    canvas.finish(orientation(&mut reader))
}

/// How many times as wide as they are high the pixels are.
fn aspect(info: &Info) -> f64 {
    match info.pixel_dims {
        Some(sides) if sides.xppu > 0 && sides.yppu > 0 => f64::from(sides.yppu) / f64::from(sides.xppu),
        _ => 1.0,
    }
}

/// Which way up, be it said before the pixels or after them. What is damaged there hurts no pixel.
fn orientation(reader: &mut Reader<impl BufRead + Seek>) -> Orientation {
    if reader.info().exif_metadata.is_none() {
        _ = reader.finish();
    }
    reader.info().exif_metadata.as_deref().map(Orientation::of_exif).unwrap_or_default()
}

/// From the bytes of a row to pixels.
struct Samples<'a> {
    levels: Levels<'a>,
    is_deep: bool,
    pixel_bytes: usize,
}

impl<'a> Samples<'a> {
    fn new(light: &'a Light, color: ColorType, depth: BitDepth) -> Self {
        let is_deep = depth == BitDepth::Sixteen;
        let most = if is_deep { u16::MAX } else { u8::MAX.into() };
        let pixel_bytes = color.samples() * if is_deep { 2 } else { 1 };
        Self { levels: Levels::new(light, color.samples(), most), is_deep, pixel_bytes }
    }

    /// Adds pixels: red, green and blue, multiplied by alpha, and alpha.
    fn extend(&self, pixels: &mut Vec<[f32; 4]>, bytes: &[u8]) {
        let level = |bytes: &[u8], at: usize| match self.is_deep {
            true => usize::from(u16::from_be_bytes([bytes[2 * at], bytes[2 * at + 1]])),
            false => usize::from(bytes[at]),
        };
        let pixel = |bytes: &[u8]| self.levels.pixel(|at| level(bytes, at));
        pixels.extend(bytes.chunks_exact(self.pixel_bytes).map(pixel));
    }
}
