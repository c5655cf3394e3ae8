//! One class per pixel and frame: a kernel centred there.

use std::sync::Arc;

use super::FilterForm;
use super::demand::{Wanted, marked};
use super::family::Filters;
use super::reach;
use crate::kernel::Tap;
use crate::table::extent::Extent;

/// A kernel at every site.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    /// By falling weight.
    taps: Vec<Tap>,
    /// Of the taps, made non-negative modulo the extent and counted in sites: frames, rows, columns.
    offsets: Vec<[u32; 3]>,
    form: FilterForm,
    extent: Extent,
    wanted: Wanted,
    /// The classes that hold a demanded sample, where some may not.
    visited: Option<Arc<[u32]>>,
    /// Where some samples are not demanded, the place among the taps of each class's first one that is, or
    /// less: see [`reach::first_taps`].
    firsts: Vec<u8>,
    mean_size: f64,
}

impl Pixels {
    pub(super) fn new(taps: Vec<Tap>, form: FilterForm, extent: Extent, wanted: Wanted) -> Self {
        let Extent { frames, height, width, spp } = extent;
        let forward = |by: i32, len: usize| by.rem_euclid(len as i32) as u32;
        let [row, frame] = [width, width * height].map(|sites| sites as u32);
        let offset = |tap: &Tap| {
            [forward(tap.dt, frames) * frame, forward(tap.dy, height) * row, forward(tap.dx, width)]
        };
        let mean_size = spp as f64
            * match form {
                FilterForm::Weighted => taps.len() as f64,
                FilterForm::LevelSets => taps.iter().map(|tap| tap.weight).sum::<f64>(),
            };
        let offsets = taps.iter().map(offset).collect();
        let mut pixels =
            Self { taps, offsets, form, extent, wanted, visited: None, firsts: Vec::new(), mean_size };
        if let Some(flags) = pixels.wanted.flags() {
            if form == FilterForm::LevelSets {
                pixels.firsts = reach::first_taps(&pixels.taps, &extent, flags);
            }
            let visited = marked(&reach::holders(&pixels.taps, &extent, flags));
            pixels.mean_size = pixels.wanted.mean_size(mean_size, pixels.members(), visited.len());
            pixels.visited = Some(visited.into());
        }
        pixels
    }

    /// Sites under the taps of a class whose weight exceeds `level`, in the order of the taps, but for the
    /// first ones that are not demanded. The weighted form has its whole support at any level.
    #[inline(always)]
    fn tapped_sites(&self, member: usize, level: f64) -> impl ExactSizeIterator<Item = u32> {
        let count = match self.form {
            FilterForm::Weighted => self.offsets.len(),
            FilterForm::LevelSets => self.taps.partition_point(|tap| tap.weight > level),
        };
        let first = self.firsts.get(member).map_or(0, |&first| usize::from(first).min(count));
        let Extent { frames, height, width, .. } = self.extent;
        let [row, frame, all] = [width, width * height, width * height * frames].map(|sites| sites as u32);
        let site = member as u32;
        let (x, y, t) = (site % row, site % frame - site % row, site - site % frame);
        // Where it goes below zero it becomes a large number, so that the lesser one is inside.
        let wrap = |at: u32, len: u32| at.min(at.wrapping_sub(len));
        let inside =
            move |&[dt, dy, dx]: &[u32; 3]| wrap(t + dt, all) + wrap(y + dy, frame) + wrap(x + dx, row);
        self.offsets[first..count].iter().map(inside)
    }
}

impl Filters for Pixels {
    fn members(&self) -> usize {
        self.extent.sites()
    }

    fn is_per_site(&self) -> bool {
        true
    }

    fn has_levels(&self) -> bool {
        self.form == FilterForm::LevelSets
    }

    fn visited(&self) -> Option<Arc<[u32]>> {
        self.visited.clone()
    }

    fn mean_size(&self) -> f64 {
        self.mean_size
    }

    fn mean_mass(&self) -> f64 {
        match self.form {
            FilterForm::LevelSets => self.mean_size,
            FilterForm::Weighted => {
                self.mean_size * self.taps.iter().map(|tap| tap.weight).sum::<f64>() / self.taps.len() as f64
            }
        }
    }

    fn sizes(&self) -> Vec<usize> {
        let len = self.taps.len();
        let ends = |&n: &usize| n == len || self.taps[n].weight < self.taps[n - 1].weight;
        let sites: Vec<usize> = match self.form {
            FilterForm::Weighted => vec![len],
            FilterForm::LevelSets => (1..=len).filter(ends).collect(),
        };
        sites.into_iter().map(|sites| sites * self.extent.spp).collect()
    }

    fn is_partial(&self) -> bool {
        self.wanted.is_partial()
    }

    fn taps(&self) -> Option<&[Tap]> {
        Some(&self.taps)
    }

    fn select(&self, member: usize, level: f64, samples: &mut Vec<u32>) {
        samples.clear();
        let spp = self.extent.spp as u32;
        let sites = self.tapped_sites(member, level);
        if spp == 1 && !self.wanted.is_partial() {
            // The common case by itself, without a choice per sample.
            return samples.extend(sites);
        }
        let Some(flags) = self.wanted.flags() else {
            return sites.for_each(|site| samples.extend(site * spp..(site + 1) * spp));
        };
        // All are written and those that count are kept: nobody can foresee which.
        let mut kept = 0;
        samples.resize(sites.len(), 0);
        for site in sites {
            samples[kept] = site;
            kept += usize::from(flags[site as usize]);
        }
        samples.truncate(kept);
        if spp > 1 {
            samples.resize(kept * spp as usize, 0);
            for place in (0..samples.len()).rev() {
                samples[place] = samples[place / spp as usize] * spp + (place % spp as usize) as u32;
            }
        }
    }

    fn is_empty_at(&self, member: usize, level: f64) -> bool {
        let weight = |&first: &u8| self.taps.get(usize::from(first)).map_or(0.0, |tap| tap.weight);
        self.firsts.get(member).is_some_and(|first| weight(first) <= level)
    }

    fn is_weighted(&self) -> bool {
        self.form == FilterForm::Weighted
    }

    fn weigh(&self, member: usize, weights: &mut Vec<f64>) {
        weights.clear();
        if !self.is_weighted() {
            return;
        }
        for (site, tap) in self.tapped_sites(member, 0.0).zip(&self.taps) {
            if self.wanted.site(site as usize) {
                weights.extend(std::iter::repeat_n(tap.weight, self.extent.spp));
            }
        }
    }
}
