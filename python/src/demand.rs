//! The part of a table that a renderer reads in earnest.

use fsot::classes::Demand;
use fsot::config::MOST_DIMS;
use pyo3::prelude::*;

use crate::arrays::{Numbers, to_numpy};
use crate::errors::{OrPython, refused};
use crate::term::dims_of;

/// The part of a table that a renderer reads in earnest.
///
/// Samples of other pixels, and other dimensions, keep their white noise and cost nothing. A demand of other
/// width, height or frames than the table is folded onto it, which tiles the picture.
///
/// Parameters
/// ----------
/// pixels : array_like of bool
///     What is demanded, of shape [frame, y, x] or [y, x].
/// groups : sequence of sequences of int, optional
///     Groups of dimensions that are consumed together; all dimensions by default.
///
/// Examples
/// --------
/// The left half of a picture:
///
/// >>> import numpy, fsot
/// >>> demand = fsot.Demand(numpy.arange(32) < numpy.full((32, 1), 16))
/// >>> demand.share
/// 0.5
/// >>> optimizer = fsot.Optimizer(fsot.Config(32, 32), demand=demand)
#[pyclass(frozen, eq, name = "Demand", module = "fsot", from_py_object)]
#[derive(Clone, Debug, PartialEq)]
pub struct PyDemand {
    shape: [usize; 3],
    /// Without groups if those are all dimensions.
    demand: Demand,
    all_dims: bool,
}

#[pymethods]
impl PyDemand {
    #[new]
    #[pyo3(signature = (pixels, groups = None))]
    fn new(pixels: &Bound<'_, PyAny>, groups: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::<bool>::of(pixels)?;
        let shape = match *shape.as_slice() {
            [height, width] => [1, height, width],
            [frames, height, width] => [frames, height, width],
            _ => {
                return Err(refused(format!(
                    "a demand of shape {shape:?}: give the axes [frame, y, x] or [y, x]"
                )));
            }
        };
        let all_dims = groups.is_none();
        let groups = match groups {
            Some(groups) => groups.try_iter()?.map(|group| dims_of(&group?)).collect::<PyResult<_>>()?,
            None => Vec::new(),
        };
        Ok(Self { shape, demand: Demand::new(shape, values, groups).python()?, all_dims })
    }

    /// What is demanded, of shape [frame, y, x]; a copy.
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let pixels = self.demand.pixels().to_vec();
        to_numpy(py, ndarray::Array::from_shape_vec(self.shape, pixels).expect("a flag a pixel")).into_any()
    }

    /// Groups of dimensions that are consumed together; None for all dimensions.
    #[getter]
    fn groups(&self) -> Option<Vec<Vec<usize>>> {
        (!self.all_dims).then(|| self.demand.groups().to_vec())
    }

    /// Demanded share of all pixels, in [0, 1].
    #[getter]
    fn share(&self) -> f64 {
        self.demand.share()
    }

    fn __repr__(&self) -> String {
        let [frames, height, width] = self.shape;
        let (count, all) = (self.demand.count(), frames * height * width);
        format!("<Demand: {count} of {all} pixels, {frames} x {height} x {width}>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts<'py>)> {
        Ok((py.get_type::<Self>().into_any(), (self.pixels(py), self.groups())))
    }
}

type Parts<'py> = (Bound<'py, PyAny>, Option<Vec<Vec<usize>>>);

impl PyDemand {
    /// For a table of so many dimensions.
    pub fn of(&self, dims: usize) -> PyResult<Demand> {
        match self.all_dims {
            false => Ok(self.demand.clone()),
            true => Demand::new(
                self.shape,
                self.demand.pixels().to_vec(),
                vec![(0..dims.min(MOST_DIMS)).collect()],
            )
            .python(),
        }
    }
}
