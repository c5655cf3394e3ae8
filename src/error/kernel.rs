//! What is wrong with a kernel.

use thiserror::Error;

use super::{ExtentError, RangeError, Short};

/// A kernel that cannot filter.
///
/// ```
/// use fsot::{Extent, Kernel};
///
/// let error = Kernel::gaussian(-1.0).taps(&Extent::still(8, 8)).unwrap_err();
/// assert_eq!(error.to_string(), "sigma_px is -1: give a value above 0, at most 1e6");
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum KernelError {
    /// A parameter lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The table that it should filter has no such extent.
    #[error(transparent)]
    Extent(#[from] ExtentError),
    /// A weight that is none.
    #[error(
        "{kernel} has weight {} at tap {index}: weights must be finite and at least 0",
        Short::from(weight)
    )]
    BadTap {
        /// Which kernel.
        kernel: &'static str,
        /// Position in the list of taps.
        index: usize,
        /// The weight given.
        weight: f64,
    },
    /// No positive weight.
    #[error("{kernel} has no positive weight: give at least one tap above 0")]
    Empty {
        /// Which kernel.
        kernel: &'static str,
    },
}
