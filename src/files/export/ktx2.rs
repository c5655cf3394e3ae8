//! KTX 2.0[^ktx]: a 2-D texture, or an array of them with one layer per frame; linear, no mipmaps, no
//! supercompression.
//!
//! [^ktx]: <https://registry.khronos.org/KTX/specs/2.0/ktxspec.v2.html>

use std::io::{self, Write};

use super::encode::Encoded;
use super::options::Depth;
use super::parts::Part;

/// The first bytes of any file.
const IDENTIFIER: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// Bytes of the header, its index and the index of the single level.
const HEADER: usize = 80 + 24;

/// What the format of a texel is called[^vk], for 1, 2 and 4 channels.
///
/// [^vk]: <https://registry.khronos.org/vulkan/specs/latest/man/html/VkFormat.html>: `R8_UNORM`,
///     `R8G8_UNORM`, `R8G8B8A8_UNORM`, and so on.
fn vk_format(depth: Depth, channels: usize) -> u32 {
    let of_depth = match depth {
        Depth::U8 => [9, 16, 37],
        Depth::U16 => [70, 77, 91],
        Depth::Half => [76, 83, 97],
        Depth::F32 => [100, 103, 109],
    };
    of_depth[channels.ilog2() as usize]
}

/// Channels of a texture of so many dimensions: three take four, because hardly a graphics card reads three.
fn channels(dims: usize) -> usize {
    dims.next_power_of_two()
}

/// The last channel where dimensions do not fill them: 1, as opaque as can be.
fn one(depth: Depth) -> u32 {
    match depth {
        Depth::U8 => 0xff,
        Depth::U16 => 0xffff,
        Depth::Half => 0x3c00,
        Depth::F32 => 1.0_f32.to_bits(),
    }
}

/// Writes the texture: rows from the top, layer by layer.
pub(super) fn write(out: &mut impl Write, values: &Encoded, part: &Part) -> io::Result<()> {
    let [frames, height, width, _, dims] = part.shape(values.extent());
    let (depth, channels) = (values.depth, channels(dims));
    let descriptor = descriptor(depth, channels);
    let mut entries = entry("KTXorientation", "rd");
    // Sorted by key.
    if channels != dims {
        entries.extend(entry("KTXswizzle", "rgb1"));
    }
    entries.extend(entry("KTXwriter", concat!("fsot ", env!("CARGO_PKG_VERSION"))));
    let texel = channels * depth.bytes();
    let start = (HEADER + descriptor.len() + entries.len()).next_multiple_of(texel.max(4));
    let image = frames as u64 * (height * width * texel) as u64;

    out.write_all(&IDENTIFIER)?;
    let layers = if frames > 1 { frames } else { 0 };
    // Depth 0: two dimensions. One face, one level, no supercompression.
    let words = [vk_format(depth, channels), depth.bytes() as u32, width as u32, height as u32, 0];
    let words = words.into_iter().chain([layers as u32, 1, 1, 0]);
    let index = [HEADER, descriptor.len(), HEADER + descriptor.len(), entries.len()].map(|at| at as u32);
    for word in words.chain(index) {
        out.write_all(&word.to_le_bytes())?;
    }
    // No global data of supercompression; the level.
    for word in [0, 0, start as u64, image, image] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&descriptor)?;
    out.write_all(&entries)?;
    out.write_all(&vec![0; start - HEADER - descriptor.len() - entries.len()])?;
    let one = one(depth).to_le_bytes();
    let fill = &one[..if channels == dims { 0 } else { depth.bytes() }];
    values.write_texels(out, part, fill)
}

/// A pair of key and value, padded to whole words.
fn entry(key: &str, value: &str) -> Vec<u8> {
    let length = (key.len() + value.len() + 2) as u32;
    let mut bytes = length.to_le_bytes().to_vec();
    for text in [key, value] {
        bytes.extend_from_slice(text.as_bytes());
        bytes.push(0);
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

/// The Data Format Descriptor[^dfd]: one basic block, linear, with as many samples as channels.
///
/// [^dfd]: <https://registry.khronos.org/DataFormat/specs/1.4/dataformat.1.4.html>
fn descriptor(depth: Depth, channels: usize) -> Vec<u8> {
    let block = 24 + 16 * channels;
    let bits = 8 * depth.bytes();
    // Model RGBSDA, primaries BT.709, transfer linear, alpha straight.
    let mut words = vec![4 + block as u32, 0, 2 | (block as u32) << 16, 0x0001_0101, 0];
    words.extend([(channels * depth.bytes()) as u32, 0]);
    for channel in 0..channels {
        let is_float = depth.levels().is_none();
        let id = if channel == 3 { 15 } else { channel as u32 };
        // Qualifiers: float and signed.
        let kind = if is_float { id | 0xc0 } else { id };
        let [low, high] =
            if is_float { [(-1.0_f32).to_bits(), 1.0_f32.to_bits()] } else { [0, (1 << bits) - 1] };
        words.extend([(channel * bits) as u32 | ((bits - 1) as u32) << 16 | kind << 24, 0, low, high]);
    }
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}
