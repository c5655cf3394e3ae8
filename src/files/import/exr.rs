//! OpenEXR as numbers: all channels of all layers.

use std::io::{BufRead, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::error::Error;
use exr::image::FlatSamples;
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, read as reader};

use super::Problem;
use super::source::{Source, reserved};
use crate::error::ImportError;
use crate::files::dtype::Dtype;
use crate::files::layout::Axis;

/// The first bytes of any file.
pub(super) const SIGNATURE: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Bytes that a block of pixels takes in a file at least: its offset, its place, its length.
const LEAST_BLOCK: u64 = 16;

/// Reads a file of `length` bytes: `[layer, y, x, channel]`. Channels stand as R, G, B, A, others by name.
pub(super) fn read(mut file: impl BufRead + Seek, length: u64) -> Result<Source, Problem> {
    let meta = guarded(|| MetaData::read_from_buffered(&mut file, false))?;
    check(&meta, length)?;
    file.rewind()?;
    let layers = guarded(|| {
        let all = reader().no_deep_data().largest_resolution_level().all_channels().all_layers();
        all.all_attributes().non_parallel().from_buffered(file)
    })?
    .layer_data;
    let Some(first) = layers.first() else { return Err(damaged("it has no layers").into()) };
    let ([width, height], channels) =
        ([first.size.width(), first.size.height()], first.channel_data.list.len());
    let mut values = reserved(layers.len() * width * height * channels)?;
    let mut dtype = "<f2";
    for layer in &layers {
        let list = &layer.channel_data.list;
        let mut order: Vec<usize> = (0..channels).collect();
        order.sort_by_key(|&at| place(&list[at].name.to_string()));
        for at in 0..width * height {
            for &channel in &order {
                let (value, name) = match &list[channel].sample_data {
                    FlatSamples::F16(samples) => (samples.get(at).map(|sample| sample.to_f64()), "<f2"),
                    FlatSamples::F32(samples) => (samples.get(at).map(|&sample| sample.into()), "<f4"),
                    FlatSamples::U32(samples) => (samples.get(at).map(|&sample| sample.into()), "<u4"),
                };
                values.push(value.ok_or_else(|| damaged("a channel is too short"))?);
                if name != "<f2" {
                    dtype = name;
                }
            }
        }
    }
    let descr = match dtype {
        "<f2" => "EXR of floats of 16 bits",
        "<f4" => "EXR of floats of 32 bits",
        _ => "EXR of 32 bits",
    };
    Ok(Source {
        values,
        shape: vec![layers.len(), height, width, channels],
        fortran: false,
        dtype: Dtype::named(dtype),
        levels: None,
        descr: descr.into(),
        axes: vec![Axis::Frame, Axis::Y, Axis::X, Axis::Dim],
    })
}

/// Where a channel stands among its like: by its last name.
fn place(name: &str) -> usize {
    let last = name.rsplit('.').next().unwrap_or(name);
    ["R", "G", "B", "A"].iter().position(|&known| known == last).unwrap_or(4)
}

/// Refuses what is not alike in all layers, and what no file of this length can hold.
fn check(meta: &MetaData, length: u64) -> Result<(), ImportError> {
    let refused = |what: &str| ImportError::Unsupported {
        kind: "EXR file",
        what: what.into(),
        advice: "write flat layers of one size with the same channels, each with a sample for every pixel",
    };
    let blocks = meta.headers.iter().fold(0, |sum: u64, part| sum.saturating_add(part.chunk_count as u64));
    if blocks.saturating_mul(LEAST_BLOCK) > length {
        return Err(damaged("it is too short for its blocks"));
    }
    let Some(first) = meta.headers.first() else { return Err(damaged("it has no layers")) };
    let channels = |header: &Header| -> Vec<String> {
        header.channels.list.iter().map(|channel| channel.name.to_string()).collect()
    };
    for header in &meta.headers {
        if header.deep {
            return Err(refused("is of deep samples"));
        }
        if header.channels.list.iter().any(|channel| channel.sampling.0 != 1 || channel.sampling.1 != 1) {
            return Err(refused("has channels with fewer samples than pixels"));
        }
        if header.layer_size != first.layer_size || channels(header) != channels(first) {
            return Err(refused("has layers of several kinds"));
        }
        // The crate asks for all of it, and multiplies without looking.
        let pixels = header.layer_size.0.checked_mul(header.layer_size.1);
        let bytes = pixels.and_then(|pixels| pixels.checked_mul(8 * header.channels.bytes_per_pixel.max(1)));
        if bytes.is_none_or(|bytes| reserved::<u8>(bytes).is_err()) {
            return Err(refused("has more pixels than there is memory"));
        }
    }
    Ok(())
}

/// What the crate reads. Where overflow is checked, it panics over damaged files.
fn guarded<T>(read: impl FnOnce() -> exr::error::Result<T>) -> Result<T, Problem> {
    match catch_unwind(AssertUnwindSafe(read)) {
        Ok(Ok(read)) => Ok(read),
        Ok(Err(Error::Io(error))) if error.kind() != std::io::ErrorKind::UnexpectedEof => Err(error.into()),
        Ok(Err(error)) => Err(damaged(&error.to_string()).into()),
        Err(_) => Err(damaged("a block cannot be unpacked").into()),
    }
}

fn damaged(reason: &str) -> ImportError {
    ImportError::Damaged { kind: "EXR file", reason: reason.into() }
}
