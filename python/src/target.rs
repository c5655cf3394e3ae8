//! What a class should look like.

use std::sync::Arc;

use fsot::targets::{Density, PointCloud, Target};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::Numbers;
use crate::counts::Count;
use crate::errors::{OrPython, refused};
use crate::json;
use crate::own::{Law, OwnTarget, array, quantiles_of};

/// The measure that the samples of a class should resemble.
///
/// Made by its static methods; `Target.uniform()` is the default everywhere.
#[pyclass(frozen, eq, name = "Target", module = "fsot", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyTarget(pub Target);

impl PartialEq for PyTarget {
    fn eq(&self, other: &Self) -> bool {
        match (OwnTarget::of(&self.0), OwnTarget::of(&other.0)) {
            (Some(own), Some(other)) => std::ptr::eq(own, other) || own.is_same(other),
            _ => self.0 == other.0,
        }
    }
}

#[pymethods]
impl PyTarget {
    /// The uniform measure of the unit cube, for any number of dimensions.
    #[staticmethod]
    fn uniform() -> Self {
        Self(Target::UniformCube)
    }

    /// A density on the unit square: bright pixels get their share of the points.
    ///
    /// Parameters
    /// ----------
    /// values : array_like
    ///     Finite numbers of at least 0, of shape [row, column], the first row at the top: the first
    ///     coordinate of a point runs along a row, the second down.
    /// averaging : bool
    ///     Whether blocks of pixels that points are too few to tell apart are averaged, which is fast.
    #[staticmethod]
    #[pyo3(signature = (values, *, averaging = true))]
    fn density(values: &Bound<'_, PyAny>, averaging: bool) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::<f32>::of(values)?;
        let &[height, width] = shape.as_slice() else {
            return Err(refused(format!("a density of shape {shape:?}: give the two axes [row, column]")));
        };
        let density = Density::new(width, height, values).python()?.with_averaging(averaging);
        Ok(Self(Target::Density(Arc::new(density))))
    }

    /// Equally weighted points: draws of any sampler, or points to be thinned out.
    ///
    /// Parameters
    /// ----------
    /// points : array_like
    ///     Numbers in [0, 1], of shape [point, dim].
    #[staticmethod]
    fn cloud(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::<f32>::of(points)?;
        let &[_, dims] = shape.as_slice() else {
            return Err(refused(format!("a cloud of shape {shape:?}: give the two axes [point, dim]")));
        };
        Ok(Self(Target::Cloud(Arc::new(PointCloud::new(dims, values).python()?))))
    }

    /// A target of one's own by its quantile functions.
    ///
    /// Parameters
    /// ----------
    /// quantiles : array_like or callable
    ///     For one dimension an array: the quantiles at equally spaced levels from 0 to 1, in [0, 1] and not
    ///     falling; in between they are linear. For any number of dimensions a function of a direction, an
    ///     array of shape [dim], that returns such an array for the law of `x @ direction` where `x` follows
    ///     the target. It is asked once for each of some hundred directions, when an objective is planned,
    ///     by any thread; what it raises is raised there.
    /// dims : int
    ///     Number of dimensions.
    /// name : str
    ///     Name for messages and metadata, which add a digest of an array. Functions should have names of
    ///     their own, by which a checkpoint tells them apart.
    ///
    /// Examples
    /// --------
    /// Draws of a sampler, along any direction:
    ///
    /// >>> import numpy, fsot
    /// >>> draws = numpy.random.default_rng(0).beta(2, 5, (1000, 2))
    /// >>> levels = numpy.linspace(0, 1, 257)
    /// >>> target = fsot.Target.quantiles(lambda theta: numpy.quantile(draws @ theta, levels), dims=2)
    #[staticmethod]
    #[pyo3(signature = (quantiles, dims = Count(1), *, name = "quantiles"),
           text_signature = "(quantiles, dims=1, *, name='quantiles')")]
    fn quantiles(quantiles: &Bound<'_, PyAny>, dims: Count, name: &str) -> PyResult<Self> {
        let Count(dims) = dims;
        if dims == 0 {
            return Err(refused("dims is 0: give at least 1"));
        }
        if quantiles.is_callable() {
            let law = Law::Function(quantiles.clone().unbind());
            return Ok(Self(Target::custom(OwnTarget::new(name.into(), dims, law))));
        }
        if dims != 1 {
            return Err(PyTypeError::new_err(format!(
                "an array of quantiles is a target of one dimension, not of {dims}: give a function of the \
                 direction"
            )));
        }
        let values = quantiles_of(quantiles)?;
        if values[0] < 0.0 || values[values.len() - 1] > 1.0 {
            let (low, high) = (values[0], values[values.len() - 1]);
            return Err(refused(format!("quantiles go from {low} to {high}: give values in [0, 1]")));
        }
        Ok(Self(Target::custom(OwnTarget::new(name.into(), dims, Law::Table(values)))))
    }

    /// Which target: ``"uniform"``, ``"density"``, ``"densities"``, ``"cloud"``, or ``"quantiles"``.
    #[getter]
    pub fn kind(&self) -> &'static str {
        match self.0 {
            Target::UniformCube => "uniform",
            Target::Density(_) => "density",
            Target::Densities(_) => "densities",
            Target::Cloud(_) => "cloud",
            _ => "quantiles",
        }
    }

    /// Number of dimensions; None where any will do.
    #[getter]
    fn dims(&self) -> Option<usize> {
        self.0.dims()
    }

    /// Plain data, as in metadata; of a target of one's own its name.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        json::of_python(data).map(Self)
    }

    fn __repr__(&self) -> String {
        match &self.0 {
            Target::UniformCube => "Target.uniform()".into(),
            Target::Density(density) => {
                let [width, height] = density.size();
                format!("<Target.density: {width} x {height} pixels>")
            }
            Target::Cloud(cloud) => {
                let dims = cloud.dims();
                format!("<Target.cloud: {} points of {dims} dimensions>", cloud.points().len() / dims)
            }
            other => match OwnTarget::of(other) {
                Some(own) => format!("<Target.quantiles '{}': {} dimensions>", own.given, own.dims),
                None => format!("<Target of {}>", self.kind()),
            },
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let of_type = |name: &str| py.get_type::<Self>().getattr(name);
        let Some(own) = OwnTarget::of(&self.0) else {
            return Ok((of_type("from_dict")?, PyTuple::new(py, [self.to_dict(py)?])?));
        };
        let quantiles = match &own.law {
            Law::Table(values) => array(py, values.clone()).into_any(),
            Law::Function(function) => function.bind(py).clone(),
        };
        Ok((of_type("_of_quantiles")?, (quantiles, own.dims, &own.given).into_pyobject(py)?))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_quantiles(quantiles: &Bound<'_, PyAny>, dims: Count, name: &str) -> PyResult<Self> {
        Self::quantiles(quantiles, dims, name)
    }
}
