//! Simulated annealing over swaps: which value stands at which site.
//!
//! The compared samplers that are tables (Georgiev and Fajardo 2016, Wolfe et al. 2022, Donnelly et al. 2024,
//! Heitz et al. 2019) all fix a set of values and look for the arrangement with the least energy
//! `Σ w(p − q) E(v_p, v_q)`. Here is what they share: the acceptance rule, the cooling, and regions that are
//! annealed side by side.
//!
//! A round places disjoint regions at a random offset, farther apart than the energy reaches. Each is copied
//! with its surroundings into a [`Patch`], annealed there, and copied back: no region sees another at work,
//! so the result depends on the seed alone and not on the number of threads. Values only move within their
//! frame.

mod dots;
mod neighbours;
mod pairs;

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

pub(super) use dots::Dots;
pub(super) use neighbours::Neighbours;
pub(super) use pairs::{Law, Pairs};

use crate::simd::LANES;
use fsot::Extent;
use fsot::config::RangeError;

use crate::random::{self, Purpose};
use crate::samplers::SamplerError;

/// Exponential cooling: the temperature `c_k` falls from `start` to `end` by equal factors.
///
/// A swap that changes the energy by `d` is kept if `d ≤ 0`, and with probability `exp(-d / c_k)` otherwise
/// (Metropolis). Energies have the unit of the method's own sum over ordered pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cooling {
    /// First temperature, positive and finite. Too high wastes sweeps, too low freezes a poor arrangement.
    pub start: f64,
    /// Last temperature, in `(0, start]`.
    pub end: f64,
    /// Proposed swaps per site, all in all. More is better, by ever less; the time is in proportion.
    pub sweeps: u64,
}

impl Cooling {
    /// Checks the ranges.
    pub(super) fn validate(&self) -> Result<(), SamplerError> {
        let bad = |name, value, expected| Err(RangeError::new(name, value, expected).into());
        if !(self.start > 0.0 && self.start.is_finite()) {
            return bad("the first temperature", self.start, "above 0 and finite");
        }
        if !(self.end > 0.0 && self.end <= self.start) {
            return bad("the last temperature", self.end, "above 0, at most the first");
        }
        if self.sweeps > 1 << 32 {
            return bad("sweeps", self.sweeps as f64, "of at most 4294967296");
        }
        Ok(())
    }

    /// The temperature after this share of the sweeps.
    fn at(&self, progress: f64) -> f64 {
        self.start * (self.end / self.start).powf(progress)
    }
}

/// A region of every frame with its surroundings, in memory of its own. Rows are padded to `stride`, so that
/// a vector of neighbours that begins in one ends in it.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub frames: usize,
    /// Sites that may move.
    pub rows: usize,
    /// See `rows`.
    pub columns: usize,
    /// Rows and columns of fixed sites on each side.
    pub reach: [usize; 2],
    pub stride: usize,
    /// Which value stands at `[frame][row][column]`, surroundings included; padding holds 0.
    pub ids: Vec<u32>,
}

impl Patch {
    fn empty(frames: usize, rows: usize, columns: usize, reach: [usize; 2]) -> Self {
        let stride = columns + (2 * reach[1] + 1).next_multiple_of(LANES);
        let ids = vec![0; frames * (rows + 2 * reach[0]) * stride];
        Self { frames, rows, columns, reach, stride, ids }
    }

    /// Where the movable site stands in `ids`.
    #[inline(always)]
    pub fn at(&self, frame: usize, row: usize, column: usize) -> usize {
        (frame * self.tall() + row + self.reach[0]) * self.stride + column + self.reach[1]
    }

    /// Rows of a frame, surroundings included.
    pub fn tall(&self) -> usize {
        self.rows + 2 * self.reach[0]
    }

    /// How far in `ids` from a site of the frame to another, so many frames and rows and columns away. Frames
    /// wrap.
    pub fn step(&self, frame: usize, [dt, dy]: [i32; 2], dx: isize) -> isize {
        let other = (frame as i32 + dt).rem_euclid(self.frames as i32) as isize;
        let rows = (other - frame as isize) * self.tall() as isize + dy as isize;
        rows * self.stride as isize + dx
    }

    /// Calls `each(index in ids, site of the table)` for the movable sites, or for all.
    fn for_each(
        &mut self,
        extent: &Extent,
        origin: [usize; 2],
        all: bool,
        mut each: impl FnMut(&mut u32, usize),
    ) {
        let [skip_y, skip_x] = if all { [0; 2] } else { self.reach };
        let wide = self.columns + 2 * self.reach[1];
        for frame in 0..self.frames {
            for row in skip_y..self.tall() - skip_y {
                let y = (origin[0] + extent.height + row - self.reach[0]) % extent.height;
                for column in skip_x..wide - skip_x {
                    let x = (origin[1] + extent.width + column - self.reach[1]) % extent.width;
                    let at = (frame * self.tall() + row) * self.stride + column;
                    each(&mut self.ids[at], (frame * extent.height + y) * extent.width + x);
                }
            }
        }
    }
}

/// Swaps to be tried in a patch.
pub(super) struct Work {
    pub proposals: usize,
    pub temperature: f64,
    pub generator: Xoshiro256PlusPlus,
}

impl Work {
    /// Two different movable sites of one frame, or the same twice.
    #[inline(always)]
    pub fn pair(&mut self, patch: &Patch) -> (usize, [[usize; 2]; 2]) {
        let below = |bits: u64, count: usize| (((bits & 0xffff_ffff) * count as u64) >> 32) as usize;
        let area = patch.rows * patch.columns;
        let bits: u64 = self.generator.random();
        let frame = match patch.frames {
            1 => 0,
            frames => below(self.generator.random(), frames),
        };
        let place = |site: usize| [site / patch.columns, site % patch.columns];
        (frame, [place(below(bits, area)), place(below(bits >> 32, area))])
    }

    /// The rule of Metropolis.
    #[inline(always)]
    pub fn accepts(&mut self, change: f32) -> bool {
        change <= 0.0 || exp(-change / self.temperature as f32) > self.generator.random::<f32>()
    }
}

/// An energy that can anneal a patch.
pub(super) trait Model: Sync {
    /// Rows and columns beyond which sites do not see each other.
    fn reach(&self) -> [usize; 2];

    /// Tries the swaps and leaves the arrangement reached in `patch.ids`.
    fn anneal(&self, patch: &mut Patch, work: Work);
}

/// Proposals per movable site and round: enough that copying patches costs little.
const PER_ROUND: usize = 8;

/// Anneals `ids[site]`, the value at each site, in place.
pub(super) fn anneal(extent: &Extent, model: &impl Model, cooling: &Cooling, seed: u64, ids: &mut [u32]) {
    let reach = model.reach();
    let split = |len: usize, reach: usize| {
        let count = (len / (4 * reach).max(16)).max(1);
        (count, (len / count - reach).max(1))
    };
    let (down, rows) = split(extent.height, reach[0]);
    let (across, columns) = split(extent.width, reach[1]);
    let proposals = PER_ROUND * extent.frames * rows * columns;
    let per_round = (proposals * down * across) as u128;
    let rounds = (u128::from(cooling.sweeps) * extent.sites() as u128).div_ceil(per_round) as u64;
    for round in 0..rounds {
        let mut place = random::generator(seed, Purpose::Regions, round, 0);
        let shift = [place.random_range(0..extent.height), place.random_range(0..extent.width)];
        let temperature = cooling.at(round as f64 / rounds as f64);
        let origin = |region: usize| {
            let (y, x) = (region / across, region % across);
            [
                (shift[0] + y * (extent.height / down)) % extent.height,
                (shift[1] + x * (extent.width / across)) % extent.width,
            ]
        };
        let annealed: Vec<Patch> = (0..down * across)
            .into_par_iter()
            .map(|region| {
                let mut patch = Patch::empty(extent.frames, rows, columns, reach);
                patch.for_each(extent, origin(region), true, |id, site| *id = ids[site]);
                let generator = random::generator(seed, Purpose::Swaps, round, region as u64);
                model.anneal(&mut patch, Work { proposals, temperature, generator });
                patch
            })
            .collect();
        for (region, mut patch) in annealed.into_iter().enumerate() {
            patch.for_each(extent, origin(region), false, |id, site| ids[site] = *id);
        }
    }
}

/// A random arrangement: every frame's own values in random order.
pub(super) fn shuffled(extent: &Extent, seed: u64) -> Vec<u32> {
    let mut ids: Vec<u32> = (0..extent.sites() as u32).collect();
    for (frame, ids) in ids.chunks_exact_mut(extent.height * extent.width).enumerate() {
        ids.shuffle(&mut random::generator(seed, Purpose::Start, 0, frame as u64));
    }
    ids
}

/// Values that fill the cube evenly in every frame: an Owen-scrambled Sobol' net each (`[site][dim]`).
pub(super) fn nets(extent: &Extent, dims: usize, seed: u64) -> Vec<f32> {
    let per_frame = extent.height * extent.width;
    let mut values = Vec::with_capacity(extent.sites() * dims);
    for frame in 0..extent.frames {
        for index in 0..per_frame {
            let words = [0x5e7, frame as u64, (index >> 16) as u64];
            let scramble = (super::mixed(seed, &words) >> 32) as u32;
            let index = (index & 0xffff) as u32;
            values.extend((0..dims as u32).map(|dim| sobol_burley::sample(index, dim, scramble)));
        }
    }
    values
}

/// `e^x` for `x ≤ 0` to 3e-7 relative, from additions and multiplications only: vectors of it need no
/// library, and it has the same bits everywhere.
#[inline(always)]
pub(super) fn exp(x: f32) -> f32 {
    // Adding 1.5 · 2²³ rounds to the nearest integer and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    const LN_2: f32 = std::f32::consts::LN_2;
    let t = (x * std::f32::consts::LOG2_E).max(-126.0);
    let rounded = t + ROUND;
    let f = (t - (rounded - ROUND)) * LN_2;
    let power = f32::from_bits(rounded.to_bits().wrapping_add(127) << 23);
    // Taylor's series on |f| ≤ ln 2 / 2: the first term left out is 1.2e-7.
    let series = 1.0
        + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    power * series
}

#[cfg(test)]
mod tests;
