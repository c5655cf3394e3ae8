//! One test integrand: of the library's, or a function of Python's.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use fsot::metrics::{Integrand, Integrands};
use ndarray::Array2;
use numpy::PyArray1;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use super::measured;
use crate::arrays::{Numbers, to_numpy};
use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};

/// A function on the unit cube whose mean and variance under the uniform distribution are known.
///
/// Parameters
/// ----------
/// function : callable
///     Takes an array of points ``[point, dim]``, float64 in ``[0, 1)``, that it must not change, and returns
///     one number for each. It is called once for each measurement, with all samples, on the thread that
///     measures; what it raises is raised there.
/// dims : int
///     Coordinates of a point.
/// integral, variance : float, optional
///     Mean and variance over the unit cube: both, or neither. If they are left out they are estimated from
///     the function itself. An integral that is off by `d` adds ``n d**2 / variance`` to ratios over `n`
///     samples.
/// points : int
///     Points of the Halton sequence that they are estimated from; many more than there are samples.
///
/// Examples
/// --------
/// >>> import fsot
/// >>> product = fsot.metrics.Integrand(lambda x: x[:, 0] * x[:, 1], 2)
/// >>> round(product.integral, 4)
/// 0.25
#[pyclass(frozen, name = "Integrand", module = "fsot.metrics", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyIntegrand(pub Source);

/// Where values come from.
#[derive(Clone, Debug)]
pub enum Source {
    /// The library, with the numbers that draw it again.
    Drawn { integrand: Integrand, seed: u64, family: usize, index: usize },
    /// A caller.
    Own(Arc<Own>),
}

/// A function of Python's.
#[derive(Debug)]
pub struct Own {
    pub function: Py<PyAny>,
    pub dims: usize,
    pub integral: f64,
    pub variance: f64,
}

const MOST_DIMS: usize = 64;
/// Of the points of an estimate: a gibibyte.
const MOST_COORDINATES: usize = 1 << 27;

#[pymethods]
impl PyIntegrand {
    #[new]
    #[pyo3(signature = (function, dims, integral = None, variance = None, *, points = Count(1 << 18)),
        text_signature = "(function, dims, integral=None, variance=None, *, points=262144)")]
    fn new(
        py: Python<'_>,
        function: Bound<'_, PyAny>,
        dims: Count,
        integral: Option<f64>,
        variance: Option<f64>,
        points: Count,
    ) -> PyResult<Self> {
        if !function.is_callable() {
            return Err(PyTypeError::new_err(format!(
                "{} cannot be called: give a function of points [point, dim]",
                function.get_type().name()?
            )));
        }
        let Count(dims) = dims;
        if dims > MOST_DIMS {
            return Err(refused(format!("the number of dimensions is {dims}: give a value of at most 64")));
        }
        let (integral, variance) = match (integral, variance) {
            (Some(integral), Some(variance)) => (integral, variance),
            (None, None) => {
                let points = read_only(py, halton(py, dims, points.0)?)?;
                let values = values_of(&function, &points)?;
                let count = values.len() as f64;
                let mean = values.iter().sum::<f64>() / count;
                (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count)
            }
            _ => {
                return Err(refused("integral and variance belong together: give both, or neither"));
            }
        };
        // The library's checks, in its words.
        Integrand::new(dims, |_| 0.0, integral, variance).python()?;
        Ok(Self(Source::Own(Arc::new(Own { function: function.unbind(), dims, integral, variance }))))
    }

    /// Coordinates of a point.
    #[getter]
    pub fn dims(&self) -> usize {
        match &self.0 {
            Source::Drawn { integrand, .. } => integrand.dims(),
            Source::Own(own) => own.dims,
        }
    }

    /// Mean over the unit cube.
    #[getter]
    fn integral(&self) -> f64 {
        match &self.0 {
            Source::Drawn { integrand, .. } => integrand.integral(),
            Source::Own(own) => own.integral,
        }
    }

    /// Variance of the value at a uniformly distributed point.
    #[getter]
    fn variance(&self) -> f64 {
        match &self.0 {
            Source::Drawn { integrand, .. } => integrand.variance(),
            Source::Own(own) => own.variance,
        }
    }

    /// Values at points ``[point, dim]``, float64.
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let Numbers { shape, values } = Numbers::<f64>::of(points)?;
        let dims = self.dims();
        if shape.len() != 2 || shape[1] != dims {
            return Err(refused(format!("points of shape {shape:?}: give an array [point, {dims}]")));
        }
        let values = match &self.0 {
            Source::Drawn { integrand, .. } => {
                values.chunks_exact(dims).map(|point| integrand.value(point)).collect()
            }
            Source::Own(own) => {
                let points = Array2::from_shape_vec((shape[0], dims), values).expect("as they came");
                values_of(own.function.bind(py), &read_only(py, points)?)?
            }
        };
        Ok(PyArray1::from_vec(py, values))
    }

    fn __repr__(&self) -> String {
        let (dims, integral, variance) = (self.dims(), self.integral(), self.variance());
        format!("<integrand of {dims} coordinates, integral {integral:.6}, variance {variance:.6}>")
    }

    /// The integrand that ``Integrands.random`` draws with these numbers.
    #[staticmethod]
    fn _drawn(dims: Count, seed: Number, family: Count, index: Count) -> PyResult<Self> {
        let per_family = index.0.saturating_add(1);
        let all = Integrands::random(dims.0, per_family, seed.0).python()?;
        let family = family.0.min(all.families().len() - 1);
        let integrand = all.families()[family].integrands()[index.0].clone();
        Ok(Self(Source::Drawn { integrand, seed: seed.0, family, index: index.0 }))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let class = py.get_type::<Self>();
        Ok(match &self.0 {
            Source::Drawn { integrand, seed, family, index } => {
                let numbers = (integrand.dims(), *seed, *family, *index);
                (class.getattr("_drawn")?, numbers.into_pyobject(py)?.into_any())
            }
            Source::Own(own) => {
                let parts = (own.function.bind(py), own.dims, own.integral, own.variance);
                (class.into_any(), parts.into_pyobject(py)?.into_any())
            }
        })
    }
}

impl PyIntegrand {
    /// The integrand as the library measures it: a function of Python's is called here, once, and what
    /// follows looks its values up.
    pub(super) fn at(&self, py: Python<'_>, places: &mut Places<'_>) -> PyResult<Integrand> {
        match &self.0 {
            Source::Drawn { integrand, .. } => Ok(integrand.clone()),
            Source::Own(own) => {
                let value = places.function(py, own)?;
                Integrand::new(own.dims, value, own.integral, own.variance).python()
            }
        }
    }
}

/// The places where functions are going to be asked, which the first function of Python's lists.
pub(super) struct Places<'a> {
    list: &'a dyn Fn() -> Option<Array2<f64>>,
    listed: Option<Listed>,
}

struct Listed {
    /// `None` where the samples don't have such coordinates, which the library says in its words.
    points: Option<Py<PyAny>>,
    numbers: Arc<HashMap<Box<[u64]>, usize>>,
}

impl<'a> Places<'a> {
    /// These coordinates `[point, dim]`, when they are needed.
    pub fn new(list: &'a dyn Fn() -> Option<Array2<f64>>) -> Self {
        Self { list, listed: None }
    }

    fn function(
        &mut self,
        py: Python<'_>,
        own: &Own,
    ) -> PyResult<impl Fn(&[f64]) -> f64 + Send + Sync + 'static> {
        let list = self.list;
        let listed = match &mut self.listed {
            Some(listed) => listed,
            none => none.insert(Listed::new(py, list())?),
        };
        let values = match &listed.points {
            Some(points) => values_of(own.function.bind(py), points.bind(py))?,
            None => Vec::new(),
        };
        let numbers = Arc::clone(&listed.numbers);
        Ok(move |point: &[f64]| {
            let mut bits = [0; MOST_DIMS];
            let bits = &mut bits[..point.len().min(MOST_DIMS)];
            bits.iter_mut().zip(point).for_each(|(bits, x)| *bits = x.to_bits());
            numbers.get(&*bits).map_or(f64::NAN, |&number| values[number])
        })
    }
}

impl Listed {
    fn new(py: Python<'_>, points: Option<Array2<f64>>) -> PyResult<Self> {
        let Some(points) = points else { return Ok(Self { points: None, numbers: Arc::default() }) };
        let key = |point: ndarray::ArrayView1<'_, f64>| point.iter().map(|x| x.to_bits()).collect();
        let numbers = points.outer_iter().enumerate().map(|(number, point)| (key(point), number)).collect();
        let points = read_only(py, points)?;
        Ok(Self { points: Some(points.unbind()), numbers: Arc::new(numbers) })
    }
}

/// Points that no function can change: others get them as well.
fn read_only(py: Python<'_>, points: Array2<f64>) -> PyResult<Bound<'_, PyAny>> {
    let points = to_numpy(py, points).into_any();
    points.getattr("flags")?.setattr("writeable", false)?;
    Ok(points)
}

/// Calls a function of Python's with points `[point, dim]`.
fn values_of(function: &Bound<'_, PyAny>, points: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let count = points.len()?;
    let Numbers { shape, values } = Numbers::<f64>::of(&function.call1((points,))?)?;
    if shape != [count] {
        return Err(refused(format!(
            "the integrand returns an array of shape {shape:?} for {count} points: return one number for \
             each, or wrap a function of one point, as in lambda points: [f(x) for x in points]"
        )));
    }
    if let Some(number) = values.iter().position(|value| !value.is_finite()) {
        let value = values[number];
        return Err(refused(format!("the integrand is {value} at point {number}: return finite numbers")));
    }
    Ok(values)
}

/// The points by which the library estimates integrals.
fn halton(py: Python<'_>, dims: usize, count: usize) -> PyResult<Array2<f64>> {
    if count.saturating_mul(dims) > MOST_COORDINATES {
        return Err(refused(format!(
            "the number of points is {count}: give a value of at most {}",
            MOST_COORDINATES / dims
        )));
    }
    let kept = Arc::new(Mutex::new(Vec::new()));
    let keep = Arc::clone(&kept);
    let record = move |point: &[f64]| {
        keep.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(point);
        point[0]
    };
    let estimate = measured(py, None, move || Integrand::estimated(dims, record, count))?;
    // One point has no variance: the caller's function is going to say so.
    if count != 1 {
        estimate.python()?;
    }
    let values = std::mem::take(&mut *kept.lock().unwrap_or_else(PoisonError::into_inner));
    Ok(Array2::from_shape_vec((count, dims), values).expect("all points were asked for"))
}
