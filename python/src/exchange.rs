//! Tables in other people's formats.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::str::FromStr;

use fsot::SampleTable;
use fsot::files::{Axis, Dtype, ExportOptions, Exported, Format, ImportOptions, Imported};
use pyo3::prelude::*;

use crate::arrays::{table_of, table_to_read};
use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};
use crate::json;
use crate::work::{Caller, left_alone, watched};

/// An option by its name, refused as on a command line.
fn named<T: FromStr<Err = String>>(what: &str, text: &str) -> PyResult<T> {
    text.parse().map_err(|problem: String| match problem.starts_with('\'') {
        true => refused(format!("{what}: {problem}")),
        false => refused(format!("'{text}' is no {what}: {problem}")),
    })
}

/// Files, the record beside them, and what it says.
type Written<'py> = (Vec<PathBuf>, PathBuf, Bound<'py, PyAny>);

/// Writes a table in a format of somebody else's.
#[pyfunction]
#[pyo3(signature = (path, array, format, bits, rounding, name))]
pub fn export_table<'py>(
    py: Python<'py>,
    path: PathBuf,
    array: &Bound<'py, PyAny>,
    format: &str,
    bits: Option<&str>,
    rounding: &str,
    name: Option<String>,
) -> PyResult<Written<'py>> {
    let options = ExportOptions {
        depth: bits.map(|bits| named("number of bits", bits)).transpose()?,
        rounding: named("rounding", rounding)?,
        name,
        ..ExportOptions::new(named::<Format>("format", format)?)
    };
    let table = table_of(array)?;
    let work = |caller: &Caller<'_, ()>| {
        table.export_observed(&path, &options, |_| match caller.wants_an_end() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    };
    let (exported, exception) = watched(py, Some(1), work, |_| Ok(()))?;
    match (exported, exception) {
        (Err(_), Some(exception)) => Err(exception),
        // Ctrl-C came when all was done: it is heard, and the files are there.
        (Ok(_), Some(exception)) => Err(exception),
        (exported, None) => {
            let Exported { files, record_path, record, .. } = exported.python()?;
            Ok((files, record_path, json::to_python(py, &record)?))
        }
    }
}

/// The sentence about it, and what was taken for what.
type Taken =
    (String, String, Vec<usize>, Vec<&'static str>, Option<u64>, u64, usize, Vec<usize>, Option<PathBuf>);

/// Makes a table of somebody else's file.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // they are the arguments of a function of Python
#[pyo3(signature = (path, axes, levels, lengths, channels, dtype, array))]
pub fn import_table<'py>(
    py: Python<'py>,
    path: PathBuf,
    axes: Vec<String>,
    levels: Option<Number>,
    lengths: [Option<Count>; 5],
    channels: Option<Count>,
    dtype: Option<&str>,
    array: Option<String>,
) -> PyResult<(Bound<'py, PyAny>, Taken)> {
    let [frames, height, width, spp, dims] = lengths.map(|length| length.map(|Count(length)| length));
    let options = ImportOptions {
        axes: axes.iter().map(|axis| named::<Axis>("axes", axis)).collect::<PyResult<_>>()?,
        levels: levels.map(|Number(levels)| levels),
        frames,
        height,
        width,
        spp,
        dims,
        channels: channels.map(|Count(channels)| channels),
        dtype: dtype.map(|dtype| named::<Dtype>("dtype", dtype)).transpose()?,
        array,
    };
    let imported = left_alone(py, None, move || SampleTable::import(&path, &options))?.python()?;
    let sentence = imported.to_string();
    let Imported { table, dtype, shape, axes, levels, first_level, ones, left_out, record, .. } = imported;
    let axes = axes.iter().map(|axis| axis.name()).collect();
    let taken = (sentence, dtype, shape, axes, levels, first_level, ones, left_out, record);
    Ok((table_to_read(py, table)?, taken))
}
