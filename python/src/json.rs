//! Plain data between Python's dictionaries and the library, by way of JSON's values.

use std::fmt::Write;

use pyo3::exceptions::{PyTypeError, PyUnicodeEncodeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde::Serialize;
use serde::de::{DeserializeOwned, Deserializer};
use serde_json::{Map, Value};

use crate::errors::{OrPython, refused};

/// As dictionaries, lists, numbers and texts.
pub fn to_python<'py>(py: Python<'py>, data: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(data).python()?;
    py.import("json")?.call_method1("loads", (text,))
}

/// From dictionaries, lists, numbers, also numpy's, and texts.
///
/// # Errors
/// A `TypeError` for what JSON does not hold, a `ValueError` for numbers and texts that it does not hold, and
/// for what is no `T`.
pub fn of_python<T: DeserializeOwned>(object: &Bound<'_, PyAny>) -> PyResult<T> {
    of_python_called("data", object)
}

/// The same, of data that sentences call `name`.
pub fn of_python_called<T: DeserializeOwned>(name: &str, object: &Bound<'_, PyAny>) -> PyResult<T> {
    let value = value_of(object, &Place { parent: None, step: Step::Root(name), depth: 0 })?;
    parsed(value, name)
}

/// From a text.
///
/// # Errors
/// A `ValueError` for what is no `T`.
pub fn of_text<T: DeserializeOwned>(text: &str) -> PyResult<T> {
    let value: Value =
        serde_json::from_str(text).map_err(|error| refused(format!("no JSON: {error}: correct that")))?;
    parsed(value, "data")
}

/// From values.
///
/// # Errors
/// A `ValueError` that says where the first fault is.
pub fn parsed<'de, T: DeserializeOwned>(data: impl Deserializer<'de>, name: &str) -> PyResult<T> {
    serde_path_to_error::deserialize(data).map_err(|error| {
        let path = error.path().to_string();
        let place = if path == "." { name } else { &path };
        refused(format!("{place}: {}: correct that", error.inner()))
    })
}

/// Where something stands in plain data.
struct Place<'a> {
    parent: Option<&'a Place<'a>>,
    step: Step<'a>,
    depth: usize,
}

enum Step<'a> {
    Root(&'a str),
    Key(&'a str),
    Index(usize),
}

/// Of what is nested deeper nobody could read a file.
const DEEPEST: usize = 100;

impl Place<'_> {
    fn within<'a>(&'a self, step: Step<'a>) -> PyResult<Place<'a>> {
        let depth = self.depth + 1;
        if depth > DEEPEST {
            // Also what holds itself.
            return Err(refused(format!(
                "{} is nested deeper than {DEEPEST} times: give plainer data",
                self.beginning()
            )));
        }
        Ok(Place { parent: Some(self), step, depth })
    }

    /// `metadata['figures'][3]`
    fn text(&self) -> String {
        let mut text = self.parent.map(Self::text).unwrap_or_default();
        let written = match self.step {
            Step::Root(name) => write!(text, "{name}"),
            Step::Key(key) => write!(text, "['{}']", key.escape_debug()),
            Step::Index(index) => write!(text, "[{index}]"),
        };
        written.expect("texts take all that is written");
        text
    }

    fn beginning(&self) -> String {
        match self.parent {
            Some(parent) if self.depth > 2 => parent.beginning(),
            _ => self.text(),
        }
    }
}

fn value_of(object: &Bound<'_, PyAny>, place: &Place<'_>) -> PyResult<Value> {
    if object.is_none() {
        return Ok(Value::Null);
    }
    if let Ok(truth) = object.cast::<PyBool>() {
        return Ok(Value::Bool(truth.is_true()));
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(Value::String(text_of(text, place)?));
    }
    if object.is_instance_of::<PyInt>() {
        let number = object.extract::<u64>().map(Value::from);
        return number.or_else(|_| object.extract::<i64>().map(Value::from)).map_err(|_| {
            refused(format!(
                "{} is a number out of range: give one from -2**63 to 2**64 - 1, a float, or a text",
                place.text()
            ))
        });
    }
    if object.is_instance_of::<PyFloat>() {
        let number: f64 = object.extract()?;
        return serde_json::Number::from_f64(number).map(Value::Number).ok_or_else(|| {
            refused(format!(
                "{} is {}: give a finite number or None",
                place.text(),
                number.to_string().to_lowercase()
            ))
        });
    }
    if let Ok(dict) = object.cast::<PyDict>() {
        return fields_of(dict, place).map(Value::Object);
    }
    if object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>() {
        let items = object.try_iter()?.enumerate();
        let items = items.map(|(index, item)| value_of(&item?, &place.within(Step::Index(index))?));
        return items.collect::<PyResult<_>>().map(Value::Array);
    }
    // Numpy's numbers and arrays.
    match object.call_method0("tolist") {
        Ok(plain) if !plain.get_type().is(object.get_type()) => value_of(&plain, place),
        _ => Err(PyTypeError::new_err(format!(
            "no plain data: {} is of type {}; give dictionaries, lists, numbers and texts",
            place.text(),
            object.get_type().name()?
        ))),
    }
}

fn fields_of(dict: &Bound<'_, PyDict>, place: &Place<'_>) -> PyResult<Map<String, Value>> {
    let field = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key = key.cast::<PyString>().map_err(|_| {
            let text = key.repr().map_or_else(|_| "one".into(), |text| text.to_string());
            PyTypeError::new_err(format!(
                "no plain data: {} has the key {}; give texts as keys",
                place.text(),
                text.chars().take(40).collect::<String>()
            ))
        })?;
        let key = text_of(key, place)?;
        let value = value_of(&value, &place.within(Step::Key(&key))?)?;
        Ok((key, value))
    };
    dict.iter().map(field).collect()
}

fn text_of(text: &Bound<'_, PyString>, place: &Place<'_>) -> PyResult<String> {
    text.extract::<String>().map_err(|error| match error.is_instance_of::<PyUnicodeEncodeError>(text.py()) {
        true => refused(format!(
            "{} has a text with half a character, which no file holds: give one that encodes as UTF-8",
            place.text()
        )),
        false => error,
    })
}
