//! Slices as arrays.

use std::sync::Arc;

use fsot::Objective;
use fsot::objective::Slice;
use ndarray::{Array1, Array2};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{Numbers, to_numpy};
use crate::errors::refused;
use crate::objective::PyObjective;
use crate::own::{array, wholes};

/// The dimensions of a table, and those that each term of an objective sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    pub dims: usize,
    pub of_terms: Vec<Vec<usize>>,
}

impl Groups {
    pub fn of(objective: &Objective) -> Self {
        Self { dims: objective.dims(), of_terms: objective.terms().map(|term| term.dims.clone()).collect() }
    }
}

/// Draws of an objective: each a class, a level and a direction.
///
/// `Objective.draw` makes them; the constructor takes those of one's own. Behaves as a sequence: `len`, `+`,
/// and indices, ranges and masks as of a numpy array, which all give `Slices`.
///
/// Parameters
/// ----------
/// objective : Objective
///     Whose slices they are.
/// term : array_like of int
///     Which term of the objective, of shape [slice]; or one for all.
/// member : array_like of int
///     Which class of the term's family, of shape [slice]; or one for all. The number of the pixel in C order
///     over [frame, y, x], of the frame, of the list; 0 for the whole table.
/// level : array_like of float
///     Levels in [0, 1), of shape [slice]; or one for all. A slice holds the samples whose weight exceeds
///     that share of the largest.
/// direction : array_like of float
///     Directions in the space of the table, of shape [slice, dim]: unit vectors, unless you know why not,
///     with 0 in the dimensions that the term doesn't see.
/// cut : array_like of float, optional
///     Where each dimension is cut open, in [0, 1), of shape [slice, dim]; used on a torus only.
#[pyclass(frozen, name = "Slices", module = "fsot", from_py_object)]
#[derive(Clone, Debug)]
pub struct PySlices {
    pub slices: Arc<Vec<Slice>>,
    pub groups: Arc<Groups>,
}

#[pymethods]
impl PySlices {
    #[new]
    #[pyo3(signature = (objective, term, member, level, direction, cut = None))]
    fn new(
        objective: PyRef<'_, PyObjective>,
        term: &Bound<'_, PyAny>,
        member: &Bound<'_, PyAny>,
        level: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        cut: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::of(objective.groups.clone(), term, member, level, direction, cut)
    }

    /// Which term of the objective, [slice], uint32.
    #[getter]
    fn term<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        array(py, self.slices.iter().map(|slice| slice.term as u32).collect())
    }

    /// Which class of the term's family, [slice], uint32.
    #[getter]
    fn member<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        array(py, self.slices.iter().map(|slice| slice.member as u32).collect())
    }

    /// Levels in [0, 1), [slice], float64.
    #[getter]
    fn level<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.slices.iter().map(|slice| slice.level).collect())
    }

    /// Directions in the space of the table, [slice, dim], float64; 0 in dimensions that the term doesn't
    /// see.
    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.rows(py, |slice| &slice.direction)
    }

    /// Where each dimension is cut open, [slice, dim], float64; used on a torus only.
    #[getter]
    fn cut<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.rows(py, |slice| &slice.cut)
    }

    fn __len__(&self) -> usize {
        self.slices.len()
    }

    fn __getitem__(&self, key: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = key.py();
        let numpy = py.import("numpy")?;
        let places = numpy.call_method1("arange", (self.slices.len(),))?.get_item(key)?;
        let Numbers { shape, values } = Numbers::<u64>::of(&places)?;
        if shape.len() > 1 {
            return Err(refused(format!("an index of shape {shape:?}: give one of one axis at most")));
        }
        let slices = values.iter().map(|&place| self.slices[place as usize].clone()).collect();
        Ok(Self { slices: Arc::new(slices), groups: self.groups.clone() })
    }

    fn __add__(&self, other: &Self) -> PyResult<Self> {
        if self.groups != other.groups {
            return Err(refused("slices of two objectives: add those of one"));
        }
        let slices = self.slices.iter().chain(other.slices.iter()).cloned().collect();
        Ok(Self { slices: Arc::new(slices), groups: self.groups.clone() })
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.groups == other.groups && self.slices == other.slices
    }

    fn __repr__(&self) -> String {
        let Groups { dims, of_terms } = &*self.groups;
        format!("<{} slices of {} terms, {dims} dimensions>", self.slices.len(), of_terms.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let Groups { dims, of_terms } = &*self.groups;
        let arrays = (self.term(py), self.member(py), self.level(py), self.direction(py), self.cut(py));
        let parts = (*dims, of_terms.clone(), arrays).into_pyobject(py)?.into_any();
        Ok((py.get_type::<Self>().getattr("_of_arrays")?, parts))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_arrays(dims: usize, of_terms: Vec<Vec<usize>>, arrays: &Bound<'_, PyAny>) -> PyResult<Self> {
        let at = |index: usize| arrays.get_item(index);
        if let Some(dim) = of_terms.iter().flatten().find(|&&dim| dim >= dims) {
            return Err(refused(format!(
                "a term sees dimension {dim}, but there are {dims}: the pickle is damaged; write it again"
            )));
        }
        let groups = Arc::new(Groups { dims, of_terms });
        Self::of(groups, &at(0)?, &at(1)?, &at(2)?, &at(3)?, Some(&at(4)?))
    }
}

impl PySlices {
    fn of(
        groups: Arc<Groups>,
        term: &Bound<'_, PyAny>,
        member: &Bound<'_, PyAny>,
        level: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        cut: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let directions = rows_of(direction, "direction", groups.dims, None)?;
        let count = directions.nrows();
        let cuts = match cut {
            Some(cut) => rows_of(cut, "cut", groups.dims, Some(count))?,
            None => Array2::zeros((count, groups.dims)),
        };
        let terms = column(wholes(term, "term")?, "term", count)?;
        let members = column(wholes(member, "member")?, "member", count)?;
        let levels = column(Numbers::<f64>::of(level)?, "level", count)?;
        let mut slices = Vec::with_capacity(count);
        for index in 0..count {
            let term = terms[index] as usize;
            let Some(dims) = groups.of_terms.get(term) else {
                let terms = groups.of_terms.len();
                return Err(refused(format!(
                    "slice {index}: term is {term}, but the objective has {terms}: stay below it"
                )));
            };
            let direction = directions.row(index);
            let beyond = |&dim: &usize| direction[dim] != 0.0 && !dims.contains(&dim);
            if let Some(dim) = (0..groups.dims).find(beyond) {
                return Err(refused(format!(
                    "slice {index}: direction has a component along dimension {dim}, which term {term} \
                     doesn't see: give 0 there"
                )));
            }
            slices.push(Slice {
                term,
                member: members[index] as usize,
                level: levels[index],
                direction: dims.iter().map(|&dim| direction[dim]).collect(),
                cut: dims.iter().map(|&dim| cuts[[index, dim]]).collect(),
            });
        }
        Ok(Self { slices: Arc::new(slices), groups })
    }

    /// One row a slice, in the space of the table.
    fn rows<'py>(&self, py: Python<'py>, of: fn(&Slice) -> &Vec<f64>) -> Bound<'py, PyArray2<f64>> {
        let mut rows = Array2::zeros((self.slices.len(), self.groups.dims));
        for (index, slice) in self.slices.iter().enumerate() {
            for (&dim, value) in self.groups.of_terms[slice.term].iter().zip(of(slice)) {
                rows[[index, dim]] = *value;
            }
        }
        to_numpy(py, rows)
    }
}

fn rows_of(
    object: &Bound<'_, PyAny>,
    what: &str,
    dims: usize,
    count: Option<usize>,
) -> PyResult<Array2<f64>> {
    let Numbers { shape, values } = Numbers::<f64>::of(object)?;
    match *shape.as_slice() {
        [rows, columns] if columns == dims && count.is_none_or(|count| count == rows) => {
            Ok(Array2::from_shape_vec((rows, columns), values).expect("numbers fit their shape"))
        }
        _ => {
            let count = count.map_or("slices".into(), |count| count.to_string());
            Err(refused(format!("{what} has shape {shape:?}: give [{count}, {dims}], a row for each slice")))
        }
    }
}

fn column<T: Copy>(numbers: Numbers<T>, what: &str, count: usize) -> PyResult<Array1<T>> {
    let Numbers { shape, values } = numbers;
    match (shape.as_slice(), values.as_slice()) {
        ([], &[one]) => Ok(Array1::from_elem(count, one)),
        (&[given], _) if given == count => Ok(Array1::from_vec(values)),
        _ => Err(refused(format!("{what} has shape {shape:?}: give [{count}], one for each slice"))),
    }
}
