//! Targets that the caller writes.

use std::sync::Arc;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::laws::Projected;

/// A target measure of the caller's own, on the unit cube.
///
/// It is asked for the laws of a fixed set of directions when an objective is planned, and never during the optimisation.
pub trait Measure: std::fmt::Debug + Send + Sync {
    /// Name for messages and for a serialised [`crate::Config`].
    fn name(&self) -> &str;

    /// Number of dimensions.
    fn dims(&self) -> usize;

    /// The law of `x·direction` where `x` follows the measure, with one component of any sign per dimension:
    /// [`Projected::from_quantile`], [`Projected::from_density`] or [`Projected::from_samples`] make one.
    fn project(&self, direction: &[f64]) -> Projected;
}

/// A [`Measure`] behind a shared pointer.
///
/// It is serialised as its name. Code cannot be read back from a name, so that deserialising it is an error that says so:
/// read the rest of the configuration and put the target in again with [`Target::custom`](crate::targets::Target::custom).
#[derive(Clone, Debug)]
pub struct CustomTarget(Arc<dyn Measure>);

impl CustomTarget {
    /// Wraps a measure.
    pub fn new(measure: impl Measure + 'static) -> Self {
        Self(Arc::new(measure))
    }

    /// The measure.
    pub fn measure(&self) -> &dyn Measure {
        &*self.0
    }
}

/// Equal if they are the same object.
impl PartialEq for CustomTarget {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Serialize for CustomTarget {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de> Deserialize<'de> for CustomTarget {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Err(D::Error::custom(format!(
            "the target \"{name}\" is code, which no file holds: take its term out of the file, read the rest, and add the \
             term again with Target::custom"
        )))
    }
}
