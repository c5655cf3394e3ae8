//! Owen-scrambled Sobol' points, scrambled anew in every pixel[^burley].
//!
//! [^burley]: Burley 2020, "Practical hash-based Owen scrambling", JCGT 9(4); the crate `sobol_burley`.

use fsot::Site;

use super::{Sampler, mixed};

/// An Owen-scrambled Sobol' sequence per pixel and frame, each with its own seed.
///
/// Within a pixel the samples are stratified as well as any; between pixels they are independent, so at one
/// sample per pixel this is white noise. Sequences of the underlying crate have 2¹⁶ points of 256 dimensions:
/// beyond either, another independent sequence begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OwenSobol {
    seed: u64,
}

const POINTS: u32 = 1 << 16;

impl OwenSobol {
    /// The sequences with this seed; different seeds are independent randomisations.
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Seed of the sequence that holds the sample, its index there and the dimension there.
    fn locate(&self, site: Site, sample: u32, dim: u32) -> (u32, u32, u32) {
        let words = [
            site.frame as u64,
            (site.y as u64) << 32 | site.x as u64 & 0xffff_ffff,
            u64::from(sample / POINTS) << 32 | u64::from(dim / sobol_burley::NUM_DIMENSIONS),
        ];
        let seed = (mixed(self.seed, &words) >> 32) as u32;
        (seed, sample % POINTS, dim % sobol_burley::NUM_DIMENSIONS)
    }
}

impl Sampler for OwenSobol {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        let (seed, index, dim) = self.locate(site, sample, dim);
        sobol_burley::sample(index, dim, seed)
    }

    fn sample_2d(&self, site: Site, sample: u32, dim: u32) -> [f32; 2] {
        if dim % 4 == 3 {
            return [self.sample(site, sample, dim), self.sample(site, sample, dim + 1)];
        }
        // Four dimensions for the price of one.
        let (seed, index, dim) = self.locate(site, sample, dim);
        let four = sobol_burley::sample_4d(index, dim / 4, seed);
        [four[dim as usize % 4], four[dim as usize % 4 + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_power_of_two_is_a_net_in_the_first_two_dimensions() {
        // 64 points of a (0, 2)-sequence: one in each elementary interval of area 1/64, of whatever shape.
        let sobol = OwenSobol::new(9);
        let site = Site { frame: 3, y: 5, x: 7 };
        for columns in [1, 2, 4, 8, 16, 32, 64_usize] {
            let rows = 64 / columns;
            let mut counts = vec![0; 64];
            for sample in 0..64 {
                let [u, v] = sobol.sample_2d(site, sample, 0);
                let cell = (u * columns as f32) as usize * rows + (v * rows as f32) as usize;
                counts[cell] += 1;
            }
            assert!(counts.iter().all(|&count| count == 1), "{columns} x {rows}: {counts:?}");
        }
    }
}
