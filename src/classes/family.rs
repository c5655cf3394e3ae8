//! A family planned for one extent: everything about its filters that does not depend on the samples.

use std::ops::Range;
use std::sync::Arc;

use super::listed::Listed;
use super::prefixes::Prefixes;
use super::{Classes, FilterForm};
use crate::error::ConfigError;
use crate::kernel::Tap;
use crate::table::extent::Extent;

/// A family planned for one extent: taps are sorted, sizes known, and where only a part of the table is demanded, the
/// rest is left out.
#[derive(Clone, Debug)]
pub(crate) struct Family {
    extent: Extent,
    shape: Shape,
    /// Classes that hold a demanded sample, where some don't.
    visited: Option<Vec<u32>>,
    /// Samples that a random level of a visited class selects, in the mean; the weighted form counts its support.
    mean_size: f64,
}

#[derive(Clone, Debug)]
enum Shape {
    /// Runs of consecutive sites of equal length.
    Blocks { sites: usize, wanted: Wanted },
    /// Taps by falling weight, with offsets made non-negative modulo the extent and counted in sites: frames, rows,
    /// columns.
    Lattice { taps: Vec<Tap>, offsets: Vec<[u32; 3]>, form: FilterForm, wanted: Wanted },
    /// Runs from the start of a block of samples.
    Prefixes { prefixes: Prefixes, wanted: Wanted },
    /// Samples of each class, written out; what is not demanded is left out already.
    Listed(Arc<Listed>),
}

/// Demanded sites: one flag each, or all of them.
#[derive(Clone, Debug)]
pub(crate) enum Wanted {
    /// Every site.
    All,
    /// Those with a flag.
    Some(Arc<[bool]>),
}

impl Wanted {
    pub(crate) fn site(&self, site: usize) -> bool {
        match self {
            Wanted::All => true,
            Wanted::Some(flags) => flags[site],
        }
    }
}

impl Family {
    pub(crate) fn new(classes: &Classes, extent: Extent, wanted: Wanted) -> Result<Self, ConfigError> {
        let blocks = |sites| Ok(Shape::Blocks { sites, wanted: wanted.clone() });
        let shape = match classes {
            Classes::WholeTable => blocks(extent.sites()),
            Classes::PerFrame => blocks(extent.height * extent.width),
            Classes::PerPixel => blocks(1),
            Classes::Lattice { kernel, form } => kernel.taps(&extent).map(|taps| {
                let forward = |by: i32, len: usize| by.rem_euclid(len as i32) as u32;
                let offsets = taps.iter().map(|tap| {
                    let Extent { frames, height, width, .. } = extent;
                    let [row, frame] = [width, width * height].map(|sites| sites as u32);
                    [forward(tap.dt, frames) * frame, forward(tap.dy, height) * row, forward(tap.dx, width)]
                });
                Shape::Lattice { offsets: offsets.collect(), taps, form: *form, wanted: wanted.clone() }
            }),
            Classes::Prefixes { of, lengths } => Prefixes::new(*of, lengths, extent)
                .map(|prefixes| Shape::Prefixes { prefixes, wanted: wanted.clone() }),
            Classes::Labelled { labels, subsets } => {
                Listed::labelled(labels, subsets, extent, &wanted).map(|listed| Shape::Listed(listed.into()))
            }
            Classes::Ramps { coordinates, ramps } => {
                Listed::ramps(coordinates, ramps, extent, &wanted).map(|listed| Shape::Listed(listed.into()))
            }
            Classes::Custom(classes) => {
                Listed::custom(classes, extent, &wanted).map(|listed| Shape::Listed(listed.into()))
            }
        }?;
        let spp = extent.spp as f64;
        let mean_size = match &shape {
            Shape::Blocks { sites, .. } => *sites as f64 * spp,
            Shape::Lattice { taps, form: FilterForm::Weighted, .. } => taps.len() as f64 * spp,
            Shape::Lattice { taps, .. } => taps.iter().map(|tap| tap.weight).sum::<f64>() * spp,
            Shape::Prefixes { prefixes, .. } => prefixes.mean_length(),
            Shape::Listed(listed) => listed.mean_size(),
        };
        let mut family = Self { extent, shape, visited: None, mean_size };
        if let Shape::Listed(listed) = &family.shape {
            family.visited = listed.visited();
        } else if let Wanted::Some(flags) = &wanted {
            let visited = family.holding(flags);
            family.mean_size = match &family.shape {
                Shape::Prefixes { prefixes, .. } => {
                    let held = |&member: &u32| {
                        let run = prefixes.run(member as usize);
                        run.filter(|&sample| flags[sample as usize / extent.spp]).count()
                    };
                    visited.iter().map(held).sum::<usize>() as f64 / visited.len().max(1) as f64
                }
                _ => {
                    // Every wanted site is held as often as before, but by fewer classes.
                    let share = flags.iter().filter(|&&flag| flag).count() as f64 / extent.sites() as f64;
                    family.mean_size * share * family.members() as f64 / visited.len().max(1) as f64
                }
            };
            family.visited = Some(visited);
        }
        Ok(family)
    }

    /// The classes that hold one of these sites at all.
    fn holding(&self, flags: &[bool]) -> Vec<u32> {
        let mut holds = vec![false; self.members()];
        for site in (0..flags.len()).filter(|&site| flags[site]) {
            match &self.shape {
                Shape::Listed(_) => {}
                Shape::Prefixes { prefixes, .. } => prefixes.mark(site, &mut holds),
                Shape::Blocks { sites, .. } => holds[site / sites] = true,
                Shape::Lattice { taps, .. } => {
                    let at = self.extent.site(site);
                    for tap in taps {
                        let back = (-i64::from(tap.dt), -i64::from(tap.dy), -i64::from(tap.dx));
                        holds[self.extent.site_index(self.extent.wrapped(at, back))] = true;
                    }
                }
            }
        }
        (0..holds.len() as u32).filter(|&member| holds[member as usize]).collect()
    }

    /// Number of classes.
    pub(crate) fn members(&self) -> usize {
        match &self.shape {
            Shape::Blocks { sites, .. } => self.extent.sites() / sites,
            Shape::Lattice { .. } => self.extent.sites(),
            Shape::Prefixes { prefixes, .. } => prefixes.members(),
            Shape::Listed(listed) => listed.members(),
        }
    }

    /// Whether every site of the table has classes of its own: a step then visits a part of them.
    pub(crate) fn is_per_site(&self) -> bool {
        match &self.shape {
            Shape::Blocks { sites, .. } => *sites == 1 && self.extent.sites() > 1,
            Shape::Lattice { .. } => true,
            Shape::Prefixes { prefixes, .. } => prefixes.blocks() > 1,
            Shape::Listed(_) => false,
        }
    }

    /// Whether the level decides which samples of a class are selected.
    pub(crate) fn has_levels(&self) -> bool {
        match &self.shape {
            Shape::Blocks { .. } | Shape::Prefixes { .. } => false,
            Shape::Lattice { form, .. } => *form == FilterForm::LevelSets,
            Shape::Listed(listed) => listed.has_levels(),
        }
    }

    /// Weight of a class beside the others of its family.
    #[inline(always)]
    pub(crate) fn emphasis(&self, member: usize) -> f64 {
        match &self.shape {
            Shape::Blocks { .. } | Shape::Lattice { .. } => 1.0,
            Shape::Prefixes { prefixes, .. } => prefixes.emphasis(member),
            Shape::Listed(listed) => listed.emphasis(member),
        }
    }

    /// Number of classes that hold a demanded sample.
    pub(crate) fn visited(&self) -> usize {
        self.visited.as_ref().map_or(self.members(), Vec::len)
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

    pub(crate) fn mean_size(&self) -> f64 {
        self.mean_size
    }

    /// Sum of the weights that a random level of a visited class selects, in the mean over classes by emphasis.
    pub(crate) fn mean_mass(&self) -> f64 {
        match &self.shape {
            Shape::Prefixes { prefixes, wanted: Wanted::All } => prefixes.mean_mass(),
            Shape::Prefixes { .. } => {
                let (mut samples, mut mass) = (Vec::new(), 0.0);
                for index in 0..self.visited() {
                    let member = self.visited_member(index);
                    self.select(member, 0.0, &mut samples);
                    mass += self.emphasis(member) * samples.len() as f64;
                }
                mass / self.visited() as f64
            }
            Shape::Listed(listed) => listed.mean_mass(),
            Shape::Lattice { taps, form: FilterForm::Weighted, .. } => {
                self.mean_size * taps.iter().map(|tap| tap.weight).sum::<f64>() / taps.len() as f64
            }
            _ => self.mean_size,
        }
    }

    /// The taps of a lattice family.
    pub(crate) fn taps(&self) -> Option<&[Tap]> {
        match &self.shape {
            Shape::Lattice { taps, .. } => Some(taps),
            _ => None,
        }
    }

    /// Sizes that subsets can have, increasing. Under a partial demand any size up to the last may occur.
    pub(crate) fn sizes(&self) -> Vec<usize> {
        let sites: Vec<usize> = match &self.shape {
            Shape::Prefixes { prefixes, .. } => return prefixes.sizes(),
            Shape::Listed(listed) => return listed.sizes(),
            Shape::Blocks { sites, .. } => vec![*sites],
            Shape::Lattice { taps, form: FilterForm::Weighted, .. } => vec![taps.len()],
            Shape::Lattice { taps, .. } => {
                let ends = 1..=taps.len();
                ends.filter(|&n| n == taps.len() || taps[n].weight < taps[n - 1].weight).collect()
            }
        };
        sites.into_iter().map(|sites| sites * self.extent.spp).collect()
    }

    /// Whether a part of the table is left out.
    pub(crate) fn is_partial(&self) -> bool {
        match &self.shape {
            Shape::Blocks { wanted, .. } | Shape::Lattice { wanted, .. } | Shape::Prefixes { wanted, .. } => {
                matches!(wanted, Wanted::Some(_))
            }
            // Lists hold what is demanded, and know their sizes.
            Shape::Listed(_) => false,
        }
    }

    /// Calls `visit(site, relative weight)` for the demanded sites of a class whose weight exceeds `level`, by falling
    /// weight. The weighted form has its whole support at any level.
    #[inline(always)]
    fn for_each_site(&self, member: usize, level: f64, mut visit: impl FnMut(usize, f64)) {
        match &self.shape {
            Shape::Prefixes { .. } | Shape::Listed(_) => {}
            Shape::Blocks { sites, wanted } => {
                (member * sites..(member + 1) * sites)
                    .filter(|&site| wanted.site(site))
                    .for_each(|site| visit(site, 1.0));
            }
            Shape::Lattice { taps, wanted, .. } => {
                for (site, tap) in self.tapped_sites(member, level).zip(taps) {
                    let site = site as usize;
                    if wanted.site(site) {
                        visit(site, tap.weight);
                    }
                }
            }
        }
    }

    /// Sites under the taps of a lattice class whose weight exceeds `level`, demanded or not, in the order of the taps.
    #[inline(always)]
    fn tapped_sites(&self, member: usize, level: f64) -> impl Iterator<Item = u32> {
        let offsets = match &self.shape {
            Shape::Prefixes { .. } | Shape::Listed(_) => &[],
            Shape::Blocks { .. } => &[],
            Shape::Lattice { offsets, form: FilterForm::Weighted, .. } => offsets.as_slice(),
            Shape::Lattice { taps, offsets, form: FilterForm::LevelSets, .. } => {
                &offsets[..taps.partition_point(|tap| tap.weight > level)]
            }
        };
        let Extent { frames, height, width, .. } = self.extent;
        let [row, frame, all] = [width, width * height, width * height * frames].map(|sites| sites as u32);
        let site = member as u32;
        let (x, y, t) = (site % row, site % frame - site % row, site - site % frame);
        // Where it goes below zero it becomes a large number, so that the lesser one is inside.
        let wrap = |at: u32, len: u32| at.min(at.wrapping_sub(len));
        offsets.iter().map(move |&[dt, dy, dx]| wrap(t + dt, all) + wrap(y + dy, frame) + wrap(x + dx, row))
    }

    /// The samples of class `member` at any level, where they are consecutive and all demanded by construction.
    pub(crate) fn run(&self, member: usize) -> Option<Range<u32>> {
        match &self.shape {
            Shape::Blocks { sites, wanted: Wanted::All } => {
                let samples = (sites * self.extent.spp) as u32;
                Some(member as u32 * samples..(member as u32 + 1) * samples)
            }
            Shape::Prefixes { prefixes, wanted: Wanted::All } => Some(prefixes.run(member)),
            _ => None,
        }
    }

    /// Writes the numbers of the demanded samples of class `member` whose weight exceeds `level` (in `[0, 1)`, relative
    /// to the largest weight) by falling weight.
    pub(crate) fn select(&self, member: usize, level: f64, samples: &mut Vec<u32>) {
        samples.clear();
        let spp = self.extent.spp as u32;
        match &self.shape {
            Shape::Listed(listed) => return samples.extend_from_slice(listed.above(member, level)),
            Shape::Prefixes { prefixes, wanted } => {
                let run = prefixes.run(member);
                return samples.extend(run.filter(|&sample| wanted.site((sample / spp) as usize)));
            }
            Shape::Lattice { wanted: Wanted::All, .. } if spp == 1 => {
                // The common case by itself, without a choice per sample.
                return samples.extend(self.tapped_sites(member, level));
            }
            Shape::Blocks { .. } | Shape::Lattice { .. } => {}
        }
        self.for_each_site(member, level, |site, _| {
            samples.extend(site as u32 * spp..(site as u32 + 1) * spp)
        });
    }

    /// Whether samples enter with their weights.
    pub(crate) fn is_weighted(&self) -> bool {
        matches!(&self.shape, Shape::Lattice { form: FilterForm::Weighted, .. })
    }

    /// Writes the weights of the samples that [`Family::select`] lists; nothing where all weigh 1.
    pub(crate) fn weigh(&self, member: usize, weights: &mut Vec<f64>) {
        weights.clear();
        if self.is_weighted() {
            let spp = self.extent.spp;
            self.for_each_site(member, 0.0, |_, weight| weights.extend(std::iter::repeat_n(weight, spp)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Kernel, SpatialKernel, TemporalKernel};
    use crate::table::extent::Site;

    const EXTENT: Extent = Extent { frames: 4, height: 20, width: 12, spp: 3 };

    fn lattice(form: FilterForm) -> Classes {
        let spatial = SpatialKernel::Gaussian { sigma_px: 2.1 };
        Classes::Lattice { kernel: Kernel::product(spatial, TemporalKernel::Ema { alpha: 0.4 }), form }
    }

    /// The definition: all samples whose filter weight exceeds the level, by a search of the whole table.
    fn by_definition(taps: &[Tap], member: usize, level: f64) -> Vec<u32> {
        let centre = EXTENT.site(member);
        let mut samples = Vec::new();
        for site in 0..EXTENT.sites() {
            let lands_here = |tap: &&Tap| {
                EXTENT.site_index(EXTENT.wrapped(centre, (tap.dt.into(), tap.dy.into(), tap.dx.into())))
                    == site
            };
            if taps.iter().find(lands_here).is_some_and(|tap| tap.weight > level) {
                samples.extend((site * 3) as u32..(site * 3 + 3) as u32);
            }
        }
        samples
    }

    #[test]
    fn level_sets_hold_the_samples_above_the_level() {
        let family = Family::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::All).unwrap();
        let taps = family.taps().unwrap();
        let mut samples = Vec::new();
        for (member, level) in [(0, 0.0), (17, 0.3), (959, 0.5), (500, 0.999), (240, 0.01)] {
            family.select(member, level, &mut samples);
            let mut sorted = samples.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, by_definition(taps, member, level), "member {member} level {level}");
            assert!(family.sizes().contains(&samples.len()));
        }
    }

    /// E_z |S_z| is the sum of the relative weights; a fine midpoint rule over z is exact to one step per tap.
    #[test]
    fn levels_select_each_tap_as_often_as_it_weighs() {
        let family = Family::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::All).unwrap();
        let taps = family.taps().unwrap();
        let steps = 20_000;
        let mut hits = vec![0.0; EXTENT.samples()];
        let mut samples = Vec::new();
        for step in 0..steps {
            family.select(0, (step as f64 + 0.5) / steps as f64, &mut samples);
            samples.iter().for_each(|&sample| hits[sample as usize] += 1.0 / steps as f64);
        }
        for tap in taps {
            let site =
                EXTENT.wrapped(Site { frame: 0, y: 0, x: 0 }, (tap.dt.into(), tap.dy.into(), tap.dx.into()));
            let frequency = hits[EXTENT.site_index(site) * 3];
            assert!((frequency - tap.weight).abs() <= 1.0 / steps as f64, "{tap:?} {frequency}");
        }
        let mean: f64 = hits.iter().sum();
        assert!((mean - family.mean_size()).abs() < 0.05, "{mean} {}", family.mean_size());
    }

    #[test]
    fn the_weighted_form_lists_the_support_with_its_weights() {
        let family = Family::new(&lattice(FilterForm::Weighted), EXTENT, Wanted::All).unwrap();
        let (mut samples, mut weights) = (Vec::new(), Vec::new());
        family.select(7, 0.9, &mut samples);
        family.weigh(7, &mut weights);
        assert_eq!(samples.len(), weights.len());
        assert_eq!(samples.len() as f64, family.mean_size());
        assert_eq!(weights[0], 1.0);
        assert!(weights.is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn blocks_tile_the_table() {
        for (classes, members) in [(Classes::WholeTable, 1), (Classes::PerFrame, 4), (Classes::PerPixel, 960)]
        {
            let family = Family::new(&classes, EXTENT, Wanted::All).unwrap();
            assert_eq!(family.members(), members);
            let (mut all, mut samples) = (Vec::new(), Vec::new());
            for member in 0..members {
                family.select(member, 0.5, &mut samples);
                all.extend_from_slice(&samples);
            }
            assert!(all.iter().copied().eq(0..EXTENT.samples() as u32));
        }
    }

    #[test]
    fn a_partial_demand_leaves_out_samples_and_the_classes_without_any() {
        let flags: Vec<bool> =
            (0..EXTENT.sites()).map(|site| EXTENT.site(site).frame == 1 && site % 12 < 3).collect();
        let whole = Family::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::All).unwrap();
        let part =
            Family::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::Some(flags.clone().into())).unwrap();
        let (mut all, mut some, mut visited) = (Vec::new(), Vec::new(), Vec::new());
        part.list_visited(&mut visited);
        let mut selected = 0;
        for member in 0..EXTENT.sites() {
            whole.select(member, 0.0, &mut all);
            part.select(member, 0.0, &mut some);
            all.retain(|&sample| flags[sample as usize / 3]);
            assert_eq!(all, some);
            assert_eq!(visited.contains(&(member as u32)), !some.is_empty());
            selected += usize::from(!some.is_empty());
        }
        assert!(selected < EXTENT.sites() && selected == part.visited());
        // Every demanded sample is selected as often as before, by fewer classes.
        let wanted = flags.iter().filter(|&&flag| flag).count() as f64;
        let expected = whole.mean_size() * wanted / part.visited() as f64;
        assert!((part.mean_size() - expected).abs() < 1e-9 * expected);
    }
}
