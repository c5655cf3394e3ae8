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
    /// The file says that it has more pixels than are read.
    #[error("{} has {width} x {height} pixels: make it smaller, of at most {most} in all", path.display())]
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
