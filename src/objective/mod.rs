//! What is optimised: weighted terms, and the value and gradient of their slices.

pub(crate) mod plan;

use rayon::prelude::*;

use crate::classes::demand::Demand;
use crate::classes::{Classes, Wanted};
use crate::config::term::{Role, Slicing, Term};
use crate::directions::banks::Banks;
use crate::error::ConfigError;
use crate::kernel::Tap;
use crate::laws::distance::Workspace;
use crate::objective::plan::{PlannedTerm, classes, share_work};
use crate::random::kronecker_steps;
use crate::sweeps;
use crate::table::SampleTable;
use crate::table::domain::Domain;
use crate::table::extent::Extent;

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
    pub(crate) wanted: Wanted,
}

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
        let (mut planned, mut banks) = (Vec::new(), Banks::default());
        for (index, term) in terms.iter().enumerate() {
            planned.extend(PlannedTerm::new(
                index,
                term,
                extent,
                domains,
                slicing,
                wanted.clone(),
                &mut banks,
            )?);
        }
        if planned.is_empty() {
            return Err(ConfigError::NoDemand);
        }
        share_work(&mut planned, extent, slicing);
        Ok(Self { extent, dims, domains: domains.to_vec(), terms: planned, wanted })
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

    /// Whether some balance is over parts of a table that another one holds together.
    pub(crate) fn balances_are_nested(&self) -> bool {
        let balances = || self.terms.iter().filter(|term| term.spec.role == Role::Balance);
        balances().any(|term| term.family.visited() > 1) && balances().any(|term| term.family.visited() == 1)
    }

    /// Slices of lattice terms that a step draws per visited pixel and frame, in the mean; per class where none of the
    /// terms has classes per pixel.
    pub(crate) fn slices_per_class_and_step(&self) -> f64 {
        let steady: Vec<_> =
            self.terms.iter().filter(|term| term.steady && term.spec.role == Role::Descend).collect();
        if !steady.is_empty() {
            let slices: f64 = steady.iter().map(|term| term.slices()).sum();
            return slices / steady.iter().map(|term| term.family.visited()).sum::<usize>() as f64;
        }
        let slices = |term: &PlannedTerm| match term.spec.classes {
            Classes::Lattice { .. } => term.slices(),
            _ => 0.0,
        };
        let lattice: f64 = self.terms.iter().map(slices).sum();
        if lattice > 0.0 {
            return lattice / classes(&self.terms, self.extent) as f64;
        }
        let descended = |term: &&PlannedTerm| term.spec.role == Role::Descend;
        let any = self.terms.iter().any(|term| descended(&term));
        let counted = || self.terms.iter().filter(|term| !any || descended(term));
        let slices: f64 = counted().map(PlannedTerm::slices).sum();
        slices / counted().map(|term| term.family.visited()).sum::<usize>() as f64
    }

    /// All slices at once: the squared sliced Cramér distance between filtered samples and target, meant over pixels, and
    /// its gradient with respect to every coordinate, in `f64`.
    ///
    /// For a pixel with filter `w` it is the mean over directions `theta` of
    /// `∫ (F − G)² ds`, where `F` is the distribution function of the samples' projections, weighted by `w`, and `G` that
    /// of the cube: the squared filtered error of a half-space, meant over half-spaces. Terms in the role of
    /// [`Role::Descend`] are meant by weight. Exact, without random numbers; O(samples · pairs under a filter), run in
    /// parallel. `points` are the values of a table, in its order.
    ///
    /// # Errors
    /// A term without a closed form: one whose classes are not a lattice's, or that sees a torus. A list of another
    /// length than the table's, or values outside `[0, 1)`.
    pub fn cramer(&self, points: &[f64]) -> Result<(f64, Vec<f64>), ConfigError> {
        sweeps::check(self)?;
        self.check_points(points)?;
        Ok(sweeps::value_and_gradient(self, points))
    }

    /// Mean over `slices` of `(n / N) W2²`, times the weight of the class, and its gradient with respect to every coordinate, in `f64`.
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
        let largest = self.terms.iter().flat_map(|term| term.family.sizes()).max().unwrap_or(1);
        for slices in slices.chunks((MOST_TOUCHES / largest).clamp(1, 4096)) {
            let moved: Vec<_> = slices.par_iter().map(|slice| self.transport(points, slice)).collect();
            for (slice, moved) in slices.iter().zip(moved) {
                let dims = &self.terms[slice.term].spec.dims;
                let scale = scale * self.emphasis(slice.term, slice.member);
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
    pub(crate) fn project<T: Copy + Into<f64>>(
        &self,
        points: &[T],
        slice: &Slice,
        samples: &[u32],
        projections: &mut Vec<f64>,
    ) {
        let dims = &self.terms[slice.term].spec.dims;
        projections.clear();
        projections.extend(samples.iter().map(|&sample| {
            let point = &points[sample as usize * self.dims..][..self.dims];
            let along = |(i, &dim): (usize, &usize)| {
                let value = match self.domains[dim] {
                    Domain::Interval => point[dim].into(),
                    Domain::Torus => (point[dim].into() - slice.cut[i]).rem_euclid(1.0),
                };
                value * slice.direction[i]
            };
            dims.iter().enumerate().map(along).sum::<f64>()
        }));
    }

    /// Places samples by their targets: each by that of the smallest classes that hold it, whose samples become a Kronecker
    /// sequence at a random place, jittered by some distances between neighbours and warped into the target. Parts of a
    /// target then hold as many samples as they should, up to a few: no slice brings one from one part to another
    /// without leaving others on the way.
    pub(crate) fn place(&self, points: &mut [f32]) {
        let mut terms: Vec<&PlannedTerm> =
            self.terms.iter().filter(|term| term.spec.role == Role::Descend).collect();
        if terms.iter().all(|term| term.spec.target.warp().is_none()) {
            return;
        }
        terms.sort_by(|a, b| b.family.mean_size().total_cmp(&a.family.mean_size()));
        let noise = points.to_vec();
        let (mut samples, mut place) = (Vec::new(), Vec::new());
        for term in terms {
            let Some(warp) = term.spec.target.warp() else { continue };
            let steps = kronecker_steps(term.spec.dims.len());
            for index in 0..term.family.visited() {
                term.family.select(term.family.visited_member(index), 0.0, &mut samples);
                let Some(&origin) = samples.first() else { continue };
                let shift = |dim: &usize| f64::from(noise[origin as usize * self.dims + dim]);
                let apart = JITTER * (samples.len() as f64).powf(-1.0 / steps.len() as f64);
                for (rank, &sample) in samples.iter().enumerate() {
                    let first = sample as usize * self.dims;
                    let jitter = |dim: &usize| apart * f64::from(noise[first + dim]);
                    let along = term.spec.dims.iter().map(|dim| shift(dim) + jitter(dim)).zip(&steps);
                    place.clear();
                    place.extend(along.map(|(start, step)| (start + rank as f64 * step).fract()));
                    warp.place(&mut place);
                    for (dim, place) in term.spec.dims.iter().zip(&place) {
                        points[first + dim] = Domain::Interval.admit(*place as f32);
                    }
                }
            }
        }
    }

    /// Factor on what the slices of a class pull.
    #[inline(always)]
    pub(crate) fn emphasis(&self, term: usize, member: usize) -> f64 {
        let term = &self.terms[term];
        term.pull * term.family.emphasis(member)
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

/// Samples of the slices that are transported before their displacements are added.
const MOST_TOUCHES: usize = 1 << 20;

struct Moved {
    cost: f64,
    samples: Vec<u32>,
    displacements: Vec<f64>,
}

/// Jitter of a start, in distances between neighbours: with less, the order of the sequence stays visible.
const JITTER: f64 = 3.0;
