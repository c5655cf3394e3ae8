//! Families of filters. A *class* is one member of a family: the filter of one pixel, one frame, the whole table.

use serde::{Deserialize, Serialize};

use crate::error::ConfigError;
use crate::kernel::{Kernel, Tap};
use crate::lattice::Extent;

/// A family of filters over the samples of a table (Salaün et al. 2022, Section 3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Classes {
    /// One class per pixel and frame: the kernel centred there.
    Lattice {
        /// The filter.
        kernel: Kernel,
        /// How its weights enter.
        form: Form,
    },
    /// One class: all samples alike. It is what makes a table unbiased.
    WholeTable,
    /// One class per frame: its samples alike.
    PerFrame,
    /// One class per pixel and frame: its samples alike (of use for `spp > 1`).
    PerPixel,
}

/// How the weights of a filter enter the transport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// Uniform level `z`, unweighted subset `{j : w_j > z}`: the objective of Salaün et al. 2022. Cheap.
    #[default]
    LevelSets,
    /// All samples under the filter, each with its weight. By the triangle inequality a bound at least as tight,
    /// at the cost of the whole support in every slice.
    Weighted,
}

/// A family planned for one extent: taps are sorted, sizes known.
#[derive(Clone, Debug)]
pub(crate) struct Family {
    extent: Extent,
    shape: Shape,
    /// Samples that a random level selects, in the mean; the weighted form counts its whole support.
    mean_size: f64,
}

#[derive(Clone, Debug)]
enum Shape {
    /// Runs of consecutive samples of equal length.
    Blocks { len: usize },
    /// Taps by falling weight, with offsets made non-negative modulo the extent.
    Lattice { taps: Vec<Tap>, offsets: Vec<[u32; 3]>, form: Form },
}

impl Family {
    pub(crate) fn new(classes: &Classes, extent: Extent) -> Result<Self, ConfigError> {
        let blocks = |len| (Shape::Blocks { len }, len as f64);
        let (shape, mean_size) = match classes {
            Classes::WholeTable => blocks(extent.samples()),
            Classes::PerFrame => blocks(extent.samples() / extent.frames),
            Classes::PerPixel => blocks(extent.spp),
            Classes::Lattice { kernel, form } => {
                let taps = kernel.taps(&extent)?;
                let sites = match form {
                    Form::LevelSets => taps.iter().map(|tap| tap.weight).sum(),
                    Form::Weighted => taps.len() as f64,
                };
                let forward = |by: i32, len: usize| by.rem_euclid(len as i32) as u32;
                let offsets = taps.iter().map(|tap| {
                    [
                        forward(tap.dt, extent.frames),
                        forward(tap.dy, extent.height),
                        forward(tap.dx, extent.width),
                    ]
                });
                let offsets = offsets.collect();
                (Shape::Lattice { taps, offsets, form: *form }, sites * extent.spp as f64)
            }
        };
        Ok(Self { extent, shape, mean_size })
    }

    /// Number of classes.
    pub(crate) fn members(&self) -> usize {
        match &self.shape {
            Shape::Blocks { len } => self.extent.samples() / len,
            Shape::Lattice { .. } => self.extent.sites(),
        }
    }

    pub(crate) fn mean_size(&self) -> f64 {
        self.mean_size
    }

    /// The taps of a lattice family.
    pub(crate) fn taps(&self) -> Option<&[Tap]> {
        match &self.shape {
            Shape::Blocks { .. } => None,
            Shape::Lattice { taps, .. } => Some(taps),
        }
    }

    /// Every size that a subset can have, increasing.
    pub(crate) fn sizes(&self) -> Vec<usize> {
        match &self.shape {
            Shape::Blocks { len } => vec![*len],
            Shape::Lattice { taps, form: Form::Weighted, .. } => vec![taps.len() * self.extent.spp],
            Shape::Lattice { taps, .. } => {
                let shell_ends =
                    (1..=taps.len()).filter(|&n| n == taps.len() || taps[n].weight < taps[n - 1].weight);
                shell_ends.map(|n| n * self.extent.spp).collect()
            }
        }
    }

    /// Sites in the subset at this level.
    fn sites_above(taps: &[Tap], form: Form, level: f64) -> usize {
        match form {
            Form::Weighted => taps.len(),
            Form::LevelSets => taps.partition_point(|tap| tap.weight > level).max(1),
        }
    }

    /// Writes the numbers of the samples of class `member` whose weight exceeds `level` (in `[0, 1)`, relative to
    /// the largest weight) by falling weight. Never empty.
    pub(crate) fn select(&self, member: usize, level: f64, samples: &mut Vec<u32>) {
        samples.clear();
        match &self.shape {
            Shape::Blocks { len } => {
                samples.extend((member * len) as u32..((member + 1) * len) as u32);
            }
            Shape::Lattice { taps, offsets, form } => {
                let Extent { frames, height, width, spp } = self.extent;
                let [frames, height, width, spp] = [frames, height, width, spp].map(|len| len as u32);
                let site = self.extent.site(member);
                let [t, y, x] = [site.frame, site.y, site.x].map(|at| at as u32);
                let wrap = |at: u32, len: u32| if at >= len { at - len } else { at };
                for &[dt, dy, dx] in &offsets[..Self::sites_above(taps, *form, level)] {
                    let row = wrap(t + dt, frames) * height + wrap(y + dy, height);
                    let first = (row * width + wrap(x + dx, width)) * spp;
                    samples.extend(first..first + spp);
                }
            }
        }
    }

    /// Weights of the samples that [`Family::select`] lists, `None` where all weigh 1.
    pub(crate) fn weights(&self) -> Option<Vec<f64>> {
        match &self.shape {
            Shape::Lattice { taps, form: Form::Weighted, .. } => {
                Some(taps.iter().flat_map(|tap| std::iter::repeat_n(tap.weight, self.extent.spp)).collect())
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{SpatialKernel, TemporalKernel};
    use crate::lattice::Site;

    const EXTENT: Extent = Extent { frames: 4, height: 20, width: 12, spp: 3 };

    fn lattice(form: Form) -> Classes {
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
        let family = Family::new(&lattice(Form::LevelSets), EXTENT).unwrap();
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
        let family = Family::new(&lattice(Form::LevelSets), EXTENT).unwrap();
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
        let family = Family::new(&lattice(Form::Weighted), EXTENT).unwrap();
        let (mut samples, weights) = (Vec::new(), family.weights().unwrap());
        family.select(7, 0.9, &mut samples);
        assert_eq!(samples.len(), weights.len());
        assert_eq!(samples.len() as f64, family.mean_size());
        assert_eq!(weights[0], 1.0);
        assert!(weights.is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn blocks_tile_the_table() {
        for (classes, members) in [(Classes::WholeTable, 1), (Classes::PerFrame, 4), (Classes::PerPixel, 960)]
        {
            let family = Family::new(&classes, EXTENT).unwrap();
            assert_eq!(family.members(), members);
            let (mut all, mut samples) = (Vec::new(), Vec::new());
            for member in 0..members {
                family.select(member, 0.5, &mut samples);
                all.extend_from_slice(&samples);
            }
            assert!(all.iter().copied().eq(0..EXTENT.samples() as u32));
        }
    }
}
