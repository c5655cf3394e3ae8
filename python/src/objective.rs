//! What is optimised, for optimisers of one's own.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::ControlFlow;
use std::sync::Arc;

use fsot::objective::{ObjectiveError, ValueAndGradient};
use fsot::{ConfigError, Extent, Objective};
use ndarray::ArrayD;
use numpy::{PyArray2, PyArrayDyn};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Numbers, to_numpy};
use crate::config::PyConfig;
use crate::counts::{Count, Number};
use crate::demand::PyDemand;
use crate::errors::{OrPython, refused};
use crate::kernel::rows;
use crate::slices::{Groups, PySlices};
use crate::term::{PyTerm, role_of};
use crate::work::{Caller, detached, watched};

/// What is optimised, for optimisers of your own: values and gradients.
///
/// Any number of threads may ask at once.
///
/// Parameters
/// ----------
/// config : Config
///     What is to be optimised.
/// demand : Demand, optional
///     The part that counts; all by default.
/// threads : int, optional
///     Threads to work on; one a core by default. Results don't depend on it.
///
/// Examples
/// --------
/// >>> import numpy, fsot
/// >>> objective = fsot.Objective(fsot.Config(16, 16))
/// >>> points = numpy.random.default_rng(0).random(objective.shape)
/// >>> value, gradient = objective.cramer(points)
/// >>> gradient.shape
/// (1, 16, 16, 1, 2)
#[pyclass(frozen, name = "Objective", module = "fsot", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyObjective {
    pub objective: Arc<Objective>,
    pub groups: Arc<Groups>,
    config: PyConfig,
    demand: Option<PyDemand>,
    threads: Option<usize>,
}

/// Most slices that are drawn at once: some gigabytes.
const MOST_SLICES: usize = 1 << 24;

#[pymethods]
impl PyObjective {
    #[new]
    #[pyo3(signature = (config, demand = None, *, threads = None))]
    fn new(
        py: Python<'_>,
        config: PyConfig,
        demand: Option<PyDemand>,
        threads: Option<Count>,
    ) -> PyResult<Self> {
        let threads = threads.map(|Count(threads)| threads);
        let part = demand.as_ref().map(|demand| demand.of(config.0.dims)).transpose()?;
        let plan = |caller: &Caller<'_, ()>| {
            let observe = |_| match caller.wants_an_end() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            match &part {
                Some(part) => Objective::for_demand_observed(&config.0, part, observe),
                None => Objective::new_observed(&config.0, observe),
            }
        };
        let (objective, exception) = watched(py, threads, plan, |_| Ok(()))?;
        if let Some(exception) = exception {
            return Err(exception);
        }
        let objective = objective.python()?;
        let groups = Arc::new(Groups::of(&objective));
        Ok(Self { objective: Arc::new(objective), groups, config, demand, threads })
    }

    /// Lengths of the axes ``[frame, y, x, sample, dim]`` of the points.
    #[getter]
    fn shape(&self) -> (usize, usize, usize, usize, usize) {
        self.lengths().into()
    }

    /// The configuration.
    #[getter]
    fn config(&self) -> PyConfig {
        self.config.clone()
    }

    /// The demand, or None.
    #[getter]
    fn demand(&self) -> Option<PyDemand> {
        self.demand.clone()
    }

    /// The terms as they are planned: under a demand, without what it leaves out.
    #[getter]
    fn terms(&self) -> Vec<PyTerm> {
        self.objective.terms().map(|term| PyTerm(term.clone())).collect()
    }

    /// The taps of the kernel of a term on this table, by falling weight: rows of [dt, dy, dx, weight]. None
    /// for classes without a kernel.
    fn taps<'py>(&self, py: Python<'py>, term: Count) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let (Count(term), terms) = (term, self.groups.of_terms.len());
        if term >= terms {
            return Err(refused(format!("term is {term}, but the objective has {terms}: stay below it")));
        }
        Ok(self.objective.taps(term).map(|taps| rows(py, taps)))
    }

    /// Draws the slices that an optimiser with this seed takes.
    ///
    /// A step is a batch: each of some pixels, or of all classes of a point set, by some directions. Draws
    /// with other seeds or steps are independent, so that a loop of stochastic gradient descent counts its
    /// steps here; more steps at once give a smoother gradient.
    ///
    /// Parameters
    /// ----------
    /// seed, step : int
    ///     Name the random numbers, from 0 to 2**64 - 1.
    /// steps : int
    ///     How many steps' slices, from `step` on; none for 0, of which any points are worth 0.
    /// role : {"descend", "balance"}
    ///     Of which terms.
    ///
    /// Returns
    /// -------
    /// Slices
    ///     In the order of steps and terms.
    #[pyo3(signature = (seed = Number(0), step = Number(0), *, steps = Count(1), role = "descend"),
           text_signature = "($self, seed=0, step=0, *, steps=1, role='descend')")]
    fn draw(
        &self,
        py: Python<'_>,
        seed: Number,
        step: Number,
        steps: Count,
        role: &str,
    ) -> PyResult<PySlices> {
        let (Number(seed), Number(step), Count(steps), role) = (seed, step, steps, role_of(role)?);
        let objective = &*self.objective;
        let draw = |step: u64| objective.draw(seed, step, role);
        let slices = detached(py, self.threads, || {
            if steps == 0 {
                return Ok(Vec::new());
            }
            let first = draw(step);
            let all = first.len().saturating_mul(steps);
            if all > MOST_SLICES || steps > MOST_SLICES {
                return Err(all);
            }
            let steps: Vec<u64> = (1..steps as u64).map(|by| step.wrapping_add(by)).collect();
            let rest: Vec<_> = steps.into_par_iter().map(draw).collect();
            Ok(first.into_iter().chain(rest.into_iter().flatten()).collect())
        })?;
        match slices {
            Ok(slices) => Ok(PySlices { slices: Arc::new(slices), groups: self.groups.clone() }),
            Err(all) => Err(refused(format!(
                "{steps} steps have {all} slices: ask for at most {MOST_SLICES} at once"
            ))),
        }
    }

    /// Mean over slices of (n / N) W2², times the weight of the class, and its gradient.
    ///
    /// W2 is the Wasserstein distance along the slice between its n of all N samples, and the target.
    ///
    /// Parameters
    /// ----------
    /// points : array_like
    ///     Numbers in [0, 1), in the shape of the table, as [sample, dim], or flat; axes of length 1 may be
    ///     left out.
    /// slices : Slices
    ///     Of this objective.
    ///
    /// Returns
    /// -------
    /// value : float
    /// gradient : numpy.ndarray
    ///     Derivatives with respect to every coordinate, float64, in the shape of `points`.
    fn value_and_gradient<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        slices: &PySlices,
    ) -> PyResult<Found<'py>> {
        if self.groups != slices.groups {
            return Err(refused("slices of another objective: draw them from this one"));
        }
        self.find(py, points, |points, observe| {
            self.objective.value_and_gradient_observed(points, &slices.slices, observe)
        })
    }

    /// All slices at once, in closed form: the squared sliced Cramér distance between filtered samples and
    /// the cube, and its gradient. It is the squared filtered error of a half-space, meant over half-spaces
    /// and pixels.
    ///
    /// Parameters
    /// ----------
    /// points : array_like
    ///     As of `value_and_gradient`.
    ///
    /// Returns
    /// -------
    /// value : float
    /// gradient : numpy.ndarray
    ///     Derivatives with respect to every coordinate, float64, in the shape of `points`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A term that descends and has no closed form: one of other classes than a lattice's or a pixel's,
    ///     on a torus, or with a target of its own.
    fn cramer<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Found<'py>> {
        self.find(py, points, |points, observe| self.objective.cramer_observed(points, observe))
    }

    /// Whether they are of the same configuration and demand.
    fn __eq__(&self, other: &Self) -> bool {
        (&self.config, &self.demand) == (&other.config, &other.demand)
    }

    /// Of what equal ones have in common; functions that are compiled for an objective are kept by it.
    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.lengths(), self.config.0.seed, &self.groups.of_terms).hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let [frames, height, width, spp, dims] = self.lengths();
        let terms = self.groups.of_terms.len();
        format!("<Objective of {terms} terms for [{frames}, {height}, {width}, {spp}, {dims}]>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        let parts = (self.config.clone(), self.demand.clone(), self.threads);
        Ok((py.get_type::<Self>().getattr("_of_parts")?, parts))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_parts(
        py: Python<'_>,
        config: PyConfig,
        demand: Option<PyDemand>,
        threads: Option<Count>,
    ) -> PyResult<Self> {
        Self::new(py, config, demand, threads)
    }
}

type Observe<'a> = &'a dyn Fn(f64) -> ControlFlow<()>;
type Found<'py> = (f64, Bound<'py, PyArrayDyn<f64>>);
type Parts = (PyConfig, Option<PyDemand>, Option<usize>);

impl PyObjective {
    fn find<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        of: impl Fn(&[f64], Observe<'_>) -> Result<ValueAndGradient, ObjectiveError> + Sync,
    ) -> PyResult<Found<'py>> {
        let Numbers { shape, values } = Numbers::<f64>::of(points)?;
        self.check_shape(&shape)?;
        let work = |caller: &Caller<'_, ()>| {
            of(&values, &|_| match caller.wants_an_end() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        };
        let (found, exception) = watched(py, self.threads, work, |_| Ok(()))?;
        if let Some(exception) = exception {
            return Err(exception);
        }
        if let Err(ObjectiveError::Config(ConfigError::NotInClosedForm { term, why })) = found {
            return Err(refused(format!(
                "term {term} has no closed form over all slices, since {why}: give slices, as those of draw()"
            )));
        }
        let ValueAndGradient { value, gradient } = found.python()?;
        let gradient = ArrayD::from_shape_vec(shape, gradient).expect("a slope for each coordinate");
        Ok((value, to_numpy(py, gradient)))
    }

    fn lengths(&self) -> [usize; 5] {
        let Extent { frames, height, width, spp } = self.objective.extent();
        [frames, height, width, spp, self.objective.dims()]
    }

    /// Refuses other arrangements of as many numbers.
    fn check_shape(&self, given: &[usize]) -> PyResult<()> {
        let of_table = self.lengths();
        let (all, dims) = (of_table.iter().product(), of_table[4]);
        let samples = of_table[..4].iter().product();
        let long = |shape: &[usize]| shape.iter().copied().filter(|&len| len != 1).collect::<Vec<_>>();
        let known: [&[usize]; 3] = [&of_table, &[samples, dims], &[all]];
        if known.iter().any(|known| long(known) == long(given)) {
            return Ok(());
        }
        Err(refused(format!("points of shape {given:?}: give {of_table:?}, [{samples}, {dims}] or [{all}]")))
    }
}
