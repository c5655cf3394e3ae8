//! KTX 2.0 as numbers: uncompressed textures of 1 to 4 channels, arrays and volumes of them.

use ktx2::Reader;

use super::Problem;
use super::source::{Source, reserved};
use crate::error::ImportError;
use crate::files::dtype::Dtype;
use crate::files::layout::Axis;

/// The first bytes of any file.
pub(super) const SIGNATURE: [u8; 8] = *b"\xabKTX 20\xbb";

/// Type and channels of a texel by its `VkFormat`; what is said of colours changes no number.
fn texel(format: u32) -> Option<(&'static str, usize)> {
    // UNORM, UINT and SRGB of 8 bits: 7 formats each, of which the BGR orders are left out.
    let of_bytes = |first: u32| matches!(format.checked_sub(first), Some(0 | 4 | 6));
    // UNORM, UINT and SFLOAT of 16 bits.
    let of_words = |first: u32| match format.checked_sub(first) {
        Some(0 | 4) => Some("<u2"),
        Some(6) => Some("<f2"),
        _ => None,
    };
    // UINT and SFLOAT of 32 bits.
    let of_floats = |first: u32| match format.checked_sub(first) {
        Some(0) => Some("<u4"),
        Some(2) => Some("<f4"),
        _ => None,
    };
    let bytes = [9, 16, 23, 37].into_iter().position(of_bytes).map(|at| ("|u1", at + 1));
    let found = |first: [u32; 4], of: &dyn Fn(u32) -> Option<&'static str>| {
        first.into_iter().zip(1..).find_map(|(first, channels)| Some((of(first)?, channels)))
    };
    bytes.or_else(|| found([70, 77, 84, 91], &of_words)).or_else(|| found([98, 101, 104, 107], &of_floats))
}

/// Reads the largest level: `[layer, y, x, channel]`.
pub(super) fn read(file: &[u8]) -> Result<Source, Problem> {
    let damaged = |reason: String| ImportError::Damaged { kind: "KTX 2 file", reason };
    let refused = |what: String| ImportError::Unsupported {
        kind: "KTX 2 file",
        what,
        advice: "write it with an uncompressed format of 8 or 16 bits or of floats, R, RG, RGB or RGBA",
    };
    let reader = Reader::new(file).map_err(|error| damaged(error.to_string()))?;
    let header = reader.header();
    if header.supercompression_scheme.is_some() {
        return Err(refused("is supercompressed".into()).into());
    }
    if header.face_count != 1 {
        return Err(refused(format!("has {} faces", header.face_count)).into());
    }
    let format = header.format.map_or(0, |format| format.value());
    let (dtype, channels) = texel(format)
        .ok_or_else(|| refused(format!("has texels of VkFormat {format}, which are not understood")))?;
    let dtype = Dtype::named(dtype).ok_or_else(|| refused("has unknown numbers".into()))?;
    let lengths = [header.layer_count, header.pixel_depth, header.pixel_height, header.pixel_width];
    let [layers, depth, height, width] = lengths.map(|length| length.max(1) as usize);
    let shape = [layers.saturating_mul(depth), height, width, channels];
    let count = shape.iter().fold(1_usize, |count, &length| count.saturating_mul(length));
    let level = reader.levels().next().map_or(&[][..], |level| level.data);
    if level.len() != count.saturating_mul(dtype.size) {
        return Err(
            damaged(format!("its texels take {} bytes of {}", level.len(), count * dtype.size)).into()
        );
    }
    let mut values = reserved(count)?;
    values.extend(level.chunks_exact(dtype.size).map(|bytes| dtype.decode(bytes)));
    let kept = kept(&reader, channels);
    if kept < channels {
        values = values.chunks_exact(channels).flat_map(|texel| &texel[..kept]).copied().collect();
    }
    let kind = if format_is_float(dtype) { "floats of" } else { "" };
    Ok(Source {
        values,
        shape: vec![shape[0], height, width, kept],
        fortran: false,
        dtype: Some(dtype),
        levels: None,
        descr: format!("KTX 2 of {kind} {} bits", 8 * dtype.size).replace("  ", " "),
        axes: vec![Axis::Frame, Axis::Y, Axis::X, Axis::Dim],
    })
}

fn format_is_float(dtype: Dtype) -> bool {
    dtype.kind == crate::files::dtype::Kind::Float
}

/// Channels before the first of those that a reader shall fill in itself: 3 of `rgb1`.
fn kept(reader: &Reader<&[u8]>, channels: usize) -> usize {
    let swizzle = reader.key_value_data().find(|(key, _)| *key == "KTXswizzle");
    let Some((_, swizzle)) = swizzle else { return channels };
    let constant = swizzle.iter().take(channels).position(|letter| b"01".contains(letter));
    constant.filter(|&at| at > 0 && swizzle[..at] == b"rgba"[..at]).unwrap_or(channels)
}
