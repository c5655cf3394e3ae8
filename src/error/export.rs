//! What stands against writing a table in a format of somebody else's.

use std::path::PathBuf;

use thiserror::Error;

use super::io_advice;

/// Why a table cannot be exported. Nothing is written then.
///
/// Options are called as they are on the command line; those of
/// [`ExportOptions`](crate::files::ExportOptions) have the same names without dashes, but `--bits`, which is
/// `depth`.
///
/// ```
/// use fsot::files::{Depth, ExportError, ExportOptions, Format};
/// use fsot::{Extent, SampleTable};
///
/// let table = SampleTable::white_noise(Extent::still(8, 8), 2, 0)?;
/// let error = table.export("table.png", &ExportOptions::new(Format::Ktx2)).unwrap_err();
/// assert!(matches!(error, ExportError::FileName { extension: "ktx2", .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The format has no such numbers.
    #[error("{format} holds no numbers of --bits {given}: give --bits {holds}")]
    Depth {
        /// The format.
        format: &'static str,
        /// Numbers that were asked for.
        given: &'static str,
        /// Numbers that it has.
        holds: String,
    },
    /// The path has another extension than files of the format.
    #[error("{path:?} cannot name such a file: give a name in UTF-8 that ends in .{extension}")]
    FileName {
        /// The path.
        path: PathBuf,
        /// The extension of the format.
        extension: &'static str,
    },
    /// The pattern of names cannot be filled.
    #[error(
        "--name {pattern:?} {problem}: write a name with {{name}}, {{kind}}, {{width}}, {{height}}, \
         {{frames}}, {{frame}}, {{sample}} and {{dims}} where these shall stand"
    )]
    Pattern {
        /// The pattern.
        pattern: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The pattern gives two files the same name.
    #[error("--name {pattern:?} calls several files {path:?}: put {place} into it")]
    SameName {
        /// The pattern.
        pattern: String,
        /// The name.
        path: PathBuf,
        /// What tells the files apart.
        place: &'static str,
    },
    /// The observer of [`export_observed`](crate::SampleTable::export_observed) broke off.
    #[error("broken off before all files were complete: nothing is written; export again")]
    Stopped,
    /// A file cannot be written.
    #[error("cannot write {}: {source}; {}", path.display(), io_advice(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
}
