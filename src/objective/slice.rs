//! The value and gradient of slices, in `f64`, as the textbook writes it.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::Objective;
use crate::error::{ObjectiveError, SliceError, TargetError};
use crate::laws::distance::Workspace;
use crate::table::domain::Domain;

/// One random draw of the objective: a class, a level, a direction.
///
/// ```
/// use fsot::objective::Slice;
/// use fsot::{Config, Extent, Objective};
///
/// let objective = Objective::new(&Config::new(Extent::still(2, 2), 1))?;
/// // All four samples of the first pixel's filter, along their only dimension.
/// let slice = Slice { term: 0, member: 0, level: 0.0, direction: vec![1.0], cut: vec![0.0] };
/// let found = objective.value_and_gradient(&[0.1, 0.4, 0.6, 0.9], &[slice])?;
/// assert!(found.value > 0.0 && found.gradient.len() == 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Which term of the objective.
    pub term: usize,
    /// Which class of the term's family: the number of the pixel (in C order over frames, rows, columns), of
    /// the frame, or 0 for the whole table.
    pub member: usize,
    /// Level `z` relative to the largest filter weight, in `[0, 1)`. The subset is `{j : w_j > z}`.
    pub level: f64,
    /// Direction, one component per dimension of the term; a unit vector unless you know why not.
    pub direction: Vec<f64>,
    /// Where each dimension of the term is cut open, in `[0, 1)`; used on a torus only.
    pub cut: Vec<f64>,
}

/// Samples of the slices that are transported before their displacements are added.
const MOST_TOUCHES: usize = 1 << 20;

struct Moved {
    cost: f64,
    samples: Vec<u32>,
    displacements: Vec<f64>,
}

/// What an objective is at some points, and how it changes from there.
///
/// ```
/// use fsot::{Config, Extent, Objective};
///
/// let objective = Objective::new(&Config::new(Extent::still(4, 4), 1))?;
/// let found = objective.cramer(&[0.5; 16])?;
/// assert!(found.value > 0.0 && found.gradient.len() == 16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ValueAndGradient {
    /// The value.
    pub value: f64,
    /// Its derivative with respect to every coordinate, in the order of the points.
    pub gradient: Vec<f64>,
}

impl Objective {
    /// Mean over `slices` of `(n / N) W2²`, times the weight of the class, and its gradient with respect to
    /// every coordinate, in `f64`.
    ///
    /// `points` are the coordinates of all samples in the order of [`crate::SampleTable`], in `[0, 1)`; the
    /// gradient has the same order. The weighted form replaces `n` by the sum of relative weights. An empty
    /// list of slices has value and gradient 0. O(slices × n log n), in parallel, with a fixed order of
    /// summation.
    ///
    /// # Errors
    /// A wrong number of points, a point outside `[0, 1)`, a slice that does not fit the objective or along
    /// which a target of the caller's own has no law.
    pub fn value_and_gradient(
        &self,
        points: &[f64],
        slices: &[Slice],
    ) -> Result<ValueAndGradient, ObjectiveError> {
        self.value_and_gradient_observed(points, slices, |_| ControlFlow::Continue(()))
    }

    /// The same, for whoever waits: `observe` is called from time to time with the share that is done, and
    /// may break off.
    ///
    /// # Errors
    /// As [`Objective::value_and_gradient`]; [`ObjectiveError::Stopped`] if `observe` breaks off.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use fsot::config::Role;
    /// use fsot::objective::ObjectiveError;
    /// use fsot::{Config, Extent, Objective};
    ///
    /// let objective = Objective::new(&Config::new(Extent::still(8, 8), 2))?;
    /// let (points, mut shares) = (vec![0.5; 128], Vec::new());
    /// let slices = objective.draw(7, 0, Role::Descend);
    /// let found = objective.value_and_gradient_observed(&points, &slices, |share| {
    ///     shares.push(share);
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(found, objective.value_and_gradient(&points, &slices)?);
    /// assert!(shares[0] == 0.0 && shares.is_sorted());
    /// let stopped = objective.value_and_gradient_observed(&points, &slices, |_| ControlFlow::Break(()));
    /// assert_eq!(stopped, Err(ObjectiveError::Stopped));
    /// # Ok::<(), ObjectiveError>(())
    /// ```
    pub fn value_and_gradient_observed(
        &self,
        points: &[f64],
        slices: &[Slice],
        mut observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<ValueAndGradient, ObjectiveError> {
        self.check_points(points)?;
        for (index, slice) in slices.iter().enumerate() {
            self.check_slice(slice).map_err(|problem| ObjectiveError::Slice { slice: index, problem })?;
        }
        let scale = 1.0 / (self.extent.samples() as f64 * slices.len().max(1) as f64);
        // Chunks bound the memory; their results are added in order, whatever the number of threads.
        let (mut value, mut gradient) = (0.0, vec![0.0; points.len()]);
        let largest = self.terms.iter().flat_map(|term| term.family.sizes()).max().unwrap_or(1);
        let per_chunk = (MOST_TOUCHES / largest).clamp(1, 4096);
        for (first, chunk) in (0..).step_by(per_chunk).zip(slices.chunks(per_chunk)) {
            if observe(first as f64 / slices.len() as f64).is_break() {
                return Err(ObjectiveError::Stopped);
            }
            let moved: Vec<_> = chunk.par_iter().map(|slice| self.transport(points, slice)).collect();
            for (slice, (number, moved)) in chunk.iter().zip((first..).zip(moved)) {
                let refused = |problem| ObjectiveError::Slice { slice: number, problem };
                let moved = moved.map_err(|problem| refused(problem.into()))?;
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
        Ok(ValueAndGradient { value, gradient })
    }

    /// The value alone, of points and slices that are known to fit.
    pub(crate) fn value<T: Copy + Into<f64> + Sync>(&self, points: &[T], slices: &[Slice]) -> f64 {
        let cost = |slice: &Slice| {
            let moved = self.transport(points, slice).map_or(f64::NAN, |moved| moved.cost);
            moved * self.emphasis(slice.term, slice.member)
        };
        let costs: Vec<f64> = slices.par_iter().map(cost).collect();
        costs.iter().sum::<f64>() / (self.extent.samples() as f64 * slices.len().max(1) as f64)
    }

    /// Transports one slice. Displacements are multiplied by the samples' masses, the cost by their sum.
    ///
    /// # Errors
    /// A target that has no law along the slice.
    fn transport<T: Copy + Into<f64>>(&self, points: &[T], slice: &Slice) -> Result<Moved, TargetError> {
        let term = &self.terms[slice.term];
        let mut samples = Vec::new();
        term.family.select(slice.member, slice.level, &mut samples);
        let mut projections = Vec::with_capacity(samples.len());
        self.project(points, slice, &samples, &mut projections);
        let law = term.spec.target.project(&slice.direction).sound(&slice.direction)?;
        let mut displacements = vec![0.0; samples.len()];
        let mut weights = Vec::new();
        term.family.weigh(slice.member, &mut weights);
        let given = term.family.is_weighted().then_some(weights.as_slice());
        let squared = Workspace::default().displacements(&law, &projections, given, &mut displacements);
        displacements.iter_mut().zip(&weights).for_each(|(displacement, weight)| *displacement *= weight);
        let mass = given.map_or(samples.len() as f64, |weights| weights.iter().sum());
        Ok(Moved { cost: mass * squared, samples, displacements })
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

    /// Refuses a list of another length, or a point outside the cube.
    pub(crate) fn check_points(&self, points: &[f64]) -> Result<(), ObjectiveError> {
        let expected = self.extent.samples() * self.dims;
        if points.len() != expected {
            return Err(ObjectiveError::PointCount { given: points.len(), expected });
        }
        match points.iter().position(|value| !(0.0..1.0).contains(value)) {
            Some(index) => Err(ObjectiveError::BadPoint { index, value: points[index] }),
            None => Ok(()),
        }
    }

    fn check_slice(&self, given: &Slice) -> Result<(), SliceError> {
        let below = |what, given, limit| {
            if given < limit { Ok(()) } else { Err(SliceError::NoSuch { what, given, limit }) }
        };
        below("term", given.term, self.terms.len())?;
        let term = &self.terms[given.term];
        below("member", given.member, term.family.members())?;
        let expected = term.spec.dims.len();
        for (what, vector) in [("direction", &given.direction), ("cut", &given.cut)] {
            if vector.len() != expected {
                return Err(SliceError::Components { what, given: vector.len(), expected });
            }
            if let Some(&value) = vector.iter().find(|value| !(-1e100..=1e100).contains(*value)) {
                return Err(SliceError::Value { what, value, expected: "finite values of reasonable size" });
            }
        }
        if !(0.0..1.0).contains(&given.level) {
            return Err(SliceError::Value {
                what: "level",
                value: given.level,
                expected: "a level in [0, 1)",
            });
        }
        Ok(())
    }
}
