//! Tables in files.

use std::path::PathBuf;

use fsot::SampleTable;
use fsot::files::Metadata;
use pyo3::prelude::*;

use crate::arrays::{table_of, table_to_numpy};
use crate::errors::OrPython;
use crate::json;

/// Writes a table, and its metadata beside it if there are any.
#[pyfunction]
pub fn save_table(
    py: Python<'_>,
    path: PathBuf,
    array: &Bound<'_, PyAny>,
    metadata: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let table = table_of(array)?;
    let metadata: Option<Metadata> = metadata.map(json::of_python).transpose()?;
    let save = || match &metadata {
        Some(metadata) => table.save_with(&path, metadata),
        None => table.save(&path),
    };
    py.detach(save).python()
}

/// Reads a table, and its metadata if there are any beside it.
#[pyfunction]
pub fn load_table(py: Python<'_>, path: PathBuf) -> PyResult<(Bound<'_, PyAny>, Bound<'_, PyAny>)> {
    let has_metadata = Metadata::path_beside(&path).exists();
    let load = || -> Result<_, fsot::files::TableError> {
        if has_metadata {
            return SampleTable::load_with(&path).map(|(table, metadata)| (table, Some(metadata)));
        }
        SampleTable::load(&path).map(|table| (table, None))
    };
    let (table, metadata) = py.detach(load).python()?;
    Ok((table_to_numpy(py, table)?, json::to_python(py, &metadata)?))
}

/// Refuses what is no table.
#[pyfunction]
pub fn check_table(array: &Bound<'_, PyAny>) -> PyResult<()> {
    table_of(array).map(drop)
}
