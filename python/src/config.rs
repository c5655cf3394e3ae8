//! All that determines a table but for the length of the run.

use fsot::config::{Descent, Slicing, Sweeps, Term};
use fsot::{Config, Extent, Kernel};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::classes::{PyClasses, form_of};
use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};
use crate::json;
use crate::kernel::PyKernel;
use crate::settings::{change, check_terms, domain_name, groups_of, is_plain, schedule_of, with_domain};
use crate::target::PyTarget;
use crate::term::{PyTerm, role_of};

/// All that determines a table but for the length of the run.
///
/// Plain data that does not change: `with_...` methods return another one.
#[pyclass(frozen, eq, name = "Config", module = "fsot", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyConfig(pub Config);

impl PartialEq for PyConfig {
    fn eq(&self, other: &Self) -> bool {
        without_terms(&self.0) == without_terms(&other.0) && self.terms() == other.terms()
    }
}

fn without_terms(config: &Config) -> Config {
    let mut config = config.clone();
    config.terms.clear();
    config
}

#[pymethods]
impl PyConfig {
    #[new]
    #[pyo3(signature = (
        width = Count(64), height = Count(64), frames = Count(1), spp = Count(1), dims = Count(2), *,
        seed = Number(0)
    ), text_signature = "(width=64, height=64, frames=1, spp=1, dims=2, *, seed=0)")]
    fn new(width: Count, height: Count, frames: Count, spp: Count, dims: Count, seed: Number) -> Self {
        Self(Config::new(extent(width, height, frames, spp), dims.0).with_seed(seed.0))
    }

    /// A set of points that these terms make: see `Term`. Domains are intervals, steps barycentric from 1
    /// to 0.02; 1,000 to 4,000 slices per class make a good set.
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///     Points.
    /// dims : int
    ///     Dimensions of a point.
    /// terms : sequence of Term
    ///     What the points should resemble; at least one.
    #[staticmethod]
    fn points(count: Count, dims: Count, terms: Vec<PyTerm>) -> PyResult<Self> {
        let terms: Vec<Term> = terms.into_iter().map(|term| term.0).collect();
        check_terms(&terms, dims.0)?;
        Ok(Self(Config::point_set(count.0, dims.0, terms)))
    }

    /// Lengths of the axes `[frame, y, x, sample, dim]`.
    #[getter]
    fn shape(&self) -> (usize, usize, usize, usize, usize) {
        let Extent { frames, height, width, spp } = self.0.extent;
        (frames, height, width, spp, self.0.dims)
    }

    /// Dimensions of a sample.
    #[getter]
    fn dims(&self) -> usize {
        self.0.dims
    }

    /// ``"interval"`` or ``"torus"``, for each dimension.
    #[getter]
    fn domains(&self) -> Vec<&'static str> {
        self.0.domains.iter().map(|&domain| domain_name(domain)).collect()
    }

    /// What is optimised.
    #[getter]
    fn terms(&self) -> Vec<PyTerm> {
        self.0.terms.iter().cloned().map(PyTerm).collect()
    }

    /// Groups of dimensions, with their weights, of which `with_groups` would make the same terms.
    #[getter]
    fn groups(&self) -> Vec<(Vec<usize>, f64)> {
        self.0.groups().into_iter().map(|group| (group.dims, group.weight)).collect()
    }

    /// Whether smaller filters come with each kernel.
    #[getter]
    fn companions(&self) -> bool {
        self.0.companions
    }

    /// How slices are drawn, as plain data.
    #[getter]
    fn slicing<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0.slicing)
    }

    /// How steps of slices move the samples, as plain data.
    #[getter]
    fn descent<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0.descent)
    }

    /// How sweeps move the samples, as plain data.
    #[getter]
    fn sweeps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0.sweeps)
    }

    /// How far balancing terms move the samples, over a run: a schedule as plain data.
    #[getter]
    fn balance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0.balance)
    }

    /// Seed of all random numbers.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed
    }

    /// The filters, of which `with_kernels` would make the same terms.
    #[getter]
    fn kernels(&self) -> Vec<PyKernel> {
        self.0.kernels().into_iter().map(PyKernel).collect()
    }

    /// The same with another seed.
    fn with_seed(&self, seed: Number) -> Self {
        Self(self.0.clone().with_seed(seed.0))
    }

    /// The same for another filter.
    fn with_kernel(&self, kernel: PyKernel) -> Self {
        Self(self.0.clone().with_kernel(kernel.0))
    }

    /// The same for several filters at once.
    fn with_kernels(&self, kernels: Vec<PyKernel>) -> Self {
        let kernels: Vec<Kernel> = kernels.into_iter().map(|kernel| kernel.0).collect();
        Self(self.0.clone().with_kernels(&kernels))
    }

    /// The same for other groups of dimensions that integrands consume together: lists of dimensions, or
    /// pairs of such a list and a weight.
    fn with_groups(&self, groups: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(self.0.clone().with_groups(&groups_of(groups, self.0.dims)?)))
    }

    /// The same on `"interval"`s or a `"torus"`: one for all dimensions, or a list with one for each.
    fn with_domain(&self, domain: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(with_domain(self.0.clone(), domain)?))
    }

    /// The same with or without the smaller filters that come with each kernel.
    fn with_companions(&self, companions: bool) -> Self {
        Self(self.0.clone().with_companions(companions))
    }

    /// The same with the filters in this form: ``"level_sets"`` or ``"weighted"``.
    fn with_form(&self, form: &str) -> PyResult<Self> {
        Ok(Self(self.0.clone().with_form(form_of(form)?)))
    }

    /// The same with these terms instead of all others, and no companions.
    fn with_terms(&self, terms: Vec<PyTerm>) -> PyResult<Self> {
        let terms: Vec<Term> = terms.into_iter().map(|term| term.0).collect();
        check_terms(&terms, self.0.dims)?;
        Ok(Self(self.0.clone().with_terms(terms)))
    }

    /// The same with slices that are drawn like this.
    ///
    /// Parameters
    /// ----------
    /// directions : int
    ///     Directions of each subset, from 1 to 16; fewer cost the same.
    /// axis_share : float
    ///     Share of the directions that lie on coordinate axes, in [0, 1].
    /// batch_slices : int, optional
    ///     Slices of a step; a sixteenth of an epoch by default.
    #[pyo3(signature = (*, directions = Count(16), axis_share = 0.0, batch_slices = None),
           text_signature = "($self, *, directions=16, axis_share=0.0, batch_slices=None)")]
    fn with_slicing(
        &self,
        directions: Count,
        axis_share: f64,
        batch_slices: Option<Count>,
    ) -> PyResult<Self> {
        let batch_slices = batch_slices.map(|Count(slices)| slices);
        let slicing = Slicing { directions: directions.0, axis_share, batch_slices };
        slicing.validate().python()?;
        Ok(Self(self.0.clone().with_slicing(slicing)))
    }

    /// The same with steps of slices that move the samples like this.
    ///
    /// Parameters
    /// ----------
    /// descent : {"barycentric", "sgd", "adam"} or dict
    ///     The kind of step; or all of it as plain data, as in `descent`.
    /// rate : schedule, optional
    ///     Step size over a run: a number, a pair of the first and the last, between which it goes by equal
    ///     factors, or plain data such as ``{"shape": "cosine", "first": 1.0, "last": 0.1}``. From 1e-30 to
    ///     1e6.
    /// momentum : float, optional
    ///     Share of the velocity that SGD keeps, from 0 to 0.999999.
    /// beta1, beta2 : float, optional
    ///     Decays of Adam's moments, from 0 to 0.999999.
    /// epsilon : float, optional
    ///     What Adam adds to the root of its second moment, from 1e-30 to 1e6.
    #[pyo3(signature = (
        descent, *, rate = None, momentum = None, beta1 = None, beta2 = None, epsilon = None
    ))]
    fn with_descent(
        &self,
        descent: &Bound<'_, PyAny>,
        rate: Option<&Bound<'_, PyAny>>,
        momentum: Option<&Bound<'_, PyAny>>,
        beta1: Option<&Bound<'_, PyAny>>,
        beta2: Option<&Bound<'_, PyAny>>,
        epsilon: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let given: Descent = match descent.cast::<PyString>() {
            Err(_) if descent.is_instance_of::<PyDict>() => json::of_python(descent)?,
            Err(_) => {
                return Err(PyTypeError::new_err(format!(
                    "{} is no descent: write barycentric, sgd or adam, or give a dictionary",
                    descent.repr()?
                )));
            }
            Ok(name) => match name.to_cow()?.as_ref() {
                "barycentric" => Descent::barycentric(),
                "sgd" => Descent::sgd(),
                "adam" => Descent::adam(),
                other => {
                    return Err(refused(format!("'{other}' is no descent: write barycentric, sgd or adam")));
                }
            },
        };
        // Its data is a dictionary of one item, which is another dictionary.
        let data = json::to_python(descent.py(), &given)?;
        for (name, parameters) in data.cast::<PyDict>()?.iter() {
            let changes = [
                ("rate", rate),
                ("momentum", momentum),
                ("beta1", beta1),
                ("beta2", beta2),
                ("epsilon", epsilon),
            ];
            change(parameters.cast()?, &name.to_string(), &changes)?;
        }
        let descent: Descent = json::of_python(&data)?;
        descent.validate().python()?;
        Ok(Self(self.0.clone().with_descent(descent)))
    }

    /// The same with sweeps that move the samples like this.
    ///
    /// Parameters
    /// ----------
    /// rate : schedule, optional
    ///     Step size over a run of sweeps alone, as of `with_descent`; from 2.2 to 0.2 by default.
    /// polish : schedule, optional
    ///     Step size of sweeps that follow slices or a frame of their own; from 1.5 to 0.25 by default.
    /// truncation : float, optional
    ///     Pairs of samples that filters hold together less than this share of the strongest are left out; in
    ///     [0, 1), 0.007 by default.
    /// softening : float, optional
    ///     How far samples pass each other early in a run, from 0 to 1e6; 0.7 by default.
    #[pyo3(signature = (*, rate = None, polish = None, truncation = None, softening = None))]
    fn with_sweeps(
        &self,
        py: Python<'_>,
        rate: Option<&Bound<'_, PyAny>>,
        polish: Option<&Bound<'_, PyAny>>,
        truncation: Option<&Bound<'_, PyAny>>,
        softening: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let data = json::to_python(py, &Sweeps::default())?;
        let changes =
            [("rate", rate), ("polish", polish), ("truncation", truncation), ("softening", softening)];
        change(data.cast()?, "a sweep", &changes)?;
        let sweeps: Sweeps = json::of_python(&data)?;
        sweeps.validate().python()?;
        Ok(Self(self.0.clone().with_sweeps(sweeps)))
    }

    /// The same with balancing terms that move the samples so far towards their targets: a schedule, as of
    /// `with_descent`.
    fn with_balance(&self, balance: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(self.0.clone().with_balance(schedule_of(balance)?)))
    }

    /// Plain data, as in metadata. Of classes and targets of one's own it holds the name alone: pickle keeps
    /// all.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        json::of_python(data).map(Self)
    }

    /// As JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0).python()
    }

    /// From JSON.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        json::of_text(text).map(Self)
    }

    fn __repr__(&self) -> String {
        let (frames, height, width, spp, dims) = self.shape();
        format!(
            "Config(width={width}, height={height}, frames={frames}, spp={spp}, dims={dims}, seed={}, \
             terms={})",
            self.0.seed,
            self.0.terms.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let of_type = |name: &str| py.get_type::<Self>().getattr(name);
        if is_plain(&self.0) {
            return Ok((of_type("from_json")?, (self.to_json()?,).into_pyobject(py)?.into_any()));
        }
        // What terms share is one object, so that they share it again.
        let (mut classes, mut targets): (Vec<Bound<'_, PyClasses>>, Vec<Bound<'_, PyTarget>>) =
            Default::default();
        let mut terms = Vec::new();
        for term in self.terms() {
            let known = classes.iter().position(|known| known.get().0 == term.0.classes);
            let of_classes = known.unwrap_or(classes.len());
            if known.is_none() {
                classes.push(Bound::new(py, PyClasses(term.0.classes.clone()))?);
            }
            let known = targets.iter().position(|known| known.get().0 == term.0.target);
            let of_target = known.unwrap_or(targets.len());
            if known.is_none() {
                targets.push(Bound::new(py, PyTarget(term.0.target.clone()))?);
            }
            terms.push((of_classes, of_target, term.0.dims.clone(), term.0.weight, term.role()));
        }
        let rest = serde_json::to_string(&without_terms(&self.0)).python()?;
        Ok((of_type("_of_parts")?, (rest, classes, targets, terms).into_pyobject(py)?.into_any()))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_parts(
        rest: &str,
        classes: Vec<PyClasses>,
        targets: Vec<PyTarget>,
        terms: Vec<(usize, usize, Vec<usize>, f64, String)>,
    ) -> PyResult<Self> {
        let mut config: Config = json::of_text(rest)?;
        for (of_classes, of_target, dims, weight, role) in terms {
            let (Some(classes), Some(target)) = (classes.get(of_classes), targets.get(of_target)) else {
                return Err(refused("the pickled configuration is damaged: pickle it again"));
            };
            let (classes, target) = (classes.0.clone(), target.0.clone());
            config.terms.push(Term { classes, target, dims, weight, role: role_of(&role)? });
        }
        Ok(Self(config))
    }
}

/// Of whole numbers of Python's.
pub fn extent(width: Count, height: Count, frames: Count, spp: Count) -> Extent {
    Extent { frames: frames.0, height: height.0, width: width.0, spp: spp.0 }
}
