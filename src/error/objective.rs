//! What is wrong with the points or slices that an objective is asked about.

use thiserror::Error;

use super::{ConfigError, Short, TargetError};

/// A question that an objective cannot answer.
///
/// ```
/// use fsot::objective::ObjectiveError;
/// use fsot::{Config, Extent, Objective};
///
/// let objective = Objective::new(&Config::new(Extent::still(4, 4), 2))?;
/// let error = objective.cramer(&[0.5; 7]).unwrap_err();
/// assert_eq!(error, ObjectiveError::PointCount { given: 7, expected: 32 });
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ObjectiveError {
    /// The objective has no closed form over all slices.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The list of points does not fit the table.
    #[error(
        "the list of points holds {given} values, but the table has {expected}: give one value per coordinate"
    )]
    PointCount {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// A point lies outside the unit cube.
    #[error("point coordinate {index} is {}: give finite values in [0, 1)", Short::from(value))]
    BadPoint {
        /// Index into the list of coordinates.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A slice that does not fit the objective.
    #[error("slice {slice}: {problem}")]
    Slice {
        /// Position of the slice in the list, from 0.
        slice: usize,
        /// What is wrong with it.
        problem: SliceError,
    },
    /// Whoever watched broke off.
    #[error("value and gradient were stopped half-way: let them continue to their end")]
    Stopped,
}

/// A slice that does not fit its objective.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SliceError {
    /// It refers to something that the objective does not have.
    #[error("{what} is {given}, but the objective has {limit}: stay below it")]
    NoSuch {
        /// Which field.
        what: &'static str,
        /// The value given.
        given: usize,
        /// Number of such things.
        limit: usize,
    },
    /// Its direction or cut does not fit its dimension group.
    #[error("{what} has {given} components, but its group has {expected} dimensions: give one each")]
    Components {
        /// Which field.
        what: &'static str,
        /// Components given.
        given: usize,
        /// Components expected.
        expected: usize,
    },
    /// The target has no law along it.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// A number that cannot be used.
    #[error("{what} is {}: give {expected}", Short::from(value))]
    Value {
        /// Which field.
        what: &'static str,
        /// The value given.
        value: f64,
        /// What is admissible, in words.
        expected: &'static str,
    },
}
