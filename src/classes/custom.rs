//! Families of classes that the caller writes.

use std::sync::Arc;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::table::extent::Extent;

/// A family of filters of the caller's own.
///
/// It is asked once for each of its members, when an objective is planned, and never during the optimisation: a filter may
/// be anything that can be written down as a list of samples and weights. The lists are kept, eight bytes per entry.
pub trait ClassFamily: std::fmt::Debug + Send + Sync {
    /// Name for messages and for a serialised [`crate::Config`].
    fn name(&self) -> &str;

    /// Number of classes, for tables of this extent.
    fn members(&self, extent: &Extent) -> usize;

    /// The filter of class `member`, below [`ClassFamily::members`].
    fn member(&self, extent: &Extent, member: usize) -> ClassSamples;
}

/// The filter of one class of a [`ClassFamily`].
#[derive(Clone, Debug, PartialEq)]
pub struct ClassSamples {
    /// Samples and their weights, in any order; each sample once at most, weights from 0 to 1. Sample `s` of a site has
    /// the number `extent.site_index(site) * extent.spp + s`.
    pub samples: Vec<(u32, f64)>,
    /// Weight of the class beside the others of the family; positive.
    pub weight: f64,
}

/// A [`ClassFamily`] behind a shared pointer.
///
/// It is serialised as its name. Code cannot be read back from a name, so that deserialising it is an error that says so:
/// read the rest of the configuration and put the family in again with [`Classes::custom`](crate::classes::Classes::custom).
#[derive(Clone, Debug)]
pub struct CustomClasses(Arc<dyn ClassFamily>);

impl CustomClasses {
    /// Wraps a family.
    pub fn new(family: impl ClassFamily + 'static) -> Self {
        Self(Arc::new(family))
    }

    /// The family.
    pub fn family(&self) -> &dyn ClassFamily {
        &*self.0
    }
}

/// Equal if they are the same object.
impl PartialEq for CustomClasses {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Serialize for CustomClasses {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de> Deserialize<'de> for CustomClasses {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Err(D::Error::custom(format!(
            "the class family \"{name}\" is code, which no file holds: take its term out of the file, read the rest, and \
             add the term again with Classes::custom"
        )))
    }
}
