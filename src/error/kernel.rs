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
    /// An array without weights.
    #[error("the kernel holds no weights: give at least one above 0")]
    NoWeights,
    /// A weight of an array that is none.
    #[error(
        "the kernel has weight {} at [{}y {y}, x {x}]: weights must be finite and at least 0",
        Short::from(weight),
        frame.map_or(String::new(), |frame| format!("frame {frame}, "))
    )]
    BadWeight {
        /// Frames back, where the array has such an axis.
        frame: Option<usize>,
        /// Row.
        y: usize,
        /// Column.
        x: usize,
        /// The weight given.
        weight: f64,
    },
    /// Weights of an array that are none together.
    #[error(
        "the kernel has weights whose sum is {}: give a sum that is above 0 and finite",
        Short::from(sum)
    )]
    BadSum {
        /// Their sum.
        sum: f64,
    },
    /// More weights than a tile has pixels: those beyond its edges would come in again from the other side.
    #[error(
        "the kernel has {columns} × {rows} weights, more than the {width} × {height} pixels of a frame: give \
         a smaller kernel, or a larger width and height"
    )]
    Oversized {
        /// Rows of weights.
        rows: usize,
        /// Columns of weights.
        columns: usize,
        /// Rows of the tile.
        height: usize,
        /// Columns of the tile.
        width: usize,
    },
    /// No positive weight.
    #[error("{kernel} has no positive weight: give at least one tap above 0")]
    Empty {
        /// Which kernel.
        kernel: &'static str,
    },
}
