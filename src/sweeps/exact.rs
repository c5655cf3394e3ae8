//! The closed form and its gradient in `f64`, written for clarity: the textbook twin of [`super::pairs`].

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::field::MeanDistance;
use super::mean_projection;
use crate::config::Role;
use crate::error::ObjectiveError;
use crate::kernel::autocorrelation;
use crate::objective::plan::PlannedTerm;
use crate::objective::{Objective, ValueAndGradient};
use crate::targets::watch::{Stopped, Watch};

/// Samples between two looks at whether to go on.
const AT_ONCE: usize = 1024;

impl Objective {
    /// All slices at once: the squared sliced Cramér distance between filtered samples and target, meant over
    /// pixels, and its gradient with respect to every coordinate, in `f64`.
    ///
    /// For a pixel with filter `w` it is the mean over directions `theta` of `∫ (F − G)² ds`, where `F` is
    /// the distribution function of the samples' projections, weighted by `w`, and `G` that of the cube: the
    /// squared filtered error of a half-space, meant over half-spaces. Terms in the role of [`Role::Descend`]
    /// are meant by weight. Exact, without random numbers; O(samples · pairs under a filter), run in
    /// parallel. `points` are the values of a table, in its order.
    ///
    /// # Errors
    /// A term without a closed form: one whose classes are not a lattice's, or that sees a torus. A list of
    /// another length than the table's, or values outside `[0, 1)`.
    pub fn cramer(&self, points: &[f64]) -> Result<ValueAndGradient, ObjectiveError> {
        self.cramer_observed(points, |_| ControlFlow::Continue(()))
    }

    /// The same, for whoever waits: `observe` is called from time to time with the share that is done, and
    /// may break off.
    ///
    /// # Errors
    /// As [`Objective::cramer`]; [`ObjectiveError::Stopped`] if `observe` breaks off.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use fsot::objective::ObjectiveError;
    /// use fsot::{Config, Extent, Objective};
    ///
    /// let objective = Objective::new(&Config::new(Extent::still(8, 8), 2))?;
    /// let (points, mut shares) = (vec![0.5; 128], Vec::new());
    /// let found = objective.cramer_observed(&points, |share| {
    ///     shares.push(share);
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(found, objective.cramer(&points)?);
    /// assert!(shares[0] == 0.0 && shares.is_sorted());
    /// let stopped = objective.cramer_observed(&points, |_| ControlFlow::Break(()));
    /// assert_eq!(stopped, Err(ObjectiveError::Stopped));
    /// # Ok::<(), ObjectiveError>(())
    /// ```
    pub fn cramer_observed(
        &self,
        points: &[f64],
        mut observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<ValueAndGradient, ObjectiveError> {
        super::check(self)?;
        self.check_points(points)?;
        let found = value_and_gradient(self, points, &mut Watch::new(&mut observe));
        found.map_err(|Stopped| ObjectiveError::Stopped)
    }
}

/// Mean over the descended terms by weight, and over the pixels (by the square of what their filter holds),
/// of the squared sliced Cramér distance; and its gradient.
fn value_and_gradient(
    objective: &Objective,
    points: &[f64],
    watch: &mut Watch,
) -> Result<ValueAndGradient, Stopped> {
    let (mut value, mut gradient) = (0.0, vec![0.0; points.len()]);
    let terms = || objective.terms.iter().filter(|term| term.spec.role == Role::Descend);
    let weights: f64 = terms().map(|term| term.spec.weight).sum();
    let count = terms().count() as f64;
    for (number, term) in terms().enumerate() {
        let watch = &mut watch.part(number as f64 / count, (number + 1) as f64 / count);
        let of_term = add_term(objective, term, points, watch, |coordinate, slope| {
            gradient[coordinate] += term.spec.weight / weights * slope;
        });
        value += term.spec.weight / weights * of_term?;
    }
    Ok(ValueAndGradient { value, gradient })
}

/// The value of one term; its gradient goes to `add(coordinate, slope)`.
fn add_term(
    objective: &Objective,
    term: &PlannedTerm,
    points: &[f64],
    watch: &mut Watch,
    mut add: impl FnMut(usize, f64),
) -> Result<f64, Stopped> {
    let (extent, dims) = (objective.extent, &term.spec.dims);
    let taps = term.family.taps().unwrap_or_default();
    let pairs = autocorrelation(taps, &extent, 0.0).expect("the taps of a planned kernel");
    let field = MeanDistance::new();
    let wants = |site: usize| objective.wanted.site(site);
    let samples_of = |site: usize| site * extent.spp..(site + 1) * extent.spp;
    let point = |sample: usize| -> Vec<f64> {
        dims.iter().map(|&dim| points[sample * objective.dims + dim]).collect()
    };
    // The sum over pixels of the squared sum of their filter, which normalises both filters and mean.
    let squared_masses: f64 = (0..extent.sites())
        .map(|site| {
            let at = extent.site(site);
            let lands = taps.iter().filter(|tap| {
                wants(extent.site_index(extent.wrapped(at, (tap.dt.into(), tap.dy.into(), tap.dx.into()))))
            });
            (lands.map(|tap| tap.weight).sum::<f64>() * extent.spp as f64).powi(2)
        })
        .sum();
    let scale = mean_projection(dims.len()) / squared_masses;
    let one = |sample: usize| {
        let own = point(sample);
        let (mut held, mut distances, mut slope) = (0.0, 0.0, vec![0.0; dims.len()]);
        let at = extent.site(sample / extent.spp);
        for tap in &pairs {
            let offset = (tap.dt.into(), tap.dy.into(), tap.dx.into());
            let site = extent.site_index(extent.wrapped(at, offset));
            for other in samples_of(site).filter(|_| wants(site)) {
                held += tap.weight;
                let other = point(other);
                let squares: f64 = own.iter().zip(&other).map(|(a, b)| (a - b) * (a - b)).sum();
                let distance = squares.sqrt();
                distances += tap.weight * distance;
                if distance > 0.0 {
                    for ((slope, a), b) in slope.iter_mut().zip(&own).zip(&other) {
                        *slope -= tap.weight * (a - b) / distance;
                    }
                }
            }
        }
        let mut outward = vec![0.0; dims.len()];
        field.gradient(&own, &mut outward);
        slope.iter_mut().zip(&outward).for_each(|(slope, outward)| *slope += held * outward);
        (held * field.value(&own) - 0.5 * distances, slope)
    };
    let wanted: Vec<usize> = (0..extent.sites()).filter(|&site| wants(site)).flat_map(samples_of).collect();
    let mut parts = Vec::with_capacity(wanted.len());
    for together in wanted.chunks(AT_ONCE) {
        watch.tell(parts.len() as f64 / wanted.len() as f64)?;
        parts.par_extend(together.par_iter().map(|&sample| one(sample)));
    }
    let mut value = -0.5 * field.mean(dims.len()) * squared_masses;
    for (&sample, (part, slopes)) in wanted.iter().zip(parts) {
        value += part;
        for (&dim, slope) in dims.iter().zip(slopes) {
            add(sample * objective.dims + dim, scale * slope);
        }
    }
    Ok(scale * value)
}
