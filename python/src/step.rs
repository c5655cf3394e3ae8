//! What a run tells its caller after a step.

use std::ops::ControlFlow;
use std::process;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};

use fsot::SampleTable;
use fsot::optimizer::{Checkpoint, StepReport};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::arrays::table_to_numpy;
use crate::checkpoint::PyCheckpoint;

/// Figures of a step.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    step: u64,
    steps: u64,
    slices: u64,
    displacement: f64,
    rate: f64,
    elapsed: f64,
}

impl From<&StepReport<'_>> for Facts {
    fn from(report: &StepReport<'_>) -> Self {
        let StepReport { step, steps, slices, displacement, rate, elapsed, .. } = *report;
        Self { step, steps, slices, displacement, rate, elapsed: elapsed.as_secs_f64() }
    }
}

/// What a callback may ask of the run that waits for it.
#[derive(Debug)]
pub enum Ask {
    Points(Sender<SampleTable>),
    Loss(Sender<f64>),
    Checkpoint(Sender<Checkpoint>),
    GoOn(ControlFlow<()>),
}

/// A step of a run, as a callback sees it.
///
/// Figures may be kept, copied and pickled. Points, loss and checkpoint are computed when they are asked for,
/// which is possible until the callback returns.
#[pyclass(frozen, name = "Step", module = "fsot")]
#[derive(Debug)]
pub struct PyStep {
    facts: Facts,
    /// Whose thread answers.
    process: u32,
    asks: Mutex<Option<Sender<Ask>>>,
}

#[pymethods]
impl PyStep {
    /// Steps taken in this run.
    #[getter]
    fn step(&self) -> u64 {
        self.facts.step
    }

    /// Steps that the run is planned to take.
    #[getter]
    fn steps(&self) -> u64 {
        self.facts.steps
    }

    /// Slices drawn in this run, over all terms.
    #[getter]
    fn slices(&self) -> u64 {
        self.facts.slices
    }

    /// Root mean square distance between the samples and their targets; during sweeps the root mean square
    /// pull on a coordinate. A noisy sign of progress.
    #[getter]
    fn displacement(&self) -> f64 {
        self.facts.displacement
    }

    /// Step size.
    #[getter]
    fn rate(&self) -> f64 {
        self.facts.rate
    }

    /// Seconds since the first step of the run.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.facts.elapsed
    }

    /// The coordinates after the step, `[frame, y, x, sample, dim]`, a copy.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        table_to_numpy(py, self.ask(py, Ask::Points)?)
    }

    /// A running estimate of the objective, on slices that stay the same over the run. Takes a millisecond
    /// or so.
    #[getter]
    fn loss(&self, py: Python<'_>) -> PyResult<f64> {
        self.ask(py, Ask::Loss)
    }

    /// All that the rest of the run depends on: see `Optimizer.resume`.
    fn checkpoint(&self, py: Python<'_>) -> PyResult<PyCheckpoint> {
        self.ask(py, Ask::Checkpoint).map(PyCheckpoint)
    }

    /// The figures: nothing can be asked of a copy.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, StepParts)> {
        let Facts { step, steps, slices, displacement, rate, elapsed } = self.facts;
        let parts = (step, steps, slices, displacement, rate, elapsed);
        Ok((py.get_type::<Self>().getattr("_of_figures")?, parts))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_figures(step: u64, steps: u64, slices: u64, displacement: f64, rate: f64, elapsed: f64) -> Self {
        let facts = Facts { step, steps, slices, displacement, rate, elapsed };
        Self { facts, process: process::id(), asks: Mutex::new(None) }
    }

    fn __repr__(&self) -> String {
        let Facts { step, steps, displacement, elapsed, .. } = self.facts;
        format!("<step {step} of {steps}, displacement {displacement:.3e}, {elapsed:.2} s>")
    }
}

type StepParts = (u64, u64, u64, f64, f64, f64);

impl PyStep {
    fn ask<T: Send>(&self, py: Python<'_>, what: impl FnOnce(Sender<T>) -> Ask) -> PyResult<T> {
        if self.process != process::id() {
            return Err(PyRuntimeError::new_err(
                "the run is another process's: ask there what a forked one needs, before it is forked",
            ));
        }
        let over = || PyRuntimeError::new_err("the run has gone on: ask a step while the callback sees it");
        let asks = self.asks.lock().map_err(|_| over())?.clone().ok_or_else(over)?;
        let (reply, replied) = channel();
        asks.send(what(reply)).map_err(|_| over())?;
        let replied = Mutex::new(replied);
        py.detach(|| replied.lock().ok()?.recv().ok()).ok_or_else(over)
    }

    /// A step, with the questions that will be asked about it.
    pub fn new(facts: Facts) -> (Self, Receiver<Ask>) {
        let (asks, asked) = channel();
        (Self { facts, process: process::id(), asks: Mutex::new(Some(asks)) }, asked)
    }

    /// Lets the run go on; nothing can be asked any more.
    pub fn release(&self, flow: ControlFlow<()>) {
        if let Ok(mut asks) = self.asks.lock()
            && let Some(asks) = asks.take()
        {
            // The run may have ended already.
            let _ = asks.send(Ask::GoOn(flow));
        }
    }
}

/// Answers the questions of a callback until it lets the run go on.
pub fn answer(report: &StepReport<'_>, asked: &Receiver<Ask>) -> ControlFlow<()> {
    // Whoever asked may have gone.
    for ask in asked {
        match ask {
            Ask::Points(reply) => drop(reply.send(report.table())),
            Ask::Loss(reply) => drop(reply.send(report.loss())),
            Ask::Checkpoint(reply) => drop(reply.send(report.checkpoint())),
            Ask::GoOn(flow) => return flow,
        }
    }
    ControlFlow::Break(())
}
