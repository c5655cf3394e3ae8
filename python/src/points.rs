//! Point sets: what is optimised, their files and their drawings.

use std::io::Write;
use std::path::{Path, PathBuf};

use fsot::classes::{PrefixLength, PrefixLengths};
use fsot::config::LabelSubsets;
use fsot::files::WholeFile;
use fsot::{Config, Extent};
use fsot_cli::points::{self, PointSet, usual};
use ndarray::Array1;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyString;
use serde_json::Value;

use crate::arrays::{Numbers, to_numpy};
use crate::config::PyConfig;
use crate::counts::{Count, Number};
use crate::errors::{OrPython, of_system, refused};
use crate::json;
use crate::picture::{Picture, Reading};
use crate::settings::with_domain;
use crate::work::left_alone;

type Labels<'py> = Option<Bound<'py, PyArray1<u32>>>;

/// A configuration, the labels of its points, slices that are usual, and how many times as wide as high the
/// square of the points is.
type Plan<'py> = (PyConfig, Labels<'py>, u64, f64);

/// What `fsot.classes` optimises.
#[pyfunction]
pub fn plan_classes<'py>(
    py: Python<'py>,
    counts: Vec<Count>,
    dims: Count,
    subsets: &Bound<'_, PyAny>,
    domain: Option<&Bound<'_, PyAny>>,
    seed: Number,
) -> PyResult<Plan<'py>> {
    let counts: Vec<usize> = counts.into_iter().map(|Count(count)| count).collect();
    let total = counts.iter().fold(0, |sum: usize, &count| sum.saturating_add(count));
    if total == 0 {
        return Err(refused("there are no points: give counts of which one is above 0"));
    }
    // Before the labels are listed.
    Extent::points(total).validate(dims.0).python()?;
    let subsets = subsets_of(subsets)?;
    let config = Config::classes(&counts, dims.0, &subsets).with_seed(seed.0);
    let config = domain.map_or(Ok(config.clone()), |domain| with_domain(config, domain))?;
    Ok((PyConfig(config), labels(py, &counts), usual::CLASSES_SLICES, 1.0))
}

fn subsets_of(subsets: &Bound<'_, PyAny>) -> PyResult<LabelSubsets> {
    if let Ok(name) = subsets.cast::<PyString>() {
        return match name.to_str()? {
            "each_and_all" => Ok(LabelSubsets::EachAndAll),
            "every" => Ok(LabelSubsets::Every),
            other => Err(refused(format!(
                "'{other}' names no sets of classes: write each_and_all or every, or give lists of labels"
            ))),
        };
    }
    let label = |Count(label): Count| {
        u32::try_from(label)
            .map_err(|_| refused(format!("{label} is no label: give those of the counts, from 0")))
    };
    let set = |set: Bound<'_, PyAny>| set.try_iter()?.map(|one| label(one?.extract()?)).collect();
    subsets.try_iter()?.map(|one| set(one?)).collect::<PyResult<_>>().map(LabelSubsets::Given)
}

/// What `fsot.progressive` optimises.
#[pyfunction]
pub fn plan_progressive<'py>(
    count: Count,
    dims: Count,
    lengths: &Bound<'_, PyAny>,
    domain: Option<&Bound<'_, PyAny>>,
    seed: Number,
) -> PyResult<Plan<'py>> {
    Extent::points(some(count)?).validate(dims.0).python()?;
    let config = Config::progressive(count.0, dims.0, lengths_of(lengths)?).with_seed(seed.0);
    let config = domain.map_or(Ok(config.clone()), |domain| with_domain(config, domain))?;
    Ok((PyConfig(config), None, usual::PROGRESSIVE_SLICES, 1.0))
}

fn lengths_of(lengths: &Bound<'_, PyAny>) -> PyResult<PrefixLengths> {
    if let Ok(name) = lengths.cast::<PyString>() {
        return match name.to_str()? {
            "powers_of_two" => Ok(PrefixLengths::PowersOfTwo),
            "every" => Ok(PrefixLengths::Every),
            other => Err(refused(format!(
                "'{other}' names no lengths: write powers_of_two or every, or give a list of lengths"
            ))),
        };
    }
    let length = |one: Bound<'_, PyAny>| -> PyResult<PrefixLength> {
        match one.extract::<(Count, f64)>() {
            Ok((Count(length), weight)) => Ok(PrefixLength { length, weight }),
            Err(_) => {
                let Count(length) = one.extract()?;
                // As of those that are usual. A length of 0 is refused for what it is.
                Ok(PrefixLength { length, weight: 1.0 / length.max(1) as f64 })
            }
        }
    };
    lengths.try_iter()?.map(|one| length(one?)).collect::<PyResult<_>>().map(PrefixLengths::Given)
}

/// What `fsot.stippling` optimises.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // they are the arguments of a function of Python
pub fn plan_stippling<'py>(
    py: Python<'py>,
    picture: &Bound<'_, PyAny>,
    count: Count,
    tone: &str,
    transfer: Option<&str>,
    layer: Option<String>,
    most_pixels: Option<Count>,
    limit_pixels: Count,
    seed: Number,
    threads: Option<Count>,
) -> PyResult<Plan<'py>> {
    Extent::points(some(count)?).validate(2).python()?;
    let reading = Reading::of(tone, transfer, layer, most_pixels, limit_pixels)?;
    let picture = Picture::of(picture)?;
    let threads = threads.map(|Count(threads)| threads);
    let density = left_alone(py, threads, move || picture.density(&reading))?.python()?;
    let size = density.size();
    let config = Config::stippling(count.0, density).with_seed(seed.0);
    Ok((PyConfig(config), None, usual::STIPPLE_SLICES, aspect(size)))
}

/// What `fsot.color_stippling` optimises.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // they are the arguments of a function of Python
pub fn plan_color_stippling<'py>(
    py: Python<'py>,
    picture: &Bound<'_, PyAny>,
    count: Count,
    transfer: Option<&str>,
    layer: Option<String>,
    most_pixels: Option<Count>,
    limit_pixels: Count,
    seed: Number,
    threads: Option<Count>,
) -> PyResult<Plan<'py>> {
    Extent::points(some(count)?).validate(2).python()?;
    let reading = Reading::of("dark", transfer, layer, most_pixels, limit_pixels)?;
    let picture = Picture::of(picture)?;
    let threads = threads.map(|Count(threads)| threads);
    let inks = left_alone(py, threads, move || picture.inks(&reading))?.python()?;
    // There is at least one, and all are of one size.
    let size = (0..4).find_map(|ink| inks.density(ink)).map_or([1, 1], |density| density.size());
    let config = Config::color_stippling(count.0, &inks).with_seed(seed.0);
    Ok((PyConfig(config), labels(py, &inks.counts(count.0)), usual::COLOR_SLICES, aspect(size)))
}

fn some(Count(count): Count) -> PyResult<usize> {
    if count > 0 { Ok(count) } else { Err(refused("count is 0: give at least 1 point")) }
}

fn aspect([width, height]: [usize; 2]) -> f64 {
    width as f64 / height as f64
}

/// `counts[0]` times 0, `counts[1]` times 1, and so on.
fn labels<'py>(py: Python<'py>, counts: &[usize]) -> Labels<'py> {
    let runs = (0..).zip(counts).flat_map(|(label, &count)| std::iter::repeat_n(label, count));
    Some(to_numpy(py, Array1::from_iter(runs)))
}

/// Points `[n, d]`, and the labels of all of them, or 0.
pub fn set_of(points: &Bound<'_, PyAny>, labels: Option<&Bound<'_, PyAny>>) -> PyResult<PointSet> {
    let Numbers { shape, values } = Numbers::<f32>::of(points)?;
    let &[count, dims] = shape.as_slice() else {
        return Err(refused(format!("points of shape {shape:?}: give two axes [n, d]")));
    };
    // Who has given the array may have written to it.
    if let Some(at) = values.iter().position(|value| !(0.0..1.0).contains(value)) {
        let (point, dim, value) = (at / dims, at % dims, values[at]);
        return Err(refused(format!(
            "coordinate {dim} of point {point} is {value}: give numbers from 0 to below 1"
        )));
    }
    let labels = match labels {
        Some(labels) => Numbers::<u32>::of(labels)?.values,
        None => vec![0; count],
    };
    PointSet::of_parts(values, dims, labels).ok_or_else(|| refused("give as many labels as points"))
}

/// Writes points, and how they were made beside them.
#[pyfunction]
pub fn save_points(
    py: Python<'_>,
    path: PathBuf,
    points: &Bound<'_, PyAny>,
    labels: Option<&Bound<'_, PyAny>>,
    metadata: &Bound<'_, PyAny>,
) -> PyResult<()> {
    if !["npy", "csv"]
        .iter()
        .any(|ending| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending)))
    {
        return Err(refused(format!("{}: give a file name that ends in .npy or .csv", path.display())));
    }
    let set = set_of(points, labels)?;
    let metadata: Value = json::of_python_called("metadata", metadata)?;
    let write = || -> std::io::Result<()> {
        let coordinates = set.file(&path)?;
        let record = points::record_text(&set, &coordinates, &metadata)?;
        let write = |path: &Path, bytes: Vec<u8>| WholeFile::write(path, |out| out.write_all(&bytes));
        // Both or none, as far as that can be had.
        let beside = write(&points::record_path(&path), record)?;
        write(&path, coordinates)?.commit()?;
        beside.commit()
    };
    py.detach(write).map_err(|error| {
        let advice = "check the path and its permissions";
        let sentence = format!("cannot write {}: {error}; {advice}", path.display());
        of_system(&error, sentence)
    })
}
