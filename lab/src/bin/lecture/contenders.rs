//! Every sampler of the comparison, and how it renders.

use fsot::Site;
use fsot_lab::render::{Film, render, render_frame};
use fsot_lab::samplers::{
    OwenSobol, Pattern, Sampler, SeedPermutation, Shifted, TableSampler, WhiteNoise, histogram_sampling,
};

use crate::Failure;
use crate::measure::Setting;
use crate::shelf::{Maker, Recipe, Shelf};

/// A sampler.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Contender {
    White,
    Stratified,
    OwenSobol,
    Kronecker,
    Korobov,
    Dither,
    Keys,
    Stbn,
    FastSpace,
    Fast,
    FastTaa,
    Histogram,
    Permutation,
    OursSpace,
    OursEye,
    OursTaa,
}

use Contender::*;

/// Estimates that histogram sampling chooses from.
const ESTIMATES: u64 = 8;

impl Contender {
    pub const ALL: [Self; 16] = [
        White,
        Stratified,
        OwenSobol,
        Kronecker,
        Korobov,
        Dither,
        Keys,
        Stbn,
        FastSpace,
        Fast,
        FastTaa,
        Histogram,
        Permutation,
        OursSpace,
        OursEye,
        OursTaa,
    ];

    pub fn name(self) -> &'static str {
        match self {
            White => "white noise",
            Stratified => "stratified",
            Contender::OwenSobol => "Owen-Sobol'",
            Kronecker => "R2 + white shift",
            Korobov => "lattice + white shift",
            Dither => "Sobol' + dither mask",
            Keys => "Sobol' + arranged keys",
            Stbn => "STBN",
            FastSpace => "FAST, space",
            Fast => "FAST, space + eye",
            FastTaa => "FAST, space + TAA",
            Histogram => "histogram of 8 *",
            Permutation => "seed permutation *",
            OursSpace => "ours, space",
            OursEye => "ours, space + eye",
            OursTaa => "ours, space + TAA",
        }
    }

    /// Whether it looks at rendered values.
    pub fn is_a_posteriori(self) -> bool {
        matches!(self, Histogram | Permutation)
    }

    /// Renders the scene, or nothing where the method does not apply.
    pub fn render(
        self,
        shelf: &Shelf,
        setting: &Setting,
        spp: u32,
        repeat: u64,
    ) -> Result<Option<Film>, Failure> {
        let (scene, resolution) = (&setting.scene, setting.resolution);
        let (dims, animated) = (scene.dims(), scene.frames > 1);
        let (tile, seed) = (shelf.scale.tile, shelf.seed.wrapping_add(repeat));
        let table = |maker, dims, spp: u32, frames| -> Result<TableSampler, Failure> {
            let table = shelf.table(Recipe { maker, dims, spp: spp as usize, frames })?;
            Ok(TableSampler::new(table).shifted(displacement(repeat, tile)))
        };
        let drift = |table| Drift { table, tile };
        let pairs = |table| InPairs { table, tile };
        let picture = |sampler: &dyn Sampler| Ok(Some(render(scene, sampler, resolution, spp)?));
        let time = if animated { shelf.scale.tile_frames } else { 1 };
        match self {
            White => picture(&WhiteNoise::new(seed)),
            Stratified => picture(&drift(table(Maker::Stratified, dims, spp, 1)?)),
            Contender::OwenSobol => picture(&fsot_lab::samplers::OwenSobol::new(seed)),
            Kronecker => {
                picture(&Shifted::new(Pattern::kronecker(spp as usize, dims)?, WhiteNoise::new(seed)))
            }
            Korobov => picture(&Shifted::new(Pattern::korobov(spp as usize, dims)?, WhiteNoise::new(seed))),
            Dither => {
                let mask = drift(table(Maker::Dither, dims, 1, 1)?);
                picture(&Shifted::new(Pattern::sobol(spp as usize, dims, seed)?, mask))
            }
            Keys => picture(&drift(table(Maker::Keys, dims, spp.next_power_of_two(), 1)?)),
            Stbn => picture(&pairs(table(Maker::Stbn, 2, 1, shelf.scale.tile_frames)?)),
            FastSpace => picture(&Drift { table: pairs(table(Maker::Fast, 2, 1, 1)?), tile }),
            Fast if animated => picture(&pairs(table(Maker::Fast, 2, 1, time)?)),
            FastTaa if animated => picture(&pairs(table(Maker::FastTaa, 2, 1, time)?)),
            Fast | FastTaa => Ok(None),
            OursSpace => picture(&drift(table(Maker::Ours, dims, spp, 1)?)),
            OursEye if animated => picture(&table(Maker::Ours, dims, spp, time)?),
            OursTaa if animated => picture(&table(Maker::OursTaa, dims, spp, time)?),
            OursEye | OursTaa => Ok(None),
            Histogram if animated => Ok(None),
            Histogram => {
                let mask = table(Maker::Dither, 1, 1, 1)?;
                let level = |pixel: usize| {
                    let site = Site { frame: 0, y: pixel / resolution[1], x: pixel % resolution[1] };
                    mask.sample(site, 0, 0)
                };
                let levels: Vec<f32> = (0..resolution[0] * resolution[1]).map(level).collect();
                let seeds = (1..=ESTIMATES).map(|k| seed.wrapping_mul(ESTIMATES).wrapping_add(k));
                let films: Result<Vec<Film>, _> =
                    seeds.map(|seed| render(scene, &OwenSobol::new(seed), resolution, spp)).collect();
                let films = films?;
                let estimates: Vec<&[f64]> = films.iter().map(Film::values).collect();
                let chosen = histogram_sampling(&estimates, &levels)?;
                Ok(Some(Film::new([1, resolution[0], resolution[1]], chosen)?))
            }
            Permutation if !animated => Ok(None),
            Permutation => {
                let mask = shelf.table(Recipe { maker: Maker::Dither, dims: 1, spp: 1, frames: 1 })?;
                let mut seeds = SeedPermutation::new(resolution, mask, seed)?;
                let mut values = Vec::new();
                for frame in 0..scene.frames {
                    let film = render_frame(scene, frame, &seeds, resolution, spp)?;
                    seeds.advance(film.values())?;
                    values.extend_from_slice(film.values());
                }
                Ok(Some(Film::new([scene.frames, resolution[0], resolution[1]], values)?))
            }
        }
    }
}

/// Index 0 leaves tables in place; other indices displace them by the R2 sequence, far from each other for as
/// many as there are frames.
fn displacement(index: u64, tile: usize) -> Site {
    let at = |ratio: f64| ((index as f64 * ratio).fract() * tile as f64) as usize;
    Site { frame: 0, y: at(0.569_840_290_998), x: at(0.754_877_666_247) }
}

/// A table of one frame, elsewhere in every frame: how a purely spatial table is animated.
struct Drift<S> {
    table: S,
    tile: usize,
}

impl<S: Sampler> Sampler for Drift<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let Site { y, x, .. } = displacement(site.frame as u64, self.tile);
        self.table.sample(Site { frame: 0, y: site.y + y, x: site.x + x }, sample, dim)
    }
}

/// A table of two dimensions that serves every pair of them, each from elsewhere in the tile.
struct InPairs<S> {
    table: S,
    tile: usize,
}

impl<S: Sampler> Sampler for InPairs<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        // Past the displacements of frames.
        let pair = u64::from(dim / 2);
        let Site { y, x, .. } = displacement(if pair > 0 { pair + 100 } else { 0 }, self.tile);
        self.table.sample(Site { y: site.y + y, x: site.x + x, ..site }, sample, dim % 2)
    }
}
