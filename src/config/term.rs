//! What a user asks for: terms, dimension groups, and how slices are drawn.

use serde::{Deserialize, Serialize};

use crate::classes::{Classes, FilterForm};
use crate::error::{GroupError, RangeError, TermError};
use crate::kernel::{Kernel, SpatialKernel, TemporalKernel};
use crate::simd::LANES;
use crate::table::extent::{Extent, MOST_DIMS};
use crate::targets::Target;

/// One part of the objective: a family of classes, what their samples should resemble, and in which
/// dimensions.
///
/// ```
/// use fsot::config::Role;
/// use fsot::{Config, Extent};
///
/// // The default: a lattice of filters that is descended; the whole table and both coordinates, balanced;
/// // and a smaller filter.
/// let config = Config::new(Extent::still(64, 64), 2);
/// let roles: Vec<Role> = config.terms.iter().map(|term| term.role).collect();
/// assert_eq!(roles, [Role::Descend, Role::Balance, Role::Balance, Role::Balance, Role::Descend]);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// The filters.
    pub classes: Classes,
    /// The measure that a filtered subset should resemble.
    #[serde(default)]
    pub target: Target,
    /// The dimensions that this term sees, as a renderer consumes them together.
    pub dims: Vec<usize>,
    /// Share of the work: the number of slices that touch a sample is proportional to it, in the mean. Where
    /// no term has classes per pixel, as in a point set, every class has its slices in each step, and their
    /// pull on a sample is proportional to it instead. From 1e-15 to 1e15; a run that is counted in slices
    /// asks for terms that are nearer to each other (see [`crate::ConfigError::Uneven`]).
    #[serde(default = "one")]
    pub weight: f64,
    /// How its slices move the samples.
    #[serde(default)]
    pub role: Role,
}

fn one() -> f64 {
    1.0
}

/// How the slices of a term move the samples.
///
/// ```
/// use fsot::config::Role;
///
/// assert_eq!(Role::default(), Role::Descend);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// All such terms together are descended.
    #[default]
    Descend,
    /// After each step of the descent, samples move all the way to where the slices of the term wanted them
    /// before it (times [`crate::Config::balance`]): alternating projections rather than a compromise of
    /// weights. Sweeps do without slices where the whole table or its frames should resemble the cube. Meant
    /// for few slices of large classes, whose small but systematic displacements a compromise would drown.
    Balance,
}

/// A group of dimensions that a renderer consumes together, with its share of the work.
///
/// ```
/// use fsot::config::DimensionGroup;
/// use fsot::{Config, Extent};
///
/// // A point on the light, one on the lens, and a little of all four together.
/// let all = DimensionGroup::new([0, 1, 2, 3]).with_weight(0.25);
/// let groups = [DimensionGroup::new([0, 1]), DimensionGroup::new([2, 3]), all];
/// let config = Config::new(Extent::still(32, 32), 4).with_groups(&groups);
/// assert_eq!(config.groups(), groups);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DimensionGroup {
    /// Dimensions of the table, each once.
    pub dims: Vec<usize>,
    /// Weight relative to the other groups; positive.
    #[serde(default = "one")]
    pub weight: f64,
}

impl DimensionGroup {
    /// These dimensions, with weight 1.
    pub fn new(dims: impl Into<Vec<usize>>) -> Self {
        Self { dims: dims.into(), weight: 1.0 }
    }

    /// The same with this weight.
    #[must_use]
    pub fn with_weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// Consecutive pairs of dimensions with weight 1 (a last odd one alone), and all dimensions together with
    /// half that weight if there are more than two. No table has more than 64 dimensions; more are left out.
    pub fn pairs_and_whole(dims: usize) -> Vec<Self> {
        let all: Vec<usize> = (0..dims.min(MOST_DIMS)).collect();
        let mut groups: Vec<Self> =
            all.chunks(2).map(|pair| Self { dims: pair.to_vec(), weight: 1.0 }).collect();
        if dims > 2 {
            groups.push(Self { dims: all, weight: 0.5 });
        }
        groups
    }
}

/// Share of the work that goes to the whole table, and to its frames, relative to the kernels.
const BALANCE_WEIGHT: f64 = 0.03;
/// The same for single coordinates. Kernels and a coordinate pull on all samples of a small table at once;
/// with 0.03 the first steps of slices, which are large, overshoot.
const COORDINATE_WEIGHT: f64 = 0.01;

impl Term {
    /// The terms for blue-noise error: each group under each kernel, and as much of the whole table, of each
    /// frame and of each coordinate as keeps them unbiased up to the faces of the cube.
    ///
    /// Kernels share the work equally; [`Config::with_kernels`](crate::Config::with_kernels) puts them into a
    /// configuration, together with their [companions](Term::companions).
    pub fn blue_noise(
        kernels: &[Kernel],
        form: FilterForm,
        groups: &[DimensionGroup],
        extent: &Extent,
    ) -> Vec<Self> {
        let mut terms = Vec::new();
        for kernel in kernels {
            let classes = Classes::Lattice { kernel: kernel.clone(), form };
            let of = |group| Self::uniform(&classes, Role::Descend, group, 1.0 / kernels.len() as f64);
            terms.extend(groups.iter().map(of));
        }
        let mut balance = |classes: Classes, groups: &[DimensionGroup], weight: f64| {
            let of = |group| Self::uniform(&classes, Role::Balance, group, weight);
            terms.extend(groups.iter().map(of));
        };
        balance(Classes::WholeTable, groups, BALANCE_WEIGHT);
        if extent.frames > 1 {
            balance(Classes::PerFrame, groups, BALANCE_WEIGHT);
        }
        // A slice says little of a single coordinate next to its faces, where the pull of filters has no
        // equal from beyond.
        let mut seen: Vec<usize> = groups.iter().flat_map(|group| group.dims.iter().copied()).collect();
        seen.sort_unstable();
        seen.dedup();
        let alone = |dim: &usize| groups.iter().any(|group| group.dims == [*dim]);
        let rest: Vec<_> =
            seen.iter().filter(|dim| !alone(dim)).map(|&dim| DimensionGroup::new([dim])).collect();
        balance(Classes::WholeTable, &rest, COORDINATE_WEIGHT);
        terms
    }

    /// The smaller filters that go with these kernels, each with a small weight, so that what a scene does
    /// within a kernel, or what is seen without one, finds good samples too. In space they are the pixel by
    /// itself and its nearest neighbours (the Gaussian with `sigma_px = 1`), in time the single frame, and
    /// both together; but for those that would hold one sample alone.
    ///
    /// Weights make the squared errors of all filters comparable: of what a kernel pulls on a sample from its
    /// own place, the pixel and its neighbours do a quarter each, and the frame three fifths. A kernel that
    /// is refused has none.
    pub fn companions(
        kernels: &[Kernel],
        form: FilterForm,
        groups: &[DimensionGroup],
        extent: &Extent,
    ) -> Vec<Self> {
        let mut terms: Vec<Self> = Vec::new();
        let all = kernels.iter().filter_map(|kernel| Some((kernel, concentration(kernel, extent)?)));
        let all = all.flat_map(|(kernel, own)| smaller(kernel).map(move |smaller| (own, smaller)));
        for (own, (companion, share)) in all {
            let Some(of_companion) = concentration(&companion, extent) else { continue };
            if of_companion <= own || of_companion == 1.0 && extent.spp == 1 {
                continue;
            }
            let classes = match of_companion {
                1.0 => Classes::PerPixel,
                _ => Classes::Lattice { kernel: companion, form },
            };
            let weight = share * own / of_companion / kernels.len() as f64;
            for group in groups {
                let term = Self::uniform(&classes, Role::Descend, group, weight);
                match terms.iter_mut().find(|other| (&other.classes, &other.dims) == (&classes, &group.dims))
                {
                    Some(other) => other.weight += term.weight,
                    None => terms.push(term),
                }
            }
        }
        terms
    }

    /// Refuses a term that fits no table.
    ///
    /// # Errors
    /// A weight out of range, dimensions that are no group, a target of another number of dimensions.
    pub fn validate(&self) -> Result<(), TermError> {
        let is_weight = (1e-15..=1e15).contains(&self.weight);
        RangeError::check(is_weight, "the weight of a term", self.weight, "from 1e-15 to 1e15")?;
        // Whether the table has them is found out when there is one.
        GroupError::check(&self.dims, usize::MAX)?;
        match self.target.dims() {
            Some(target) if target != self.dims.len() => {
                Err(TermError::TargetDims { target, dims: self.dims.len() })
            }
            _ => Ok(()),
        }
    }

    fn uniform(classes: &Classes, role: Role, group: &DimensionGroup, share: f64) -> Self {
        Self {
            classes: classes.clone(),
            target: Target::UniformCube,
            dims: group.dims.clone(),
            weight: share * group.weight,
            role,
        }
    }
}

/// A kernel's companions, and what they pull on a sample from its own place as share of what the kernel does.
fn smaller(kernel: &Kernel) -> impl Iterator<Item = (Kernel, f64)> {
    let [near, pixel] = [SpatialKernel::Gaussian { sigma_px: 1.0 }, SpatialKernel::Box { size_px: 1 }];
    let in_space = [(kernel.spatial.clone(), 1.0), (near, NEAR), (pixel, PIXEL)];
    let mut in_time = vec![(kernel.temporal.clone(), 1.0)];
    if kernel.temporal != TemporalKernel::None {
        in_time.push((TemporalKernel::None, FRAME));
    }
    in_space.into_iter().flat_map(move |(spatial, share)| {
        let with = move |(temporal, of_time): (TemporalKernel, f64)| {
            (Kernel { spatial: spatial.clone(), temporal, ..kernel.clone() }, share * of_time)
        };
        in_time.clone().into_iter().map(with)
    })
}

const PIXEL: f64 = 0.25;
const NEAR: f64 = 0.25;
const FRAME: f64 = 0.6;

/// `Σw² / (Σw)²`: the squared error that a kernel leaves of white noise.
fn concentration(kernel: &Kernel, extent: &Extent) -> Option<f64> {
    let taps = kernel.taps(extent).ok()?;
    let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
    Some(taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum())
}

/// How slices are drawn.
///
/// ```
/// use fsot::config::Slicing;
/// use fsot::{Config, Extent};
///
/// let slicing = Slicing { batch_slices: Some(4096), ..Slicing::default() };
/// let config = Config::new(Extent::still(64, 64), 2).with_slicing(slicing);
/// # let _ = config;
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Slicing {
    /// Directions per filtered subset, `1..=16`. Sixteen ride in the lanes of one vector; fewer cost the
    /// same.
    pub directions: usize,
    /// Share of the directions that lie on coordinate axes, in `[0, 1]`. Axes replace whole frames: there are
    /// none for groups of more than `directions` dimensions and for subsets too large to share directions,
    /// such as the whole table. More sharpens one-dimensional marginals at the cost of all else.
    pub axis_share: f64,
    /// Slices per step. `None`: a sixteenth of an epoch, where an epoch visits every pixel of every frame
    /// once; in a point set `directions` slices of every class (of 16 classes of a term that has more).
    ///
    /// At most 2^22, or 16 per pixel and frame if that is more; and as many as hold 2^26 samples together
    /// in the mean, or 64 times those of the table. Where a sixteenth of an epoch would be more, as under
    /// filters as wide as a large table, it is that many.
    pub batch_slices: Option<usize>,
}

impl Default for Slicing {
    fn default() -> Self {
        Self { directions: LANES, axis_share: 0.0, batch_slices: None }
    }
}

impl Slicing {
    /// Directions of a subset in a group of so many dimensions: in one, all are the same.
    pub(crate) fn per_subset(&self, dims: usize) -> usize {
        if dims == 1 { 1 } else { self.directions }
    }

    /// Refuses settings by which no slice could be drawn.
    ///
    /// # Errors
    /// The first number that lies outside its range.
    pub fn validate(&self) -> Result<(), RangeError> {
        let Self { directions, axis_share, batch_slices } = *self;
        let is_good = (1..=LANES).contains(&directions);
        RangeError::check(is_good, "directions per subset", directions as f64, "from 1 to 16")?;
        RangeError::check((0.0..=1.0).contains(&axis_share), "the axis share", axis_share, "in [0, 1]")?;
        // How many are too many depends on what they hold.
        let is_good = batch_slices != Some(0);
        RangeError::check(is_good, "the batch size", 0.0, "of at least 1 slice")
    }
}
