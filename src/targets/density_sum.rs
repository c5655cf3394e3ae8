//! Densities on top of each other.

use serde::{Deserialize, Serialize};

use super::density::Density;
use crate::error::TargetError;

/// The sum of densities of one size, as they are: some inks of a picture together.
///
/// It holds its parts instead of adding them up. An optimiser plans sums that share parts, clones of each
/// other, in one pass over each part.
///
/// ```
/// use fsot::targets::{Density, DensitySum};
///
/// let [left, right] = [[1.0, 0.0], [0.0, 3.0]].map(|values| Density::new(2, 1, values.to_vec()));
/// let both = DensitySum::new(vec![left?, right?])?;
/// assert_eq!((both.mass(), both.at([0.7, 0.5])), (4.0, 3.0));
/// # Ok::<(), fsot::targets::TargetError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct DensitySum {
    parts: Vec<Density>,
}

/// A sum as a file says it.
#[derive(Deserialize)]
struct Unchecked {
    parts: Vec<Density>,
}

impl TryFrom<Unchecked> for DensitySum {
    type Error = TargetError;

    fn try_from(given: Unchecked) -> Result<Self, TargetError> {
        Self::new(given.parts)
    }
}

impl DensitySum {
    /// The sum of at least one density.
    ///
    /// # Errors
    /// Nothing to add, densities of different sizes.
    pub fn new(parts: Vec<Density>) -> Result<Self, TargetError> {
        let Some(first) = parts.first() else {
            return Err(TargetError::Empty { what: "the number of densities" });
        };
        let expected = first.size();
        match parts.iter().find(|part| part.size() != expected) {
            Some(other) => Err(TargetError::OtherDensity { given: other.size(), expected }),
            None => Ok(Self { parts }),
        }
    }

    /// What is added.
    pub fn parts(&self) -> &[Density] {
        &self.parts
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        self.parts[0].size()
    }

    /// Sum of all values.
    pub fn mass(&self) -> f64 {
        self.parts.iter().map(Density::mass).sum()
    }

    /// The value at a point of the unit square.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        self.parts.iter().map(|part| part.at(place)).sum()
    }

    /// Lengths of the picture's sides, the longer one being 1.
    pub(super) fn scales(&self) -> [f64; 2] {
        self.parts[0].scales()
    }
}
