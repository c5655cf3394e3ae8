//! Every sampler of the comparison, and how it renders.

use fsot::Site;
use fsot::render::{Film, render, render_frame};
use fsot::sampler::histogram_sampling;
use fsot::sampler::{OwenSobol, Pattern, Sampler, SeedPermutation, Shifted, TableSampler, WhiteNoise};

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
    Fast,
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
    pub const ALL: [Self; 14] = [
        White,
        Stratified,
        OwenSobol,
        Kronecker,
        Korobov,
        Dither,
        Keys,
        Stbn,
        Fast,
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
            Dither => "lattice + dither mask",
            Keys => "Sobol' + arranged keys",
            Stbn => "STBN",
            Fast => "FAST",
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
        seed: u64,
    ) -> Result<Option<Film>, Failure> {
        let (scene, resolution) = (&setting.scene, setting.resolution);
        let (dims, animated) = (scene.dims(), scene.frames > 1);
        let table = |maker, dims, spp: u32, frames| -> Result<TableSampler, Failure> {
            let table = shelf.table(Recipe { maker, dims, spp: spp as usize, frames })?;
            Ok(TableSampler::new(table).shifted(displacement(seed)))
        };
        let picture = |sampler: &dyn Sampler| Ok(Some(render(scene, sampler, resolution, spp)?));
        let time = if animated { shelf.scale.tile_frames } else { 1 };
        match self {
            White => picture(&WhiteNoise::new(seed)),
            Stratified => picture(&Drift(table(Maker::Stratified, dims, spp, 1)?)),
            Contender::OwenSobol => picture(&fsot::sampler::OwenSobol::new(seed)),
            Kronecker => {
                picture(&Shifted::new(Pattern::kronecker(spp as usize, dims)?, WhiteNoise::new(seed)))
            }
            Korobov => picture(&Shifted::new(Pattern::korobov(spp as usize, dims)?, WhiteNoise::new(seed))),
            Dither => {
                let mask = Drift(table(Maker::Dither, dims, 1, 1)?);
                picture(&Shifted::new(Pattern::korobov(spp as usize, dims)?, mask))
            }
            Keys => {
                let most = shelf.scale.spps.iter().max().map_or(1, |spp| spp.next_power_of_two());
                picture(&Drift(table(Maker::Keys, dims, most, 1)?))
            }
            Stbn => picture(&InPairs(table(Maker::Stbn, 2, 1, shelf.scale.tile_frames)?)),
            Fast => picture(&InPairs(table(Maker::Fast, 2, 1, time)?)),
            OursSpace => picture(&Drift(table(Maker::Ours, dims, spp, 1)?)),
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
                let seeds = ESTIMATES * (seed + 1)..ESTIMATES * (seed + 2);
                let films: Result<Vec<Film>, _> =
                    seeds.map(|seed| render(scene, &OwenSobol::new(seed), resolution, spp)).collect();
                let films = films?;
                let estimates: Vec<&[f64]> = films.iter().map(Film::values).collect();
                let chosen = histogram_sampling(&estimates, &levels);
                Ok(Some(Film::new([1, resolution[0], resolution[1]], chosen)?))
            }
            Permutation if !animated => Ok(None),
            Permutation => {
                let mask = shelf.table(Recipe { maker: Maker::Dither, dims: 1, spp: 1, frames: 1 })?;
                let mut seeds = SeedPermutation::new(resolution, mask, seed)?;
                let mut values = Vec::new();
                for frame in 0..scene.frames {
                    let film = render_frame(scene, frame, &seeds, resolution, spp)?;
                    seeds.advance(film.values());
                    values.extend_from_slice(film.values());
                }
                Ok(Some(Film::new([scene.frames, resolution[0], resolution[1]], values)?))
            }
        }
    }
}

/// Seed 0 leaves tables in place; other seeds displace them by well-spread amounts.
fn displacement(seed: u64) -> Site {
    let at = |ratio: f64| ((seed as f64 * ratio).fract() * 1024.0) as usize;
    Site { frame: 0, y: at(0.569_840_290_998), x: at(0.754_877_666_247) }
}

/// A table of one frame, elsewhere in every frame: how a purely spatial table is animated.
struct Drift<S>(S);

impl<S: Sampler> Sampler for Drift<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let Site { y, x, .. } = displacement(site.frame as u64 * 11);
        self.0.sample(Site { frame: 0, y: site.y + y, x: site.x + x }, sample, dim)
    }
}

/// A table of two dimensions that serves every pair of them, each from elsewhere in the tile.
struct InPairs<S>(S);

impl<S: Sampler> Sampler for InPairs<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let Site { y, x, .. } = displacement(u64::from(dim / 2) * 7);
        self.0.sample(Site { y: site.y + y, x: site.x + x, ..site }, sample, dim % 2)
    }
}
