//! A table on its way.

use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, TryLockError};

use fsot::files::{Metadata, RunRecord};
use fsot::optimizer::{Checkpoint, StepReport};
use fsot::{Optimizer, RunReport, SampleTable};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::arrays::{table_of, table_to_numpy};
use crate::checkpoint::PyCheckpoint;
use crate::config::PyConfig;
use crate::counts::Count;
use crate::demand::PyDemand;
use crate::errors::OrPython;
use crate::json;
use crate::step::{Facts, PyStep, answer};
use crate::until::Until;
use crate::work::{Caller, Event, detached, watched};

/// What a run did.
#[pyclass(frozen, eq, get_all, name = "Report", module = "fsot")]
#[derive(Clone, Debug, PartialEq)]
pub struct PyReport {
    /// `"finished"`, `"converged"`, or `"stopped"` by a callback, an exception or Ctrl-C.
    ended: String,
    /// Steps taken.
    steps: u64,
    /// Slices drawn, over all terms.
    slices: u64,
    /// What the run was planned for. It gives the same table again, anywhere.
    work: Until,
    /// Seconds of the steps.
    elapsed: f64,
}

#[pymethods]
impl PyReport {
    fn __repr__(&self) -> String {
        let Self { ended, steps, work, elapsed, .. } = self;
        format!("<{ended} after {steps} steps, {elapsed:.2} s: {}>", work.repr())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, ReportParts)> {
        let Self { ended, steps, slices, work, elapsed } = self.clone();
        Ok((py.get_type::<Self>().getattr("_of_parts")?, (ended, steps, slices, work, elapsed)))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_parts(ended: String, steps: u64, slices: u64, work: Until, elapsed: f64) -> Self {
        Self { ended, steps, slices, work, elapsed }
    }
}

type ReportParts = (String, u64, u64, Until, f64);

#[derive(Debug)]
struct State {
    optimizer: Optimizer,
    /// Of the run that made the points, if it was one.
    report: Option<RunReport>,
    /// The run that has ended early, where it did; until something else moves the points.
    pending: Option<Checkpoint>,
}

/// A table on its way.
#[pyclass(frozen, subclass, name = "Optimizer", module = "fsot._fsot")]
#[derive(Debug)]
pub struct PyOptimizer {
    state: Mutex<State>,
    threads: Option<usize>,
}

/// A table to go on from.
struct Start {
    table: SampleTable,
    metadata: Option<Metadata>,
}

impl Start {
    /// A `Table`, or an array without metadata.
    fn of(start: &Bound<'_, PyAny>) -> PyResult<Self> {
        let metadata = match start.getattr_opt("metadata")? {
            Some(metadata) if metadata.is_truthy()? => Some(json::of_python(&metadata)?),
            _ => None,
        };
        Ok(Self { table: table_of(start)?, metadata })
    }
}

enum Told {
    Progress(Facts),
    Step(PyStep),
}

/// How often progress is told, in seconds.
const TELL: f64 = 0.1;

#[pymethods]
impl PyOptimizer {
    #[new]
    #[pyo3(signature = (config, *, demand = None, start = None, threads = None))]
    fn new(
        py: Python<'_>,
        config: PyConfig,
        demand: Option<PyDemand>,
        start: Option<&Bound<'_, PyAny>>,
        threads: Option<Count>,
    ) -> PyResult<Self> {
        let threads = threads.map(|Count(threads)| threads);
        let demand = demand.map(|demand| demand.of(config.0.dims)).transpose()?;
        let start = start.map(Start::of).transpose()?;
        let plan = |caller: &Caller<'_, ()>| {
            let observe = |_| match caller.wants_an_end() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let config = config.0.clone();
            match (&demand, start) {
                (None, None) => Optimizer::new_observed(config, observe),
                (None, Some(Start { table, metadata: Some(metadata) })) => {
                    Optimizer::from_table_with(config, table, &metadata)
                }
                (None, Some(Start { table, metadata: None })) => Optimizer::from_table(config, table),
                (Some(demand), start) => {
                    let mut optimizer = Optimizer::for_demand_observed(config, demand, observe)?;
                    start.map_or(Ok(()), |start| optimizer.start_from(start.table))?;
                    Ok(optimizer)
                }
            }
        };
        let (optimizer, exception) = watched(py, threads, plan, |_| Ok(()))?;
        if let Some(exception) = exception {
            return Err(exception);
        }
        Ok(Self { state: Mutex::new(State::new(optimizer.python()?)), threads })
    }

    /// The configuration.
    #[getter]
    fn config(&self) -> PyResult<PyConfig> {
        Ok(PyConfig(self.state()?.optimizer.config().clone()))
    }

    /// The coordinates as they are now, `[frame, y, x, sample, dim]`; a copy. To go on from others, assign
    /// them.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        table_to_numpy(py, self.state()?.optimizer.table())
    }

    #[setter]
    fn set_points(&self, points: &Bound<'_, PyAny>) -> PyResult<()> {
        let table = table_of(points)?;
        let mut state = self.state()?;
        state.optimizer.start_from(table).python()?;
        state.pending = None;
        Ok(())
    }

    /// Takes one step of slices with step size `rate`, then balances with `balance`. Returns the root mean
    /// square distance between the samples and their targets before the step.
    #[pyo3(signature = (rate = 1.0, balance = 1.0))]
    fn step(&self, py: Python<'_>, rate: f64, balance: f64) -> PyResult<f64> {
        let State { optimizer, pending, .. } = &mut *self.state()?;
        let step = detached(py, self.threads, || optimizer.step(rate, balance))?.python()?;
        *pending = None;
        Ok(step.displacement)
    }

    /// Sweeps once over all samples. Returns the root mean square pull on a coordinate.
    #[pyo3(signature = (rate = 1.0, balance = 1.0))]
    fn sweep(&self, py: Python<'_>, rate: f64, balance: f64) -> PyResult<f64> {
        let State { optimizer, pending, .. } = &mut *self.state()?;
        let pull = detached(py, self.threads, || optimizer.sweep(rate, balance))?.python()?;
        *pending = None;
        Ok(pull)
    }

    /// Runs; `callback` is called after each step, and `progress` from time to time. Returns the report, and
    /// the exception that ended it, if one did.
    #[pyo3(signature = (until, callback, progress))]
    fn _run(
        &self,
        py: Python<'_>,
        until: Option<Until>,
        callback: Option<Py<PyAny>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(PyReport, Option<PyErr>)> {
        let State { optimizer, report: last, pending } = &mut *self.state()?;
        if until.is_none() && pending.is_none() && !optimizer.is_in_a_run() {
            return Err(PyRuntimeError::new_err(
                "there is no run to finish: begin one with run(), or resume() a checkpoint that was \
                 taken in one",
            ));
        }
        let (calls_back, tells) = (callback.is_some(), progress.is_some());
        let mut kept = None;
        let work = |caller: &Caller<'_, Told>| -> PyResult<RunReport> {
            let mut told = 0.0;
            let mut look = |report: &StepReport<'_>| -> ControlFlow<()> {
                let facts = Facts::from(report);
                if tells && report.elapsed.as_secs_f64() - told >= TELL {
                    told = report.elapsed.as_secs_f64();
                    caller.tell(Told::Progress(facts));
                }
                if calls_back {
                    let (step, asked) = PyStep::new(facts);
                    caller.tell(Told::Step(step));
                    answer(report, &asked)?;
                }
                if caller.wants_an_end() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let observe = |report: &StepReport<'_>| {
                let flow = look(report);
                if flow.is_break() {
                    // Before the run's end tidies up.
                    kept = Some(report.checkpoint());
                }
                flow
            };
            if let Some(until) = until {
                return optimizer.run_observed(until.0, observe).python();
            }
            if let Some(checkpoint) = pending.clone() {
                optimizer.resume(checkpoint).python()?;
            }
            optimizer.finish_observed(observe).python()
        };
        let look = |event: Event<Told>| match event {
            Event::Message(Told::Step(step)) => call_back(py, &callback, step),
            Event::Message(Told::Progress(facts)) => tell(py, &progress, facts),
            Event::Nothing => Ok(()),
        };
        let (report, exception) = watched(py, self.threads, work, look)?;
        let (report, exception) = match (report, exception) {
            // What a function of the caller's has raised is why the work was refused.
            (Err(_), Some(exception)) => return Err(exception),
            (report, exception) => (report?, exception),
        };
        (*last, *pending) = (Some(report), kept);
        Ok((PyReport::new(&report), exception))
    }

    /// All that further steps depend on; a copy.
    ///
    /// After a run that a callback, an exception or Ctrl-C has ended it is of that run where it broke off, so
    /// that `finish` ends it. After one that has come to its end, and after steps of one's own, it is of no
    /// run.
    fn checkpoint(&self) -> PyResult<PyCheckpoint> {
        let state = self.state()?;
        Ok(PyCheckpoint(state.pending.clone().unwrap_or_else(|| state.optimizer.checkpoint())))
    }

    /// Goes on from a checkpoint instead of what was reached: `finish` ends its run, if it was taken in one.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A checkpoint of another configuration or demand. Nothing is changed then.
    fn resume(&self, checkpoint: &PyCheckpoint) -> PyResult<()> {
        let mut state = self.state()?;
        state.optimizer.resume(checkpoint.0.clone()).python()?;
        (state.report, state.pending) = (None, None);
        Ok(())
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "an optimiser is neither pickled nor copied: pickle optimizer.checkpoint() instead, and resume \
             it in another optimiser of its configuration",
        ))
    }

    /// What the last run did, as in metadata.
    fn _record<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.state()?.report.as_ref().map(RunRecord::from))
    }

    /// The array of the table and its metadata.
    fn _table<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let state = self.state()?;
        let metadata = state.metadata();
        Ok((table_to_numpy(py, state.optimizer.table())?, json::to_python(py, &metadata)?))
    }
}

impl State {
    fn new(optimizer: Optimizer) -> Self {
        Self { optimizer, report: None, pending: None }
    }

    fn metadata(&self) -> Metadata {
        match &self.report {
            Some(report) => self.optimizer.metadata(report),
            None => self.optimizer.metadata_without_run(),
        }
    }
}

impl PyOptimizer {
    fn state(&self) -> PyResult<MutexGuard<'_, State>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            Err(TryLockError::Poisoned(state)) => Ok(state.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "the optimiser is running: wait for it, or ask the step that its callback sees",
            )),
        }
    }
}

impl PyReport {
    fn new(report: &RunReport) -> Self {
        let RunReport { ended, steps, slices, work, elapsed, .. } = *report;
        let ended = serde_json::to_value(ended).ok().and_then(|name| name.as_str().map(String::from));
        Self {
            ended: ended.unwrap_or_default(),
            steps,
            slices,
            work: Until(fsot::Until::Work(work)),
            elapsed: elapsed.as_secs_f64(),
        }
    }
}

fn call_back(py: Python<'_>, callback: &Option<Py<PyAny>>, step: PyStep) -> PyResult<()> {
    let Some(callback) = callback else { return Ok(()) };
    let step = Bound::new(py, step)?;
    let goes_on = callback.bind(py).call1((&step,)).and_then(|answer| goes_on(&answer));
    let flow = if let Ok(true) = goes_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    step.get().release(flow);
    goes_on.map(drop)
}

/// Whether an answer is anything but `False`, be it Python's, or numpy's or another library's, also in an
/// array without axes.
///
/// # Errors
/// Those of its `__bool__`, as of arrays of several.
fn goes_on(answer: &Bound<'_, PyAny>) -> PyResult<bool> {
    if answer.is_instance_of::<PyBool>() {
        return answer.is_truthy();
    }
    let Some(dtype) = answer.getattr_opt("dtype")? else { return Ok(true) };
    let is_bool = matches!(dtype.str()?.to_str()?, "bool" | "torch.bool");
    if is_bool { answer.is_truthy() } else { Ok(true) }
}

fn tell(py: Python<'_>, progress: &Option<Py<PyAny>>, facts: Facts) -> PyResult<()> {
    match progress {
        Some(progress) => progress.call1(py, (Bound::new(py, PyStep::new(facts).0)?,)).map(drop),
        None => Ok(()),
    }
}
