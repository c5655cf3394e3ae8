//! Who hands a renderer its random numbers.
//!
//! A [`Sampler`] is asked by (frame, pixel, sample, dimension), in any order and from any thread, and always
//! gives the same answer to the same question (the contract of pbrt-v4's samplers, without their hidden
//! state). It is not told how many samples there will be; where a number of samples was chosen beforehand,
//! fewer of them are a worse set.
//!
//! * [`TableSampler`] reads an optimised [`SampleTable`];
//! * [`WhiteNoise`] is plain Monte Carlo, the yardstick of every ratio;
//! * [`OwenSobol`] is the strongest sampler that knows nothing of its neighbours.
//!
//! The samplers of the literature that filtered sliced optimal transport is compared with are here as well,
//! each from its paper's description. Most are recipes for a table:
//!
//! | recipe | arranges | after |
//! |---|---|---|
//! | [`stratified`] | nothing: jittered pixels | Cook 1986 |
//! | [`Shifted`] [`Pattern`] | nothing: a lattice, shifted per pixel | Cranley and Patterson 1976 |
//! | [`DitherMask`] | unlike values at near pixels | Georgiev and Fajardo 2016 |
//! | [`ScramblingKeys`] | unlike errors at near pixels | Heitz et al. 2019 |
//! | [`SeedPermutation`], [`histogram_sampling`] | rendered values by a mask | Heitz and Belcour 2019 |
//! | [`Stbn`] | unlike values in space and in time | Wolfe et al. 2022 |
//! | [`Fast`] | the energy distance under a filter | Donnelly et al. 2024 |
//!
//! The same seed gives the same table at any number of threads. Across platforms, exponentials and powers of
//! the standard library may round differently, and annealing amplifies that.

mod anneal;
mod dither;
mod error;
mod fast;
mod keys;
mod pattern;
mod permute;
mod sobol;
mod stbn;
mod stratified;
mod table;
mod void_cluster;
mod white;

pub use anneal::Cooling;
pub use dither::DitherMask;
pub use error::SamplerError;
pub use fast::Fast;
pub use keys::ScramblingKeys;
pub use pattern::{Pattern, Shifted};
pub use permute::{SeedPermutation, histogram_sampling};
pub use sobol::OwenSobol;
pub use stbn::Stbn;
pub use stratified::stratified;
pub use table::TableSampler;
pub use white::WhiteNoise;

use fsot::config::RangeError;
use fsot::{Extent, SampleTable, Site};

use crate::random::{GOLDEN, finalise};

/// Random numbers of a renderer, as a pure function of where they are used.
pub trait Sampler: Sync {
    /// Coordinate `dim` of sample `sample` at this site, in `[0, 1)`. All indices are unbounded: frame, row
    /// and column may lie outside a table's tile.
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32;

    /// Coordinates `dim` and `dim + 1`, equal to two calls of [`sample`](Self::sample).
    fn sample_2d(&self, site: Site, sample: u32, dim: u32) -> [f32; 2] {
        [self.sample(site, sample, dim), self.sample(site, sample, dim + 1)]
    }
}

impl<S: Sampler + ?Sized> Sampler for &S {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        (**self).sample(site, sample, dim)
    }

    fn sample_2d(&self, site: Site, sample: u32, dim: u32) -> [f32; 2] {
        (**self).sample_2d(site, sample, dim)
    }
}

/// Mixes a seed and a list of words into 64 unrelated bits, one round of SplitMix64 a word.
fn mixed(seed: u64, words: &[u64]) -> u64 {
    words.iter().fold(finalise(seed), |state, &word| finalise(state ^ word.wrapping_mul(GOLDEN)))
}

/// Checks the extent of a table that has one sample per pixel by construction.
fn one_sample(extent: &Extent, dims: usize) -> Result<(), SamplerError> {
    extent.validate(dims)?;
    if extent.spp > 1 {
        let expected = "of 1: the method arranges one sample per pixel";
        return Err(RangeError::new("spp", extent.spp as f64, expected).into());
    }
    Ok(())
}

/// `1 / sigma²` of a similarity between values.
fn steepness(sigma_value: f64) -> Result<f32, SamplerError> {
    let steepness = (sigma_value * sigma_value).recip() as f32;
    if sigma_value > 0.0 && steepness > 0.0 && steepness.is_finite() {
        return Ok(steepness);
    }
    let expected = "above 0, neither tiny nor huge: the papers use 1";
    Err(RangeError::new("sigma_value", sigma_value, expected).into())
}

/// The table in which site `i` has the value `ids[i]` of `[id][dim]`.
fn arranged(extent: &Extent, dims: usize, values: &[f32], ids: &[u32]) -> SampleTable {
    let value = |&id: &u32| &values[id as usize * dims..][..dims];
    table_of(*extent, dims, ids.iter().flat_map(value).copied().collect())
}

/// A table of values that lie in `[0, 1)` by construction and fit the extent, which was checked.
fn table_of(extent: Extent, dims: usize, values: Vec<f32>) -> SampleTable {
    SampleTable::new(extent, dims, values).expect("the extent was checked, and every value is below 1")
}

#[cfg(test)]
mod tests {
    use rand::seq::SliceRandom;
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;

    const EXTENT: Extent = Extent { frames: 2, height: 3, width: 5, spp: 2 };

    /// One checker, every sampler.
    fn every_sampler(check: impl Fn(&str, &dyn Sampler)) {
        let table = SampleTable::white_noise(EXTENT, 2, 7).unwrap();
        check("table", &TableSampler::new(&table));
        check("shifted table", &TableSampler::new(&table).shifted(Site { frame: 1, y: 2, x: 4 }));
        check("white noise", &WhiteNoise::new(1));
        check("Owen-Sobol'", &OwenSobol::new(1));
        check("shifted lattice", &Shifted::new(Pattern::korobov(4, 3).unwrap(), WhiteNoise::new(1)));
        let mask =
            SampleTable::white_noise(Extent { frames: 1, height: 8, width: 16, spp: 1 }, 1, 3).unwrap();
        check("permuted seeds", &SeedPermutation::new([64, 64], &mask, 1).unwrap());
    }

    #[test]
    fn answers_do_not_depend_on_the_order_of_questions() {
        every_sampler(|name, sampler| {
            let mut questions = Vec::new();
            for frame in 0..3 {
                for (y, x) in [(0, 0), (2, 4), (3, 5), (200, 1000)] {
                    for sample in [0, 1, 2, 5, 70_000] {
                        questions.extend((0..6).map(|dim| (Site { frame, y, x }, sample, dim)));
                    }
                }
            }
            let ask = |&(site, sample, dim): &(Site, u32, u32)| sampler.sample(site, sample, dim);
            let in_order: Vec<f32> = questions.iter().map(ask).collect();
            assert!(in_order.iter().all(|u| (0.0..1.0).contains(u)), "{name}");
            let mut order: Vec<usize> = (0..questions.len()).collect();
            order.shuffle(&mut Xoshiro256PlusPlus::seed_from_u64(3));
            for at in order {
                assert_eq!(ask(&questions[at]), in_order[at], "{name} {:?}", questions[at]);
                let (site, sample, dim) = questions[at];
                let pair = [sampler.sample(site, sample, dim), sampler.sample(site, sample, dim + 1)];
                assert_eq!(sampler.sample_2d(site, sample, dim), pair, "{name} {:?}", questions[at]);
            }
        });
    }

    #[test]
    fn every_sampler_is_uniform_over_pixels() {
        // Mean of 4096 independent uniforms: standard error 0.0045. The table has 60 values only: 0.037.
        every_sampler(|name, sampler| {
            let allowed = 5.0 * if name.contains("table") { 0.0373 } else { 0.0045 };
            for dim in 0..2 {
                let mean = (0..4096)
                    .map(|i| f64::from(sampler.sample(Site { frame: 0, y: i / 64, x: i % 64 }, 0, dim)))
                    .sum::<f64>()
                    / 4096.0;
                assert!((mean - 0.5).abs() < allowed, "{name} dim {dim}: {mean}");
            }
        });
    }

    #[test]
    fn words_are_mixed_by_position() {
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(5);
        let (a, b) = (generator.next_u64(), generator.next_u64());
        assert_ne!(mixed(0, &[a, b]), mixed(0, &[b, a]));
        assert_ne!(mixed(0, &[a]), mixed(1, &[a]));
        assert_ne!(mixed(0, &[a]), mixed(0, &[a, 0]));
    }
}
