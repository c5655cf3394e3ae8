//! What is measured: tables, arrays of tables' shape, points; in single or double precision.

use fsot::Extent;
use fsot::metrics::{MeasureError, Samples};
use ndarray::Array2;
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::Numbers;
use crate::counts::Count;
use crate::errors::refused;

/// Samples that a caller has given, with a lattice if they have one.
#[derive(Clone, Debug)]
pub struct Given {
    pub dims: usize,
    extent: Option<Extent>,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    F32(Vec<f32>),
    F64(Vec<f64>),
}

impl Given {
    /// Takes a table, an array `[frame, y, x, sample, dim]`, or points `[point, dim]`.
    ///
    /// # Errors
    /// Another number of axes; what is no array of real numbers. Values are looked at by [`Given::samples`].
    pub fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (shape, values) = match is_narrow(object)? {
            true => {
                let Numbers { shape, values } = Numbers::<f32>::of(object)?;
                (shape, Values::F32(values))
            }
            false => {
                let Numbers { shape, values } = Numbers::<f64>::of(object)?;
                (shape, Values::F64(values))
            }
        };
        match *shape.as_slice() {
            [frames, height, width, spp, dims] => {
                Ok(Self { dims, extent: Some(Extent { frames, height, width, spp }), values })
            }
            [_, dims] => Ok(Self { dims, extent: None, values }),
            _ => Err(refused(format!(
                "samples of shape {shape:?}: give a table [frame, y, x, sample, dim] or points [point, dim]"
            ))),
        }
    }

    /// What the library measures. O(values).
    ///
    /// # Errors
    /// Nothing to measure; values outside of `[0, 1)`.
    pub fn samples(&self) -> Result<Samples<'_>, MeasureError> {
        let points = match &self.values {
            Values::F32(values) => Samples::points(values.as_slice(), self.dims)?,
            Values::F64(values) => Samples::points(values.as_slice(), self.dims)?,
        };
        match self.extent {
            Some(extent) => points.on(extent),
            None => Ok(points),
        }
    }

    /// Frames of a table; points are of one.
    pub fn frames(&self) -> usize {
        self.extent.map_or(1, |extent| extent.frames)
    }

    /// Frames, height, width and samples per pixel.
    pub fn extent(&self) -> Extent {
        let values = match &self.values {
            Values::F32(values) => values.len(),
            Values::F64(values) => values.len(),
        };
        self.extent.unwrap_or(Extent::points(values / self.dims.max(1)))
    }

    /// The coordinates of a group of dimensions, `[point, dim]`. The samples must have them.
    pub fn coordinates(&self, group: &[usize]) -> Array2<f64> {
        fn gathered<T: Copy + Into<f64>>(values: &[T], dims: usize, group: &[usize]) -> Vec<f64> {
            values.chunks_exact(dims).flat_map(|x| group.iter().map(|&dim| x[dim].into())).collect()
        }
        let values = match &self.values {
            Values::F32(values) => gathered(values, self.dims, group),
            Values::F64(values) => gathered(values, self.dims, group),
        };
        let count = values.len() / group.len();
        Array2::from_shape_vec((count, group.len()), values).expect("a coordinate per dimension and point")
    }
}

/// Whether single precision holds what is given.
fn is_narrow(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    // What is no array is refused elsewhere.
    let Ok(array) = object.py().import("numpy")?.call_method1("asarray", (object,)) else { return Ok(true) };
    let dtype = array.cast_into::<PyUntypedArray>()?.dtype();
    let kind: String = dtype.getattr("kind")?.extract()?;
    let bytes: usize = dtype.getattr("itemsize")?.extract()?;
    Ok(kind == "f" && bytes <= 4)
}

/// The dimensions that are measured together: all, if none are named.
pub fn group_of(dims: Option<&Bound<'_, PyAny>>, all: usize) -> PyResult<Vec<usize>> {
    let Some(dims) = dims else { return Ok((0..all).collect()) };
    if let Ok(Count(one)) = dims.extract() {
        return Ok(vec![one]);
    }
    dims.try_iter()?.map(|dim| Ok(dim?.extract::<Count>()?.0)).collect()
}
