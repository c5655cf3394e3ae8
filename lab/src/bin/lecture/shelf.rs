//! The tables of all samplers, made once.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::time::Instant;

use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Config, Extent, Kernel, SampleTable, Until};
use fsot_lab::samplers::{DitherMask, Fast, ScramblingKeys, Stbn, stratified};

use crate::scale::Scale;
use crate::{Failure, measure, scene};

/// What a table is made by.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Maker {
    Stratified,
    Dither,
    Keys,
    Stbn,
    /// FAST, for the eye's filter: in space alone for one frame, in space and time for more.
    Fast,
    /// FAST, for temporal antialiasing.
    FastTaa,
    /// Ours, for the eye's filter: in space alone for one frame, in space and time for more.
    Ours,
    /// Ours, for temporal antialiasing.
    OursTaa,
}

/// A table to make.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Recipe {
    pub maker: Maker,
    pub dims: usize,
    pub spp: usize,
    pub frames: usize,
}

impl fmt::Display for Recipe {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let name = match self.maker {
            Maker::Stratified => "stratified",
            Maker::Dither => "dither mask",
            Maker::Keys => "scrambling keys",
            Maker::Stbn => "STBN",
            Maker::Fast => "FAST",
            Maker::FastTaa => "FAST for TAA",
            Maker::Ours => "ours",
            Maker::OursTaa => "ours for TAA",
        };
        write!(out, "{name}, {} dims, {} spp, {} frame(s)", self.dims, self.spp, self.frames)
    }
}

pub struct Shelf {
    pub scale: Scale,
    pub seed: u64,
    tables: BTreeMap<Recipe, SampleTable>,
    seconds: Vec<(Recipe, f64)>,
}

impl Shelf {
    pub fn new(scale: Scale, seed: u64) -> Self {
        Self { scale, seed, tables: BTreeMap::new(), seconds: Vec::new() }
    }

    /// All tables that the scenes need.
    pub fn recipes(scale: &Scale) -> Result<BTreeSet<Recipe>, Failure> {
        let mut recipes = BTreeSet::new();
        let stills = scale.still_scenes.iter().map(|scene| (scene, false));
        for (name, animated) in stills.chain(scale.animated_scenes.iter().map(|scene| (scene, true))) {
            let dims = scene(name)?.dims();
            let frames = if animated { scale.tile_frames } else { 1 };
            let mut add = |maker, dims, spp, frames| recipes.insert(Recipe { maker, dims, spp, frames });
            add(Maker::Dither, 1, 1, 1); // the mask of a-posteriori methods
            add(Maker::Dither, dims, 1, 1);
            add(Maker::Stbn, 2, 1, scale.tile_frames);
            add(Maker::Fast, 2, 1, 1);
            if animated {
                add(Maker::Fast, 2, 1, frames);
                add(Maker::FastTaa, 2, 1, frames);
            }
            for &spp in &scale.spps {
                add(Maker::Stratified, dims, spp as usize, 1);
                add(Maker::Keys, dims, spp.next_power_of_two() as usize, 1);
                add(Maker::Ours, dims, spp as usize, 1);
                if animated {
                    add(Maker::Ours, dims, spp as usize, frames);
                    add(Maker::OursTaa, dims, spp as usize, frames);
                }
            }
        }
        Ok(recipes)
    }

    pub fn make(&mut self, recipe: Recipe) -> Result<(), Failure> {
        let Recipe { maker, dims, spp, frames } = recipe;
        let Scale { tile, effort, .. } = self.scale;
        let extent = Extent { frames, height: tile, width: tile, spp };
        let seed = self.seed;
        let begin = Instant::now();
        let sweeps = |sweeps: u64| (sweeps as f64 * effort).ceil() as u64;
        let table = match maker {
            Maker::Stratified => stratified(extent, dims, seed)?,
            Maker::Dither => {
                let mut mask = DitherMask { seed, ..DitherMask::new(extent, dims) };
                mask.cooling.sweeps = sweeps(1000);
                mask.table()?
            }
            Maker::Keys => {
                let mut keys = ScramblingKeys { seed, ..ScramblingKeys::new(extent, dims) };
                keys.cooling.sweeps = sweeps(1000);
                keys.table()?
            }
            Maker::Stbn => {
                let mut mask = Stbn { seed, ..Stbn::new(extent, dims) };
                mask.cooling.sweeps = sweeps(100);
                mask.table()?
            }
            Maker::Fast | Maker::FastTaa => {
                let mut table = Fast { seed, ..Fast::new(extent, dims) };
                if maker == Maker::FastTaa {
                    table.kernels = vec![for_taa()];
                }
                table.cooling.sweeps = sweeps(if frames > 1 { 150 } else { 2000 });
                table.table()?
            }
            Maker::Ours => ours(Config::new(extent, dims).with_seed(seed), effort)?,
            Maker::OursTaa => ours(Config::new(extent, dims).with_seed(seed).with_kernel(for_taa()), effort)?,
        };
        self.seconds.push((recipe, begin.elapsed().as_secs_f64()));
        self.tables.insert(recipe, table);
        Ok(())
    }

    /// What the tables took, in the order of their making.
    pub fn seconds(&self) -> &[(Recipe, f64)] {
        &self.seconds
    }

    /// A table that was made.
    pub fn table(&self, recipe: Recipe) -> Result<&SampleTable, Failure> {
        self.tables.get(&recipe).ok_or_else(|| format!("no table was made for {recipe}").into())
    }
}

/// Our tables, with the optimiser's defaults and the work that is usually worth it.
fn ours(config: Config, effort: f64) -> Result<SampleTable, Failure> {
    let until = if effort < 1.0 { Until::Sweeps(2) } else { Until::Usual };
    Ok(config.optimize(until)?)
}

/// The eye's spatial filter times the history of temporal antialiasing.
fn for_taa() -> Kernel {
    Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, measure::taa())
}

/// The kernel of the eye over frames at 60 per second.
pub fn eye() -> TemporalKernel {
    TemporalKernel::Perceptual { fps: 60.0 }
}
