//! Plain data between Python's dictionaries and the library, by way of JSON.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::errors::{OrPython, refused};

/// As dictionaries, lists, numbers and texts.
pub fn to_python<'py>(py: Python<'py>, data: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(data).python()?;
    py.import("json")?.call_method1("loads", (text,))
}

/// From dictionaries, lists, numbers, also numpy's, and texts.
///
/// # Errors
/// A `TypeError` for what JSON does not hold, a `ValueError` for what is no `T`.
pub fn of_python<T: DeserializeOwned>(object: &Bound<'_, PyAny>) -> PyResult<T> {
    let py = object.py();
    let options = PyDict::new(py);
    // Of numpy's numbers and arrays.
    options.set_item("default", py.import("operator")?.call_method1("methodcaller", ("tolist",))?)?;
    let text = py.import("json")?.call_method("dumps", (object,), Some(&options)).map_err(|error| {
        PyTypeError::new_err(format!(
            "no plain data: {}; give dictionaries, lists, numbers and texts",
            error.value(py)
        ))
    })?;
    of_text(&text.extract::<String>()?)
}

/// From a text.
///
/// # Errors
/// A `ValueError` for what is no `T`.
pub fn of_text<T: DeserializeOwned>(text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|error| {
        let sentence = format!("{error}: correct that");
        // The library names what Rust calls.
        refused(
            sentence
                .replace("Classes::custom", "Classes.listed")
                .replace("Target::custom", "Target.quantiles"),
        )
    })
}
