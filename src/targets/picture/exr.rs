//! EXR: floating point, linear, colours multiplied by alpha, block by block.

use std::collections::HashSet;
use std::io::{BufRead, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::error::Error;
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::*;

use super::canvas::{Canvas, Raster, check_size, reserve};
use super::exif::Orientation;
use super::layers::{Layer, Missing, choose};
use super::light::multiplied;
use super::options::{PictureOptions, Transfer};
use super::primaries::{ColorMatrix, Primaries};
use crate::error::PictureError;

/// The first bytes of any EXR file.
pub(super) const SIGNATURE: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Bytes that a block of pixels takes in a file at least: its offset, its place, its length.
const LEAST_BLOCK: u64 = 16;

/// Reads a file of `length` bytes.
pub(super) fn read<const N: usize>(
    mut file: impl BufRead + Seek,
    length: u64,
    path: &Path,
    options: &PictureOptions,
    convert: impl Fn([f32; 4]) -> std::result::Result<[f32; N], f32>,
) -> std::result::Result<Raster<N>, PictureError> {
    let refused = |source: Error| PictureError::Exr { path: path.into(), source };
    let invalid = |what: &'static str| refused(Error::Invalid(what.into()));
    // Once without checks, which refuse files for channels that they don't name.
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(refused)?;
    check_samples(&meta.headers).map_err(refused)?;
    file.rewind().map_err(|source| PictureError::Read { path: path.into(), source })?;
    let reader = exr::block::read(file, false).map_err(refused)?;
    let meta = reader.meta_data().clone();
    let layer = choose(&meta.headers, options.layer.as_deref()).map_err(|missing| {
        let path = path.into();
        match (missing, options.layer.clone()) {
            (Missing::Colors(found), _) => PictureError::Channels { path, found },
            (Missing::Layer(found), None) => PictureError::Layers { path, found },
            (Missing::Layer(found), Some(wanted)) => PictureError::NoLayer { path, wanted, found },
        }
    })?;
    let header = &meta.headers[layer.part];
    let window = header.shared_attributes.display_window;
    let size = [window.size.width(), window.size.height()];
    check_size(path, size, options)?;
    check_size(path, [header.layer_size.width(), header.layer_size.height()], options)?;
    let blocks = meta.headers.iter().fold(0, |sum: u64, part| sum.saturating_add(part.chunk_count as u64));
    if blocks.saturating_mul(LEAST_BLOCK) > length {
        return Err(invalid("the file is too short for its blocks"));
    }
    // What the decoder will take, for a block as it is packed and as it is.
    let bytes = block_bytes(header).ok_or_else(|| invalid("the tiles are too large"))?;
    reserve(path, &mut Vec::<u8>::new(), bytes.saturating_mul(2))?;

    let aspect = f64::from(header.shared_attributes.pixel_aspect);
    let mut canvas = Canvas::new(path, size, aspect, options, convert)?;
    let mut rows = Rows::new(header, &layer, matrix(header, path, options)?, path)?;
    let empty = [0.0, 0.0, 0.0, if layer.alpha.is_some() { 0.0 } else { 1.0 }];
    if !canvas.is_nothing(empty) {
        rows.surroundings(empty, |row, first, pixels| canvas.put(row, [first, 1], pixels))?;
    }
    let chunks = reader
        .filter_chunks(false, |_, tile, block| {
            block.layer == layer.part && tile.is_largest_resolution_level()
        })
        .map_err(refused)?;
    let mut seen = HashSet::new();
    for chunk in chunks {
        let block = decompressed(chunk.map_err(refused)?, &meta).map_err(refused)?;
        let Vec2(x, y) = block.index.pixel_position;
        let is_expected = block.index.layer == layer.part && block.index.level == Vec2(0, 0);
        if !is_expected || !seen.insert([x, y]) {
            return Err(invalid("a block is not where the file says"));
        }
        rows.each(&block, |row, first, pixels| canvas.put(row, [first, 1], pixels))?;
    }
    canvas.finish(Orientation::default())
}

/// A block of pixels. Where overflow is checked, the decoder panics over damaged B44.
fn decompressed(chunk: Chunk, meta: &MetaData) -> Result<UncompressedBlock> {
    let decompress = || UncompressedBlock::decompress_chunk(chunk, meta, false);
    let failed = |_| Err(Error::Invalid("a block cannot be unpacked".into()));
    catch_unwind(AssertUnwindSafe(decompress)).unwrap_or_else(failed)
}

/// Refuses, by name, channels that have fewer samples than there are pixels.
fn check_samples(headers: &[Header]) -> Result<()> {
    let channels = headers.iter().filter(|header| !header.deep).flat_map(|header| &header.channels.list);
    let coarse = channels.filter(|channel| channel.sampling != Vec2(1, 1));
    let names: Vec<String> = coarse.map(|channel| channel.name.to_string()).collect();
    match names.is_empty() {
        true => Ok(()),
        false => {
            let names = names.join(", ");
            let what =
                format!("channels with fewer samples than pixels ({names}), as of luminance and chroma");
            Err(Error::NotSupported(what.into()))
        }
    }
}

/// Bytes of the pixels of the largest block; `None` for numbers that the decoder can't multiply.
fn block_bytes(header: &Header) -> Option<usize> {
    let per_pixel = header.channels.bytes_per_pixel;
    let Vec2(width, height) = match header.blocks {
        BlockDescription::ScanLines => Vec2(header.layer_size.0, header.compression.scan_lines_per_block()),
        BlockDescription::Tiles(tiles) => tiles.tile_size,
    };
    width.checked_mul(height)?.checked_mul(per_pixel)?.checked_mul(8)?;
    Some(width.min(header.layer_size.0) * height.min(header.layer_size.1) * per_pixel)
}

/// From the file's colours to those of Rec. 709.
fn matrix(
    header: &Header,
    path: &Path,
    options: &PictureOptions,
) -> std::result::Result<Option<ColorMatrix>, PictureError> {
    let Some(given) = header.shared_attributes.chromaticities else { return Ok(None) };
    if options.transfer != Transfer::FromFile {
        return Ok(None);
    }
    let [red, green, blue, white] =
        [given.red, given.green, given.blue, given.white].map(|Vec2(x, y)| [f64::from(x), f64::from(y)]);
    Primaries { red, green, blue, white }.to_rec_709().ok_or_else(|| {
        let what = "its chromaticities span no space".into();
        PictureError::Encoding { path: path.into(), what }
    })
}

/// Rows of pixels of the blocks of a file, cropped to what is to be seen.
struct Rows<'a> {
    header: &'a Header,
    layer: &'a Layer,
    matrix: Option<ColorMatrix>,
    /// From the data to what is to be seen.
    offset: [i64; 2],
    /// Columns and rows that are to be seen.
    size: [usize; 2],
    pixels: Vec<[f32; 4]>,
}

type Done = std::result::Result<(), PictureError>;

impl<'a> Rows<'a> {
    fn new(
        header: &'a Header,
        layer: &'a Layer,
        matrix: Option<ColorMatrix>,
        path: &Path,
    ) -> std::result::Result<Self, PictureError> {
        let window = header.shared_attributes.display_window;
        let [data, seen] = [header.own_attributes.layer_position, window.position];
        let offset = [i64::from(data.0) - i64::from(seen.0), i64::from(data.1) - i64::from(seen.1)];
        let size = [window.size.0, window.size.1];
        let mut pixels = Vec::new();
        reserve(path, &mut pixels, size[0].max(header.layer_size.0))?;
        Ok(Self { header, layer, matrix, offset, size, pixels })
    }

    /// What is to be seen where there are no data: nothing, or black without alpha.
    fn surroundings(
        &mut self,
        empty: [f32; 4],
        mut put: impl FnMut(usize, usize, &[[f32; 4]]) -> Done,
    ) -> Done {
        self.pixels.resize(self.size[0], empty);
        let clamp = |at: i64, axis: usize| at.clamp(0, self.size[axis] as i64) as usize;
        let data = [self.header.layer_size.0, self.header.layer_size.1];
        let [columns, rows] = [0, 1]
            .map(|axis| clamp(self.offset[axis], axis)..clamp(self.offset[axis] + data[axis] as i64, axis));
        for row in 0..self.size[1] {
            if !rows.contains(&row) || columns.is_empty() {
                put(row, 0, &self.pixels)?;
                continue;
            }
            put(row, 0, &self.pixels[..columns.start])?;
            put(row, columns.end, &self.pixels[columns.end..])?;
        }
        Ok(())
    }

    /// Rows of a block.
    fn each(
        &mut self,
        block: &UncompressedBlock,
        mut put: impl FnMut(usize, usize, &[[f32; 4]]) -> Done,
    ) -> Done {
        let Self { header, layer, matrix, offset, size, pixels } = self;
        let last = header.channels.list.len() - 1;
        let first = block.index.pixel_position.0 as i64 + offset[0];
        // Columns of the block that are to be seen.
        let width = block.index.pixel_size.0;
        let start = first.min(0).unsigned_abs() as usize;
        let end = usize::try_from(size[0] as i64 - first).unwrap_or(0).min(width);
        pixels.clear();
        pixels.resize(width, [0.0, 0.0, 0.0, 1.0]);
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            let numbers = |slot: usize, pixels: &mut [[f32; 4]]| {
                fill(header.channels.list[channel].sample_type, line.value, slot, pixels);
            };
            let is_color = |slot: &usize| layer.colors[*slot] == channel;
            (0..3).filter(is_color).for_each(|slot| numbers(slot, pixels));
            if layer.alpha == Some(channel) {
                numbers(3, pixels);
            }
            let row = usize::try_from(line.location.position.1 as i64 + offset[1]);
            let Some(row) = row.ok().filter(|row| *row < size[1] && start < end && channel == last) else {
                continue;
            };
            if let Some(matrix) = matrix {
                for pixel in &mut *pixels {
                    let [red, green, blue] = multiplied(matrix, [pixel[0], pixel[1], pixel[2]]);
                    *pixel = [red, green, blue, pixel[3]];
                }
            }
            put(row, (first + start as i64) as usize, &pixels[start..end])?;
        }
        Ok(())
    }
}

/// Writes the samples of a line to one number of each pixel.
fn fill(kind: SampleType, bytes: &[u8], slot: usize, pixels: &mut [[f32; 4]]) {
    let slots = pixels.iter_mut().map(|pixel| &mut pixel[slot]);
    match kind {
        SampleType::F16 => slots
            .zip(bytes.as_chunks().0)
            .for_each(|(slot, &bytes)| *slot = f16::from_ne_bytes(bytes).to_f32()),
        SampleType::F32 => {
            slots.zip(bytes.as_chunks().0).for_each(|(slot, &bytes)| *slot = f32::from_ne_bytes(bytes));
        }
        SampleType::U32 => {
            slots.zip(bytes.as_chunks().0).for_each(|(slot, &bytes)| *slot = u32::from_ne_bytes(bytes) as f32)
        }
    }
}
