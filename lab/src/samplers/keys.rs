//! Sobol' sequences whose scrambling keys are arranged so that the errors of near pixels differ[^heitz].
//!
//! [^heitz]: Heitz, Belcour, Ostromoukhov, Coeurjolly, Iehl 2019, "A low-discrepancy sampler that distributes
//!     Monte Carlo errors as a blue noise in screen space", SIGGRAPH Talks,
//!     <https://doi.org/10.1145/3306307.3328191>.

use fsot::config::RangeError;
use fsot::kernel::{Kernel, SpatialKernel, TemporalKernel};
use fsot::{Extent, SampleTable};
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::anneal::{self, Cooling, Dots, Neighbours};
use super::mixed;
use crate::random::{self, Purpose};
use crate::samplers::SamplerError;

/// How the keys are arranged.
///
/// Every pixel has a key, the seed of its own Owen-scrambled Sobol' sequence, and a vector `ε` of its signed
/// errors over many Heaviside functions of random orientation and offset. Swapping keys between pixels
/// maximises the paper's energy
///
/// ```text
/// Σ_{p, q} exp(−‖p − q‖² / σ²) · ‖ε_p − ε_q‖²,
/// ```
///
/// in which only `−2 ε_p · ε_q` depends on the arrangement. Within a pixel nothing changes, so the error of
/// single pixels is that of Owen-scrambled Sobol', and at worst the errors of pixels are uncorrelated.
///
/// Then every pixel's *ranking key*, XORed to the index of its samples, is chosen from the highest bit to the
/// lowest so that the first half, quarter, … of its samples err unlike its neighbours' as well: a renderer
/// may stop at any power of two. (The paper chooses ranking keys by the same energy.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScramblingKeys {
    /// Frames, height, width, and samples per pixel: a power of two up to 65536. Frames are arranged one by
    /// one.
    pub extent: Extent,
    /// Dimensions of a sample, `1..=64`. The fewer, the bluer.
    pub dims: usize,
    /// `σ` in pixels, in `(0, 1e6]`; 2.1 as in Georgiev and Fajardo 2016.
    pub sigma_px: f64,
    /// Test functions, from 1 to 65536 (rounded up to a multiple of 16). Few are learnt by heart; the default
    /// is 128.
    pub integrands: usize,
    /// Temperatures are in units of `Σ w ε_p · ε_q` with the mean of `‖ε‖²` scaled to 1.
    pub cooling: Cooling,
    /// Names every random number.
    pub seed: u64,
}

impl ScramblingKeys {
    /// The defaults: about 3 seconds for 64 × 64 pixels on two cores.
    pub fn new(extent: Extent, dims: usize) -> Self {
        let cooling = Cooling { start: 0.3, end: 3e-3, sweeps: 300 };
        Self { extent, dims, sigma_px: 2.1, integrands: 128, cooling, seed: 0 }
    }

    /// Makes the table. The same seed gives the same bits at any number of threads.
    ///
    /// O(sites · integrands · (spp · dims + sweeps)), and `12 · sites · integrands` bytes.
    ///
    /// # Errors
    /// An empty or oversized extent; samples that are no power of two; a parameter outside its range.
    pub fn table(&self) -> Result<SampleTable, SamplerError> {
        let Self { extent, dims, sigma_px, cooling, seed, .. } = *self;
        extent.validate(dims)?;
        cooling.validate()?;
        let out_of_range = |name, value, expected| Err(RangeError::new(name, value, expected).into());
        if !extent.spp.is_power_of_two() || extent.spp > 1 << 16 {
            let expected = "that is a power of two, at most 65536";
            return out_of_range("spp", extent.spp as f64, expected);
        }
        if !(1..=1 << 16).contains(&self.integrands) {
            return out_of_range("the number of integrands", self.integrands as f64, "from 1 to 65536");
        }
        let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
        let neighbours = Neighbours::of_kernels(&[kernel], &extent)?;
        let heavisides = Heavisides::random(self.integrands.next_multiple_of(16), dims, seed);

        // Swap the keys by the errors of all samples.
        let keys: Vec<u32> =
            (0..extent.sites() as u64).map(|key| (mixed(seed, &[0x4e1, key]) >> 32) as u32).collect();
        let errors = heavisides.errors(&keys, &vec![0; keys.len()], extent.spp);
        let mut ids = anneal::shuffled(&extent, seed);
        let model = Dots::new(&errors, heavisides.count(), &neighbours);
        anneal::anneal(&extent, &model, &cooling, seed, &mut ids);
        let keys: Vec<u32> = ids.iter().map(|&id| keys[id as usize]).collect();

        // Decide which half of them comes first, then which half of that, and so on.
        let mut ranks = vec![0_u32; keys.len()];
        let mut half = extent.spp / 2;
        while half > 0 {
            let first = heavisides.errors(&keys, &ranks, half);
            let flipped: Vec<u32> = ranks.iter().map(|rank| rank ^ half as u32).collect();
            let second = heavisides.errors(&keys, &flipped, half);
            let halves = [first.as_slice(), second.as_slice()];
            let chosen = choose(&extent, &neighbours, heavisides.count(), halves, seed ^ half as u64);
            for ((rank, flipped), chosen) in ranks.iter_mut().zip(flipped).zip(chosen) {
                *rank = if chosen { flipped } else { *rank };
            }
            half /= 2;
        }
        let samples = keys.iter().zip(&ranks).flat_map(|(&key, &rank)| {
            (0..extent.spp as u32).flat_map(move |sample| {
                (0..dims as u32).map(move |dim| sobol_burley::sample(sample ^ rank, dim, key))
            })
        });
        Ok(super::table_of(extent, dims, samples.collect()))
    }
}

/// Steps `n · x > n · c` through random points `c` of the cube, with random normals `n`.
struct Heavisides {
    dims: usize,
    /// Normal and offset of each.
    planes: Vec<(Vec<f32>, f32)>,
}

impl Heavisides {
    fn random(count: usize, dims: usize, seed: u64) -> Self {
        let plane = |index: usize| {
            let mut generator = random::generator(seed, Purpose::Start, 3, index as u64);
            let normal: Vec<f32> = (0..dims).map(|_| generator.sample(StandardNormal)).collect();
            let offset = normal.iter().map(|n| n * generator.random::<f32>()).sum();
            (normal, offset)
        };
        Self { dims, planes: (0..count).map(plane).collect() }
    }

    fn count(&self) -> usize {
        self.planes.len()
    }

    /// Errors of the first `spp` samples of each key and rank, `[pixel][function]`, scaled so that a pixel's
    /// vector has the squared length 1 in the mean. The truth is the mean over all pixels.
    fn errors(&self, keys: &[u32], ranks: &[u32], spp: usize) -> Vec<f32> {
        let count = self.count();
        let mut errors = vec![0.0; keys.len() * count];
        errors.par_chunks_exact_mut(count).zip(keys.par_iter().zip(ranks)).for_each(
            |(errors, (&key, &rank))| {
                let mut point = vec![0.0; self.dims];
                for sample in 0..spp as u32 {
                    for (dim, value) in (0..).zip(&mut point) {
                        *value = sobol_burley::sample(sample ^ rank, dim, key);
                    }
                    for (error, (normal, offset)) in errors.iter_mut().zip(&self.planes) {
                        let along: f32 = normal.iter().zip(&point).map(|(n, x)| n * x).sum();
                        *error += f32::from(u8::from(along > *offset));
                    }
                }
            },
        );
        let mut means = vec![0.0_f64; count];
        for pixel in errors.chunks_exact(count) {
            means.iter_mut().zip(pixel).for_each(|(mean, &error)| *mean += f64::from(error));
        }
        means.iter_mut().for_each(|mean| *mean /= keys.len() as f64);
        let mut squares = 0.0_f64;
        for pixel in errors.chunks_exact_mut(count) {
            for (error, &mean) in pixel.iter_mut().zip(&means) {
                *error -= mean as f32;
                squares += f64::from(*error * *error);
            }
        }
        let scale = (keys.len() as f64 / squares.max(f64::MIN_POSITIVE)).sqrt() as f32;
        errors.iter_mut().for_each(|error| *error *= scale);
        errors
    }
}

/// Passes over the pixels in which each takes the better of its two vectors; few change after ten.
const PASSES: u64 = 16;

/// Which of two vectors every pixel takes, so that `Σ w v_p · v_q` is small.
fn choose(
    extent: &Extent,
    neighbours: &Neighbours,
    count: usize,
    halves: [&[f32]; 2],
    seed: u64,
) -> Vec<bool> {
    let mut order: Vec<usize> = (0..extent.sites()).collect();
    let mut first = random::generator(seed, Purpose::Start, 4, 0);
    let mut chosen: Vec<bool> = order.iter().map(|_| first.next_u64() >> 63 == 1).collect();
    let mut around = vec![0.0; count];
    for pass in 0..PASSES {
        order.shuffle(&mut random::generator(seed, Purpose::Start, 5, pass));
        for &site in &order {
            around.fill(0.0);
            let here = extent.site(site);
            for &(dt, dy, dx, weight) in &neighbours.taps {
                let there = extent.site_index(extent.wrapped(here, (dt.into(), dy.into(), dx.into())));
                let vector = &halves[usize::from(chosen[there])][there * count..][..count];
                around.iter_mut().zip(vector).for_each(|(sum, value)| *sum += weight * value);
            }
            let energy = |half: usize| -> f32 {
                halves[half][site * count..][..count].iter().zip(&around).map(|(v, a)| v * a).sum()
            };
            chosen[site] = energy(1) < energy(0);
        }
    }
    chosen
}
