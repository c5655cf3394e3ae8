//! Filters.

use fsot::kernel::{SpatialKernel, Tap, TemporalKernel};
use fsot::{Extent, Kernel};
use ndarray::Array2;
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{Numbers, to_numpy};
use crate::errors::{OrPython, refused};
use crate::json;

/// A filter over pixels and frames, under which errors are to be small.
#[pyclass(frozen, eq, name = "Kernel", module = "fsot", from_py_object)]
#[derive(Clone, Debug, PartialEq)]
pub struct PyKernel(pub Kernel);

#[pymethods]
impl PyKernel {
    /// The Gaussian `exp(-r² / sigma²)`, whose standard deviation is `sigma / sqrt(2)`.
    #[staticmethod]
    #[pyo3(signature = (sigma = 2.1, *, temporal = None))]
    fn gaussian(sigma: f64, temporal: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self(Kernel::product(SpatialKernel::Gaussian { sigma_px: sigma }, in_time(temporal)?)))
    }

    /// Equal weights on `size` times `size` pixels.
    #[staticmethod]
    #[pyo3(signature = (size, *, temporal = None))]
    fn box_(size: usize, temporal: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self(Kernel::product(SpatialKernel::Box { size_px: size }, in_time(temporal)?)))
    }

    /// The outer product of the binomial coefficients of `size` taps.
    #[staticmethod]
    #[pyo3(signature = (size, *, temporal = None))]
    fn binomial(size: usize, temporal: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self(Kernel::product(SpatialKernel::Binomial { size_px: size }, in_time(temporal)?)))
    }

    /// The same in space, times this in time: see `fsot.table`.
    fn with_temporal(&self, temporal: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(self.0.clone().with_temporal(in_time(Some(temporal))?)))
    }

    /// The taps on a tile that wraps, by falling weight: rows of `[dt, dy, dx, weight]`.
    #[pyo3(signature = (width = 64, height = 64, frames = 1))]
    fn taps<'py>(
        &self,
        py: Python<'py>,
        width: usize,
        height: usize,
        frames: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let taps = self.0.taps(&Extent { frames, height, width, spp: 1 }).python()?;
        Ok(rows(py, &taps))
    }

    /// Plain data, as in metadata.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        json::of_python(data).map(Self)
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("Kernel.from_dict({})", serde_json::to_string(&self.0).python()?))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        Ok((py.get_type::<Self>().getattr("from_dict")?, (self.to_dict(py)?,)))
    }
}

/// A temporal kernel as it is written on a command line, or weights with the current frame first.
pub fn in_time(temporal: Option<&Bound<'_, PyAny>>) -> PyResult<TemporalKernel> {
    let Some(temporal) = temporal else { return Ok(TemporalKernel::None) };
    match temporal.extract::<String>() {
        Ok(text) => fsot_cli::temporal::parse(&text).map_err(refused),
        Err(_) => Ok(TemporalKernel::Taps(Numbers::<f64>::of(temporal)?.values)),
    }
}

/// Taps as rows of `[dt, dy, dx, weight]`.
pub fn rows<'py>(py: Python<'py>, taps: &[Tap]) -> Bound<'py, PyArray2<f64>> {
    let row = |tap: &Tap| [f64::from(tap.dt), f64::from(tap.dy), f64::from(tap.dx), tap.weight];
    let values = taps.iter().flat_map(row).collect();
    to_numpy(py, Array2::from_shape_vec((taps.len(), 4), values).expect("four numbers a tap"))
}
