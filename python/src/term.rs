//! Parts of an objective.

use fsot::config::{Role, Term};
use pyo3::prelude::*;

use crate::classes::PyClasses;
use crate::counts::Count;
use crate::errors::{OrPython, refused};
use crate::target::PyTarget;

/// One part of the objective: a family of classes, what their samples should resemble, and in which
/// dimensions.
///
/// Parameters
/// ----------
/// classes : Classes
///     The filters.
/// target : Target, optional
///     What a filtered subset should resemble; uniform by default.
/// dims : int or sequence of int
///     The dimensions of the table that this term sees, from 0.
/// weight : float
///     Share of the work, from 1e-15 to 1e15: the number of slices that touch a sample is proportional to it.
/// role : {"descend", "balance"}
///     How its slices move the samples: all terms that descend do so together; after each step, samples move
///     to where those that balance wanted them. The latter is meant for few slices of large classes, such as
///     the whole table.
///
/// Raises
/// ------
/// ValueError
///     A weight out of range, a dimension twice or none, a target of another number of dimensions.
///
/// Examples
/// --------
/// >>> import fsot
/// >>> lattice = fsot.Classes.lattice(fsot.Kernel.gaussian(2.1))
/// >>> terms = [fsot.Term(lattice, dims=[0, 1]), fsot.Term(fsot.Classes.whole_table(), dims=[0, 1],
/// ...          weight=0.03, role="balance")]
/// >>> config = fsot.Config(16, 16).with_terms(terms)
#[pyclass(frozen, eq, name = "Term", module = "fsot", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyTerm(pub Term);

impl PartialEq for PyTerm {
    fn eq(&self, other: &Self) -> bool {
        let rest = |term: &Term| (term.dims.clone(), term.weight, term.role);
        rest(&self.0) == rest(&other.0)
            && self.classes() == other.classes()
            && self.target() == other.target()
    }
}

#[pymethods]
impl PyTerm {
    #[new]
    #[pyo3(signature = (classes, target = None, *, dims, weight = 1.0, role = "descend"))]
    fn new(
        classes: PyClasses,
        target: Option<PyTarget>,
        dims: &Bound<'_, PyAny>,
        weight: f64,
        role: &str,
    ) -> PyResult<Self> {
        let target = target.map_or_else(Default::default, |target| target.0);
        let (dims, role) = (dims_of(dims)?, role_of(role)?);
        let term = Term { classes: classes.0, target, dims, weight, role };
        term.validate().python()?;
        Ok(Self(term))
    }

    /// The filters.
    #[getter]
    fn classes(&self) -> PyClasses {
        PyClasses(self.0.classes.clone())
    }

    /// What a filtered subset should resemble.
    #[getter]
    fn target(&self) -> PyTarget {
        PyTarget(self.0.target.clone())
    }

    /// The dimensions of the table that it sees.
    #[getter]
    fn dims(&self) -> Vec<usize> {
        self.0.dims.clone()
    }

    /// Share of the work.
    #[getter]
    fn weight(&self) -> f64 {
        self.0.weight
    }

    /// ``"descend"`` or ``"balance"``.
    #[getter]
    pub fn role(&self) -> &'static str {
        match self.0.role {
            Role::Descend => "descend",
            Role::Balance => "balance",
        }
    }

    fn __repr__(&self) -> String {
        let (classes, target) = (self.classes().kind(), self.target().kind());
        let Term { dims, weight, .. } = &self.0;
        let role = self.role();
        format!("<Term: {classes} like {target}, dims={dims:?}, weight={weight}, role={role}>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        let parts = (self.classes(), self.target(), self.dims(), self.weight(), self.role());
        Ok((py.get_type::<Self>().getattr("_of_parts")?, parts))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_parts(
        classes: PyClasses,
        target: PyTarget,
        dims: &Bound<'_, PyAny>,
        weight: f64,
        role: &str,
    ) -> PyResult<Self> {
        Self::new(classes, Some(target), dims, weight, role)
    }
}

type Parts = (PyClasses, PyTarget, Vec<usize>, f64, &'static str);

pub fn role_of(name: &str) -> PyResult<Role> {
    match name {
        "descend" => Ok(Role::Descend),
        "balance" => Ok(Role::Balance),
        other => Err(refused(format!("'{other}' is no role: write descend or balance"))),
    }
}

/// A dimension, or any number of them.
pub fn dims_of(dims: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    if let Ok(Count(dim)) = dims.extract() {
        return Ok(vec![dim]);
    }
    dims.try_iter()?.map(|dim| Ok(dim?.extract::<Count>()?.0)).collect()
}
