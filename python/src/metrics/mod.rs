//! What tables and points are worth. The other half, with the documentation, is `fsot/metrics.py`.

pub mod given;
pub mod integrand;
pub mod integrands;
pub mod measure;

use pyo3::marker::Ungil;
use pyo3::prelude::*;

use crate::counts::Count;
use crate::work::detached;

/// Measures on so many threads, without the interpreter's lock.
///
/// # Errors
/// A number of threads out of range.
pub fn measured<T: Ungil + Send>(
    py: Python<'_>,
    threads: Option<Count>,
    work: impl FnOnce() -> T + Ungil + Send,
) -> PyResult<T> {
    detached(py, threads.map(|Count(threads)| threads), work)
}
