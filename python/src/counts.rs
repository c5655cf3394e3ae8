//! Whole numbers of Python's, which have no end and a sign.

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// How many: from 0 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count(pub usize);

/// What names random numbers: from 0 to 2^64 - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number(pub u64);

impl<'a, 'py> FromPyObject<'a, 'py> for Number {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let none = || PyTypeError::new_err(format!("{} is no whole number: give one", short(object.repr())));
        // True is no number of anything.
        if object.extract::<bool>().is_ok() {
            return Err(none());
        }
        object.extract::<u64>().map(Self).map_err(|error| {
            if error.is_instance_of::<PyOverflowError>(object.py()) {
                return PyValueError::new_err(format!(
                    "{} is out of range: give a whole number from 0 to 2**64 - 1",
                    short(object.str())
                ));
            }
            if error.is_instance_of::<PyTypeError>(object.py()) { none() } else { error }
        })
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Count {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let Number(number) = object.extract()?;
        match usize::try_from(number) {
            Ok(count) => Ok(Self(count)),
            Err(_) => Err(PyValueError::new_err(format!("{number} is out of range: give a smaller number"))),
        }
    }
}

/// A number may have a million digits, and an object of somebody else's any text.
fn short(text: PyResult<Bound<'_, PyString>>) -> String {
    let text = text.map_or_else(|_| "the number".into(), |text| text.to_string_lossy().into_owned());
    if text.chars().nth(40).is_none() { text } else { text.chars().take(20).chain("...".chars()).collect() }
}
