//! Arrays of any kind in, numpy arrays out.

use fsot::{Extent, SampleTable};
use ndarray::{Array, Dimension};
use numpy::{Element, PyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::OrPython;

/// Numbers in C order, with the lengths of their axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers<T> {
    pub shape: Vec<usize>,
    pub values: Vec<T>,
}

impl<T: Element + Copy> Numbers<T> {
    /// Copies whatever `numpy.asarray` takes: lists, arrays of any strides and byte order, tensors on the
    /// CPU. Whole numbers and truth values become numbers of this type.
    ///
    /// # Errors
    /// A `TypeError` for anything but real numbers: complex ones, texts, objects, ragged lists.
    pub fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = object.py();
        refuse_masked(object)?;
        let numpy = py.import("numpy")?;
        let given = numpy.call_method1("asarray", (object,)).map_err(|error| {
            let sentence =
                format!("no array of numbers: {}; give one that numpy.asarray takes", error.value(py));
            if error.is_instance_of::<PyValueError>(py) || error.is_instance_of::<PyTypeError>(py) {
                PyTypeError::new_err(sentence)
            } else {
                error
            }
        })?;
        let dtype = given.getattr("dtype")?;
        let kind: String = dtype.getattr("kind")?.extract()?;
        if !["b", "i", "u", "f"].contains(&kind.as_str()) {
            return Err(PyTypeError::new_err(format!(
                "an array of dtype {dtype}: give real numbers, as by array.astype('float32')"
            )));
        }
        let wanted = PyDict::new(py);
        wanted.set_item("dtype", numpy::dtype::<T>(py))?;
        wanted.set_item("order", "C")?;
        let array = numpy.call_method("asarray", (given,), Some(&wanted))?;
        let array = array.cast_into::<PyArrayDyn<T>>()?;
        let shape = array.shape().to_vec();
        let array = array.try_readonly()?;
        Ok(Self { shape, values: array.as_slice()?.to_vec() })
    }
}

/// Refuses arrays, and lists of arrays, of which a part is masked: numpy would give what is below the mask.
pub fn refuse_masked(object: &Bound<'_, PyAny>) -> PyResult<()> {
    let refuse = object.py().import("fsot._arrays")?.getattr("refuse_masked")?;
    refuse.call1((object, "numbers")).map(drop)
}

/// Gives an array to Python, without a copy.
pub fn to_numpy<T: Element, D: Dimension>(py: Python<'_>, array: Array<T, D>) -> Bound<'_, PyArray<T, D>> {
    PyArray::from_owned_array(py, array)
}

/// The values of a table as an array `[frame, y, x, sample, dim]`, without a copy.
pub fn table_to_numpy(py: Python<'_>, table: SampleTable) -> PyResult<Bound<'_, PyAny>> {
    let shape = table.shape();
    let array = Array::from_shape_vec(shape, table.into_values()).expect("a table fits its shape");
    Ok(to_numpy(py, array).into_any())
}

/// The same, of an array that nobody can write to.
pub fn table_to_read(py: Python<'_>, table: SampleTable) -> PyResult<Bound<'_, PyAny>> {
    let array = table_to_numpy(py, table)?;
    array.getattr("flags")?.setattr("writeable", false)?;
    Ok(array)
}

/// A table of an array `[frame, y, x, sample, dim]`.
///
/// # Errors
/// Another number of axes; values outside of `[0, 1)`.
pub fn table_of(object: &Bound<'_, PyAny>) -> PyResult<SampleTable> {
    let Numbers { shape, values } = Numbers::<f32>::of(object)?;
    let &[frames, height, width, spp, dims] = shape.as_slice() else {
        return Err(PyValueError::new_err(format!(
            "an array of shape {shape:?}: give the five axes [frame, y, x, sample, dim]"
        )));
    };
    SampleTable::new(Extent { frames, height, width, spp }, dims, values).python()
}
