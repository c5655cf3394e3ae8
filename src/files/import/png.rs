//! PNG as numbers: levels as they are stored, whatever colour they are said to be.

use std::io::{BufRead, Seek};

use png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Transformations};

use super::Problem;
use super::source::{Source, reserved};
use crate::error::ImportError;
use crate::files::dtype::Dtype;
use crate::files::layout::PICTURE;

/// The first bytes of any file.
pub(super) const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// For what is not the pixels themselves, such as profiles.
const MOST_BYTES: usize = 64 << 20;

/// Bytes that a picture has for one of its file at most: as deflate packs, with bits of a palette that become
/// four bytes.
const MOST_PACKED: u64 = 1032 * 32;

/// Reads the picture: `[y, x, channel]`. A palette gives way to its colours, and transparent colours stay.
pub(super) fn read(file: impl BufRead + Seek, length: u64) -> Result<Source, Problem> {
    let damaged = |source: DecodingError| damaged(&source.to_string());
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MOST_BYTES });
    decoder.set_ignore_text_chunk(true);
    let header = decoder.read_header_info().map_err(damaged)?;
    let is_palette = header.color_type == ColorType::Indexed;
    decoder.set_transformations(if is_palette { Transformations::EXPAND } else { Transformations::IDENTITY });
    let mut reader = decoder.read_info().map_err(damaged)?;
    // The decoder does not look, and would read beyond the end.
    if reader.info().palette.as_ref().is_some_and(|palette| !palette.len().is_multiple_of(3)) {
        return Err(self::damaged("its palette ends within a colour").into());
    }
    let [width, height] = [reader.info().width as usize, reader.info().height as usize];
    let (color, depth) = reader.output_color_type();
    let channels = color.samples();
    let count = width.saturating_mul(height).saturating_mul(channels);
    let size = reader.output_buffer_size().unwrap_or(usize::MAX);
    // Nothing is asked for that the file cannot fill.
    if size as u64 > length.saturating_mul(MOST_PACKED) {
        let reason = format!("{width} x {height} pixels are more than its {length} bytes can hold");
        return Err(self::damaged(&reason).into());
    }
    let mut values = reserved(count)?;
    let mut bytes = reserved(size)?;
    bytes.resize(bytes.capacity(), 0_u8);
    let frame = reader.next_frame(&mut bytes).map_err(damaged)?;
    // What follows is checked too.
    reader.finish().map_err(damaged)?;
    for row in bytes.chunks_exact(frame.line_size).take(height) {
        let numbers = width * channels;
        match depth {
            BitDepth::Sixteen => values.extend(
                row.as_chunks().0.iter().map(|&bytes| f64::from(u16::from_be_bytes(bytes))).take(numbers),
            ),
            BitDepth::Eight => values.extend(row.iter().copied().map(f64::from).take(numbers)),
            _ => {
                let bits = depth as usize;
                let level = |at: usize| row[at * bits / 8] >> (8 - bits - at * bits % 8) & ((1 << bits) - 1);
                values.extend((0..numbers).map(level).map(f64::from));
            }
        }
    }
    let bits = depth as u32;
    Ok(Source {
        values,
        shape: vec![height, width, channels],
        fortran: false,
        dtype: Dtype::named(if bits == 16 { "<u2" } else { "|u1" }),
        levels: Some(1 << bits),
        descr: format!("PNG of {bits} bits"),
        axes: PICTURE.to_vec(),
    })
}

fn damaged(reason: &str) -> ImportError {
    ImportError::Damaged { kind: "PNG", reason: reason.into() }
}
