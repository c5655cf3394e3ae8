//! What is wrong with a target.

use thiserror::Error;

use super::{RangeError, Short, ShortList};

/// A measure that cannot be a target.
///
/// ```
/// use fsot::targets::{Density, TargetError};
///
/// let error = Density::new(2, 1, vec![0.0; 2]).unwrap_err();
/// assert_eq!(error, TargetError::NoDensity { width: 2, height: 1 });
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TargetError {
    /// A number lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A density or a cloud of nothing.
    #[error("{what} is 0: give at least 1")]
    Empty {
        /// Number of what.
        what: &'static str,
    },
    /// The values of a density are not one per pixel.
    #[error("{given} values for a density of {width} by {height} pixels: give {expected}, row by row")]
    DensityCount {
        /// Values given.
        given: usize,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Values expected.
        expected: usize,
    },
    /// A value cannot be a density.
    #[error(
        "the density at column {x}, row {y} is {}: give finite values of at least 0",
        Short::from(&(*value as f32))
    )]
    BadDensity {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The value.
        value: f64,
    },
    /// A density that is 0 everywhere: an all-black picture, where bright draws points.
    #[error(
        "the density is 0 in all of its {width} by {height} pixels, so that no point has a place: \
         give at least one above 0 (a picture needs some ink, or the other tone)"
    )]
    NoDensity {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Densities of different sizes cannot be added.
    #[error("a density has {given:?} columns and rows, another {expected:?}: bring all to the same size")]
    OtherDensity {
        /// Columns and rows.
        given: [usize; 2],
        /// Those of the first.
        expected: [usize; 2],
    },
    /// A density that doesn't fit the memory.
    #[error("there is no memory for a density of {pixels} pixels: average the picture down to fewer")]
    Memory {
        /// Its pixels.
        pixels: usize,
    },
    /// The last point of a cloud is incomplete.
    #[error("{given} coordinates for points of {dims} dimensions: give a multiple of {dims}")]
    IncompletePoint {
        /// Coordinates given.
        given: usize,
        /// Dimensions of a point.
        dims: usize,
    },
    /// A point of a cloud lies outside the unit cube.
    #[error("coordinate {index} of the cloud is {}: give finite values in [0, 1]", Short::from(value))]
    BadCoordinate {
        /// Position in the list of coordinates.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The law along a direction is not a law.
    #[error("the target has no finite law along {}: correct its projection", ShortList(direction))]
    BadLaw {
        /// The direction.
        direction: Vec<f64>,
    },
    /// The law along a direction is not that of a measure on the unit cube.
    #[error(
        "along {} the target reaches from {} to {}, but the unit cube from {} to {}: correct its projection",
        ShortList(direction), Short::from(reach[0]), Short::from(reach[1]), Short::from(cube[0]),
        Short::from(cube[1])
    )]
    OutsideCube {
        /// The direction.
        direction: Vec<f64>,
        /// Least and largest value of the law.
        reach: [f64; 2],
        /// The same of the cube.
        cube: [f64; 2],
    },
}
