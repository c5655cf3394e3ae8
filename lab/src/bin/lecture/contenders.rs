//! Every sampler of the comparison, and how it renders. Another one is another entry of [`CONTENDERS`].

use fsot::{Extent, Site};
use fsot_lab::render::{Film, render, render_frame};
use fsot_lab::samplers::{
    OwenSobol, Pattern, Sampler, SeedPermutation, Shifted, TableSampler, WhiteNoise, histogram_sampling,
};

use crate::Failure;
use crate::measure::Setting;
use crate::shelf::{Maker, Recipe, Shelf};

/// A sampler.
pub struct Contender {
    pub name: &'static str,
    /// Whether it looks at rendered values.
    pub a_posteriori: bool,
    render: fn(&Rendering) -> Rendered,
}

/// A picture, or nothing where the method does not apply.
type Rendered = Result<Option<Film>, Failure>;

impl Contender {
    const fn new(name: &'static str, render: fn(&Rendering) -> Rendered) -> Self {
        Self { name, a_posteriori: false, render }
    }

    const fn a_posteriori(name: &'static str, render: fn(&Rendering) -> Rendered) -> Self {
        Self { name, a_posteriori: true, render }
    }

    /// Renders the scene, or nothing where the method does not apply.
    pub fn render(&self, rendering: &Rendering) -> Rendered {
        (self.render)(rendering)
    }
}

/// All of them, in the order of the report.
pub const CONTENDERS: [Contender; 16] = [
    Contender::new("white noise", |r| r.picture(&WhiteNoise::new(r.seed()))),
    Contender::new("stratified", |r| r.drifting(Maker::Stratified, r.dims(), r.spp)),
    Contender::new("Owen-Sobol'", |r| r.picture(&OwenSobol::new(r.seed()))),
    Contender::new("R2 + white shift", |r| {
        let pattern = Pattern::kronecker(r.spp as usize, r.dims())?;
        r.picture(&Shifted::new(pattern, WhiteNoise::new(r.seed())))
    }),
    Contender::new("lattice + white shift", |r| {
        let pattern = Pattern::korobov(r.spp as usize, r.dims())?;
        r.picture(&Shifted::new(pattern, WhiteNoise::new(r.seed())))
    }),
    Contender::new("Sobol' + dither mask", |r| {
        let mask = r.drift(r.table(Maker::Dither, r.dims(), 1, 1)?);
        r.picture(&Shifted::new(Pattern::sobol(r.spp as usize, r.dims(), r.seed())?, mask))
    }),
    Contender::new("Sobol' + arranged keys", |r| {
        r.drifting(Maker::Keys, r.dims(), r.spp.next_power_of_two())
    }),
    Contender::new("STBN", |r| {
        r.picture(&r.in_pairs(r.table(Maker::Stbn, 2, 1, r.shelf.scale.tile_frames)?))
    }),
    Contender::new("FAST, space", |r| r.picture(&r.drift(r.in_pairs(r.table(Maker::Fast, 2, 1, 1)?)))),
    Contender::new("FAST, space + eye", |r| r.animated_in_pairs(Maker::Fast)),
    Contender::new("FAST, space + TAA", |r| r.animated_in_pairs(Maker::FastTaa)),
    Contender::a_posteriori("histogram of 8 *", |r| r.histogram()),
    Contender::a_posteriori("seed permutation *", |r| r.permuted()),
    Contender::new("ours, space", |r| r.drifting(Maker::Ours, r.dims(), r.spp)),
    Contender::new("ours, space + eye", |r| r.animated(Maker::Ours)),
    Contender::new("ours, space + TAA", |r| r.animated(Maker::OursTaa)),
];

/// Estimates that histogram sampling chooses from.
const ESTIMATES: u64 = 8;

/// What is rendered, and from which tables.
pub struct Rendering<'a> {
    pub shelf: &'a Shelf,
    pub setting: &'a Setting,
    pub spp: u32,
    /// Which realisation.
    pub repeat: u64,
}

impl<'a> Rendering<'a> {
    fn seed(&self) -> u64 {
        self.shelf.seed.wrapping_add(self.repeat)
    }

    fn dims(&self) -> usize {
        self.setting.scene.dims()
    }

    fn is_animated(&self) -> bool {
        self.setting.scene.frames > 1
    }

    fn picture(&self, sampler: &dyn Sampler) -> Rendered {
        Ok(Some(render(&self.setting.scene, sampler, self.setting.resolution, self.spp)?))
    }

    /// A table, elsewhere in every realisation.
    fn table(&self, maker: Maker, dims: usize, spp: u32, frames: usize) -> Result<TableSampler<'a>, Failure> {
        let table = self.shelf.table(Recipe { maker, dims, spp: spp as usize, frames })?;
        // Past the displacements of frames, pairs and samples: else one realisation is another a frame later.
        Ok(TableSampler::new(table).shifted(self.tile().displacement(1000 * self.repeat)))
    }

    fn tile(&self) -> Extent {
        Extent::still(self.shelf.scale.tile, self.shelf.scale.tile)
    }

    fn drift<S>(&self, table: S) -> Drift<S> {
        Drift { table, tile: self.tile() }
    }

    fn in_pairs<S>(&self, table: S) -> InPairs<S> {
        InPairs { table, tile: self.tile() }
    }

    /// From a table of one frame.
    fn drifting(&self, maker: Maker, dims: usize, spp: u32) -> Rendered {
        self.picture(&self.drift(self.table(maker, dims, spp, 1)?))
    }

    /// From a table of many frames, for animations alone.
    fn animated(&self, maker: Maker) -> Rendered {
        if !self.is_animated() {
            return Ok(None);
        }
        self.picture(&self.table(maker, self.dims(), self.spp, self.shelf.scale.tile_frames)?)
    }

    /// From a table of two dimensions, one sample and many frames, for animations alone.
    fn animated_in_pairs(&self, maker: Maker) -> Rendered {
        if !self.is_animated() {
            return Ok(None);
        }
        self.picture(&self.in_pairs(self.table(maker, 2, 1, self.shelf.scale.tile_frames)?))
    }

    fn histogram(&self) -> Rendered {
        if self.is_animated() {
            return Ok(None);
        }
        let (scene, [height, width]) = (&self.setting.scene, self.setting.resolution);
        let mask = self.table(Maker::Dither, 1, 1, 1)?;
        let level = |pixel: usize| {
            let site = Site { frame: 0, y: pixel / width, x: pixel % width };
            mask.sample(site, 0, 0)
        };
        let levels: Vec<f32> = (0..height * width).map(level).collect();
        let seeds = (1..=ESTIMATES).map(|k| self.seed().wrapping_mul(ESTIMATES).wrapping_add(k));
        let films: Vec<Film> = seeds
            .map(|seed| render(scene, &OwenSobol::new(seed), [height, width], self.spp))
            .collect::<Result<_, _>>()?;
        let estimates: Vec<&[f64]> = films.iter().map(Film::values).collect();
        let chosen = histogram_sampling(&estimates, &levels)?;
        Ok(Some(Film::new([1, height, width], chosen)?))
    }

    fn permuted(&self) -> Rendered {
        if !self.is_animated() {
            return Ok(None);
        }
        let (scene, [height, width]) = (&self.setting.scene, self.setting.resolution);
        let mask = self.shelf.table(Recipe { maker: Maker::Dither, dims: 1, spp: 1, frames: 1 })?;
        let mut seeds = SeedPermutation::new([height, width], mask, self.seed())?;
        let mut values = Vec::new();
        for frame in 0..scene.frames {
            let film = render_frame(scene, frame, &seeds, [height, width], self.spp)?;
            seeds.advance(film.values())?;
            values.extend_from_slice(film.values());
        }
        Ok(Some(Film::new([scene.frames, height, width], values)?))
    }
}

/// A table of one frame, elsewhere in every frame: how a purely spatial table is animated.
struct Drift<S> {
    table: S,
    tile: Extent,
}

impl<S: Sampler> Sampler for Drift<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let Site { y, x, .. } = self.tile.displacement(site.frame as u64);
        self.table.sample(Site { frame: 0, y: site.y + y, x: site.x + x }, sample, dim)
    }
}

/// A table of two dimensions that serves every pair of them, each from elsewhere in the tile.
struct InPairs<S> {
    table: S,
    tile: Extent,
}

impl<S: Sampler> Sampler for InPairs<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        // Past the displacements of frames.
        let pair = u64::from(dim / 2);
        let Site { y, x, .. } = self.tile.displacement(if pair > 0 { pair + 100 } else { 0 });
        self.table.sample(Site { y: site.y + y, x: site.x + x, ..site }, sample, dim % 2)
    }
}
