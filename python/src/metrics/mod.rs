//! What tables and points are worth. The other half, with the documentation, is `fsot/metrics.py`.

pub mod given;
pub mod integrand;
pub mod integrands;
pub mod measure;

use pyo3::prelude::*;

use crate::counts::Count;
use crate::work::left_alone;

/// Measures on so many threads, without the interpreter's lock, unless Ctrl-C comes.
///
/// # Errors
/// A number of threads out of range; what a signal's handler raises.
pub fn measured<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<Count>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    left_alone(py, threads.map(|Count(threads)| threads), work)
}
