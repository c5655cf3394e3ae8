//! Independent uniform numbers without state: a hash of where the number is used.

use fsot::Site;

use super::{Sampler, mixed};

/// White noise: `hash(seed, frame, y, x, sample, dim)` with 24 bits, so every multiple of 2⁻²⁴ in `[0, 1)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WhiteNoise {
    seed: u64,
}

impl WhiteNoise {
    /// The noise with this seed; different seeds are independent.
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }
}

impl Sampler for WhiteNoise {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let words = [
            site.frame as u64,
            (site.y as u64) << 32 | site.x as u64 & 0xffff_ffff,
            u64::from(sample) << 32 | u64::from(dim),
        ];
        (mixed(self.seed, &words) >> 40) as f32 * (1.0 / (1 << 24) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_uncorrelated() {
        // Correlation of n = 16384 pairs: standard error 1 / sqrt(n) = 0.0078.
        let noise = WhiteNoise::new(1);
        let centred = |site, sample, dim| f64::from(noise.sample(site, sample, dim)) - 0.5;
        let mut sums = [0.0; 5];
        for i in 0..16384 {
            let site = Site { frame: 0, y: i / 128, x: i % 128 };
            let here = centred(site, 0, 0);
            let others = [
                centred(Site { frame: 1, ..site }, 0, 0),
                centred(Site { y: site.y + 1, ..site }, 0, 0),
                centred(Site { x: site.x + 1, ..site }, 0, 0),
                centred(site, 1, 0),
                centred(site, 0, 1),
            ];
            sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += here * other);
        }
        for sum in sums {
            let correlation = sum / 16384.0 * 12.0;
            assert!(correlation.abs() < 5.0 * 0.0078, "{sums:?}");
        }
    }
}
