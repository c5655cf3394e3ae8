//! The library's errors as Python's: its own sentences, in the kind that callers catch.

use std::io;

use fsot::ConfigError;
use fsot::files::{ExportError, FormatError, TableError};
use fsot::metrics::MeasureError;
use fsot::objective::ObjectiveError;
use fsot::optimizer::CheckpointError;
use fsot::targets::{PictureError, TargetError};
use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyValueError};

/// What becomes an exception.
pub trait IntoPython {
    /// The exception: an `OSError`, which Python narrows to `FileNotFoundError` and the like by its number,
    /// where the system refused something, and a `ValueError` otherwise.
    fn into_python(self) -> PyErr;
}

/// A refusal of the caller's values.
pub fn refused(sentence: impl ToString) -> PyErr {
    PyValueError::new_err(sentence.to_string())
}

/// A refusal of the system's.
fn of_system(error: &io::Error, sentence: String) -> PyErr {
    match error.raw_os_error() {
        Some(number) => PyOSError::new_err((number, sentence)),
        None => PyOSError::new_err(sentence),
    }
}

impl IntoPython for TableError {
    fn into_python(self) -> PyErr {
        match &self {
            Self::Io { source, .. } => of_system(source, self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPython for ExportError {
    fn into_python(self) -> PyErr {
        match &self {
            Self::Io { source, .. } => of_system(source, self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPython for CheckpointError {
    fn into_python(self) -> PyErr {
        match &self {
            Self::Io(source) => of_system(source, self.to_string()),
            _ => refused(self),
        }
    }
}

impl IntoPython for PictureError {
    fn into_python(self) -> PyErr {
        refused(self)
    }
}

/// Errors that are about values alone.
macro_rules! refusals {
    ($($error:ty),*) => {
        $(impl IntoPython for $error {
            fn into_python(self) -> PyErr {
                refused(self)
            }
        })*
    };
}

refusals!(
    ConfigError,
    FormatError,
    MeasureError,
    ObjectiveError,
    TargetError,
    fsot::config::ExtentError,
    fsot::config::GroupError,
    fsot::config::RangeError,
    fsot::config::TermError,
    fsot::kernel::KernelError,
    serde_json::Error
);

impl IntoPython for fsot_cli::Failure {
    fn into_python(self) -> PyErr {
        refused(self)
    }
}

/// `result.python()?` in functions that Python calls.
pub trait OrPython<T> {
    /// The error as an exception.
    fn python(self) -> Result<T, PyErr>;
}

impl<T, E: IntoPython> OrPython<T> for Result<T, E> {
    fn python(self) -> Result<T, PyErr> {
        self.map_err(E::into_python)
    }
}
