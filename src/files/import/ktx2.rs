//! KTX 2.0 as numbers: uncompressed textures of 1 to 4 channels, arrays and volumes of them.

use super::Problem;
use super::source::{Source, reserved};
use crate::error::ImportError;
use crate::files::dtype::{Dtype, Kind};
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

/// A number of the header at this place, little-endian.
fn word<const BYTES: usize>(file: &[u8], at: usize) -> Option<u64> {
    let mut word = [0; 8];
    word[..BYTES].copy_from_slice(file.get(at..at.checked_add(BYTES)?)?);
    Some(u64::from_le_bytes(word))
}

/// So many bytes from this place on.
fn section(file: &[u8], from: u64, length: u64) -> Option<&[u8]> {
    let from = usize::try_from(from).ok()?;
    file.get(from..from.checked_add(usize::try_from(length).ok()?)?)
}

/// What of a file[^ktx] is needed to read its largest level.
///
/// Not by the crate `ktx2`, which panics over damaged descriptors.
///
/// [^ktx]: <https://registry.khronos.org/KTX/specs/2.0/ktxspec.v2.html>
struct Container<'a> {
    format: u64,
    /// Layers, depth, rows and columns; 0 where the texture has no such side.
    sides: [u64; 4],
    faces: u64,
    supercompression: u64,
    entries: &'a [u8],
    level: &'a [u8],
}

impl<'a> Container<'a> {
    fn of(file: &'a [u8]) -> Option<Self> {
        let word = |at: usize| word::<4>(file, at);
        let long = |at: usize| self::word::<8>(file, at);
        Some(Self {
            format: word(12)?,
            sides: [word(32)?, word(28)?, word(24)?, word(20)?],
            faces: word(36)?,
            supercompression: word(44)?,
            entries: section(file, word(56)?, word(60)?)?,
            level: section(file, long(80)?, long(88)?)?,
        })
    }

    /// The value of a key.
    fn value(&self, wanted: &str) -> Option<&'a [u8]> {
        let mut rest = self.entries;
        while let Some(length) = word::<4>(rest, 0) {
            let entry = section(rest, 4, length)?;
            let end = entry.iter().position(|&byte| byte == 0)?;
            if entry[..end] == *wanted.as_bytes() {
                return Some(&entry[end + 1..]);
            }
            rest = rest.get(4 + entry.len().next_multiple_of(4)..)?;
        }
        None
    }
}

/// Reads the largest level: `[layer, y, x, channel]`.
pub(super) fn read(file: &[u8]) -> Result<Source, Problem> {
    let damaged = |reason: String| ImportError::Damaged { kind: "KTX 2 file", reason };
    let refused = |what: String| ImportError::Unsupported {
        kind: "KTX 2 file",
        what,
        advice: "write it with an uncompressed format of 8 or 16 bits or of floats, R, RG, RGB or RGBA",
    };
    let file = Container::of(file).ok_or_else(|| damaged("it ends before its texels do".into()))?;
    if file.supercompression != 0 {
        return Err(refused("is supercompressed".into()).into());
    }
    if file.faces != 1 {
        return Err(refused(format!("has {} faces", file.faces)).into());
    }
    let (dtype, channels) = texel(file.format as u32)
        .and_then(|(name, channels)| Some((Dtype::named(name)?, channels)))
        .ok_or_else(|| {
            refused(format!("has texels of VkFormat {}, which are not understood", file.format))
        })?;
    let [layers, depth, height, width] = file.sides.map(|side| side.max(1) as usize);
    let shape = [layers.saturating_mul(depth), height, width, channels];
    let count = shape.iter().fold(1_usize, |count, &length| count.saturating_mul(length));
    let expected = count.saturating_mul(dtype.size);
    if file.level.len() != expected {
        return Err(damaged(format!("its texels take {} bytes of {expected}", file.level.len())).into());
    }
    let mut values = reserved(count)?;
    values.extend(file.level.chunks_exact(dtype.size).map(|bytes| dtype.decode(bytes)));
    let kept = kept(&file, channels);
    if kept < channels {
        values = values.chunks_exact(channels).flat_map(|texel| &texel[..kept]).copied().collect();
    }
    let floats = if dtype.kind == Kind::Float { "floats of " } else { "" };
    Ok(Source {
        values,
        shape: vec![shape[0], height, width, kept],
        fortran: false,
        dtype: Some(dtype),
        levels: None,
        descr: format!("KTX 2 of {floats}{} bits", 8 * dtype.size),
        axes: vec![Axis::Frame, Axis::Y, Axis::X, Axis::Dim],
    })
}

/// Channels before the first of those that a reader shall fill in itself: 3 of `rgb1`.
fn kept(file: &Container, channels: usize) -> usize {
    let Some(swizzle) = file.value("KTXswizzle") else { return channels };
    let constant = swizzle.iter().take(channels).position(|letter| b"01".contains(letter));
    constant.filter(|&at| at > 0 && swizzle[..at] == b"rgba"[..at]).unwrap_or(channels)
}
