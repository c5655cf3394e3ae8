//! A term made ready for one extent: everything that does not depend on the samples is computed once.

use std::collections::{BTreeMap, BTreeSet};

use crate::bank::Boundary;
use crate::class::{Family, Wanted};
use crate::direction::Slicer;
use crate::error::ConfigError;
use crate::lanes::LONGEST;
use crate::lattice::Extent;
use crate::network::Network;
use crate::term::{Slicing, Term};

/// A term with its family of classes, its directions, and what sorting its subsets takes.
#[derive(Clone, Debug)]
pub(crate) struct PlannedTerm {
    pub spec: Term,
    pub family: Family,
    pub slicer: Slicer,
    /// Networks and quantile cells of the subset sizes that are sorted in lanes. A subset of another size takes the
    /// next larger network.
    pub sizes: BTreeMap<usize, SizePlan>,
    /// Subsets drawn per step; need not be whole.
    pub rate: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct SizePlan {
    pub network: Network,
    /// Boundaries of the quantile cells, where laws are tabulated.
    pub grid: Vec<Boundary>,
}

impl PlannedTerm {
    pub(crate) fn new(
        index: usize,
        term: &Term,
        extent: Extent,
        dims: usize,
        slicing: &Slicing,
        wanted: Wanted,
    ) -> Result<Self, ConfigError> {
        if !(term.weight > 0.0 && term.weight.is_finite()) {
            let expected = "above 0 and finite";
            return Err(ConfigError::OutOfRange {
                name: "the weight of a term",
                value: term.weight,
                expected,
            });
        }
        if term.dims.is_empty() {
            return Err(ConfigError::EmptyGroup { group: index });
        }
        for (place, &dimension) in term.dims.iter().enumerate() {
            if dimension >= dims {
                return Err(ConfigError::NoSuchDimension { group: index, dimension, dims });
            }
            if term.dims[..place].contains(&dimension) {
                return Err(ConfigError::RepeatedDimension { group: index, dimension });
            }
        }
        let family = Family::new(&term.classes, extent, wanted)?;
        let sizes = family.sizes();
        // A subset that is not sorted in lanes gains nothing from sharing its directions.
        let long = sizes[0] > LONGEST;
        let per_subset = if long { 1 } else { slicing.directions };
        let slicer = Slicer::new(term.dims.len(), per_subset, slicing.axis_share, &term.target);
        let in_lanes = !family.is_weighted() && slicer.per_subset() > 1;
        let sizes: BTreeSet<usize> = match sizes.last() {
            _ if !in_lanes => BTreeSet::new(),
            Some(&largest) if family.is_partial() => partial_sizes(largest.min(LONGEST)).collect(),
            _ => sizes.into_iter().filter(|&size| size <= LONGEST).collect(),
        };
        let plan = |n: usize| {
            let grid = if slicer.bank().is_some() { Boundary::grid(n).collect() } else { Vec::new() };
            (n, SizePlan { network: Network::new(n), grid })
        };
        let sizes = sizes.into_iter().map(plan).collect();
        Ok(Self { spec: term.clone(), family, slicer, sizes, rate: 0.0 })
    }
}

/// Pixels and frames that the kernels visit; all of them if there is no kernel.
pub(crate) fn classes(terms: &[PlannedTerm], extent: Extent) -> usize {
    let visited = terms.iter().filter(|term| term.family.taps().is_some()).map(|term| term.family.visited());
    visited.max().unwrap_or(extent.sites())
}

/// Sizes to plan for where any up to `largest` may occur: all of the small ones, then steps of a tenth.
fn partial_sizes(largest: usize) -> impl Iterator<Item = usize> {
    let next = |&size: &usize| (size < usize::MAX / 2).then(|| size + (size / 10).max(1));
    std::iter::successors(Some(1), next).take_while(move |&size| size < largest).chain([largest])
}
