//! The numbers of somebody else's file, whatever its format.

use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use super::ImportOptions;
use crate::error::{FormatError, ImportError};
use crate::files::dtype::Dtype;
use crate::files::header::{self, Fault};
use crate::files::text::{self, Unread};

/// The numbers of a file, as they lie there.
pub(super) struct Source {
    pub(super) values: Vec<f64>,
    pub(super) shape: Vec<usize>,
    pub(super) fortran: bool,
    pub(super) dtype: Option<Dtype>,
    pub(super) descr: String,
}

pub(super) enum Problem {
    Fault(Fault),
    Import(ImportError),
}

impl<F: Into<Fault>> From<F> for Problem {
    fn from(fault: F) -> Self {
        Self::Fault(fault.into())
    }
}

impl From<ImportError> for Problem {
    fn from(problem: ImportError) -> Self {
        Self::Import(problem)
    }
}

/// Reads all numbers of a file.
pub(super) fn source(path: &Path, options: &ImportOptions) -> Result<Source, Problem> {
    let (mut file, bytes) = header::open(path)?;
    let header = match header::read(&mut file, bytes) {
        Err(Fault::Format(FormatError::NotNpy { .. })) => {
            file.seek(SeekFrom::Start(0))?;
            return source_of_text(file, options);
        }
        Err(fault) => return Err(fault.into()),
        Ok(header) => header,
    };
    let dtype = header.dtype.map_err(|dtype| ImportError::Dtype { dtype })?;
    let shape = header.shape;
    let count = shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    let expected = count.and_then(|count| count.checked_mul(dtype.size)).unwrap_or(usize::MAX) as u64;
    let given = bytes - header.bytes;
    if given != expected {
        return Err(FormatError::Length { given, expected, shape }.into());
    }
    let count = count.unwrap_or(0);
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(io::Error::from)?;
    let mut block = vec![0; 1 << 16];
    while values.len() < count {
        let bytes = block.len().min(dtype.size * (count - values.len()));
        file.read_exact(&mut block[..bytes])?;
        values.extend(block[..bytes].chunks_exact(dtype.size).map(|bytes| dtype.decode(bytes)));
    }
    Ok(Source { values, shape, fortran: header.fortran, dtype: Some(dtype), descr: header.descr })
}

fn source_of_text(file: std::fs::File, options: &ImportOptions) -> Result<Source, Problem> {
    let numbers = text::read(file).map_err(|unread| match unread {
        Unread::Io(error) => Problem::from(error),
        Unread::Import(problem) => problem.into(),
    })?;
    let count = numbers.values.len();
    let shape = match numbers.columns {
        // All on one line, in whichever order: a list.
        Ok(columns) if columns == count && columns > 16 => vec![count],
        Ok(columns) => vec![count / columns, columns],
        Err(_) if options.dims.is_some() => vec![count],
        Err(ragged) => return Err(ragged.into()),
    };
    Ok(Source { values: numbers.values, shape, fortran: false, dtype: None, descr: "text".into() })
}
