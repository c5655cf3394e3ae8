//! Families of classes that the caller writes.

use crate::named::{ByName, Named};
use crate::table::extent::Extent;

/// A family of filters of the caller's own.
///
/// It is asked once for each of its members, when an objective is planned, and never during the optimisation:
/// a filter may be anything that can be written down as a list of samples and weights. The lists are kept,
/// eight bytes per entry.
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
    /// Samples and their weights, in any order; each sample once at most, weights from 0 to 1. Sample `s` of
    /// a site has the number `extent.site_index(site) * extent.spp + s`.
    pub samples: Vec<(u32, f64)>,
    /// Weight of the class beside the others of the family; positive.
    pub weight: f64,
}

impl Named for dyn ClassFamily {
    const KIND: &'static str = "class family";
    const CONSTRUCTOR: &'static str = "Classes::custom";

    fn name(&self) -> &str {
        ClassFamily::name(self)
    }
}

/// A [`ClassFamily`] behind a shared pointer; [`Classes::custom`](super::Classes::custom) makes one.
pub type CustomClasses = ByName<dyn ClassFamily>;
