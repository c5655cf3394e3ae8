//! Families of test integrands.

use std::sync::Arc;

use fsot::metrics::Integrands;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::given::Given;
use super::integrand::{Places, PyIntegrand, Source};
use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};

/// Families of integrands on the unit cube: random ones, your own, or both.
///
/// Figures are means over each family, and over families, which count alike.
///
/// Parameters
/// ----------
/// families : dict
///     Lists of `Integrand`, all of as many coordinates, by the names of their families.
///
/// Examples
/// --------
/// >>> import fsot
/// >>> from fsot.metrics import Integrand, Integrands
/// >>> powers = [Integrand(lambda x, n=n: x[:, 0] ** n, 1, 1 / (n + 1), n**2 / ((n + 1) ** 2 * (2 * n + 1)))
/// ...           for n in range(1, 5)]
/// >>> integrands = Integrands.random(1, 16).with_family("powers", powers)
/// >>> list(integrands.families)
/// ['half-space', 'smooth', 'ball', 'box', 'powers']
#[pyclass(frozen, name = "Integrands", module = "fsot.metrics", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyIntegrands {
    dims: usize,
    families: Vec<(String, Vec<PyIntegrand>)>,
    /// What the library needs, where no function is a caller's.
    ready: Option<Arc<Integrands>>,
    /// Number and seed of each of the first four families, if they were drawn.
    drawn: Option<(usize, u64)>,
}

/// Families that are drawn together.
const DRAWN: usize = 4;

#[pymethods]
impl PyIntegrands {
    #[new]
    fn new(families: &Bound<'_, PyAny>) -> PyResult<Self> {
        let wanted = |what: &str| {
            PyTypeError::new_err(format!(
                "{what}: give a dictionary of lists of Integrand by the names of their families, as in \
                 {{\"own\": [Integrand(function, 2)]}}"
            ))
        };
        let Ok(families) = families.cast::<PyDict>() else {
            return Err(wanted(&format!("families is of type {}", families.get_type().name()?)));
        };
        let families = families.iter().map(|(name, integrands)| {
            let name: String = name.extract().map_err(|_| wanted("a name of a family is no text"))?;
            match integrands.extract::<Vec<PyIntegrand>>() {
                Ok(integrands) => Ok((name, integrands)),
                Err(_) => Err(wanted(&format!("the family '{name}' is no list of Integrand"))),
            }
        });
        let families = families.collect::<PyResult<Vec<_>>>()?;
        let Some(dims) = families.iter().flat_map(|(_, list)| list).map(PyIntegrand::dims).next() else {
            return Err(refused("there are no integrands: give at least 1"));
        };
        Self::checked(dims, families, None)
    }

    /// Draws integrands of four families: half-spaces, smooth functions, balls and boxes.
    ///
    /// Parameters
    /// ----------
    /// dims : int
    ///     Coordinates of a point.
    /// per_family : int
    ///     Integrands of each family; 256 leave a standard error of about 2 % in the mean.
    /// seed : int
    ///     The same seed gives the same integrands, of which more begin with fewer.
    #[staticmethod]
    #[pyo3(signature = (dims = Count(2), per_family = Count(256), seed = Number(0)),
        text_signature = "(dims=2, per_family=256, seed=0)")]
    pub fn random(dims: Count, per_family: Count, seed: Number) -> PyResult<Self> {
        let ready = Integrands::random(dims.0, per_family.0, seed.0).python()?;
        let families = ready.families().iter().enumerate().map(|(family, drawn)| {
            let of = drawn.integrands().iter().enumerate().map(|(index, integrand)| {
                let integrand = integrand.clone();
                PyIntegrand(Source::Drawn { integrand, seed: seed.0, family, index })
            });
            (drawn.name().to_owned(), of.collect())
        });
        let families = families.collect();
        let drawn = Some((per_family.0, seed.0));
        Ok(Self { dims: dims.0, families, ready: Some(Arc::new(ready)), drawn })
    }

    /// The same with a further family, which counts as much as every other, whatever its size.
    fn with_family(&self, name: String, integrands: Vec<PyIntegrand>) -> PyResult<Self> {
        let mut families = self.families.clone();
        families.push((name, integrands));
        Self::checked(self.dims, families, self.drawn)
    }

    /// Coordinates of a point.
    #[getter]
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Lists of `Integrand` by the names of their families.
    #[getter]
    fn families<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let families = PyDict::new(py);
        self.families.iter().try_for_each(|(name, list)| families.set_item(name, list.clone()))?;
        Ok(families)
    }

    fn __len__(&self) -> usize {
        self.families.iter().map(|(_, integrands)| integrands.len()).sum()
    }

    fn __repr__(&self) -> String {
        let of = self.families.iter().map(|(name, integrands)| format!("{} {name}", integrands.len()));
        let of = of.collect::<Vec<_>>().join(", ");
        format!("<integrands of {} coordinates: {of}>", self.dims)
    }

    /// Drawn families, and others after them.
    #[staticmethod]
    fn _drawn(dims: Count, per_family: Count, seed: Number, others: &Bound<'_, PyDict>) -> PyResult<Self> {
        others.iter().try_fold(Self::random(dims, per_family, seed)?, |all, (name, integrands)| {
            all.with_family(name.extract()?, integrands.extract()?)
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let class = py.get_type::<Self>();
        let Some((per_family, seed)) = self.drawn else {
            return Ok((class.into_any(), (self.families(py)?,).into_pyobject(py)?.into_any()));
        };
        let others = PyDict::new(py);
        let own = self.families.iter().skip(DRAWN);
        own.into_iter().try_for_each(|(name, list)| others.set_item(name, list.clone()))?;
        let parts = (self.dims, per_family, seed, others);
        Ok((class.getattr("_drawn")?, parts.into_pyobject(py)?.into_any()))
    }
}

impl PyIntegrands {
    /// Refuses what the library refuses, before any function is called.
    fn checked(
        dims: usize,
        families: Vec<(String, Vec<PyIntegrand>)>,
        drawn: Option<(usize, u64)>,
    ) -> PyResult<Self> {
        let stand_in = |integrand: &PyIntegrand| match &integrand.0 {
            Source::Drawn { integrand, .. } => Ok(integrand.clone()),
            Source::Own(own) => {
                fsot::metrics::Integrand::new(own.dims, |_| f64::NAN, own.integral, own.variance).python()
            }
        };
        let mut all: Option<Integrands> = None;
        for (name, list) in &families {
            let list = list.iter().map(stand_in).collect::<PyResult<_>>()?;
            all = Some(grown(all, dims, name, list)?);
        }
        let is_own = |integrand: &PyIntegrand| matches!(integrand.0, Source::Own(_));
        let has_own = families.iter().flat_map(|(_, list)| list).any(is_own);
        Ok(Self { dims, ready: all.map(Arc::new).filter(|_| !has_own), families, drawn })
    }

    /// The integrands as the library measures them on these samples: functions of Python's are called here.
    pub fn at(&self, py: Python<'_>, given: &Given, group: &[usize]) -> PyResult<Arc<Integrands>> {
        if let Some(ready) = &self.ready {
            return Ok(Arc::clone(ready));
        }
        let list = || places(given, group, self.dims);
        let mut places = Places::new(&list);
        let mut all: Option<Integrands> = None;
        for (name, integrands) in &self.families {
            let list = integrands.iter().map(|integrand| integrand.at(py, &mut places));
            let list = list.collect::<PyResult<_>>()?;
            all = Some(grown(all, self.dims, name, list)?);
        }
        all.map(Arc::new).ok_or_else(|| refused("there are no integrands: give at least 1"))
    }
}

/// The coordinates that integrands of so many dimensions are asked for, if the samples have them.
pub fn places(given: &Given, group: &[usize], dims: usize) -> Option<ndarray::Array2<f64>> {
    let is_there = group.len() == dims && group.iter().all(|dim| *dim < given.dims);
    (is_there && given.samples().is_ok()).then(|| given.coordinates(group))
}

fn grown(
    all: Option<Integrands>,
    dims: usize,
    name: &str,
    integrands: Vec<fsot::metrics::Integrand>,
) -> PyResult<Integrands> {
    match all {
        Some(all) => all.with_family(name, integrands),
        None => Integrands::own(dims, name, integrands),
    }
    .python()
}
