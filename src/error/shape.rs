//! What is wrong with a number, with the shape of a table, or with a list of its dimensions.

use thiserror::Error;

use super::Short;

/// A number that lies outside its range.
///
/// ```
/// use fsot::config::RangeError;
///
/// let error = RangeError::check(false, "alpha", 2.0, "from 0 to 1").unwrap_err();
/// assert_eq!(error.to_string(), "alpha is 2: give a value from 0 to 1");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{name} is {}: give a value {expected}", Short::from(.value))]
#[non_exhaustive]
pub struct RangeError {
    /// Name of the parameter.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
    /// The admissible range, in words.
    pub expected: &'static str,
}

impl RangeError {
    /// `name` is `value`, but should be `expected`: `"above 0, at most 1e6"`, say.
    pub fn new(name: &'static str, value: f64, expected: &'static str) -> Self {
        Self { name, value, expected }
    }

    /// Refuses a value that is not admissible.
    ///
    /// # Errors
    /// The value, unless it `is_good`.
    pub fn check(is_good: bool, name: &'static str, value: f64, expected: &'static str) -> Result<(), Self> {
        if is_good { Ok(()) } else { Err(Self::new(name, value, expected)) }
    }
}

/// An extent, or a number of dimensions, that no table has.
///
/// ```
/// use fsot::Extent;
/// use fsot::config::ExtentError;
///
/// let empty = Extent::still(0, 64);
/// assert_eq!(empty.validate(2), Err(ExtentError::EmptyAxis { axis: "height" }));
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtentError {
    /// An axis has no entries.
    #[error("{axis} is 0: give at least 1")]
    EmptyAxis {
        /// Name of the axis.
        axis: &'static str,
    },
    /// More values than can be numbered.
    #[error("the table would hold {values} values: stay at or below 2147483647 (2^31 - 1)")]
    TooLarge {
        /// Number of values asked for (saturating).
        values: u64,
    },
    /// More than memory holds.
    #[error("{what} takes {bytes} bytes, which there are not: give a smaller extent, or fewer dimensions")]
    NoMemory {
        /// What takes them.
        what: &'static str,
        /// How many.
        bytes: usize,
    },
    /// More dimensions than a sample can have.
    #[error("dims is {dims}: give a value of at most {most}")]
    TooManyDims {
        /// Dimensions asked for.
        dims: usize,
        /// Most dimensions of a sample.
        most: usize,
    },
}

/// A list of dimensions that is no group.
///
/// ```
/// use fsot::config::GroupError;
///
/// assert_eq!(GroupError::check(&[0, 2], 2), Err(GroupError::NoSuchDimension { dimension: 2, dims: 2 }));
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GroupError {
    /// It names none.
    #[error("the dimension group is empty: name at least one dimension")]
    Empty,
    /// It names a dimension that the table does not have.
    #[error(
        "the dimension group names dimension {dimension}, but the table has {dims}: \
         name dimensions from 0 to {}",
        dims.saturating_sub(1)
    )]
    NoSuchDimension {
        /// The dimension named.
        dimension: usize,
        /// Dimensions of the table.
        dims: usize,
    },
    /// It names a dimension twice.
    #[error("the dimension group names dimension {dimension} twice: name each dimension once")]
    Repeated {
        /// The dimension named.
        dimension: usize,
    },
}

impl GroupError {
    /// Refuses a group that is empty, or names a dimension twice or beyond the `dims` of the table.
    ///
    /// # Errors
    /// What is wrong with the group.
    pub fn check(group: &[usize], dims: usize) -> Result<(), Self> {
        if group.is_empty() {
            return Err(Self::Empty);
        }
        for (place, &dimension) in group.iter().enumerate() {
            if dimension >= dims {
                return Err(Self::NoSuchDimension { dimension, dims });
            }
            if group[..place].contains(&dimension) {
                return Err(Self::Repeated { dimension });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_group_is_named() {
        assert_eq!(GroupError::check(&[2, 0], 3), Ok(()));
        assert_eq!(GroupError::check(&[], 3), Err(GroupError::Empty));
        assert_eq!(GroupError::check(&[1, 1], 3), Err(GroupError::Repeated { dimension: 1 }));
        let beyond = GroupError::check(&[0, 3], 3).unwrap_err();
        assert_eq!(beyond, GroupError::NoSuchDimension { dimension: 3, dims: 3 });
        assert!(beyond.to_string().ends_with("name dimensions from 0 to 2"), "{beyond}");
    }
}
