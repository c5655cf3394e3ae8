//! What cannot be measured, with the values that show it. Every message ends in what to do about it.

use std::sync::Arc;

use thiserror::Error;

use crate::error::{ConfigError, GroupError, KernelError, RangeError, Short, TargetError};

/// A question that has no answer: samples, dimensions, integrands or settings that cannot be measured.
///
/// ```
/// use fsot::metrics::{MeasureError, Samples};
///
/// let error = Samples::points(&[0.5, 0.25, 0.125], 2).unwrap_err();
/// assert_eq!(error, MeasureError::PointCount { given: 3, dims: 2 });
/// assert_eq!(error.to_string(), "3 values are no points of 2 dimensions: give 2 values per point");
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// There is nothing of what is needed.
    #[error("the number of {what} is 0: give at least 1")]
    Nothing {
        /// What there is nothing of.
        what: &'static str,
    },
    /// A list of values ends within a point.
    #[error("{given} values are no points of {dims} dimensions: give {dims} values per point")]
    PointCount {
        /// Values given.
        given: usize,
        /// Dimensions of a point.
        dims: usize,
    },
    /// A point lies outside the unit cube.
    #[error(
        "point {point} has {} in dimension {dimension}: give finite values in [0, 1)",
        Short::from(value)
    )]
    BadPoint {
        /// Number of the point.
        point: usize,
        /// The dimension.
        dimension: usize,
        /// The value.
        value: f64,
    },
    /// A selection of points that are not there, or of none.
    #[error("points {start}..{end} of {count} are selected: give an ascending range that ends by {count}")]
    NoSuchPoints {
        /// First point of the selection.
        start: usize,
        /// The point after the last.
        end: usize,
        /// Points that there are.
        count: usize,
    },
    /// A dimension group does not fit what it is measured with.
    #[error("the dimension group has {given} dimensions, but {what} has {expected}: name as many")]
    GroupSize {
        /// What it is measured with: an integrand, the target.
        what: &'static str,
        /// Dimensions named.
        given: usize,
        /// Dimensions expected.
        expected: usize,
    },
    /// A family holds an integrand of another number of coordinates.
    #[error(
        "integrand {index} of \"{family}\" has {given} coordinates instead of {expected}: give it as many"
    )]
    IntegrandDims {
        /// Name of the family.
        family: Arc<str>,
        /// Position in the family.
        index: usize,
        /// Coordinates of the integrand.
        given: usize,
        /// Coordinates of the set.
        expected: usize,
    },
    /// Two families have the same name.
    #[error("two families are called \"{name}\": give each a name of its own")]
    RepeatedFamily {
        /// The name.
        name: Arc<str>,
    },
    /// The samples have another shape than the objective is planned for.
    #[error("the samples have shape {given:?}: bring some of shape {expected:?} [frame, y, x, sample, dim]")]
    OtherShape {
        /// Shape of the samples.
        given: Box<[usize; 5]>,
        /// Shape that the objective is planned for.
        expected: Box<[usize; 5]>,
    },
    /// A list of dimensions that is no group.
    #[error(transparent)]
    Group(#[from] GroupError),
    /// A number lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A kernel that cannot filter.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// A target that is none.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// What an objective refuses.
    #[error(transparent)]
    Config(#[from] ConfigError),
}
