//! Blocks of consecutive sites of equal length: the whole table, its frames, its pixels.

use std::ops::Range;
use std::sync::Arc;

use super::demand::Wanted;
use super::family::Filters;
use crate::kernel::Tap;
use crate::table::extent::Extent;

/// One class per block: its samples alike.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    sites: usize,
    extent: Extent,
    wanted: Wanted,
    mean_size: f64,
}

impl Blocks {
    /// Blocks of so many sites.
    pub(super) fn new(sites: usize, extent: Extent, wanted: Wanted) -> Self {
        let mut blocks = Self { sites, extent, wanted, mean_size: (sites * extent.spp) as f64 };
        if let Some(visited) = blocks.visited() {
            blocks.mean_size = blocks.wanted.mean_size(blocks.mean_size, blocks.members(), visited.len());
        }
        blocks
    }
}

impl Filters for Blocks {
    fn members(&self) -> usize {
        self.extent.sites() / self.sites
    }

    fn is_per_site(&self) -> bool {
        self.sites == 1 && self.extent.sites() > 1
    }

    fn visited(&self) -> Option<Arc<[u32]>> {
        self.wanted.holding(self.members(), |site, holds| holds[site / self.sites] = true)
    }

    fn mean_size(&self) -> f64 {
        self.mean_size
    }

    fn sizes(&self) -> Vec<usize> {
        vec![self.sites * self.extent.spp]
    }

    fn is_partial(&self) -> bool {
        self.wanted.is_partial()
    }

    /// A pixel by itself is a kernel of one tap.
    fn taps(&self) -> Option<&[Tap]> {
        (self.sites == 1).then_some(&[Tap { dt: 0, dy: 0, dx: 0, weight: 1.0 }])
    }

    fn run(&self, member: usize) -> Option<Range<u32>> {
        let samples = (self.sites * self.extent.spp) as u32;
        (!self.is_partial()).then(|| member as u32 * samples..(member as u32 + 1) * samples)
    }

    fn select(&self, member: usize, _level: f64, samples: &mut Vec<u32>) {
        samples.clear();
        let spp = self.extent.spp as u32;
        let block = member * self.sites..(member + 1) * self.sites;
        self.wanted.for_each(block, |site| samples.extend(site * spp..(site + 1) * spp));
    }
}
