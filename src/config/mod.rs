//! What a caller sets: plain data.

pub(crate) mod descent;
pub(crate) mod point_sets;
pub(crate) mod sweeps;
pub(crate) mod term;
pub(crate) mod until;

use serde::{Deserialize, Serialize};

pub use self::descent::{Descent, Schedule, Shape};
pub use self::point_sets::LabelSubsets;
pub use self::sweeps::Sweeps;
pub use self::term::{DimensionGroup, Role, Slicing, Term};
pub use self::until::{EndReason, Until, Work};
use crate::classes::FilterForm;
use crate::kernel::{Kernel, SpatialKernel, TemporalKernel};
pub use crate::table::domain::{BELOW_ONE, Domain};
use crate::table::extent::Extent;
pub use crate::table::extent::MOST_DIMS;

/// Everything that determines a table, but for the length of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// Frames, height, width and samples per pixel.
    pub extent: Extent,
    /// Dimensions of a sample.
    pub dims: usize,
    /// Interval or torus, per dimension.
    pub domains: Vec<Domain>,
    /// What is optimised.
    pub terms: Vec<Term>,
    /// How slices are drawn.
    pub slicing: Slicing,
    /// How steps of slices move the samples.
    pub descent: Descent,
    /// How sweeps move them.
    #[serde(default)]
    pub sweeps: Sweeps,
    /// How far the terms in the role of [`Role::Balance`] move the samples towards their targets, over a run.
    pub balance: Schedule,
    /// Names every random number: the same seed gives the same bits.
    pub seed: u64,
}

impl Config {
    /// The defaults for a table of this extent: interval domains, the spatial Gaussian of the papers (`sigma_px =
    /// 2.1`), times the perceptual kernel at 60 frames per second if there are several frames, consecutive pairs of
    /// dimensions and all of them at half their weight, unbiased, barycentric steps of slices.
    pub fn new(extent: Extent, dims: usize) -> Self {
        let temporal = match extent.frames {
            0 | 1 => TemporalKernel::None,
            _ => TemporalKernel::Perceptual { fps: 60.0 },
        };
        let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, temporal);
        let groups = DimensionGroup::pairs_and_whole(dims);
        Self {
            extent,
            dims,
            // More dimensions are refused when the configuration is used; a list of them might not fit the memory.
            domains: vec![Domain::Interval; dims.min(MOST_DIMS)],
            terms: Term::blue_noise(&[kernel], FilterForm::LevelSets, &groups, &extent),
            slicing: Slicing::default(),
            descent: Descent::default(),
            sweeps: Sweeps::default(),
            balance: Schedule::constant(1.0),
            seed: 0,
        }
    }
}
