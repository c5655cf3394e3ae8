//! What is wrong with a table, or with the file of one.

use std::path::PathBuf;

use thiserror::Error;

use super::{ExtentError, ImportError, Short, io_advice};

/// A table that cannot be made, read or written.
///
/// ```
/// use fsot::{Extent, SampleTable};
///
/// let error = SampleTable::new(Extent::still(1, 2), 1, vec![0.5, 1.0]).unwrap_err();
/// assert!(error.to_string().contains("x 1, sample 0, dim 0] is 1"));
/// ```
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// The extent or the number of dimensions is not admissible.
    #[error(transparent)]
    Extent(#[from] ExtentError),
    /// The number of values does not fit the extent.
    #[error("{given} values for a table of {expected}: give frames * height * width * spp * dims values")]
    Length {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// A value lies outside `[0, 1)` or is not finite.
    #[error(
        "the value at [frame {}, y {}, x {}, sample {}, dim {}] is {}: \
         values must lie in [0, 1)",
        at[0], at[1], at[2], at[3], at[4], Short::from(value)
    )]
    Value {
        /// `[frame, y, x, sample, dim]`.
        at: [usize; 5],
        /// The value.
        value: f32,
    },
    /// The file could not be opened, read or written.
    #[error("cannot {verb} {}: {source}; {}", path.display(), io_advice(source))]
    Io {
        /// `read` or `write`.
        verb: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
    /// The path cannot name a table.
    #[error(
        "{path:?} cannot name a table: give a file name that ends in .npy; \
         .json is for the metadata beside it"
    )]
    FileName {
        /// The path.
        path: PathBuf,
    },
    /// The file was read, but it is not what this crate writes.
    #[error("{}: {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FormatError,
    },
    /// The file holds no numbers that could be a table.
    #[error("{}: {problem}", path.display())]
    Import {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: ImportError,
    },
}

/// What is wrong with a file that should hold a table or its metadata.
///
/// ```
/// use fsot::SampleTable;
/// use fsot::files::{FormatError, TableError};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("table.npy");
/// std::fs::write(&path, "no table")?;
/// let error = SampleTable::load(&path).unwrap_err();
/// assert!(matches!(error, TableError::Format { problem: FormatError::NotNpy { .. }, .. }));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// A directory, a device or a pipe.
    #[error("not an ordinary file: give the path of a file")]
    NotAFile,
    /// Another kind of file.
    #[error("starts with \"{}\" instead of \"\\x93NUMPY\": {advice}", start.escape_ascii())]
    NotNpy {
        /// First bytes of the file.
        start: Vec<u8>,
        /// What makes a table of it.
        advice: String,
    },
    /// The file ends before the values begin.
    #[error("ends after {bytes} bytes, but its header takes {needed}: it was cut off, write it again")]
    Truncated {
        /// Length of the file.
        bytes: u64,
        /// Length up to the first value, as far as the file tells.
        needed: u64,
    },
    /// A version of the `.npy` format that is not known.
    #[error(".npy format version {major}.{minor} is not known: save it as version 1.0, 2.0 or 3.0")]
    Version {
        /// Major version.
        major: u8,
        /// Minor version.
        minor: u8,
    },
    /// The header announces a length that no table needs.
    #[error("the header announces {bytes} bytes, more than {limit}: the file is damaged, write it again")]
    HeaderLength {
        /// Length that the header announces.
        bytes: u64,
        /// Longest header that is read.
        limit: u64,
    },
    /// The header cannot be understood.
    #[error("the .npy header cannot be read ({reason}): save a plain array of '<f4' with numpy.save")]
    Header {
        /// What the parser stumbled over.
        reason: String,
    },
    /// The values are not little-endian `f32`.
    #[error("the dtype is {dtype} instead of '<f4': {advice}")]
    Dtype {
        /// Type descriptor of the file.
        dtype: String,
        /// What makes a table of it.
        advice: String,
    },
    /// The values are in Fortran order.
    #[error("the array of shape {shape:?} is in Fortran order: {advice}")]
    FortranOrder {
        /// Shape of the file.
        shape: Vec<usize>,
        /// What makes a table of it.
        advice: String,
    },
    /// The array does not have five axes.
    #[error("shape {shape:?} has {} axes instead of 5: {advice}", shape.len())]
    Axes {
        /// Shape of the file.
        shape: Vec<usize>,
        /// What makes a table of it.
        advice: String,
    },
    /// The array is empty or too large.
    #[error("shape {shape:?} cannot be a table: {problem}")]
    Extent {
        /// Shape of the file.
        shape: [usize; 5],
        /// Which axis, or how many values.
        problem: ExtentError,
    },
    /// The file does not hold as many values as its shape says.
    #[error(
        "{given} bytes of values, but shape {shape:?} takes {expected}: \
         the file was cut off or appended to, write it again"
    )]
    Length {
        /// Bytes after the header.
        given: u64,
        /// Bytes that the shape takes.
        expected: u64,
        /// Shape of the file.
        shape: Vec<usize>,
    },
    /// A value lies outside `[0, 1)` or is not finite.
    #[error(
        "the value at [frame {}, y {}, x {}, sample {}, dim {}] is {} instead of in [0, 1): {advice}",
        at[0], at[1], at[2], at[3], at[4], Short::from(value)
    )]
    Value {
        /// `[frame, y, x, sample, dim]`.
        at: [usize; 5],
        /// The value.
        value: f32,
        /// What makes a table of it.
        advice: String,
    },
    /// The metadata is not JSON, or lacks a field.
    #[error("{reason}: correct line {line}, or save the table again with its metadata")]
    Json {
        /// Line, from 1.
        line: usize,
        /// Column, from 1; 0 is the end of the line before.
        column: usize,
        /// What the parser stumbled over, with line and column.
        reason: String,
    },
    /// A field of the metadata says that the table is in a format that this version does not know.
    #[error(
        "{field} is {given:?} instead of {expected:?}: use the version of this crate that wrote the file"
    )]
    Field {
        /// Which field.
        field: &'static str,
        /// What it says.
        given: String,
        /// What it must say.
        expected: String,
    },
    /// The metadata describes another table.
    #[error(
        "the metadata says shape {metadata:?}, but the table has {table:?}: \
         bring the two that belong together"
    )]
    OtherTable {
        /// Shape according to the metadata.
        metadata: [usize; 5],
        /// Shape of the table.
        table: [usize; 5],
    },
    /// The metadata describes other values of the same shape.
    #[error(
        "the metadata is of other values (SHA-256 {metadata}) than the table has ({table}), as when the \
         table was saved without metadata or two programs wrote at once: load the table alone, or save both \
         again"
    )]
    OtherValues {
        /// Hash according to the metadata.
        metadata: String,
        /// Hash of the table.
        table: String,
    },
}
