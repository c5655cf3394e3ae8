//! A family planned for one extent: everything about its filters that does not depend on the samples.

use std::fmt::Debug;
use std::ops::{Deref, Range};
use std::sync::Arc;

use super::Classes;
use super::blocks::Blocks;
use super::demand::Wanted;
use super::listed::Listed;
use super::pixels::Pixels;
use super::prefixes::Prefixes;
use crate::error::TermError;
use crate::kernel::Tap;
use crate::table::extent::Extent;

/// The filters of a family, by the number of the class (its *member*). Each kind of family is a type of its
/// own.
pub(crate) trait Filters: Debug + Send + Sync {
    /// Number of classes.
    fn members(&self) -> usize;

    /// Whether every site of the table has classes of its own: a step then visits a part of them.
    fn is_per_site(&self) -> bool;

    /// Whether the level decides which samples of a class are selected.
    fn has_levels(&self) -> bool {
        false
    }

    /// Weight of a class beside the others of its family.
    fn emphasis(&self, _member: usize) -> f64 {
        1.0
    }

    /// The classes that hold a demanded sample, where some don't.
    fn visited(&self) -> Option<Arc<[u32]>>;

    /// Samples that a random level of a visited class selects, in the mean; the weighted form counts its
    /// support.
    fn mean_size(&self) -> f64;

    /// Sum of the weights that a random level of a visited class selects, in the mean over classes by
    /// emphasis.
    fn mean_mass(&self) -> f64 {
        self.mean_size()
    }

    /// Sizes that subsets can have, increasing. Under a partial demand any size up to the last may occur.
    fn sizes(&self) -> Vec<usize>;

    /// Whether a part of the table is left out, so that subsets may have other sizes than [`Filters::sizes`].
    fn is_partial(&self) -> bool;

    /// The taps of a kernel, where there is one.
    fn taps(&self) -> Option<&[Tap]> {
        None
    }

    /// The samples of a class at any level, where they are consecutive and all demanded by construction.
    fn run(&self, _member: usize) -> Option<Range<u32>> {
        None
    }

    /// Writes the numbers of the demanded samples of a class whose weight exceeds `level` (in `[0, 1)`,
    /// relative to the largest weight) by falling weight.
    fn select(&self, member: usize, level: f64, samples: &mut Vec<u32>);

    /// Whether it is known, without a look at the samples, that [`Filters::select`] lists none.
    fn is_empty_at(&self, _member: usize, _level: f64) -> bool {
        false
    }

    /// Whether samples enter with their weights.
    fn is_weighted(&self) -> bool {
        false
    }

    /// Writes the weights of the samples that [`Filters::select`] lists; nothing where all weigh 1.
    fn weigh(&self, _member: usize, weights: &mut Vec<f64>) {
        weights.clear();
    }
}

/// Filters, and which of them are visited: where only a part of the table is demanded, the rest is left out.
#[derive(Clone, Debug)]
pub(crate) struct FilterFamily {
    filters: Arc<dyn Filters>,
    visited: Option<Arc<[u32]>>,
    /// [`Filters::mean_size`], which may take a look at every class.
    mean_size: f64,
}

impl Deref for FilterFamily {
    type Target = dyn Filters;

    fn deref(&self) -> &Self::Target {
        &*self.filters
    }
}

impl FilterFamily {
    /// Plans a family.
    ///
    /// # Errors
    /// A bad kernel, bad classes.
    pub(crate) fn new(classes: &Classes, extent: Extent, wanted: Wanted) -> Result<Self, TermError> {
        let filters: Arc<dyn Filters> = match classes {
            Classes::WholeTable => Arc::new(Blocks::new(extent.sites(), extent, wanted)),
            Classes::PerFrame => Arc::new(Blocks::new(extent.height * extent.width, extent, wanted)),
            Classes::PerPixel => Arc::new(Blocks::new(1, extent, wanted)),
            Classes::Lattice { kernel, form } => {
                Arc::new(Pixels::new(kernel.taps(&extent)?, *form, extent, wanted))
            }
            Classes::Prefixes { of, lengths } => Arc::new(Prefixes::new(*of, lengths, extent, wanted)?),
            Classes::Labelled { labels, subsets } => {
                Arc::new(Listed::labelled(labels, subsets, extent, &wanted)?)
            }
            Classes::Ramps { coordinates, ramps } => {
                Arc::new(Listed::ramps(coordinates, ramps, extent, &wanted)?)
            }
            Classes::Custom(classes) => Arc::new(Listed::custom(classes, extent, &wanted)?),
        };
        let (visited, mean_size) = (filters.visited(), filters.mean_size());
        Ok(Self { filters, visited, mean_size })
    }

    /// Samples that a random level of a visited class selects, in the mean.
    pub(crate) fn mean_size(&self) -> f64 {
        self.mean_size
    }

    /// Number of classes that hold a demanded sample.
    pub(crate) fn visits(&self) -> usize {
        self.visited.as_ref().map_or(self.members(), |visited| visited.len())
    }

    /// The `index`th class that holds a demanded sample.
    pub(crate) fn visited_member(&self, index: usize) -> usize {
        self.visited.as_ref().map_or(index, |visited| visited[index] as usize)
    }

    /// Writes the classes that hold a demanded sample, in order.
    pub(crate) fn list_visited(&self, members: &mut Vec<u32>) {
        members.clear();
        match &self.visited {
            None => members.extend(0..self.members() as u32),
            Some(visited) => members.extend_from_slice(visited),
        }
    }
}
