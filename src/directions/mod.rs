//! Slicing directions of a dimension group, drawn for one subset at a time.

pub(crate) mod banks;
pub(crate) mod cube_bank;
pub(crate) mod frames;
pub(crate) mod target_bank;

use std::sync::Arc;

use rand::{Rng, RngExt};

use self::banks::Banks;
use self::cube_bank::{Block, CubeBank};
use self::target_bank::TargetBank;
use crate::simd::{LANES, Row};
use crate::targets::Target;

/// Draws the directions of subsets in one number of dimensions.
///
/// * One dimension has one direction.
/// * In the plane the directions of a subset divide the half circle evenly, from a phase that its caller
///   stratifies over the subsets of a step.
/// * In more dimensions they are rows of random orthonormal frames ([`CubeBank`]); orthonormal frames and
///   even angles are variance reduction over independent directions (Sisouk et al. 2025; Petrovic et al.
///   2025).
#[derive(Clone, Debug)]
pub(crate) struct Slicer {
    dims: usize,
    per_subset: usize,
    axis_share: f64,
    bank: Option<Arc<CubeBank>>,
    /// Directions and laws of a target other than the cube.
    target_bank: Option<Arc<TargetBank>>,
    /// Cosine and sine of evenly spaced angles, turned as one for each subset. Where their number is even,
    /// the second half of them are the first turned by a right angle, and not listed.
    fan: Vec<[f64; 2]>,
}

/// Directions of one subset: lanes `0..count` are unit vectors, the others zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct Directions {
    /// Directions in use.
    pub count: usize,
    /// Components, one row of lanes per dimension.
    pub theta: Vec<Row>,
    /// Block of the cube's bank that the lanes come from, in three and more dimensions.
    block: usize,
    /// Places in a target's bank that the lanes come from, if there is one.
    places: [u32; LANES],
    /// Lanes that were replaced by a coordinate axis.
    pub on_axis: [bool; LANES],
    /// Whether the upper half of the lanes holds the lower half turned by a right angle, in the plane: their
    /// laws are the same.
    pub paired: bool,
}

/// The laws of drawn directions, by lane.
#[derive(Clone, Copy)]
pub(crate) enum Laws<'a> {
    /// Of the cube, in one or two dimensions: a closed form of the components.
    Closed,
    /// Of the cube, in three or more: tabulated. A coordinate axis has the law of one dimension.
    Block {
        /// Where the directions come from.
        block: &'a Block,
        /// Lanes that are an axis instead.
        on_axis: &'a [bool; LANES],
    },
    /// Of another target.
    Pieces {
        /// Where the directions come from.
        bank: &'a TargetBank,
        /// Which of its directions.
        places: &'a [u32; LANES],
    },
}

impl Directions {
    fn look_up(&mut self, bank: &TargetBank, lane: usize, index: usize) {
        self.places[lane] = index as u32;
        self.theta.iter_mut().zip(bank.theta(index)).for_each(|(row, &component)| row[lane] = component);
    }
}

impl Slicer {
    /// Draws `per_subset` directions (`1..=LANES`; one in one dimension) for a target, of which the share
    /// `axis_share` lies on coordinate axes. The bank of a target other than the cube must have been planned.
    pub(crate) fn new(
        dims: usize,
        per_subset: usize,
        axis_share: f64,
        target: &Target,
        banks: &mut Banks,
    ) -> Self {
        let per_subset = per_subset.min(LANES);
        let (mut bank, mut target_bank) = (None, None);
        if *target != Target::UniformCube {
            target_bank = banks.of_target(dims, target);
            debug_assert!(target_bank.is_some(), "{target:?} was not planned");
        } else if dims > 2 {
            bank = Some(banks.of_cube(dims));
        }
        let mut slicer = Self { dims, per_subset, axis_share, bank, target_bank, fan: Vec::new() };
        let spacing = slicer.spacing();
        let listed = if per_subset.is_multiple_of(2) { per_subset / 2 } else { per_subset };
        slicer.fan.extend((0..listed).map(|lane| {
            let (sin, cos) = libm::sincos(spacing * lane as f64);
            [cos, sin]
        }));
        slicer
    }

    /// The laws of directions that this slicer has drawn.
    pub(crate) fn laws<'a>(&'a self, directions: &'a Directions) -> Laws<'a> {
        match (&self.target_bank, &self.bank) {
            (Some(bank), _) => Laws::Pieces { bank, places: &directions.places },
            (None, Some(bank)) => {
                Laws::Block { block: bank.block(directions.block), on_axis: &directions.on_axis }
            }
            (None, None) => Laws::Closed,
        }
    }

    pub(crate) fn per_subset(&self) -> usize {
        self.per_subset
    }

    /// Whether quantile cells are looked up in a bank of the cube's.
    pub(crate) fn is_tabulated(&self) -> bool {
        self.bank.is_some()
    }

    /// Whether [`Slicer::draw`] asks its generator for anything.
    pub(crate) fn is_random(&self) -> bool {
        self.bank.is_some() || self.axis_share > 0.0 && self.dims > 1
    }

    /// Draws directions; `phase` in `[0, 1)` turns the fan of the plane.
    pub(crate) fn draw(&self, phase: f64, generator: &mut impl Rng, directions: &mut Directions) {
        directions.count = self.per_subset;
        directions.paired = self.dims == 2 && self.per_subset == LANES && self.target_bank.is_none();
        directions.on_axis = [false; LANES];
        directions.theta.resize(self.dims, [0.0; LANES]);
        for row in &mut directions.theta {
            row[self.per_subset..].fill(0.0);
        }
        if let Some(bank) = &self.target_bank {
            for lane in 0..self.per_subset {
                directions.look_up(bank, lane, bank.index(phase, lane, self.per_subset));
            }
            if self.axis_share > 0.0 && self.dims > 1 {
                self.align(generator, directions);
            }
            return;
        }
        match &self.bank {
            None if self.dims == 1 => directions.theta[0][0] = 1.0,
            None => self.turn(phase, &mut directions.theta),
            Some(bank) => self.pick(bank, generator, directions),
        }
        if self.axis_share > 0.0 && self.dims > 1 {
            self.align(generator, directions);
        }
    }

    /// Angle between neighbours in the plane.
    fn spacing(&self) -> f64 {
        std::f64::consts::PI / self.per_subset as f64
    }

    fn turn(&self, phase: f64, theta: &mut [Row]) {
        // From `libm`, whose bits do not depend on the platform.
        let (sin, cos) = libm::sincos(self.spacing() * phase);
        let [across, along] = theta else { return };
        for (lane, [fixed_cos, fixed_sin]) in self.fan.iter().enumerate() {
            across[lane] = (fixed_cos * cos - fixed_sin * sin) as f32;
            along[lane] = (fixed_sin * cos + fixed_cos * sin) as f32;
        }
        for lane in self.fan.len()..self.per_subset {
            let half = lane - self.fan.len();
            (across[lane], along[lane]) = (-along[half], across[half]);
        }
    }

    fn pick(&self, bank: &CubeBank, generator: &mut impl Rng, directions: &mut Directions) {
        directions.block = generator.random_range(0..bank.len());
        let block = bank.block(directions.block);
        let signs: u64 = generator.random();
        // A random permutation of the axes by insertion (Fisher and Yates), without a buffer.
        for (dim, row) in block.theta.iter().enumerate() {
            let sign = if signs >> (dim % 64) & 1 == 0 { 1.0 } else { -1.0 };
            let place = generator.random_range(0..=dim);
            directions.theta.swap(place, dim);
            for (component, stored) in directions.theta[place].iter_mut().zip(row).take(self.per_subset) {
                *component = sign * stored;
            }
        }
    }

    /// Replaces whole frames by the coordinate axes, so that every axis gets its share.
    fn align(&self, generator: &mut impl Rng, directions: &mut Directions) {
        let frames = self.per_subset / self.dims;
        let wanted = self.axis_share * self.per_subset as f64 / self.dims as f64;
        let replaced = ((wanted + generator.random::<f64>()) as usize).min(frames);
        for frame in 0..replaced {
            for axis in 0..self.dims {
                // In the plane, directions half a fan apart are orthogonal; in a bank, frames are
                // consecutive.
                let lane = if self.dims == 2 { frame + axis * frames } else { frame * self.dims + axis };
                if let Some(bank) = &self.target_bank {
                    directions.look_up(bank, lane, bank.len() + axis);
                    continue;
                }
                directions.on_axis[lane] = true;
                for (dim, row) in directions.theta.iter_mut().enumerate() {
                    row[lane] = if dim == axis { 1.0 } else { 0.0 };
                }
            }
        }
    }
}
