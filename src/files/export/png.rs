//! PNG: one to four dimensions as grey, grey and alpha, RGB or RGBA, of 8 or 16 bits.
//!
//! Frames of a part lie one below the other. No chunk says what colour the numbers are (`gAMA`, `sRGB`,
//! `cICP`, `iCCP`): they are none, and a reader that heeds such chunks would change them. Alpha is not
//! multiplied into the others; whoever loads the file must not do that either.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder, Filter};

use super::encode::Encoded;
use super::options::Depth;
use super::parts::Part;

/// Writes the picture.
pub(super) fn write(out: &mut impl Write, values: &Encoded, part: &Part) -> io::Result<()> {
    let [frames, height, width, _, dims] = part.shape(values.extent());
    let mut encoder = Encoder::new(out, width as u32, (frames * height) as u32);
    encoder.set_color(
        [ColorType::Grayscale, ColorType::GrayscaleAlpha, ColorType::Rgb, ColorType::Rgba][dims - 1],
    );
    encoder.set_depth(if values.depth == Depth::U8 { BitDepth::Eight } else { BitDepth::Sixteen });
    // Neighbours have as little in common as can be: every filter and every packing would make it larger, by
    // up to 40 %. The filter comes second, because the other sets one too.
    encoder.set_compression(Compression::NoCompression);
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header().map_err(io::Error::from)?;
    let mut stream = writer.stream_writer().map_err(io::Error::from)?;
    let mut row = Vec::with_capacity(width * dims * values.depth.bytes());
    for frame in part.frames.clone() {
        for y in 0..height {
            row.clear();
            values.extend_big(&mut row, part.row(values.extent(), values.dims(), frame, y));
            stream.write_all(&row)?;
        }
    }
    stream.finish().map_err(io::Error::from)?;
    writer.finish().map_err(io::Error::from)
}
