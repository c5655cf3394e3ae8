//! What is optimised: weighted terms, and the value and gradient of their slices.

use std::collections::{BTreeMap, BTreeSet};

use rand::RngExt;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::bank::Boundary;
use crate::class::{Classes, Family, Form, Wanted};
use crate::demand::Demand;
use crate::direction::{Directions, Slicer};
use crate::domain::Domain;
use crate::error::ConfigError;
use crate::kernel::{Kernel, Tap};
use crate::lanes::{LANES, LONGEST};
use crate::lattice::{Extent, MOST_DIMS};
use crate::network::Network;
use crate::stream::{self, Purpose};
use crate::table::SampleTable;
use crate::target::Target;
use crate::transport::Workspace;

/// One part of the objective: a family of classes, what their samples should resemble, and in which dimensions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// The filters.
    pub classes: Classes,
    /// The measure that a filtered subset should resemble.
    pub target: Target,
    /// The dimensions that this term sees, as a renderer consumes them together.
    pub dims: Vec<usize>,
    /// Share of the work: the number of slices that touch a sample is proportional to it, in the mean. Positive.
    pub weight: f64,
    /// How its slices move the samples.
    pub role: Role,
}

/// How the slices of a term move the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// All such terms together are descended.
    #[default]
    Descend,
    /// After each step of the descent, samples move all the way to their targets along the slices of the term
    /// (times [`crate::Config::balance`]): alternating projections rather than a compromise of weights. Meant for few
    /// slices of large classes, whose small but systematic displacements a compromise would drown.
    Balance,
}

/// A group of dimensions that a renderer consumes together, with its share of the work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DimensionGroup {
    /// Dimensions of the table, each once.
    pub dims: Vec<usize>,
    /// Weight relative to the other groups; positive.
    pub weight: f64,
}

impl DimensionGroup {
    /// Consecutive pairs of dimensions with weight 1 (a last odd one alone), and all dimensions together with half
    /// that weight if there are more than two. No table has more than 1024 dimensions; more are left out.
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

/// How slices are drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slicing {
    /// Directions per filtered subset, `1..=16`. Sixteen ride in the lanes of one vector; fewer cost the same.
    pub directions: usize,
    /// Share of the directions that lie on coordinate axes, in `[0, 1]`, for groups of at most `directions`
    /// dimensions. More sharpens one-dimensional marginals at the cost of all else.
    pub axis_share: f64,
    /// Slices per step. `None`: a sixteenth of an epoch, where an epoch visits every pixel of every frame once.
    pub batch_slices: Option<usize>,
}

impl Default for Slicing {
    fn default() -> Self {
        Self { directions: LANES, axis_share: 0.0, batch_slices: None }
    }
}

/// One random draw of the objective: a class, a level, a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Which term of the objective.
    pub term: usize,
    /// Which class of the term's family: the number of the pixel (in C order over frames, rows, columns), of the
    /// frame, or 0 for the whole table.
    pub member: usize,
    /// Level `z` relative to the largest filter weight, in `[0, 1)`. The subset is `{j : w_j > z}`.
    pub level: f64,
    /// Direction, one component per dimension of the term; a unit vector unless you know why not.
    pub direction: Vec<f64>,
    /// Where each dimension of the term is cut open, in `[0, 1)`; used on a torus only.
    pub cut: Vec<f64>,
}

/// An objective planned for one extent.
///
/// Its value is the mean over slices of `(n / N) · W2²(X_S · theta, mu · theta)`: the level-set objective of Salaün
/// et al. 2022 with the squared 2-Wasserstein distance as the one-dimensional cost, whose gradient exists.
#[derive(Clone, Debug)]
pub struct Objective {
    pub(crate) extent: Extent,
    pub(crate) dims: usize,
    pub(crate) domains: Vec<Domain>,
    pub(crate) terms: Vec<PlannedTerm>,
}

#[derive(Clone, Debug)]
pub(crate) struct PlannedTerm {
    pub spec: Term,
    pub family: Family,
    pub slicer: Slicer,
    /// Networks and quantile cells of the subset sizes that are sorted in lanes. A subset of another size takes the
    /// next larger network.
    pub sizes: BTreeMap<usize, SizePlan>,
    /// Subsets drawn per step; need not be whole.
    pub rate: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct SizePlan {
    pub network: Network,
    /// Boundaries of the quantile cells, where laws are tabulated.
    pub grid: Vec<Boundary>,
}

/// One subset of a step, before its samples and directions are looked up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draw {
    pub term: u32,
    pub member: u32,
    pub level: f64,
    pub phase: f64,
    /// Term, and number within its step: names the subset's generator.
    pub name: u64,
}

/// The order in which a term visits its classes: a new random permutation each epoch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Order {
    epoch: Option<u64>,
    members: Vec<u32>,
}

/// Share of the work that goes to the whole table, and to its frames, relative to the kernels.
const BALANCE_WEIGHT: f64 = 0.03;

impl Objective {
    /// Checks and plans the terms.
    ///
    /// `domains` holds one entry per dimension of the table.
    ///
    /// # Errors
    /// An empty or oversized extent, a wrong number of domains, no terms, a weight that is not positive and finite,
    /// a dimension group that is empty, repeats or exceeds the table's dimensions, a kernel without a positive
    /// weight, slicing parameters outside their ranges.
    pub fn new(
        extent: Extent,
        dims: usize,
        domains: &[Domain],
        terms: &[Term],
        slicing: &Slicing,
    ) -> Result<Self, ConfigError> {
        Self::planned(extent, dims, domains, terms, slicing, Wanted::All)
    }

    /// The same for the part of a table that a renderer will really consume.
    ///
    /// A demand of other width, height or frames is folded onto the table first, which tiles it. Samples of other sites
    /// and dimensions outside the demanded groups belong to no class any more: a subset holds its demanded samples
    /// alone, whose errors are the only ones that a filter sees; terms lose the dimensions that are not demanded, and
    /// classes without a demanded sample are never drawn. The cost is in proportion to what is left.
    ///
    /// # Errors
    /// As [`Objective::new`]; a demand for dimensions that the table does not have; a demand for nothing.
    pub fn for_demand(
        extent: Extent,
        dims: usize,
        domains: &[Domain],
        terms: &[Term],
        slicing: &Slicing,
        demand: &Demand,
    ) -> Result<Self, ConfigError> {
        extent.validate(dims)?;
        for (group, dimensions) in demand.groups().iter().enumerate() {
            if let Some(&dimension) = dimensions.iter().find(|&&dimension| dimension >= dims) {
                return Err(ConfigError::NoSuchDimension { group, dimension, dims });
            }
        }
        let folded = demand.folded(&extent)?;
        let mut terms = terms.to_vec();
        for term in &mut terms {
            // A group of the caller's that is empty or names no dimension of the table is still an error below.
            if term.dims.iter().all(|&dim| dim < dims) && !term.dims.is_empty() {
                term.dims.retain(|dim| demand.groups().iter().flatten().any(|demanded| demanded == dim));
                if term.dims.is_empty() {
                    term.weight = 0.0;
                }
            }
        }
        terms.retain(|term| term.weight != 0.0 || !term.dims.is_empty());
        if terms.is_empty() || folded.count() == 0 {
            return Err(ConfigError::NoDemand);
        }
        Self::planned(extent, dims, domains, &terms, slicing, Wanted::Some(folded.pixels().into()))
    }

    fn planned(
        extent: Extent,
        dims: usize,
        domains: &[Domain],
        terms: &[Term],
        slicing: &Slicing,
        wanted: Wanted,
    ) -> Result<Self, ConfigError> {
        extent.validate(dims)?;
        if domains.len() != dims {
            return Err(ConfigError::DomainCount { given: domains.len(), dims });
        }
        if terms.is_empty() {
            return Err(ConfigError::NoTerms);
        }
        slicing.validate()?;
        let mut planned = Vec::new();
        for (index, term) in terms.iter().enumerate() {
            planned.push(PlannedTerm::new(index, term, extent, dims, slicing, wanted.clone())?);
        }
        let classes = classes(&planned, extent);
        let slices = slicing.batch_slices.unwrap_or_else(|| (classes * slicing.directions).div_ceil(16));
        // Touches are shared by weight; a slice touches as many samples as its subset holds.
        let slices_of = |term: &PlannedTerm| term.spec.weight / term.family.mean_size();
        let total: f64 = planned.iter().map(slices_of).sum();
        for term in &mut planned {
            term.rate = slices_of(term) / total * slices as f64 / term.slicer.per_subset() as f64;
        }
        Ok(Self { extent, dims, domains: domains.to_vec(), terms: planned })
    }

    /// The terms for blue-noise error: each group under each kernel, and as much of the whole table and of each
    /// frame as keeps them unbiased.
    pub fn blue_noise(
        kernels: &[Kernel],
        form: Form,
        groups: &[DimensionGroup],
        extent: &Extent,
    ) -> Vec<Term> {
        let mut terms = Vec::new();
        let mut add = |classes: Classes, role: Role, share: f64| {
            for group in groups {
                terms.push(Term {
                    classes: classes.clone(),
                    target: Target::UniformCube,
                    dims: group.dims.clone(),
                    weight: share * group.weight,
                    role,
                });
            }
        };
        for kernel in kernels {
            add(Classes::Lattice { kernel: kernel.clone(), form }, Role::Descend, 1.0 / kernels.len() as f64);
        }
        add(Classes::WholeTable, Role::Balance, BALANCE_WEIGHT);
        if extent.frames > 1 {
            add(Classes::PerFrame, Role::Balance, BALANCE_WEIGHT);
        }
        terms
    }

    /// Frames, height, width and samples per pixel of the tables that this objective is planned for.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Dimensions of a sample.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The terms as they were given.
    pub fn terms(&self) -> impl Iterator<Item = &Term> {
        self.terms.iter().map(|term| &term.spec)
    }

    /// The folded taps of a term's kernel, by falling weight; `None` for families without one.
    pub fn taps(&self, term: usize) -> Option<&[Tap]> {
        self.terms.get(term)?.family.taps()
    }

    /// Slices of lattice terms that a step draws per visited pixel and frame, in the mean.
    pub(crate) fn slices_per_class_and_step(&self) -> f64 {
        let slices = |term: &PlannedTerm| match term.spec.classes {
            Classes::Lattice { .. } => term.rate * term.slicer.per_subset() as f64,
            _ => 0.0,
        };
        let lattice: f64 = self.terms.iter().map(slices).sum();
        let all: f64 = self.terms.iter().map(|term| term.rate * term.slicer.per_subset() as f64).sum();
        (if lattice > 0.0 { lattice } else { all }) / classes(&self.terms, self.extent) as f64
    }

    /// The subsets that the terms of a role draw in a step. `orders` keeps the permutations between steps.
    pub(crate) fn draw_subsets(
        &self,
        seed: u64,
        step: u64,
        role: Role,
        orders: &mut Vec<Order>,
        draws: &mut Vec<Draw>,
    ) {
        orders.resize_with(self.terms.len(), Order::default);
        draws.clear();
        for (index, (term, order)) in self.terms.iter().zip(orders).enumerate() {
            if term.spec.role != role {
                continue;
            }
            let begin = (step as f64 * term.rate) as u64;
            let end = ((step + 1) as f64 * term.rate) as u64;
            let mut generator = stream::generator(seed, Purpose::Strata, step, index as u64);
            let turn: f64 = generator.random();
            let members = term.family.visited() as u64;
            for visit in begin..end {
                order.turn_to(seed, index as u64, visit / members, &term.family);
                let (i, strata) = ((visit - begin) as f64, (end - begin) as f64);
                draws.push(Draw {
                    term: index as u32,
                    member: order.members[(visit % members) as usize],
                    // Jittered strata of the level against a rotated golden-ratio sequence of the phase.
                    level: ((i + generator.random::<f64>()) / strata).min(1.0 - f64::EPSILON),
                    phase: (turn + i * GOLDEN_RATIO).fract(),
                    name: (index as u64) << 32 | (visit - begin),
                });
            }
        }
    }

    /// Directions and torus cuts of a subset.
    pub(crate) fn draw_directions(
        &self,
        seed: u64,
        step: u64,
        draw: &Draw,
        directions: &mut Directions,
        cut: &mut Vec<Option<f32>>,
    ) {
        let term = &self.terms[draw.term as usize];
        let mut generator = stream::generator(seed, Purpose::Subset, step, draw.name);
        term.slicer.draw(draw.phase, &mut generator, directions);
        cut.clear();
        cut.extend(term.spec.dims.iter().map(|&dim| match self.domains[dim] {
            Domain::Interval => None,
            Domain::Torus => Some(generator.random()),
        }));
    }

    /// The slices that the terms of a role draw in step `step` of an optimisation with this seed, one by one.
    pub fn draw(&self, seed: u64, step: u64, role: Role) -> Vec<Slice> {
        let (mut orders, mut draws) = (Vec::new(), Vec::new());
        let (mut directions, mut cut) = (Directions::default(), Vec::new());
        self.draw_subsets(seed, step, role, &mut orders, &mut draws);
        let mut slices = Vec::new();
        for draw in &draws {
            self.draw_directions(seed, step, draw, &mut directions, &mut cut);
            slices.extend((0..directions.count).map(|lane| Slice {
                term: draw.term as usize,
                member: draw.member as usize,
                level: draw.level,
                direction: directions.theta.iter().map(|row| f64::from(row[lane])).collect(),
                cut: cut.iter().map(|cut| f64::from(cut.unwrap_or(0.0))).collect(),
            }));
        }
        slices
    }

    /// Mean over `slices` of `(n / N) W2²` and its gradient with respect to every coordinate, in `f64`.
    ///
    /// `points` are the coordinates of all samples in the order of [`crate::SampleTable`], in `[0, 1)`; the gradient has
    /// the same order. The weighted form replaces `n` by the sum of relative weights. An empty list of slices has
    /// value and gradient 0. O(slices × n log n), in parallel, with a fixed order of summation.
    ///
    /// # Errors
    /// A wrong number of points, a point outside `[0, 1)`, a slice that does not fit the objective.
    pub fn value_and_gradient(
        &self,
        points: &[f64],
        slices: &[Slice],
    ) -> Result<(f64, Vec<f64>), ConfigError> {
        self.check_points(points)?;
        for (index, slice) in slices.iter().enumerate() {
            self.check_slice(index, slice)?;
        }
        let scale = 1.0 / (self.extent.samples() as f64 * slices.len().max(1) as f64);
        // Chunks bound the memory; their results are added in order, whatever the number of threads.
        let (mut value, mut gradient) = (0.0, vec![0.0; points.len()]);
        for slices in slices.chunks(4096) {
            let moved: Vec<_> = slices.par_iter().map(|slice| self.transport(points, slice)).collect();
            for (slice, moved) in slices.iter().zip(moved) {
                let dims = &self.terms[slice.term].spec.dims;
                value += scale * moved.cost;
                for (&sample, displacement) in moved.samples.iter().zip(moved.displacements) {
                    for (&dim, component) in dims.iter().zip(&slice.direction) {
                        gradient[sample as usize * self.dims + dim] -= 2.0 * scale * displacement * component;
                    }
                }
            }
        }
        Ok((value, gradient))
    }

    /// Transports one slice. Displacements are multiplied by the samples' masses, the cost by their sum.
    fn transport(&self, points: &[f64], slice: &Slice) -> Moved {
        let term = &self.terms[slice.term];
        let mut samples = Vec::new();
        term.family.select(slice.member, slice.level, &mut samples);
        let mut projections = Vec::with_capacity(samples.len());
        self.project(points, slice, &samples, &mut projections);
        let law = term.spec.target.project(&slice.direction);
        let mut displacements = vec![0.0; samples.len()];
        let mut weights = Vec::new();
        term.family.weigh(slice.member, &mut weights);
        let given = term.family.is_weighted().then_some(weights.as_slice());
        let squared = Workspace::default().displacements(&law, &projections, given, &mut displacements);
        displacements.iter_mut().zip(&weights).for_each(|(displacement, weight)| *displacement *= weight);
        let mass = given.map_or(samples.len() as f64, |weights| weights.iter().sum());
        Moved { cost: mass * squared, samples, displacements }
    }

    /// Projections of the listed samples on the slice's direction, after cutting open the torus dimensions.
    pub(crate) fn project(&self, points: &[f64], slice: &Slice, samples: &[u32], projections: &mut Vec<f64>) {
        let dims = &self.terms[slice.term].spec.dims;
        projections.clear();
        projections.extend(samples.iter().map(|&sample| {
            let point = &points[sample as usize * self.dims..][..self.dims];
            let along = |(i, &dim): (usize, &usize)| {
                let value = match self.domains[dim] {
                    Domain::Interval => point[dim],
                    Domain::Torus => (point[dim] - slice.cut[i]).rem_euclid(1.0),
                };
                value * slice.direction[i]
            };
            dims.iter().enumerate().map(along).sum::<f64>()
        }));
    }

    /// Refuses a table of another shape, also one that holds as many values.
    pub(crate) fn check_table(&self, table: &SampleTable) -> Result<(), ConfigError> {
        let Extent { frames, height, width, spp } = self.extent;
        let [given, expected] = [table.shape(), [frames, height, width, spp, self.dims]].map(Box::new);
        if given == expected { Ok(()) } else { Err(ConfigError::OtherShape { given, expected }) }
    }

    fn check_points(&self, points: &[f64]) -> Result<(), ConfigError> {
        let expected = self.extent.samples() * self.dims;
        if points.len() != expected {
            return Err(ConfigError::ValueCount {
                what: "the list of points",
                given: points.len(),
                expected,
            });
        }
        match points.iter().position(|value| !(0.0..1.0).contains(value)) {
            Some(index) => Err(ConfigError::BadPoint { index, value: points[index] }),
            None => Ok(()),
        }
    }

    fn check_slice(&self, slice: usize, given: &Slice) -> Result<(), ConfigError> {
        let below = |what, given, limit| {
            if given < limit { Ok(()) } else { Err(ConfigError::BadSlice { slice, what, given, limit }) }
        };
        below("term", given.term, self.terms.len())?;
        let term = &self.terms[given.term];
        below("member", given.member, term.family.members())?;
        let expected = term.spec.dims.len();
        for (what, vector) in [("direction", &given.direction), ("cut", &given.cut)] {
            if vector.len() != expected {
                return Err(ConfigError::SliceShape { slice, what, given: vector.len(), expected });
            }
            if let Some(&value) = vector.iter().find(|value| !(-1e100..=1e100).contains(*value)) {
                let expected = "finite values of reasonable size";
                return Err(ConfigError::SliceValue { slice, what, value, expected });
            }
        }
        if !(0.0..1.0).contains(&given.level) {
            let expected = "a level in [0, 1)";
            return Err(ConfigError::SliceValue { slice, what: "level", value: given.level, expected });
        }
        Ok(())
    }
}

struct Moved {
    cost: f64,
    samples: Vec<u32>,
    displacements: Vec<f64>,
}

/// Fractional part of the golden ratio: multiples of it are evenly spread for any count (Weyl, van der Corput).
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_8;

impl Order {
    fn turn_to(&mut self, seed: u64, term: u64, epoch: u64, family: &Family) {
        if self.epoch != Some(epoch) {
            self.epoch = Some(epoch);
            family.list_visited(&mut self.members);
            self.members.shuffle(&mut stream::generator(seed, Purpose::Order, epoch, term));
        }
    }
}

impl Slicing {
    fn validate(&self) -> Result<(), ConfigError> {
        let out_of_range = |name, value, expected| Err(ConfigError::OutOfRange { name, value, expected });
        if !(1..=LANES).contains(&self.directions) {
            return out_of_range("directions per subset", self.directions as f64, "from 1 to 16");
        }
        if !(0.0..=1.0).contains(&self.axis_share) {
            return out_of_range("the axis share", self.axis_share, "in [0, 1]");
        }
        if self.batch_slices == Some(0) {
            return out_of_range("the batch size", 0.0, "of at least 1 slice");
        }
        Ok(())
    }
}

impl PlannedTerm {
    fn new(
        index: usize,
        term: &Term,
        extent: Extent,
        dims: usize,
        slicing: &Slicing,
        wanted: Wanted,
    ) -> Result<Self, ConfigError> {
        if !(term.weight > 0.0 && term.weight.is_finite()) {
            let expected = "above 0 and finite";
            return Err(ConfigError::OutOfRange {
                name: "the weight of a term",
                value: term.weight,
                expected,
            });
        }
        if term.dims.is_empty() {
            return Err(ConfigError::EmptyGroup { group: index });
        }
        for (place, &dimension) in term.dims.iter().enumerate() {
            if dimension >= dims {
                return Err(ConfigError::NoSuchDimension { group: index, dimension, dims });
            }
            if term.dims[..place].contains(&dimension) {
                return Err(ConfigError::RepeatedDimension { group: index, dimension });
            }
        }
        let family = Family::new(&term.classes, extent, wanted)?;
        let sizes = family.sizes();
        // A subset that is not sorted in lanes gains nothing from sharing its directions.
        let long = sizes[0] > LONGEST;
        let per_subset = if long { 1 } else { slicing.directions };
        let slicer = Slicer::new(term.dims.len(), per_subset, slicing.axis_share, &term.target);
        let in_lanes = !family.is_weighted() && slicer.per_subset() > 1;
        let sizes: BTreeSet<usize> = match sizes.last() {
            _ if !in_lanes => BTreeSet::new(),
            Some(&largest) if family.is_partial() => partial_sizes(largest.min(LONGEST)).collect(),
            _ => sizes.into_iter().filter(|&size| size <= LONGEST).collect(),
        };
        let plan = |n: usize| {
            let grid = if slicer.bank().is_some() { Boundary::grid(n).collect() } else { Vec::new() };
            (n, SizePlan { network: Network::new(n), grid })
        };
        let sizes = sizes.into_iter().map(plan).collect();
        Ok(Self { spec: term.clone(), family, slicer, sizes, rate: 0.0 })
    }
}

/// Pixels and frames that the kernels visit; all of them if there is no kernel.
fn classes(terms: &[PlannedTerm], extent: Extent) -> usize {
    let visited = terms.iter().filter(|term| term.family.taps().is_some()).map(|term| term.family.visited());
    visited.max().unwrap_or(extent.sites())
}

/// Sizes to plan for where any up to `largest` may occur: all of the small ones, then steps of a tenth.
fn partial_sizes(largest: usize) -> impl Iterator<Item = usize> {
    let next = |&size: &usize| (size < usize::MAX / 2).then(|| size + (size / 10).max(1));
    std::iter::successors(Some(1), next).take_while(move |&size| size < largest).chain([largest])
}
