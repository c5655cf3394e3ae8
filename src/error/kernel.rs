//! What is wrong with a kernel.

use thiserror::Error;

use super::{ExtentError, RangeError};

/// A kernel that cannot filter.
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
    #[error("{kernel} has weight {weight} at tap {index}: weights must be finite and at least 0")]
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
