//! Point sets that all pixels share, and their shift per pixel.

use std::f64::consts::PI;

use fsot::Site;
use fsot::config::{BELOW_ONE, ExtentError, MOST_DIMS, RangeError};
use fsot::random::kronecker_steps;

use super::{Sampler, mixed};
use crate::samplers::SamplerError;

/// A finite list of points of `[0, 1)^dims`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    dims: usize,
    /// `[point][dim]`.
    values: Vec<f32>,
}

/// Most points of a pattern, so that products of two of them fit 64 bits and Sobol' indices their sequence.
const MOST_POINTS: usize = 1 << 16;

/// Most points for which generators are searched: the search is quadratic.
const MOST_SEARCHED: usize = 4096;

impl Pattern {
    /// The rank-1 lattice `frac(i · z / n)`, `i = 0, …, n − 1`, of a generating vector `z`.
    ///
    /// Lattices are meant to be used whole: the first points of one are no good set. The first is the origin.
    ///
    /// # Errors
    /// 0 points or more than 65536; an empty vector or one of more than 64 entries.
    pub fn rank1(points: usize, generator: &[u64]) -> Result<Self, SamplerError> {
        check(points, MOST_POINTS, generator.len())?;
        let n = points as u64;
        let values = (0..n)
            .flat_map(|i| generator.iter().map(move |z| below_one((i * (z % n) % n) as f64 / n as f64)));
        Ok(Self { dims: generator.len(), values: values.collect() })
    }

    /// The best Korobov lattice, `z = (1, a, a², …) mod n`: of all `a` without a divisor in common with `n`,
    /// so that every coordinate has `n` values, the one with the least
    ///
    /// ```text
    /// P₂ = −1 + 1/n Σ_i Π_d (1 + 2π² B₂(frac(i z_d / n))),   B₂(x) = x² − x + 1/6,
    /// ```
    ///
    /// the squared worst-case error for periodic functions with square-integrable mixed second
    /// derivatives[^sloan]. O(n² dims).
    ///
    /// [^sloan]: Sloan and Joe 1994, "Lattice methods for multiple integration", chapter 4; Korobov 1959.
    ///
    /// # Errors
    /// 0 points or more than 4096; 0 dimensions or more than 64.
    pub fn korobov(points: usize, dims: usize) -> Result<Self, SamplerError> {
        check(points, MOST_SEARCHED, dims)?;
        let n = points as u64;
        let factors: Vec<f64> = (0..n)
            .map(|k| {
                let x = k as f64 / n as f64;
                1.0 + 2.0 * PI * PI * (x * x - x + 1.0 / 6.0)
            })
            .collect();
        let powers = |a: u64| std::iter::successors(Some(1 % n), move |z| Some(z * a % n)).take(dims);
        let error = |a: u64| -> f64 {
            let z: Vec<u64> = powers(a).collect();
            (0..n).map(|i| z.iter().map(|z| factors[(i * z % n) as usize]).product::<f64>()).sum()
        };
        // Of `a` and `n − a`, mirror images, the smaller.
        let coprime = |a: &u64| gcd(*a, n) == 1;
        let best =
            (1..=(n / 2).max(1)).filter(coprime).map(|a| (error(a), a)).min_by(|a, b| a.0.total_cmp(&b.0));
        let generator: Vec<u64> = powers(best.map_or(1, |(_, a)| a)).collect();
        Self::rank1(points, &generator)
    }

    /// The first points of a Kronecker sequence, `frac(i · (1/φ, 1/φ², …))` with the root `φ` of
    /// `φ^(dims + 1) = φ + 1`: the golden ratio for one dimension, R2 for two[^roberts]. Any number of first
    /// points is a good set. The first is the origin.
    ///
    /// [^roberts]: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences",
    ///     extremelearning.com.au.
    ///
    /// # Errors
    /// 0 points or more than 65536; 0 dimensions or more than 64.
    pub fn kronecker(points: usize, dims: usize) -> Result<Self, SamplerError> {
        check(points, MOST_POINTS, dims)?;
        let steps = kronecker_steps(dims);
        let values =
            (0..points).flat_map(|i| steps.iter().map(move |step| below_one((i as f64 * step).fract())));
        Ok(Self { dims, values: values.collect() })
    }

    /// The first points of an Owen-scrambled Sobol' sequence; powers of two are nets in the first dimensions.
    ///
    /// # Errors
    /// 0 points or more than 65536; 0 dimensions or more than 64.
    pub fn sobol(points: usize, dims: usize, seed: u64) -> Result<Self, SamplerError> {
        check(points, MOST_POINTS, dims)?;
        let scramble = (mixed(seed, &[0x9a7]) >> 32) as u32;
        let point = |i: u32| (0..dims as u32).map(move |dim| sobol_burley::sample(i, dim, scramble));
        Ok(Self { dims, values: (0..points as u32).flat_map(point).collect() })
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.values.len() / self.dims
    }

    /// Dimensions of a point.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The coordinates of all points, `[point][dim]`.
    pub fn values(&self) -> &[f32] {
        &self.values
    }
}

/// The greatest common divisor (Euclid).
pub(super) fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn check(points: usize, most: usize, dims: usize) -> Result<(), SamplerError> {
    for (axis, len) in [("points", points), ("dims", dims)] {
        if len == 0 {
            return Err(ExtentError::EmptyAxis { axis }.into());
        }
    }
    if points > most {
        let expected = if most == MOST_POINTS { "of at most 65536" } else { "of at most 4096" };
        return Err(RangeError::new("points", points as f64, expected).into());
    }
    if dims > MOST_DIMS {
        let expected = "of at most 64";
        return Err(RangeError::new("dims", dims as f64, expected).into());
    }
    Ok(())
}

fn below_one(value: f64) -> f32 {
    (value as f32).min(BELOW_ONE)
}

/// A pattern shifted toroidally in every pixel, `frac(pattern + shift)` (Cranley and Patterson 1976).
///
/// The shifts come from another sampler, sample 0 of each pixel: [`WhiteNoise`](super::WhiteNoise) makes
/// pixels independent; a [`DitherMask`](super::DitherMask) through a [`TableSampler`](super::TableSampler) is
/// blue-noise dithered sampling. Samples beyond the pattern repeat it with the shift's next sample;
/// dimensions beyond it are the shift's own, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Shifted<S> {
    pattern: Pattern,
    shifts: S,
}

impl<S: Sampler> Shifted<S> {
    /// The pattern, shifted by sample 0 of `shifts`.
    pub fn new(pattern: Pattern, shifts: S) -> Self {
        Self { pattern, shifts }
    }
}

impl<S: Sampler> Sampler for Shifted<S> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        if dim as usize >= self.pattern.dims {
            return self.shifts.sample(site, sample, dim);
        }
        let points = self.pattern.points() as u32;
        let point = self.pattern.values[(sample % points) as usize * self.pattern.dims + dim as usize];
        let sum = point + self.shifts.sample(site, sample / points, dim);
        if sum >= 1.0 { sum - 1.0 } else { sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(pattern: &Pattern, i: usize) -> &[f32] {
        &pattern.values()[i * pattern.dims()..][..pattern.dims()]
    }

    #[test]
    fn the_search_finds_fibonacci_lattices() {
        // In two dimensions the best lattices of so few points are Fibonacci's (1, F_(k − 1)).
        for (points, fibonacci) in [(5, 2), (13, 5)] {
            let lattice = Pattern::korobov(points, 2).unwrap();
            assert_eq!(lattice, Pattern::rank1(points, &[1, fibonacci]).unwrap());
            assert_eq!(point(&lattice, 1), [1.0 / points as f32, fibonacci as f32 / points as f32]);
        }
    }

    #[test]
    fn every_coordinate_of_a_lattice_has_as_many_values_as_it_has_points() {
        for points in [1, 2, 4, 9, 16, 30] {
            for dims in [1, 2, 4, 6] {
                let lattice = Pattern::korobov(points, dims).unwrap();
                for dim in 0..dims {
                    let mut values: Vec<u32> = (0..points)
                        .map(|i| (point(&lattice, i)[dim] * points as f32).round() as u32)
                        .collect();
                    values.sort_unstable();
                    assert!(
                        values.into_iter().eq(0..points as u32),
                        "{points} points, dimension {dim} of {dims}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_point_of_r2_is_where_its_author_says() {
        let r2 = Pattern::kronecker(2, 2).unwrap();
        // Roberts 2018: 1/g and 1/g² of g = 1.32471795724474602596.
        assert_eq!(point(&r2, 1), [0.754_877_7, 0.569_840_3]);
        let golden = Pattern::kronecker(2, 1).unwrap();
        assert_eq!(point(&golden, 1), [0.618_034]);
    }

    #[test]
    fn shifts_wrap_and_later_blocks_have_their_own() {
        struct Shift;
        impl Sampler for Shift {
            fn sample(&self, _: Site, sample: u32, dim: u32) -> f32 {
                if dim > 1 { 0.125 } else { 0.75 + 0.1 * sample as f32 }
            }
        }
        let site = Site { frame: 0, y: 0, x: 0 };
        let sampler = Shifted::new(Pattern::rank1(2, &[1, 1]).unwrap(), Shift);
        assert_eq!(sampler.sample_2d(site, 0, 0), [0.75, 0.75]);
        assert_eq!(sampler.sample_2d(site, 1, 0), [0.25, 0.25]);
        assert!((sampler.sample(site, 2, 0) - 0.85).abs() < 1e-6);
        assert_eq!(sampler.sample(site, 1, 2), 0.125);
    }

    #[test]
    fn mistakes_are_named() {
        let text = |made: Result<Pattern, SamplerError>| made.unwrap_err().to_string();
        assert!(text(Pattern::korobov(0, 2)).contains("points is 0"));
        assert!(text(Pattern::korobov(5000, 2)).contains("points is 5000: give a value of at most 4096"));
        assert!(text(Pattern::kronecker(70_000, 2)).contains("at most 65536"));
        assert!(text(Pattern::rank1(4, &[])).contains("dims is 0"));
        assert!(text(Pattern::sobol(4, 65, 0)).contains("dims is 65"));
    }
}
