//! PNG: 1 to 16 bits, grey, colours or a palette, with or without alpha.

use std::io::{self, BufRead, Seek};
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Transformations};

use super::{Picture, check_size, transfer};
use crate::error::PictureError;

/// The first bytes of any PNG file.
pub(super) const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// For what is not the pixels themselves, such as profiles.
const MOST_BYTES: usize = 64 << 20;

pub(super) fn read(file: impl BufRead + Seek, path: &Path) -> Result<Picture, PictureError> {
    let refused = |source: DecodingError| PictureError::Png { path: path.into(), source };
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MOST_BYTES });
    decoder.set_ignore_text_chunk(true);
    // Palettes to colours, `tRNS` to alpha, fewer bits than 8 to 8.
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(refused)?;
    let [width, height] = [header.width as usize, header.height as usize];
    check_size(path, [width, height])?;
    let mut reader = decoder.read_info().map_err(refused)?;
    // The decoder does not look, and would read beyond the end.
    if reader.info().palette.as_ref().is_some_and(|palette| !palette.len().is_multiple_of(3)) {
        let cut = io::Error::new(io::ErrorKind::InvalidData, "its palette ends within a colour");
        return Err(refused(DecodingError::IoError(cut)));
    }
    let (color, depth) = reader.output_color_type();
    let Some(length) = reader.output_buffer_size() else {
        return Err(refused(DecodingError::LimitsExceeded));
    };
    let mut bytes = vec![0; length];
    reader.next_frame(&mut bytes).map_err(refused)?;

    let light = light(reader.info());
    let pixels = match depth {
        BitDepth::Sixteen => {
            let samples: Vec<u16> =
                bytes.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect();
            pixels(&samples, color, u16::MAX, light)
        }
        _ => pixels(&bytes, color, u8::MAX, light),
    };
    Picture::new(width, height, pixels)
        .map_err(|problem| PictureError::Density { path: path.into(), problem })
}

/// What the file says about its colours.
fn light(_: &Info) -> impl Fn(f32) -> f32 {
    transfer::srgb
}

/// Red, green, blue and alpha of samples up to `most`.
fn pixels<S: Copy + Into<u16>>(
    samples: &[S],
    color: ColorType,
    most: S,
    light: impl Fn(f32) -> f32,
) -> Vec<[f32; 4]> {
    let is_grey = color.samples() < 3;
    let unit = f32::from(most.into());
    // Grey is multiplied and colours are divided, which differs in the last bit: so did the crate `image`,
    // which read files before, and a seed promises its points.
    let share = |sample: u16| match is_grey {
        true => f32::from(sample) * unit.recip(),
        false => f32::from(sample) / unit,
    };
    let lights: Vec<f32> = (0..=most.into()).map(|sample| light(share(sample))).collect();
    let light = |sample: S| lights[usize::from(sample.into())];
    let alpha = |sample: S| share(sample.into());
    let pixel = |samples: &[S]| match *samples {
        [grey] => [light(grey), light(grey), light(grey), 1.0],
        [grey, cover] => [light(grey), light(grey), light(grey), alpha(cover)],
        [red, green, blue, cover] => [light(red), light(green), light(blue), alpha(cover)],
        _ => [light(samples[0]), light(samples[1]), light(samples[2]), 1.0],
    };
    samples.chunks_exact(color.samples()).map(pixel).collect()
}
