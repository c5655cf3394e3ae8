//! Tables whose arrangement minimises the energy distance under a given filter[^donnelly].
//!
//! [^donnelly]: Donnelly, Wolfe, Bütepage, Valdés 2024, "FAST: filter-adapted spatio-temporal sampling for
//!     real-time rendering", PACMCGIT 7(1), <https://doi.org/10.1145/3651283>.

use fsot::config::RangeError;
use fsot::kernel::{Kernel, SpatialKernel, TemporalKernel};
use fsot::{Extent, SampleTable};

use super::anneal::{self, Cooling, Law, Neighbours, Pairs};
use crate::samplers::SamplerError;

/// How a filter-adapted table is made.
///
/// For a filter `f` the expected squared filtered error is a sum over pairs of sites, weighted by the
/// autocorrelation `F₂ = f ⋆ f`; with half-spaces for integrands a pair contributes `-‖x_i − x_j‖`, so the
/// paper's loss is
///
/// ```text
/// E = Σ_{i ≠ j} F₂(i − j) · (−‖x_i − x_j‖).
/// ```
///
/// The values are fixed: in every frame an Owen-scrambled Sobol' net, stratified in the strict sense. Swaps
/// within frames are annealed. Where there are frames, one kernel is the paper's *product* and two
/// ([`Kernel::separate`]) are its *separate* filter, the sum of their energies.
#[derive(Clone, Debug, PartialEq)]
pub struct Fast {
    /// Frames, height and width; `spp` has to be 1. At most 2³¹ values.
    pub extent: Extent,
    /// Dimensions of a sample, `1..=64`.
    pub dims: usize,
    /// The filters, each scaled to sum to 1; at least one. The default is `exp(-r² / 2.1²)`, times the
    /// perceptual kernel at 60 frames per second where there are frames.
    pub kernels: Vec<Kernel>,
    /// Temperatures are in units of the energy above with `F₂` scaled so that its largest weight is 1.
    pub cooling: Cooling,
    /// Names every random number.
    pub seed: u64,
}

impl Fast {
    /// The defaults for a table of this shape: about as good as the published textures of the method, in
    /// about 3 seconds for 64 × 64 pixels on two cores.
    pub fn new(extent: Extent, dims: usize) -> Self {
        let temporal = match extent.frames {
            0 | 1 => TemporalKernel::None,
            _ => TemporalKernel::Perceptual { fps: 60.0 },
        };
        let kernels = vec![Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, temporal)];
        Self { extent, dims, kernels, cooling: Cooling { start: 0.03, end: 6e-4, sweeps: 2000 }, seed: 0 }
    }

    /// Makes the table. The same seed gives the same bits at any number of threads.
    ///
    /// A proposed swap costs two passes over the support of `F₂`, some 180 sites for one frame of the
    /// default.
    ///
    /// # Errors
    /// An empty or oversized extent; more than one sample per pixel; no kernel or a bad one; a bad cooling.
    pub fn table(&self) -> Result<SampleTable, SamplerError> {
        let Self { extent, dims, kernels, cooling, seed } = self;
        super::one_sample(extent, *dims)?;
        cooling.validate()?;
        if kernels.is_empty() {
            let expected = "of at least 1";
            return Err(RangeError::new("the number of kernels", 0.0, expected).into());
        }
        let neighbours = Neighbours::of_autocorrelations(kernels, extent, 1e-3)?;
        let values = anneal::nets(extent, *dims, *seed);
        let mut ids = anneal::shuffled(extent, *seed);
        let model = Pairs::new(&values, *dims, Law::Distance, &neighbours);
        anneal::anneal(extent, &model, cooling, *seed, &mut ids);
        Ok(super::arranged(extent, *dims, &values, &ids))
    }
}
