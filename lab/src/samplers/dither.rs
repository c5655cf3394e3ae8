//! Blue-noise dither masks in any number of dimensions[^georgiev].
//!
//! [^georgiev]: Georgiev and Fajardo 2016, "Blue-noise dithered sampling", SIGGRAPH Talks,
//!     <https://doi.org/10.1145/2897839.2927430>.

use fsot::kernel::{Kernel, SpatialKernel, TemporalKernel};
use fsot::{Extent, SampleTable};

use super::anneal::{self, Cooling, Law, Neighbours, Pairs};
use crate::samplers::SamplerError;

/// How a dither mask is made: one point of `[0, 1)^D` per pixel, arranged so that near pixels get unlike
/// points.
///
/// The energy of a mask with points `s_p` at the pixels `p` is (the equation of the paper)
///
/// ```text
/// E(M) = Σ_{p ≠ q} exp(−‖p − q‖² / σ_i² − ‖s_p − s_q‖^(D/2) / σ_s²).
/// ```
///
/// Distances of pixels wrap, distances of points do not; pixels beyond 0.1 % of the weight of the nearest are
/// left out. The points are an Owen-scrambled Sobol' net, so any mask fills the cube evenly (the paper starts
/// from random points). Several frames are masks of their own.
///
/// A mask is used as the shift of a pattern that all pixels share: [`Shifted`](super::Shifted). Read as
/// samples, through [`TableSampler`](super::TableSampler), it is a table for one sample per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DitherMask {
    /// Frames, height and width; `spp` has to be 1. At most 2³¹ values.
    pub extent: Extent,
    /// Dimensions of a point, `1..=64`. The more, the weaker the blue noise of each.
    pub dims: usize,
    /// `σ_i` in pixels, in `(0, 1e6]`; the paper uses 2.1.
    pub sigma_px: f64,
    /// `σ_s`, positive; the paper uses 1.
    pub sigma_value: f64,
    /// Temperatures are in units of `E`.
    pub cooling: Cooling,
    /// Names every random number.
    pub seed: u64,
}

impl DitherMask {
    /// The constants of the paper, and a cooling of about 1 s for 64 × 64 pixels on two cores.
    pub fn new(extent: Extent, dims: usize) -> Self {
        let cooling = Cooling { start: 0.01, end: 2e-4, sweeps: 500 };
        Self { extent, dims, sigma_px: 2.1, sigma_value: 1.0, cooling, seed: 0 }
    }

    /// Makes the mask. The same seed gives the same bits at any number of threads.
    ///
    /// A proposed swap costs two passes over the some hundred neighbours of the default.
    ///
    /// # Errors
    /// An empty or oversized extent; more than one sample per pixel; a parameter outside its range.
    pub fn table(&self) -> Result<SampleTable, SamplerError> {
        let Self { extent, dims, sigma_px, sigma_value, cooling, seed } = *self;
        super::one_sample(&extent, dims)?;
        cooling.validate()?;
        let steepness = super::steepness(sigma_value)?;
        let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
        let neighbours = Neighbours::of_kernels(&[kernel], &extent)?;
        let values = anneal::nets(&extent, dims, seed);
        let mut ids = anneal::shuffled(&extent, seed);
        let model = Pairs::new(&values, dims, Law::Likeness { steepness }, &neighbours);
        anneal::anneal(&extent, &model, &cooling, seed, &mut ids);
        Ok(super::arranged(&extent, dims, &values, &ids))
    }
}
