//! The library's errors as Python's: its own sentences, in the kind that callers catch.

use std::error::Error;
use std::io;

use fsot::optimizer::CheckpointError;
use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyValueError};

/// `result.python()?` in functions that Python calls.
pub trait OrPython<T> {
    /// The error as an exception: an `OSError`, which Python narrows to `FileNotFoundError` and the like by
    /// its number, where the system refused something, and a `ValueError` otherwise.
    fn python(self) -> Result<T, PyErr>;
}

impl<T, E: Error + 'static> OrPython<T> for Result<T, E> {
    fn python(self) -> Result<T, PyErr> {
        self.map_err(|error| exception(&error))
    }
}

/// A refusal of the caller's values.
pub fn refused(sentence: impl ToString) -> PyErr {
    PyValueError::new_err(sentence.to_string())
}

fn exception(error: &(dyn Error + 'static)) -> PyErr {
    match refusal_of_system(error) {
        Some(refusal) => of_system(refusal, error.to_string()),
        None => refused(error),
    }
}

/// A refusal of the system's, in these words.
pub fn of_system(refusal: &io::Error, sentence: String) -> PyErr {
    match refusal.raw_os_error() {
        Some(number) => PyOSError::new_err((number, sentence)),
        // `FileNotFoundError` and the like.
        None => io::Error::new(refusal.kind(), sentence).into(),
    }
}

/// What the system has said, if this is a refusal of its.
fn refusal_of_system<'a>(error: &'a (dyn Error + 'static)) -> Option<&'a io::Error> {
    use io::ErrorKind::{IsADirectory, NotADirectory, NotFound, PermissionDenied};
    // A checkpoint's error shows what it wraps, and so doesn't name it as its source.
    if let Some(CheckpointError::File { problem, .. }) = error.downcast_ref() {
        return refusal_of_system(&**problem);
    }
    let Some(refusal) = error.downcast_ref::<io::Error>() else {
        return error.source().and_then(refusal_of_system);
    };
    // The library finds some of them out by itself, which then have no number; others are of a file's bytes.
    let is_found_out = matches!(refusal.kind(), NotFound | PermissionDenied | IsADirectory | NotADirectory);
    (refusal.raw_os_error().is_some() || is_found_out).then_some(refusal)
}
