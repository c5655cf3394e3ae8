//! How long a run is.

use fsot::config::Work;
use pyo3::prelude::*;

use crate::counts::Number;
use crate::errors::refused;
use crate::json;

/// How long a run is.
///
/// Made by its class methods; `Until.usual()` is the default everywhere.
///
/// Examples
/// --------
/// >>> import fsot
/// >>> fsot.Until.sweeps(100)
/// Until.sweeps(100)
#[pyclass(frozen, eq, module = "fsot", from_py_object)]
#[derive(Clone, Debug, PartialEq)]
pub struct Until(pub fsot::Until);

#[pymethods]
impl Until {
    /// As much work as is usually worth it: some ten seconds of a core. The same work on every machine.
    #[staticmethod]
    fn usual() -> Self {
        Self(fsot::Until::Usual)
    }

    /// About this many seconds, with what gets furthest by then.
    #[staticmethod]
    fn seconds(seconds: f64) -> Self {
        Self(fsot::Until::Seconds(seconds))
    }

    /// This many sweeps; 20 to 100 make a good table.
    #[staticmethod]
    fn sweeps(sweeps: Number) -> Self {
        Self(fsot::Until::Sweeps(sweeps.0))
    }

    /// This many slices per pixel and frame, or per class of a point set.
    #[staticmethod]
    fn slices(slices: Number) -> Self {
        Self(fsot::Until::SlicesPerClass(slices.0))
    }

    /// Sweeps of the frame that an animation begins with, then slices, then sweeps.
    #[staticmethod]
    #[pyo3(signature = (*, frame_sweeps = Number(0), slices = Number(0), sweeps = Number(0)),
        text_signature = "(*, frame_sweeps=0, slices=0, sweeps=0)")]
    fn work(frame_sweeps: Number, slices: Number, sweeps: Number) -> Self {
        let [frame_sweeps, slices, sweeps] = [frame_sweeps, slices, sweeps].map(|Number(number)| number);
        Self(fsot::Until::Work(Work { frame_sweeps, slices_per_class: slices, sweeps }))
    }

    /// Slices until they bring little more: as soon as the mean squared displacement falls by less than the
    /// share `improvement`, in `[0, 1)`, from one window of `window_steps` steps to the next, and after
    /// `at_most` slices per pixel and frame at the latest.
    #[staticmethod]
    #[pyo3(signature = (improvement = 0.01, *, window_steps = Number(64), at_most = Number(10_000)),
        text_signature = "(improvement=0.01, *, window_steps=64, at_most=10000)")]
    fn converged(improvement: f64, window_steps: Number, at_most: Number) -> Self {
        let [window_steps, at_most] = [window_steps, at_most].map(|Number(number)| number);
        Self(fsot::Until::Converged { improvement, window_steps, at_most })
    }

    /// Plain data, as in metadata.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        json::of_python(data).map(Self)
    }

    #[pyo3(name = "__repr__")]
    pub fn repr(&self) -> String {
        match self.0 {
            fsot::Until::Usual => "Until.usual()".into(),
            fsot::Until::Seconds(seconds) => format!("Until.seconds({seconds:?})"),
            fsot::Until::Sweeps(sweeps) => format!("Until.sweeps({sweeps})"),
            fsot::Until::SlicesPerClass(slices) => format!("Until.slices({slices})"),
            fsot::Until::Work(Work { frame_sweeps, slices_per_class, sweeps }) => {
                format!("Until.work(frame_sweeps={frame_sweeps}, slices={slices_per_class}, sweeps={sweeps})")
            }
            fsot::Until::Converged { improvement, window_steps, at_most } => {
                format!("Until.converged({improvement:?}, window_steps={window_steps}, at_most={at_most})")
            }
            other => format!("Until.from_dict({})", serde_json::to_string(&other).unwrap_or_default()),
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        Ok((py.get_type::<Self>().getattr("from_dict")?, (self.to_dict(py)?,)))
    }
}

/// What `seconds`, `sweeps` and `slices` of a function say together.
#[pyfunction]
pub fn until(seconds: Option<f64>, sweeps: Option<Number>, slices: Option<Number>) -> PyResult<Until> {
    let [sweeps, slices] = [sweeps, slices].map(|number| number.map(|Number(number)| number));
    let until = match (seconds, sweeps, slices) {
        (None, None, None) => fsot::Until::Usual,
        (Some(seconds), None, None) => fsot::Until::Seconds(seconds),
        (None, Some(sweeps), None) => fsot::Until::Sweeps(sweeps),
        (None, None, Some(slices)) => fsot::Until::SlicesPerClass(slices),
        (None, Some(sweeps), Some(slices)) => {
            fsot::Until::Work(Work { slices_per_class: slices, sweeps, ..Work::default() })
        }
        _ => {
            return Err(refused(
                "seconds and a number of sweeps or slices say the same thing twice: leave out one of them",
            ));
        }
    };
    Ok(Until(until))
}
