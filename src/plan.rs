//! A term made ready for one extent: everything that does not depend on the samples is computed once.

use std::collections::{BTreeMap, BTreeSet};

use crate::bank::{Banks, Boundary};
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
    /// Largest subset that is sorted in lanes; 0 if none is.
    pub longest: usize,
    /// Networks of the subsets that are sorted in lanes, by their number of blocks.
    pub networks: Vec<Network>,
    /// Boundaries of the quantile cells, where laws are tabulated, for the most frequent sizes.
    pub grids: BTreeMap<usize, Vec<Boundary>>,
    /// Subsets drawn per step; need not be whole.
    pub rate: f64,
}

impl PlannedTerm {
    pub(crate) fn new(
        index: usize,
        term: &Term,
        extent: Extent,
        dims: usize,
        slicing: &Slicing,
        wanted: Wanted,
        banks: &mut Banks,
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
        let slicer = Slicer::new(term.dims.len(), per_subset, slicing.axis_share, &term.target, banks);
        let in_lanes = !family.is_weighted() && slicer.per_subset() > 1;
        let sizes: BTreeSet<usize> = match sizes.last() {
            _ if !in_lanes => BTreeSet::new(),
            Some(&largest) if family.is_partial() => partial_sizes(largest.min(LONGEST)).collect(),
            _ => sizes.into_iter().filter(|&size| size <= LONGEST).collect(),
        };
        let longest = sizes.last().copied().unwrap_or(0);
        let networks = (0..=Network::blocks(longest)).map(Network::of_blocks).collect();
        let grids = match slicer.bank() {
            Some(_) => sizes.into_iter().map(|n| (n, Boundary::grid(n).collect())).collect(),
            None => BTreeMap::new(),
        };
        Ok(Self { spec: term.clone(), family, slicer, longest, networks, grids, rate: 0.0 })
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
