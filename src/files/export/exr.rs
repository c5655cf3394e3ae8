//! OpenEXR: one to four dimensions as the channels `Y`, or `R`, `G`, `B` and `A`; a frame is a part of the
//! file. Packed not at all, because neighbours have as little in common as can be.

use std::io::{self, Seek, Write};

use exr::block::writer::ChunksWriter;
use exr::error::Error;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, attribute::ChannelDescription};
use exr::prelude::{Compression, LineOrder, SampleType, Text};

use super::encode::Encoded;
use super::options::Depth;
use super::parts::Part;

/// Names of the channels of so many dimensions, in their order; those of four serve two and three.
pub(in crate::files) const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// Writes a part of the file for each frame.
pub(super) fn write(out: &mut (impl Write + Seek), values: &Encoded, part: &Part) -> io::Result<()> {
    let [_, height, width, _, dims] = part.shape(values.extent());
    let names = if dims == 1 { &["Y"] } else { &CHANNELS[..dims] };
    // A file lists them by name.
    let mut order: Vec<usize> = (0..dims).collect();
    order.sort_by_key(|&dim| names[dim]);
    let kind = if values.depth == Depth::Half { SampleType::F16 } else { SampleType::F32 };
    let channel = |&dim: &usize| ChannelDescription::new(names[dim], kind, true);
    let header = |frame: usize| {
        let name = Text::new_or_none(format!("frame_{frame}")).ok_or(io::ErrorKind::InvalidInput)?;
        let header = Header::new(name, (width, height), order.iter().map(channel).collect());
        let lines = BlockDescription::ScanLines;
        io::Result::Ok(header.with_encoding(Compression::Uncompressed, lines, LineOrder::Increasing))
    };
    let headers = part.frames.clone().map(header).collect::<io::Result<_>>()?;
    let written = exr::block::write(out, headers, true, |meta, writer| {
        let blocks = meta.collect_ordered_block_data(|block| {
            let mut bytes = Vec::with_capacity(block.pixel_size.area() * dims * values.depth.bytes());
            let frame = part.frames.start + block.layer;
            let first = block.pixel_position.1;
            for y in first..first + block.pixel_size.1 {
                for &channel in &order {
                    let row = part.row(values.extent(), values.dims(), frame, y);
                    // In the machine's order, as the crate wants it.
                    values.extend_native(&mut bytes, row.skip(channel).step_by(dims));
                }
            }
            bytes
        });
        let mut writer = writer.sequential_blocks_compressor(&meta);
        for (index, block) in blocks {
            writer.compress_block(index, block)?;
        }
        Ok(())
    });
    written.map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other),
    })
}
