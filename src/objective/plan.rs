//! A term made ready for one extent: everything that does not depend on the samples is computed once.

use std::collections::{BTreeMap, BTreeSet};

use crate::classes::{FilterFamily, Wanted};
use crate::config::{Role, Slicing, Term};
use crate::directions::Slicer;
use crate::directions::banks::Banks;
use crate::directions::cube_bank::Boundary;
use crate::error::{ConfigError, GroupError, TermError};
use crate::table::domain::Domain;
use crate::table::extent::Extent;
use crate::targets::Target;
use crate::transport::lanes::LONGEST;
use crate::transport::network::Network;

/// A term with its family of classes, its directions, and what sorting its subsets takes.
#[derive(Clone, Debug)]
pub(crate) struct PlannedTerm {
    pub spec: Term,
    pub family: FilterFamily,
    pub slicer: Slicer,
    /// Largest subset that is sorted in lanes; 0 if none is.
    pub longest: usize,
    /// Whether a lane holds a subset, and not one of a subset's directions.
    pub abreast: bool,
    /// Networks of the subsets that are sorted in lanes, by their number of blocks.
    pub networks: Vec<Network>,
    /// Boundaries of the quantile cells, where laws are tabulated, for the most frequent sizes.
    pub grids: BTreeMap<usize, Vec<Boundary>>,
    /// Per dimension, the square of the unit of distances along the slices in that of the coordinates; 1 but
    /// for pictures that are not square.
    pub stretch: Vec<f32>,
    /// Subsets drawn per step; need not be whole.
    pub rate: f64,
    /// Whether every step draws as many, so that a class sees its directions in even steps.
    pub steady: bool,
    /// Factor on what its slices pull; 1 where the number of slices says all.
    pub pull: f64,
}

/// Sizes of subsets that are planned for one by one.
const MOST_SIZES: usize = 128;
/// Classes of a term that a steady step visits at most.
const VISITS: usize = 16;
/// Samples that the subsets of a batch hold together, at most: a second or some.
const MOST_TOUCHES: usize = 1 << 26;
/// The same for each sample of a large table.
const TOUCHES_PER_SAMPLE: usize = 64;
/// Most slices of a batch, where an epoch has fewer.
const MOST_SLICES: usize = 1 << 22;
/// Levels of a class that a steady step draws.
const LEVELS: usize = 4;

impl PlannedTerm {
    /// Checks a term and lists its classes, or takes those that another one has; `None` if no demand touches
    /// any of them.
    pub(crate) fn family(
        term: &Term,
        extent: Extent,
        domains: &[Domain],
        wanted: Wanted,
        shared: Option<FilterFamily>,
    ) -> Result<Option<FilterFamily>, TermError> {
        let dims = domains.len();
        term.validate()?;
        GroupError::check(&term.dims, dims)?;
        if term.target != Target::UniformCube
            && let Some(&dimension) = term.dims.iter().find(|&&dim| domains[dim] == Domain::Torus)
        {
            return Err(TermError::TargetOnTorus { dimension });
        }
        let family = match shared {
            Some(family) => family,
            None => FilterFamily::new(&term.classes, extent, wanted)?,
        };
        Ok(Some(family).filter(|family| family.visits() > 0))
    }

    /// Plans a term whose target's bank is there.
    pub(crate) fn new(term: Term, family: FilterFamily, slicing: &Slicing, banks: &mut Banks) -> Self {
        let sizes = family.sizes();
        // A subset that is not sorted in lanes gains nothing from sharing its directions.
        let long = sizes[0] > LONGEST;
        let per_subset = if long { 1 } else { slicing.per_subset(term.dims.len()) };
        let slicer = Slicer::new(term.dims.len(), per_subset, slicing.axis_share, &term.target, banks);
        let abreast = term.dims.len() == 1 && term.target == Target::UniformCube && family.is_per_site();
        let in_lanes = !family.is_weighted() && (slicer.per_subset() > 1 || abreast);
        let sizes: BTreeSet<usize> = match sizes.last() {
            _ if !in_lanes => BTreeSet::new(),
            Some(&largest) if family.is_partial() || sizes.len() > MOST_SIZES => {
                partial_sizes(largest.min(LONGEST)).collect()
            }
            _ => sizes.into_iter().filter(|&size| size <= LONGEST).collect(),
        };
        let longest = sizes.last().copied().unwrap_or(0);
        let networks = (0..=Network::blocks(longest)).map(Network::of_blocks).collect();
        let grids = match slicer.is_tabulated() {
            true => sizes.into_iter().map(|n| (n, Boundary::grid(n).collect())).collect(),
            false => BTreeMap::new(),
        };
        let scales = term.target.scales(term.dims.len());
        let stretch = scales.iter().map(|scale| (1.0 / (scale * scale)) as f32).collect();
        Self {
            spec: term,
            family,
            slicer,
            longest,
            abreast,
            networks,
            grids,
            stretch,
            rate: 0.0,
            steady: false,
            pull: 1.0,
        }
    }

    /// The lower boundaries of `n` quantile cells, as planned or else written to `spare`.
    pub(crate) fn grid<'a>(&'a self, n: usize, spare: &'a mut Vec<Boundary>) -> &'a [Boundary] {
        self.grids.get(&n).unwrap_or_else(|| {
            spare.clear();
            spare.extend(Boundary::grid(n));
            spare
        })
    }

    /// Slices that a step draws, in the mean.
    pub(crate) fn slices(&self) -> f64 {
        self.rate * self.slicer.per_subset() as f64
    }

    /// Draws some slices of every class, or of [`VISITS`] of them, in each step.
    fn visit_steadily(&mut self, directions: usize) {
        let levels = if self.family.has_levels() { LEVELS } else { 1 };
        // Subsets that don't share directions come once for each.
        let alone = self.slicer.per_subset() == 1 && self.spec.dims.len() > 1;
        let turns = if alone { directions } else { 1 };
        self.steady = true;
        self.rate = (self.family.visits().min(VISITS) * levels * turns) as f64;
    }
}

/// Decides how many subsets a step draws of each term.
///
/// Where pixels have classes of their own, a step is a small part of an epoch and touches are shared by
/// weight; a slice touches as many samples as its subset holds. Of terms that make a `share` of the slices of
/// a whole table, a step draws that share. Elsewhere there are few classes, none of
/// which can be spared in a step: all are drawn, and the weights of the terms enter as factors.
///
/// # Errors
/// A batch that would take all too long.
pub(crate) fn share_work(
    terms: &mut [PlannedTerm],
    extent: Extent,
    slicing: &Slicing,
    share: f64,
) -> Result<(), ConfigError> {
    let descended = |term: &&PlannedTerm| term.spec.role == Role::Descend;
    let per_site = !terms.iter().any(|term| descended(&term))
        || terms.iter().filter(descended).any(|term| term.family.is_per_site());
    let touches = |term: &PlannedTerm| term.spec.weight / term.family.mean_size();
    if per_site || slicing.batch_slices.is_some() {
        let total: f64 = terms.iter().map(touches).sum();
        let per_slice = terms.iter().map(|term| term.spec.weight).sum::<f64>() / total;
        let touches_of_step = MOST_TOUCHES.max(TOUCHES_PER_SAMPLE * extent.samples());
        let most = (touches_of_step as f64 / per_slice) as usize;
        let most = most.clamp(1, MOST_SLICES.max(16 * extent.sites()));
        if let Some(slices) = slicing.batch_slices.filter(|&slices| slices > most) {
            return Err(ConfigError::Batch { slices, most });
        }
        let default = || (classes(terms, extent) * slicing.directions).div_ceil(16).min(most) as f64 * share;
        let slices = slicing.batch_slices.map_or_else(default, |slices| slices as f64);
        for term in terms {
            term.rate = touches(term) / total * slices / term.slicer.per_subset() as f64;
        }
        return Ok(());
    }
    for term in terms.iter_mut() {
        term.visit_steadily(slicing.directions);
        term.pull = touches(term) / term.slices();
    }
    let largest = terms.iter().map(|term| term.pull).fold(0.0, f64::max);
    terms.iter_mut().for_each(|term| term.pull /= largest);
    Ok(())
}

/// Pixels and frames that the kernels visit; all of them if there is no kernel.
pub(crate) fn classes(terms: &[PlannedTerm], extent: Extent) -> usize {
    let visited = terms.iter().filter(|term| term.family.taps().is_some()).map(|term| term.family.visits());
    visited.max().unwrap_or(extent.sites())
}

/// Sizes to plan for where any up to `largest` may occur: all of the small ones, then steps of a tenth.
fn partial_sizes(largest: usize) -> impl Iterator<Item = usize> {
    let next = |&size: &usize| (size < usize::MAX / 2).then(|| size + (size / 10).max(1));
    std::iter::successors(Some(1), next).take_while(move |&size| size < largest).chain([largest])
}
