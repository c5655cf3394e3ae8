//! What is wrong with a picture.

use std::path::PathBuf;

use thiserror::Error;

use super::TargetError;

/// A picture that cannot serve as a density.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}; give a PNG or EXR file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
    /// The file is no picture of a known format.
    #[error(
        "cannot read {}: its first bytes, \"{}\", are of no picture; give a PNG or EXR file",
        path.display(),
        start.escape_ascii()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Its first bytes, eight at most.
        start: Vec<u8>,
    },
    /// A PNG file is damaged, or of a kind that cannot be read.
    #[error("cannot read the PNG {}: {source}; save it anew or give another PNG or EXR file", path.display())]
    Png {
        /// The file.
        path: PathBuf,
        /// The decoder's word.
        source: png::DecodingError,
    },
    /// An EXR file is damaged, or of a kind that cannot be read.
    #[error("cannot read the EXR {}: {source}; save it anew or give another PNG or EXR file", path.display())]
    Exr {
        /// The file.
        path: PathBuf,
        /// The decoder's word.
        source: exr::error::Error,
    },
    /// An EXR file has no channels that make a picture.
    #[error(
        "{} has no channels R, G and B, nor Y alone, but {}: save it with those, or give another PNG or EXR \
         file",
        path.display(),
        listed(found)
    )]
    Channels {
        /// The file.
        path: PathBuf,
        /// Channels that it has.
        found: Vec<String>,
    },
    /// An EXR file has several layers, and none was chosen.
    #[error("{} has the layers {}: choose one by `layer`", path.display(), listed(found))]
    Layers {
        /// The file.
        path: PathBuf,
        /// Their names.
        found: Vec<String>,
    },
    /// An EXR file has no layer of the name.
    #[error(
        "{} has no layer \"{}\", but {}: choose one that it has by `layer`, or none",
        path.display(),
        wanted.escape_debug(),
        listed(found)
    )]
    NoLayer {
        /// The file.
        path: PathBuf,
        /// The name that was given.
        wanted: String,
        /// Names of the layers that it has.
        found: Vec<String>,
    },
    /// The numbers of a file have a meaning that is not understood.
    #[error("{}: {what}; say how to take its values by `transfer`, or save it as sRGB", path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// What it says of its colours.
        what: String,
    },
    /// An array whose last axis holds no colours.
    #[error(
        "a picture of {given} channels: give 1 (grey), 2 (grey and alpha), 3 (red, green and blue) or 4 (the \
         same and alpha)"
    )]
    ChannelCount {
        /// Length of the last axis.
        given: usize,
    },
    /// The pixels of a file are much wider than high, or higher than wide.
    #[error(
        "the pixels of {} are {} times as wide as high: save it with square ones, or within 1/64 to 64",
        path.display(),
        short(*aspect)
    )]
    Aspect {
        /// The file.
        path: PathBuf,
        /// Width over height.
        aspect: f64,
    },
    /// The system has not enough memory.
    #[error(
        "{} takes {bytes} bytes at once, which the system has not: average it to fewer pixels by \
         `most_pixels`, or give a smaller picture",
        path.display()
    )]
    Memory {
        /// The file.
        path: PathBuf,
        /// Bytes that were asked for.
        bytes: usize,
    },
    /// The file says that it has more pixels than are read.
    #[error(
        "{} has {width} x {height} pixels, which is more than {most}: allow more by `limit_pixels`, or give \
         a smaller picture",
        path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels that are read at most.
        most: usize,
    },
    /// The picture is no density.
    #[error("{}: {problem}", path.display())]
    Density {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: TargetError,
    },
}

/// Names of a file, as many as a line holds.
fn listed(names: &[String]) -> String {
    const MOST: usize = 12;
    let shown: Vec<String> = names.iter().take(MOST).map(|name| name.escape_debug().to_string()).collect();
    match names.len() {
        0 => "none".into(),
        count @ ..=MOST => shown.join(if count == 2 { " and " } else { ", " }),
        count => format!("{} and {} more", shown.join(", "), count - MOST),
    }
}

/// Few digits.
fn short(value: f64) -> String {
    let is_plain = (1e-3..1e6).contains(&value.abs()) || value == 0.0 || !value.is_finite();
    if is_plain { format!("{value:.4}") } else { format!("{value:.4e}") }
}
