//! Spatio-temporal blue noise: blue over the pixels of each frame, and over the frames of each pixel[^wolfe].
//!
//! [^wolfe]: Wolfe, Morrical, Akenine-Möller, Ramamoorthi 2022, "Spatiotemporal blue noise masks", EGSR,
//!     <https://doi.org/10.2312/sr.20221161>.

use fsot::kernel::{Kernel, SpatialKernel, TemporalKernel};
use fsot::{Extent, SampleTable};

use super::anneal::{self, Cooling, Law, Neighbours, Pairs};
use super::void_cluster;
use crate::samplers::SamplerError;

/// How a spatio-temporal blue-noise mask is made.
///
/// Two sites see each other if they share the frame, with the weight `exp(−‖p − q‖² / (2 σ_xy²))`, or the
/// pixel, with `exp(−(t_p − t_q)² / (2 σ_t²))`; others don't. That is what makes it two-dimensional and
/// one-dimensional blue noise at once, rather than three-dimensional blue noise, whose slices are not blue.
///
/// One dimension is ranked by void and cluster (Ulichney 1993) under these weights. Vectors are annealed: the
/// energy of [`DitherMask`](super::DitherMask) under these weights, swaps within frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stbn {
    /// Frames, height and width; `spp` has to be 1. At most 2³¹ values.
    pub extent: Extent,
    /// Dimensions of a value, `1..=64`.
    pub dims: usize,
    /// `σ_xy`, a *standard deviation* in pixels, in `(0, 7e5]`; the paper uses 1.9.
    pub deviation_px: f64,
    /// `σ_t`, a *standard deviation* in frames, in `(0, 7e5]`; the paper uses 1.9.
    pub deviation_frames: f64,
    /// `σ_s` of vectors, positive; 1 as in Georgiev and Fajardo 2016. Scalars do without.
    pub sigma_value: f64,
    /// For vectors, in units of the energy. Scalars do without.
    pub cooling: Cooling,
    /// Names every random number.
    pub seed: u64,
}

impl Stbn {
    /// The constants of the paper, and a cooling of about 0.3 ms per site on two cores.
    pub fn new(extent: Extent, dims: usize) -> Self {
        Self {
            extent,
            dims,
            deviation_px: 1.9,
            deviation_frames: 1.9,
            sigma_value: 1.0,
            cooling: Cooling { start: 0.01, end: 2e-4, sweeps: 500 },
            seed: 0,
        }
    }

    /// Makes the mask. The same seed gives the same bits at any number of threads.
    ///
    /// Scalars are ranks, `(r + ½) / sites`, each once; O(sites · (taps + rows)). Vectors cost two passes
    /// over the neighbours per proposed swap.
    ///
    /// # Errors
    /// An empty or oversized extent; more than one sample per pixel; a parameter outside its range.
    pub fn table(&self) -> Result<SampleTable, SamplerError> {
        let Self { extent, dims, deviation_px, deviation_frames, sigma_value, cooling, seed } = *self;
        super::one_sample(&extent, dims)?;
        cooling.validate()?;
        let steepness = super::steepness(sigma_value)?;
        let temporal = TemporalKernel::Gaussian { sigma_frames: deviation_frames * std::f64::consts::SQRT_2 };
        let spatial = SpatialKernel::gaussian_from_deviation(deviation_px);
        let neighbours = Neighbours::of_kernels(&Kernel::separate(spatial, temporal), &extent)?;
        if dims == 1 {
            let ranks = void_cluster::ranks(&extent, &neighbours, seed);
            let sites = extent.sites() as f64;
            let value = |rank: u32| ((f64::from(rank) + 0.5) / sites) as f32;
            let values = ranks.into_iter().map(|rank| value(rank).min(fsot::config::BELOW_ONE));
            return Ok(super::table_of(extent, 1, values.collect()));
        }
        let values = anneal::nets(&extent, dims, seed);
        let mut ids = anneal::shuffled(&extent, seed);
        let model = Pairs::new(&values, dims, Law::Likeness { steepness }, &neighbours);
        anneal::anneal(&extent, &model, &cooling, seed, &mut ids);
        Ok(super::arranged(&extent, dims, &values, &ids))
    }
}
