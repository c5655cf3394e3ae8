//! Families of classes that the caller writes.

use std::any::Any;

use crate::named::{ByName, Named};
use crate::table::extent::Extent;

/// A family of filters of the caller's own.
///
/// It is asked once for each of its members, when an objective is planned, and never during the optimisation:
/// a filter may be anything that can be written down as a list of samples and weights. The lists are kept,
/// eight bytes per entry. `CustomClasses::get` gives it back as `&dyn Any`, so that who made it finds it
/// again.
///
/// ```
/// use fsot::classes::{ClassFamily, ClassSamples, Classes};
/// use fsot::config::{Role, Term};
/// use fsot::targets::Target;
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// /// Every window of 16 consecutive points.
/// #[derive(Debug)]
/// struct Windows;
///
/// impl ClassFamily for Windows {
///     fn name(&self) -> &str {
///         "windows"
///     }
///     fn members(&self, extent: &Extent) -> usize {
///         extent.samples() / 16
///     }
///     fn member(&self, _extent: &Extent, member: usize) -> ClassSamples {
///         let first = 16 * member as u32;
///         ClassSamples { samples: (first..first + 16).map(|sample| (sample, 1.0)).collect(), weight: 1.0 }
///     }
/// }
///
/// let (classes, target, dims) = (Classes::custom(Windows), Target::UniformCube, vec![0, 1]);
/// let term = Term { classes, target, dims, weight: 1.0, role: Role::Descend };
/// Optimizer::new(Config::point_set(64, 2, vec![term]))?.run(Until::SlicesPerClass(64))?;
/// # Ok::<(), fsot::ConfigError>(())
/// ```
pub trait ClassFamily: Any + std::fmt::Debug + Send + Sync {
    /// Name for messages and for a serialised [`crate::Config`].
    fn name(&self) -> &str;

    /// Number of classes, for tables of this extent; at most 2^24.
    fn members(&self, extent: &Extent) -> usize;

    /// The filter of class `member`, below [`ClassFamily::members`].
    fn member(&self, extent: &Extent, member: usize) -> ClassSamples;
}

/// The filter of one class of a [`ClassFamily`].
///
/// ```
/// use fsot::classes::ClassSamples;
///
/// // Two samples alike, and a third that counts half.
/// let class = ClassSamples { samples: vec![(0, 1.0), (4, 1.0), (8, 0.5)], weight: 1.0 };
/// assert_eq!(class.samples.len(), 3);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ClassSamples {
    /// Samples and their weights, in any order; each sample once at most, weights from 0 to 1. Sample `s` of
    /// a site has the number `extent.site_index(site) * extent.spp + s`.
    pub samples: Vec<(u32, f64)>,
    /// Weight of the class beside the others of the family; from 1e-12 to 1e6.
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
