//! The library's errors as Python's: its own sentences, in the kind that callers catch.

use std::error::Error;
use std::io::{self, ErrorKind};

use fsot::files::{FormatError, TableError};
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
    PyValueError::new_err(in_python(sentence.to_string()))
}

/// What sentences of the library call something, and what Python calls it.
const NAMES: [(&str, &str); 4] = [
    ("Checkpoint::config", "Checkpoint.config"),
    ("Classes::custom", "Classes.listed"),
    ("Target::custom", "Target.quantiles"),
    ("SampleTable::import", "fsot.import_table"),
];

fn in_python(sentence: String) -> String {
    NAMES.iter().fold(sentence, |sentence, (name, python)| match sentence.contains(name) {
        true => sentence.replace(name, python),
        false => sentence,
    })
}

/// A failure of the command's.
pub fn failed(failure: &(dyn Error + Send + Sync + 'static)) -> PyErr {
    exception(failure)
}

fn exception(error: &(dyn Error + 'static)) -> PyErr {
    match refusal_of_system(error) {
        Some(number) => PyOSError::new_err((number, in_python(error.to_string()))),
        None => refused(error),
    }
}

/// The system's number of it.
const IS_A_DIRECTORY: i32 = 21;

/// The number of the system's refusal, if this is one.
fn refusal_of_system(error: &(dyn Error + 'static)) -> Option<i32> {
    if let Some(TableError::Format { path, problem: FormatError::NotAFile }) = error.downcast_ref() {
        return path.is_dir().then_some(IS_A_DIRECTORY);
    }
    // A checkpoint's error shows what it wraps, and so doesn't name it as its source.
    if let Some(CheckpointError::File { problem, path, .. }) = error.downcast_ref() {
        return refusal_of_system(&**problem).or_else(|| path.is_dir().then_some(IS_A_DIRECTORY));
    }
    match error.downcast_ref::<io::Error>() {
        Some(error) => number_of(error),
        None => error.source().and_then(refusal_of_system),
    }
}

/// A refusal of the system's, in these words.
pub fn of_system(refusal: &io::Error, sentence: String) -> PyErr {
    match number_of(refusal) {
        Some(number) => PyOSError::new_err((number, in_python(sentence))),
        // It was not asked: the name of the file is none.
        None if refusal.kind() == ErrorKind::InvalidInput => refused(sentence),
        None => PyOSError::new_err(in_python(sentence)),
    }
}

/// Its number, also of what the library found out itself before it asked the system.
fn number_of(refusal: &io::Error) -> Option<i32> {
    if let Some(number) = refusal.raw_os_error() {
        return Some(number);
    }
    match refusal.kind() {
        ErrorKind::NotFound => Some(2),
        ErrorKind::PermissionDenied => Some(13),
        ErrorKind::NotADirectory => Some(20),
        ErrorKind::IsADirectory => Some(IS_A_DIRECTORY),
        _ => None,
    }
}
