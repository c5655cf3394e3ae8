//! Whole numbers of Python's, which have no end and a sign.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// How many: from 0 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count(pub usize);

/// What names random numbers: from 0 to 2^64 - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number(pub u64);

impl<'a, 'py> FromPyObject<'a, 'py> for Number {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        // True is no number of anything.
        if object.extract::<bool>().is_ok() {
            return Err(PyTypeError::new_err(format!("{} is no whole number: give one", object.repr()?)));
        }
        object.extract::<u64>().map(Self).map_err(|error| {
            match error.is_instance_of::<pyo3::exceptions::PyOverflowError>(object.py()) {
                true => PyValueError::new_err(format!(
                    "{} is out of range: give a whole number from 0 to 2**64 - 1",
                    short(&object)
                )),
                false => error,
            }
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
fn short(object: &Borrowed<'_, '_, PyAny>) -> String {
    let text = object.str().map_or_else(|_| "the number".into(), |text| text.to_string());
    if text.chars().nth(40).is_none() { text } else { text.chars().take(20).chain("...".chars()).collect() }
}
