//! Random numbers named by where they are used, never by which thread drew them.
//!
//! Every consumer asks for the generator of its own `(seed, purpose, step, index)`. The four numbers are
//! mixed into the 256-bit state of a xoshiro256++ with SplitMix64's finaliser (Steele, Lea and Flood 2014,
//! "Fast splittable pseudorandom number generators"), so generators of neighbouring names are unrelated.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// What a generator is used for; part of its name.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// The table before the first step.
    WhiteNoise = 1,
    /// The order in which the members of a class family are visited.
    Order,
    /// The stratification shared by the subsets of one step.
    Strata,
    /// One subset: its level, directions and cut.
    Subset,
    /// Fixed frames of directions.
    Frames,
    /// Slices that measure rather than optimise.
    Bound,
    /// The order in which a sweep visits the samples.
    Sweep,
    /// Parameters of one test integrand.
    Integrands = 32,
}

impl From<Purpose> for u64 {
    fn from(purpose: Purpose) -> u64 {
        purpose as u64
    }
}

/// The generator with this name.
///
/// `purpose` keeps what consumers ask for apart; numbers below 1024 are this project's own.
///
/// ```
/// use rand::RngExt;
///
/// // Sample 5 of step 3, whoever draws it.
/// let number: f64 = fsot::random::generator(7, 2000_u64, 3, 5).random();
/// assert_eq!(number, fsot::random::generator(7, 2000_u64, 3, 5).random::<f64>());
/// ```
#[inline]
pub fn generator(seed: u64, purpose: impl Into<u64>, step: u64, index: u64) -> Xoshiro256PlusPlus {
    let mut state = [0_u8; 32];
    let mut word = seed;
    for (bytes, salt) in state.chunks_exact_mut(8).zip([purpose.into(), step, index, 0x5eed]) {
        word = finalise(word.wrapping_add(salt.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    Xoshiro256PlusPlus::from_seed(state)
}

/// Fractional part of the golden ratio: multiples of it are evenly spread for any count (Weyl, van der
/// Corput).
pub(crate) const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_8;

/// A generator for where one is needed in form only.
#[inline]
pub(crate) fn unnamed() -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::from_seed([1; 32])
}

/// SplitMix64's bijective finaliser.
#[inline]
pub fn finalise(mut word: u64) -> u64 {
    word = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// `count` independent uniform numbers in `[0, 1)`.
pub(crate) fn uniforms(seed: u64, count: usize) -> Vec<f32> {
    let mut generator = generator(seed, Purpose::WhiteNoise, 0, 0);
    (0..count).map(|_| generator.random()).collect()
}

/// Steps of a Kronecker sequence, `(1/φ, 1/φ², …)` with the root `φ` of `φ^(dims + 1) = φ + 1`: the golden
/// ratio for one dimension, R2 for two (Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences").
///
/// ```
/// // The golden ratio's, for one dimension.
/// assert!((fsot::random::kronecker_steps(1)[0] - 0.618_034).abs() < 1e-6);
/// ```
pub fn kronecker_steps(dims: usize) -> Vec<f64> {
    // Newton's iteration would do; this contraction cannot leave (1, 2).
    let phi = (0..100).fold(1.5_f64, |phi, _| (1.0 + phi).powf(1.0 / (dims as f64 + 1.0)));
    (1..=dims as i32).map(|d| phi.powi(-d)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_names_give_unrelated_numbers() {
        // Means of 4096 uniforms whose names differ in one coordinate: standard error 0.0045, so 5 of them.
        let mean = |name: &dyn Fn(u64) -> Xoshiro256PlusPlus| {
            (0..4096).map(|i| name(i).random::<f64>()).sum::<f64>() / 4096.0
        };
        let means = [
            mean(&|i| generator(i, Purpose::Subset, 0, 0)),
            mean(&|i| generator(0, Purpose::Subset, i, 0)),
            mean(&|i| generator(0, Purpose::Subset, 0, i)),
        ];
        for mean in means {
            assert!((mean - 0.5).abs() < 5.0 * 0.0045, "{means:?}");
        }
        let first = |step, index| generator(7, Purpose::Order, step, index).random::<u64>();
        assert_ne!(first(1, 2), first(2, 1));
        assert_ne!(first(1, 2), generator(7, Purpose::Bound, 1, 2).random::<u64>());
    }

    /// Value stability: a change here changes every table and belongs in the CHANGELOG.
    #[test]
    fn the_first_numbers_are_pinned() {
        assert_eq!(uniforms(1, 2), [0.043_152_57, 0.681_555_45]);
        assert_eq!(uniforms(0, 3), uniforms(0, 5)[..3]);
    }
}
