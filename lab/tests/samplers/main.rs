//! What the papers of the compared samplers claim, measured. Fixed seeds; every bound names its significance.
//!
//! Yardstick of spectra: of a 64 × 64 image the frequencies below 0.1 cycles per pixel are 128, in 64
//! conjugate pairs, whose power in white noise is exponential with mean 1. Their mean is 1 ± 0.125, so 0.375
//! is five standard deviations below white noise, and averaging over integrands only makes white noise vary
//! less.

mod common;
mod keys;
mod masks;
mod optimised;
mod permutation;
mod refusals;
mod threads;
