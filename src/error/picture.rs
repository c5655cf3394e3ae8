//! What is wrong with a picture.

use std::path::PathBuf;

use thiserror::Error;

use super::TargetError;

/// A picture that cannot serve as a density.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file cannot be read as a picture.
    #[error("cannot read {}: {source}; give a PNG or EXR file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What stands against it.
        source: image::ImageError,
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
