//! Runs that go on another day.

use fsot::optimizer::Checkpoint;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::config::PyConfig;
use crate::errors::OrPython;
use crate::until::Until;

/// All that the rest of a run depends on, or all that further steps do. Who resumes it ends with the same
/// bits.
///
/// `Step.checkpoint` takes one in the middle of a run, and `Optimizer.checkpoint` between steps, or of a run
/// that has ended early, where it broke off.
#[pyclass(frozen, name = "Checkpoint", module = "fsot")]
#[derive(Clone, Debug)]
pub struct PyCheckpoint(pub Checkpoint);

#[pymethods]
impl PyCheckpoint {
    /// Reads a file.
    #[staticmethod]
    fn load(py: Python<'_>, path: std::path::PathBuf) -> PyResult<Self> {
        py.detach(|| Checkpoint::load(path)).python().map(Self)
    }

    /// Writes a file, which appears whole or not at all.
    fn save(&self, py: Python<'_>, path: std::path::PathBuf) -> PyResult<()> {
        py.detach(|| self.0.save(path)).python()
    }

    /// The configuration of the run.
    #[getter]
    fn config(&self) -> PyResult<PyConfig> {
        self.0.config().python().map(PyConfig)
    }

    /// The bytes of its file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        self.0.write(&mut bytes)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// From the bytes of its file.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        Checkpoint::read(&mut &*bytes).python().map(Self)
    }

    /// Whether their files are the same.
    fn __eq__(&self, other: &Self) -> PyResult<bool> {
        let bytes = |checkpoint: &Checkpoint| {
            let mut bytes = Vec::new();
            checkpoint.write(&mut bytes).map(|()| bytes)
        };
        Ok(bytes(&self.0)? == bytes(&other.0)?)
    }

    fn __repr__(&self) -> String {
        match self.0.progress() {
            Some((work, step)) => {
                format!("<Checkpoint at step {step} of {}>", Until(fsot::Until::Work(work)).repr())
            }
            None => "<Checkpoint between runs>".into(),
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((py.get_type::<Self>().getattr("from_bytes")?, (self.to_bytes(py)?,)))
    }
}
