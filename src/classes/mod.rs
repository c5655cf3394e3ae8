//! Families of filters. A *class* is one member of a family: the filter of one pixel, of one label, of a
//! prefix.

mod blocks;
mod custom;
mod demand;
mod family;
mod listed;
mod pixels;
mod prefixes;
mod reach;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use self::custom::{ClassFamily, ClassSamples, CustomClasses};
pub use self::demand::Demand;
pub(crate) use self::demand::Wanted;
pub(crate) use self::family::FilterFamily;
pub use self::listed::{LabelSet, Ramp};
pub use self::prefixes::{PrefixLength, PrefixLengths, PrefixOf};
pub use crate::error::ClassError;
use crate::kernel::Kernel;

/// A family of filters over the samples of a table (Salaün et al. 2022, Section 3).
///
/// Samples are numbered in the order of the table, `site * spp + sample`; a point set
/// ([`crate::Extent::points`]) has one per site. A class that holds no sample is never drawn and costs
/// nothing.
///
/// ```
/// use fsot::classes::{Classes, FilterForm};
/// use fsot::config::{Role, Term};
/// use fsot::targets::Target;
/// use fsot::{Config, Extent, Kernel, Objective};
///
/// // Filtered pixels of two samples each, and the samples of each pixel by themselves.
/// let of = |classes, weight| {
///     let (target, dims, role) = (Target::UniformCube, vec![0, 1], Role::Descend);
///     Term { classes, target, dims, weight, role }
/// };
/// let lattice = Classes::Lattice { kernel: Kernel::gaussian(2.1), form: FilterForm::LevelSets };
/// let terms = vec![of(lattice, 1.0), of(Classes::PerPixel, 0.2)];
/// let config = Config::new(Extent::still(16, 16).with_spp(2), 2).with_terms(terms);
/// assert_eq!(Objective::new(&config)?.terms().count(), 2);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Classes {
    /// One class per pixel and frame: the kernel centred there.
    Lattice {
        /// The filter.
        kernel: Kernel,
        /// How its weights enter.
        #[serde(default)]
        form: FilterForm,
    },
    /// One class: all samples alike. It is what makes a table unbiased.
    WholeTable,
    /// One class per frame: its samples alike.
    PerFrame,
    /// One class per pixel and frame: its samples alike (of use for `spp > 1`).
    PerPixel,
    /// One class per set of labels: the samples that carry one of them, alike.
    Labelled {
        /// Label of each sample; any numbers.
        labels: Arc<[u32]>,
        /// The classes. A set whose labels no sample carries is an empty class.
        subsets: Vec<LabelSet>,
    },
    /// One class per ramp: filters that rise or fall along a coordinate of the samples. Its level sets are
    /// the samples beyond any threshold, so that every part of the ramp looks like the target.
    Ramps {
        /// Class coordinate of each sample, in `[0, 1]`.
        coordinates: Arc<[f64]>,
        /// The classes.
        ramps: Vec<Ramp>,
    },
    /// One class per length: the first so many samples.
    Prefixes {
        /// What is to be cut short: the table, or the samples of each pixel.
        of: PrefixOf,
        /// Where.
        lengths: PrefixLengths,
    },
    /// A family of the caller's own.
    Custom(CustomClasses),
}

impl Classes {
    /// A family of the caller's own.
    pub fn custom(family: impl ClassFamily + 'static) -> Self {
        Self::Custom(CustomClasses::shared(Arc::new(family)))
    }

    /// One class per set of labels, all with the same weight.
    pub fn labelled(labels: impl Into<Arc<[u32]>>, subsets: impl IntoIterator<Item = Vec<u32>>) -> Self {
        let subsets = subsets.into_iter().map(|labels| LabelSet { labels, weight: 1.0 }).collect();
        Self::Labelled { labels: labels.into(), subsets }
    }
}

/// How the weights of a filter enter the transport.
///
/// ```
/// use fsot::classes::FilterForm;
/// use fsot::{Config, Extent};
///
/// let config = Config::new(Extent::still(16, 16), 2).with_form(FilterForm::Weighted);
/// # let _ = config;
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilterForm {
    /// Uniform level `z`, unweighted subset `{j : w_j > z}`: the objective of Salaün et al. 2022. Cheap.
    #[default]
    LevelSets,
    /// All samples under the filter, each with its weight. By the triangle inequality a bound at least as
    /// tight, at the cost of the whole support in every slice.
    Weighted,
}

#[cfg(test)]
mod tests;
