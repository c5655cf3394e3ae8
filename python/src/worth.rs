//! What a table is worth: figures, pages and pictures, by the code of the command.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fsot::SampleTable;
use fsot::files::WholeFile;
use fsot::targets::VectorMap;
use fsot_cli::inspect::{Yardstick, figures_of};
use fsot_cli::report::{Glance, Pages, Shown, pages};
use numpy::{PyArray5, PyReadonlyArray5};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{table_of, to_numpy};
use crate::counts::{Count, Number};
use crate::errors::{OrPython, failed, of_system, refused};
use crate::json;
use crate::kernel::PyKernel;
use crate::metrics::measured;
use crate::tables::metadata_of;

fn yardstick(kernel: Option<PyKernel>, seed: Number) -> Yardstick {
    Yardstick { kernel: kernel.map(|kernel| kernel.0), seed: seed.0, ..Yardstick::default() }
}

/// The figures of `fsot inspect --json`.
#[pyfunction]
#[pyo3(signature = (name, array, metadata, kernel, integrands, slices, seed, threads))]
#[allow(clippy::too_many_arguments)] // they are the arguments of a function of Python
pub fn inspect_table<'py>(
    py: Python<'py>,
    name: String,
    array: &Bound<'py, PyAny>,
    metadata: Option<&Bound<'py, PyAny>>,
    kernel: Option<PyKernel>,
    integrands: Count,
    slices: Count,
    seed: Number,
    threads: Option<Count>,
) -> PyResult<Bound<'py, PyAny>> {
    let table = table_of(array)?;
    let metadata = metadata.map(|given| metadata_of(given, &table)).transpose()?;
    let yardstick = yardstick(kernel, seed);
    let measure = move || figures_of(name, table, metadata, &yardstick, integrands.0, slices.0);
    json::to_python(py, &measured(py, threads, measure)?.map_err(|failure| failed(&*failure))?)
}

/// Writes the page of `fsot report`, and a sheet of its pictures if that is wanted.
#[pyfunction]
#[pyo3(signature = (html, png, tables, kernel, integrands, slices, seed, threads))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub fn report_tables<'py>(
    py: Python<'py>,
    html: Option<PathBuf>,
    png: Option<PathBuf>,
    tables: Vec<(String, Bound<'py, PyAny>, Option<Bound<'py, PyAny>>)>,
    kernel: Option<PyKernel>,
    integrands: Option<Count>,
    slices: Count,
    seed: Number,
    threads: Option<Count>,
) -> PyResult<()> {
    // What stands against the files is said before the work.
    for path in html.iter().chain(&png) {
        WholeFile::write(path, |_| Ok(())).map_err(|error| cannot_write(path, &error))?;
    }
    let shown = tables.iter().map(|(label, array, metadata)| {
        let table = table_of(array)?;
        let metadata = metadata.as_ref().map(|given| metadata_of(given, &table)).transpose()?;
        Ok(Shown { label: label.clone(), table, metadata })
    });
    let shown = shown.collect::<PyResult<Vec<_>>>()?;
    let yardstick = yardstick(kernel, seed);
    let integrands = integrands.map(|Count(count)| count);
    let made_by = "fsot.Table.report()";
    let measure = move || pages(shown, made_by, &yardstick, integrands, slices.0);
    let made = measured(py, threads, measure)?.map_err(|failure| failed(&*failure))?;
    let Pages { html: page, png: sheet } = made;
    let files = [(&html, page.into_bytes()), (&png, sheet)];
    let files = files.iter().filter_map(|(path, bytes)| path.as_ref().map(|path| (path, bytes)));
    let write = |(path, bytes): (&PathBuf, &Vec<u8>)| {
        let file = WholeFile::write(path, |out| out.write_all(bytes));
        file.map(|file| (path.clone(), file)).map_err(|error| cannot_write(path, &error))
    };
    // Both are complete before either appears.
    for (path, file) in files.map(write).collect::<PyResult<Vec<_>>>()? {
        file.commit().map_err(|error| cannot_write(&path, &error))?;
    }
    Ok(())
}

fn cannot_write(path: &Path, error: &io::Error) -> PyErr {
    of_system(error, format!("cannot write {}: {error}; choose another path", path.display()))
}

/// A sheet of pictures; each of them, and what it shows.
type Pictures<'py> = (Bound<'py, PyBytes>, Vec<(String, Bound<'py, PyBytes>)>);

/// What a notebook shows: a sheet of pictures as PNG; each of them, and what it shows.
#[pyfunction]
pub fn glance_at_table<'py>(py: Python<'py>, array: PyReadonlyArray5<'py, f32>) -> PyResult<Pictures<'py>> {
    let values = array.as_array().to_owned();
    let glance =
        measured(py, None, move || Glance::new(values.view()))?.map_err(|failure| failed(&*failure))?;
    let sheet = PyBytes::new(py, &glance.sheet.to_png()?);
    let pictures =
        glance.pictures.into_iter().map(|(what, picture)| Ok((what, PyBytes::new(py, &picture.to_png()?))));
    Ok((sheet, pictures.collect::<PyResult<_>>()?))
}

/// Two dimensions of a table as vectors `[frame, y, x, sample, component]`.
#[pyfunction]
pub fn mapped_table<'py>(
    py: Python<'py>,
    array: &Bound<'py, PyAny>,
    mapping: &str,
    dims: [Count; 2],
) -> PyResult<Bound<'py, PyArray5<f32>>> {
    let table: SampleTable = table_of(array)?;
    let mapping = match mapping {
        "disc" => VectorMap::Disc,
        "sphere" => VectorMap::Sphere,
        "cosine-hemisphere" => VectorMap::CosineHemisphere,
        other => {
            return Err(refused(format!("'{other}' is no mapping: write disc, sphere or cosine-hemisphere")));
        }
    };
    let dims = dims.map(|Count(dim)| dim);
    Ok(to_numpy(py, measured(py, None, move || table.mapped(mapping, dims))?.python()?))
}
