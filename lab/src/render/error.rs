//! What can go wrong around a rendering.

use std::path::PathBuf;

use fsot::ConfigError;
use fsot::config::{ExtentError, RangeError};
use fsot::kernel::KernelError;
use thiserror::Error;

/// A rendering, a picture or a comparison that cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// An axis is empty.
    #[error(transparent)]
    Extent(#[from] ExtentError),
    /// A parameter lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A filter that is none.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// A demand that is none.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Two films that are compared differ in shape, or values do not fit a film.
    #[error("{what} has the shape {given:?}, but {expected:?} is needed: [frames, height, width]")]
    Shape {
        /// Which film.
        what: &'static str,
        /// `[frames, height, width]` given.
        given: [usize; 3],
        /// `[frames, height, width]` needed.
        expected: [usize; 3],
    },
    /// The number of values does not fit the film.
    #[error("{given} values for a film of {expected}: give frames * height * width values")]
    Length {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// A film has no such frame.
    #[error("frame {frame} of a film of {frames}: name a frame from 0 to {}", frames - 1)]
    NoSuchFrame {
        /// The frame named.
        frame: usize,
        /// Frames of the film.
        frames: usize,
    },
    /// A temporal filter looks further back than the film reaches.
    #[error("a temporal filter of {needed} frames on a film of {frames}: render at least {needed} frames")]
    TooShort {
        /// Frames of the film.
        frames: usize,
        /// Frames of the filter.
        needed: usize,
    },
    /// A file could not be read or written.
    #[error("cannot {verb} {}: {source}; check the path and its permissions", path.display())]
    Io {
        /// `read`, `write` or `create`.
        verb: &'static str,
        /// The file or directory.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
}

/// Refuses an empty axis.
pub(super) fn not_empty(axis: &'static str, len: usize) -> Result<(), ExtentError> {
    if len == 0 { Err(ExtentError::EmptyAxis { axis }) } else { Ok(()) }
}
