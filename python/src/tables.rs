//! Tables in files.

use std::path::PathBuf;

use fsot::files::{FormatError, Metadata, TableError};
use fsot::{Extent, SampleTable};
use pyo3::prelude::*;
use serde_json::{Map, Value};

use crate::arrays::{table_of, table_to_read};
use crate::errors::{OrPython, refused};
use crate::json;
use crate::work::left_alone;

/// Writes a table, and its metadata beside it if there are any.
#[pyfunction]
pub fn save_table(
    py: Python<'_>,
    path: PathBuf,
    array: &Bound<'_, PyAny>,
    metadata: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let table = table_of(array)?;
    let metadata = metadata.map(|given| whole_metadata_of(given, &table)).transpose()?;
    let save = || match &metadata {
        Some(metadata) => {
            // Those of other values would be lost, or would stay as those of these.
            metadata.check(&table).map_err(|problem| other(&path, problem))?;
            table.save_with(&path, metadata)
        }
        None => table.save(&path),
    };
    // Not left alone: a file that appears after Ctrl-C would surprise.
    py.detach(save).python()
}

fn other(path: &std::path::Path, problem: FormatError) -> TableError {
    TableError::Format { path: Metadata::path_beside(path), problem }
}

/// Metadata as they are given: those of a run, or notes alone.
///
/// # Errors
/// What is neither.
pub fn metadata_of(given: &Bound<'_, PyAny>, table: &SampleTable) -> PyResult<Metadata> {
    parsed(fields_of(given, table)?)
}

fn fields_of(given: &Bound<'_, PyAny>, table: &SampleTable) -> PyResult<Map<String, Value>> {
    let mut fields: Map<String, Value> = json::of_python_called("metadata", given)?;
    for (name, value) in blank(table) {
        fields.entry(name).or_insert(value);
    }
    Ok(fields)
}

fn parsed(fields: Map<String, Value>) -> PyResult<Metadata> {
    json::parsed(Value::Object(fields), "metadata")
}

/// The same, of which nothing is lost.
fn whole_metadata_of(given: &Bound<'_, PyAny>, table: &SampleTable) -> PyResult<Metadata> {
    let fields = fields_of(given, table)?;
    let metadata = parsed(fields.clone())?;
    let kept = serde_json::to_value(&metadata).python()?;
    match lost(&Value::Object(fields), &kept) {
        Some(place) => Err(refused(format!(
            "metadata{place} has no place in the file of a table: give notes a name of their own at the top"
        ))),
        None => Ok(metadata),
    }
}

/// What is said of a table of which nothing is known.
fn blank(table: &SampleTable) -> Map<String, Value> {
    let [frames, height, width, spp, dims] = table.shape();
    let blank = Metadata::new(Extent { frames, height, width, spp }, dims, 0, Value::Null);
    match serde_json::to_value(blank) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

/// The first place of something that is not there any more.
fn lost(given: &Value, kept: &Value) -> Option<String> {
    match (given, kept) {
        (Value::Object(given), Value::Object(kept)) => given.iter().find_map(|(name, value)| {
            let place = format!("[{name:?}]");
            match kept.get(name) {
                Some(kept) => lost(value, kept).map(|inner| place + &inner),
                // What is said not to be known need not be said.
                None if value.is_null() => None,
                None => Some(place),
            }
        }),
        (Value::Array(given), Value::Array(kept)) => {
            let pairs = given.iter().zip(kept).enumerate();
            pairs
                .into_iter()
                .find_map(|(at, (given, kept))| lost(given, kept).map(|inner| format!("[{at}]{inner}")))
        }
        _ => None,
    }
}

/// Reads a table and, unless they are not wanted, its metadata if there are any beside it.
#[pyfunction]
pub fn load_table(
    py: Python<'_>,
    path: PathBuf,
    metadata: bool,
) -> PyResult<(Bound<'_, PyAny>, Bound<'_, PyAny>)> {
    let has_metadata = metadata && Metadata::path_beside(&path).exists();
    let load = move || -> Result<_, TableError> {
        if has_metadata {
            return SampleTable::load_with(&path).map(|(table, metadata)| (table, Some(metadata)));
        }
        SampleTable::load(&path).map(|table| (table, None))
    };
    let (table, metadata) = left_alone(py, None, load)?.python()?;
    Ok((table_to_read(py, table)?, json::to_python(py, &metadata)?))
}

/// Refuses what is no table.
#[pyfunction]
pub fn check_table(array: &Bound<'_, PyAny>) -> PyResult<()> {
    table_of(array).map(drop)
}

/// By how many rows and columns the `use_number`th use of a table of this size in a frame is displaced.
#[pyfunction]
pub fn displacement(height: usize, width: usize, use_number: crate::counts::Number) -> (usize, usize) {
    let by = Extent::still(height, width).displacement(use_number.0);
    (by.y, by.x)
}
