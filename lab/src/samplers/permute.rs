//! A-posteriori blue noise: pixels choose among their own estimates, or exchange their seeds between
//! frames[^heitz].
//!
//! Unlike every other sampler here these look at rendered values: they need no model of the integrand, and
//! assume that near pixels, or the next frame, have nearly the same one.
//!
//! [^heitz]: Heitz and Belcour 2019, "Distributing Monte Carlo errors as a blue noise in screen space by
//!     permuting pixel seeds between frames", CGF 38(4), <https://doi.org/10.1111/cgf.13778>.

use fsot::config::{ExtentError, RangeError};
use fsot::{SampleTable, Site};
use rand::RngExt;

use super::pattern::gcd;
use super::{Sampler, mixed};
use crate::random::{self, Purpose};
use crate::samplers::SamplerError;

/// Histogram sampling (the paper's section 3): at every pixel the estimate whose rank among `estimates` is
/// the mask's value there.
///
/// `estimates` are renderings of the same frame with independent numbers, all of `mask.len()` pixels; `mask`
/// holds values in `[0, 1)`. Each pixel's result is one of its estimates, of a random rank: unbiased, and as
/// noisy as one of them, but its error follows the mask. The price is rendering all of them. O(pixels · n log
/// n).
///
/// # Errors
/// No estimate, or one whose length is not that of the mask.
pub fn histogram_sampling(estimates: &[&[f64]], mask: &[f32]) -> Result<Vec<f64>, SamplerError> {
    if estimates.is_empty() {
        return Err(ExtentError::EmptyAxis { axis: "the number of estimates" }.into());
    }
    for estimate in estimates {
        check_pixels("the number of pixels of an estimate", estimate.len(), mask.len())?;
    }
    let mut values = Vec::new();
    let pick = |(pixel, &level): (usize, &f32)| {
        values.clear();
        values.extend(estimates.iter().map(|estimate| estimate[pixel]));
        values.sort_by(f64::total_cmp);
        values[((f64::from(level) * values.len() as f64) as usize).min(values.len() - 1)]
    };
    Ok(mask.iter().enumerate().map(pick).collect())
}

fn check_pixels(name: &'static str, given: usize, pixels: usize) -> Result<(), RangeError> {
    RangeError::check(given == pixels, name, given as f64, "for each pixel of the mask or picture")
}

/// The temporal algorithm (the paper's section 4): seeds of a picture that change places after every frame.
///
/// As a [`Sampler`] it gives each pixel the Owen-scrambled Sobol' sequence of its seed. After a frame is
/// rendered
/// [`advance`](Self::advance) *sorts*: in blocks of 4 × 4 pixels the seeds are exchanged so that the pixel
/// values they just gave have the order of the mask's values. Then it *retargets*: the mask of the next frame
/// is the same mask displaced, and a permutation found beforehand takes seeds from where the one mask has a
/// value to where the next has nearly the same. Blocks lie elsewhere in every frame. Seeds are only ever
/// permuted, so the set of sequences stays the same.
#[derive(Clone, Debug)]
pub struct SeedPermutation {
    height: usize,
    width: usize,
    tile: [usize; 2],
    /// The mask, `[y][x]` of the tile.
    mask: Vec<f32>,
    /// Where in the tile the next mask's pixel finds a seed.
    source: Vec<u32>,
    seeds: Vec<u32>,
    frame: usize,
    seed: u64,
}

/// Side of the blocks that are sorted, in pixels: the paper's.
const BLOCK: usize = 4;

/// How far retargeting may carry a seed in each direction, in pixels; the paper uses a radius of 6.
const RADIUS: i64 = 6;

/// By how much the mask is displaced from frame to frame, as shares of the tile: that of the R2 sequence, up
/// to the next number without a divisor in common with the tile's side, so that no place comes again before
/// all have been there.
const STEP: [f64; 2] = [0.569_840_290_998_053_3, 0.754_877_666_246_692_8];

impl SeedPermutation {
    /// Random seeds for a picture of `[height, width]` pixels, to follow the first frame and dimension of a
    /// mask.
    ///
    /// O(tile) memory and some 50 ms per 64 × 64 pixels of the tile for the retargeting.
    ///
    /// # Errors
    /// An empty picture; a picture that is no multiple of the mask, or is larger than 2³¹ pixels.
    pub fn new([height, width]: [usize; 2], mask: &SampleTable, seed: u64) -> Result<Self, SamplerError> {
        let picture = fsot::Extent { frames: 1, height, width, spp: 1 };
        picture.validate(1)?;
        let extent = mask.extent();
        for (name, len, tile) in [("height", height, extent.height), ("width", width, extent.width)] {
            if !len.is_multiple_of(tile) {
                let expected = "that is a multiple of the mask's";
                return Err(RangeError::new(name, len as f64, expected).into());
            }
        }
        let at = |site: usize| {
            let site = Site { frame: 0, y: site / extent.width, x: site % extent.width };
            mask.sample(site, 0)[0]
        };
        let mask: Vec<f32> = (0..extent.height * extent.width).map(at).collect();
        let tile = [extent.height, extent.width];
        let seeds = (0..(height * width) as u64).map(|pixel| (mixed(seed, &[0x5eed, pixel]) >> 32) as u32);
        let mut made =
            Self { height, width, tile, source: Vec::new(), seeds: seeds.collect(), mask, frame: 0, seed };
        made.source = made.retargeting();
        Ok(made)
    }

    /// Seeds of the pixels, row by row.
    pub fn seeds(&self) -> &[u32] {
        &self.seeds
    }

    /// The value of the current frame's mask at a pixel.
    fn level(&self, y: usize, x: usize, frame: usize) -> f32 {
        let [dy, dx] = self.displacement(frame);
        let [height, width] = self.tile;
        self.mask[(y + dy) % height * width + (x + dx) % width]
    }

    /// The same displacement every time, so that one retargeting serves all frames.
    fn displacement(&self, frame: usize) -> [usize; 2] {
        [0, 1].map(|axis| {
            let len = self.tile[axis];
            let least = (STEP[axis] * len as f64).round() as usize;
            let step = (least..).find(|&step| gcd(step as u64, len as u64) == 1).unwrap_or(1);
            frame % len * step % len
        })
    }

    /// Exchanges seeds after a frame was rendered with them: `values` are its pixels, row by row.
    ///
    /// O(pixels).
    ///
    /// # Errors
    /// Not as many values as pixels; nothing is exchanged then.
    pub fn advance(&mut self, values: &[f64]) -> Result<(), SamplerError> {
        check_pixels("the number of values", values.len(), self.seeds.len())?;
        self.sort(values);
        let [dy, dx] = self.displacement(self.frame);
        let ([tall, wide], source) = (self.tile, &self.source);
        let retargeted = (0..self.seeds.len()).map(|pixel| {
            let (y, x) = (pixel / self.width, pixel % self.width);
            let (at_y, at_x) = ((y + dy) % tall, (x + dx) % wide);
            let from = source[at_y * wide + at_x] as usize;
            // The same step on the picture, whose sides are multiples of the tile's.
            let from_y = (y + self.height).wrapping_add_signed(near(from / wide, at_y, tall)) % self.height;
            let from_x = (x + self.width).wrapping_add_signed(near(from % wide, at_x, wide)) % self.width;
            self.seeds[from_y * self.width + from_x]
        });
        self.seeds = retargeted.collect();
        self.frame += 1;
        Ok(())
    }

    /// Matches the order of values to that of the mask within blocks, at an offset of this frame.
    fn sort(&mut self, values: &[f64]) {
        let mut place = random::generator(self.seed, Purpose::Start, 6, self.frame as u64);
        let offset = [place.random_range(0..BLOCK), place.random_range(0..BLOCK)];
        let ranges = |len: usize, offset: usize| {
            let mut cuts: Vec<usize> = (offset..len).step_by(BLOCK).collect();
            cuts.insert(0, 0);
            cuts.push(len);
            cuts.dedup();
            cuts.windows(2).map(|cut| cut[0]..cut[1]).collect::<Vec<_>>()
        };
        for rows in ranges(self.height, offset[0]) {
            for columns in ranges(self.width, offset[1]) {
                let pixels = rows.clone().flat_map(|y| columns.clone().map(move |x| (y, x)));
                let index = |&(y, x): &(usize, usize)| y * self.width + x;
                let mut by_value: Vec<(usize, usize)> = pixels.collect();
                let mut by_level = by_value.clone();
                by_value.sort_by(|a, b| values[index(a)].total_cmp(&values[index(b)]));
                let level = |at: &(usize, usize)| self.level(at.0, at.1, self.frame);
                by_level.sort_by(|a, b| level(a).total_cmp(&level(b)));
                let sorted: Vec<u32> = by_value.iter().map(|at| self.seeds[index(at)]).collect();
                for (at, seed) in by_level.iter().zip(sorted) {
                    self.seeds[at.0 * self.width + at.1] = seed;
                }
            }
        }
    }

    /// For every pixel of the tile, the pixel whose value in frame 0 is nearly that of the pixel in frame 1:
    /// pairs change places while that lowers the sum of squared differences and nobody goes farther than the
    /// radius.
    fn retargeting(&self) -> Vec<u32> {
        const SWEEPS: usize = 500;
        let [height, width] = self.tile;
        let mut source: Vec<u32> = (0..(height * width) as u32).collect();
        let mut generator = random::generator(self.seed, Purpose::Start, 7, 0);
        let next: Vec<f32> = (0..height * width).map(|p| self.level(p / width, p % width, 1)).collect();
        let reaches = |from: u32, p: usize| {
            let far = |from: usize, at: usize, len: usize| {
                let apart = from.abs_diff(at);
                apart.min(len - apart) as i64 <= RADIUS
            };
            let from = from as usize;
            far(from / width, p / width, height) && far(from % width, p % width, width)
        };
        for _ in 0..SWEEPS * height * width {
            let p = generator.random_range(0..height * width);
            let step = [(); 2].map(|()| generator.random_range(-RADIUS..=RADIUS));
            let y = (p as i64 / width as i64 + step[0]).rem_euclid(height as i64) as usize;
            let x = (p as i64 % width as i64 + step[1]).rem_euclid(width as i64) as usize;
            let q = y * width + x;
            let (a, b) = (source[p], source[q]);
            let cost = |from: u32, at: usize| (self.mask[from as usize] - next[at]).powi(2);
            if cost(b, p) + cost(a, q) < cost(a, p) + cost(b, q) && reaches(b, p) && reaches(a, q) {
                source.swap(p, q);
            }
        }
        source
    }
}

/// The short way to `from` on a torus of this length.
fn near(from: usize, at: usize, len: usize) -> isize {
    let ahead = ((from + len - at) % len) as isize;
    if 2 * ahead > len as isize { ahead - len as isize } else { ahead }
}

impl Sampler for SeedPermutation {
    /// Sample of the pixel's current seed; the frame does not matter, since seeds move when frames do.
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let seed = self.seeds[site.y % self.height * self.width + site.x % self.width];
        let seed = mixed(seed.into(), &[u64::from(sample >> 16), u64::from(dim >> 8)]) as u32;
        sobol_burley::sample(sample & 0xffff, dim & 0xff, seed)
    }
}

#[cfg(test)]
mod tests {
    use fsot::Extent;

    use super::*;
    use crate::samplers::DitherMask;

    fn correlation(pairs: &[(f64, f64)]) -> f64 {
        let count = pairs.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let moment = |of: &dyn Fn(f64, f64) -> f64| mean(&|pair| of(pair.0 - x, pair.1 - y));
        moment(&|x, y| x * y) / (moment(&|x, _| x * x) * moment(&|_, y| y * y)).sqrt()
    }

    /// What a frame was sorted for is the mask of that frame; retargeting makes it that of the next.
    #[test]
    fn one_step_takes_values_from_the_mask_of_a_frame_to_that_of_the_next() {
        let mut mask = DitherMask::new(Extent { frames: 1, height: 32, width: 32, spp: 1 }, 1);
        mask.cooling.sweeps = 50;
        let mask = mask.table().unwrap();
        let mut seeds = SeedPermutation::new([64, 64], &mask, 3).unwrap();
        let picture = |seeds: &SeedPermutation| -> Vec<f64> {
            let at = |i: usize| Site { frame: 0, y: i / 64, x: i % 64 };
            (0..4096).map(|i| f64::from(seeds.sample(at(i), 0, 0))).collect()
        };
        let like = |seeds: &SeedPermutation, frame: usize| {
            let level = |i: usize| f64::from(seeds.level(i / 64, i % 64, frame));
            let pairs: Vec<(f64, f64)> =
                picture(seeds).into_iter().enumerate().map(|(i, value)| (value, level(i))).collect();
            correlation(&pairs)
        };
        // Values without connection correlate by 0 ± 1/64; the mask with itself elsewhere by up to a few
        // times that.
        assert!(like(&seeds, 0).abs() < 5.0 / 64.0);
        seeds.advance(&picture(&seeds)).unwrap();
        let (last, next) = (like(&seeds, 0), like(&seeds, 1));
        assert!(next > 0.6 && last.abs() < 0.2, "{last} {next}");
    }

    #[test]
    fn displacements_do_not_repeat_before_the_tile_is_through() {
        let mask =
            SampleTable::white_noise(Extent { frames: 1, height: 16, width: 64, spp: 1 }, 1, 0).unwrap();
        let seeds = SeedPermutation::new([16, 64], &mask, 0).unwrap();
        let places: std::collections::BTreeSet<_> = (0..64).map(|frame| seeds.displacement(frame)).collect();
        assert_eq!(places.len(), 64);
    }
}
