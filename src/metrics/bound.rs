//! The objective's value with exact one-dimensional distances, and its ratio to white noise.

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::error::MeasureError;
use super::samples::{Samples, Values};
use crate::error::{RangeError, TargetError};
use crate::files::metadata::BoundEstimate;
use crate::laws::distance::Workspace;
use crate::objective::{Objective, Slice};
use crate::random::{self, Purpose};
use crate::table::extent::Extent;
use crate::targets::Target;

/// The bound on the filtered error of samples, measured on random slices.
///
/// ```
/// use fsot::metrics::Bound;
/// use fsot::{Config, Extent, Optimizer};
///
/// let optimizer = Optimizer::new(Config::new(Extent { frames: 1, height: 16, width: 16, spp: 1 }, 2))?;
/// let of_white_noise = Bound::measure(&optimizer.table(), optimizer.objective(), 0, 1024)?;
/// assert!((0.5..1.5).contains(&of_white_noise.total.ratio_to_white_noise));
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bound {
    /// The whole objective: the terms' bounds, averaged with their weights.
    pub total: BoundEstimate,
    /// One estimate per term of the objective.
    pub terms: Vec<BoundEstimate>,
}

/// Most subsets that share a direction; the standard error is taken over directions.
const CLUSTER: usize = 32;
/// Most slices of an estimate: its error is a few millionths then.
pub(super) const MOST_SLICES: usize = 1 << 24;
/// Fewest directions.
const DIRECTIONS: usize = 8;

impl Bound {
    /// Estimates the bound by the exact 1-Wasserstein distances of about `slices` random slices per term, at
    /// least one (fewer for terms with large subsets, along at least 8 directions).
    ///
    /// White noise of the same shape is represented by as many independent points per slice as its subset
    /// holds, so that the ratio's denominator is exact in the mean, whatever the shape. Slices are those of
    /// `seed`; the optimiser's own are others. O(slices · n log n), in parallel, the same bits at any thread
    /// count.
    ///
    /// # Errors
    /// Samples whose shape is not that of the objective; `slices` of 0 or above 2^24; a target of the
    /// caller's own that has no law along some direction.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        objective: &Objective,
        seed: u64,
        slices: usize,
    ) -> Result<Self, MeasureError> {
        let samples = samples.into();
        if slices == 0 {
            return Err(MeasureError::Nothing { what: "slices" });
        }
        let is_good = slices <= MOST_SLICES;
        RangeError::check(is_good, "the number of slices", slices as f64, "of at most 16777216")?;
        let Extent { frames, height, width, spp } = objective.extent();
        let [given, expected] =
            [samples.shape(), [frames, height, width, spp, objective.dims()]].map(Box::new);
        if given != expected {
            return Err(MeasureError::OtherShape { given, expected });
        }
        let terms = (0..objective.terms().count()).map(|term| match samples.values() {
            Values::F32(points) => Moments::of_term(objective, points, seed, slices, term),
            Values::F64(points) => Moments::of_term(objective, points, seed, slices, term),
        });
        let terms = terms.collect::<Result<Vec<Moments>, TargetError>>()?;
        let weights: Vec<f64> = objective.terms().map(|term| term.weight).collect();
        let total: f64 = weights.iter().sum();
        let mut mean = Moments::default();
        for (moments, weight) in terms.iter().zip(weights) {
            mean.add(moments, weight / total);
        }
        Ok(Self { total: mean.estimate(), terms: terms.iter().map(Moments::estimate).collect() })
    }
}

/// Means over slices of the table's distance and of white noise's, and the covariance of those means.
#[derive(Clone, Copy, Default)]
struct Moments {
    table: f64,
    noise: f64,
    table_variance: f64,
    noise_variance: f64,
    covariance: f64,
}

impl Moments {
    fn of_term<T: Copy + Into<f64> + Sync>(
        objective: &Objective,
        points: &[T],
        seed: u64,
        slices: usize,
        term: usize,
    ) -> Result<Self, TargetError> {
        let family = &objective.terms[term].family;
        // As many touches as the smallest family needs for its slices, in a large one too.
        let least = objective.terms.iter().map(|term| term.family.mean_size()).fold(f64::INFINITY, f64::min);
        let slices = (slices as f64 * least / family.mean_size()).ceil() as usize;
        // LabelSubsets of a direction are different ones: a family of a few large classes has one each.
        let per_direction = if family.visits() < DIRECTIONS * CLUSTER { 1 } else { CLUSTER };
        let clusters = slices.div_ceil(per_direction).max(DIRECTIONS);
        let pairs = (0..clusters)
            .into_par_iter()
            .map(|cluster| distances(objective, points, seed, term, (cluster, clusters, per_direction)));
        let pairs = pairs.collect::<Result<Vec<(f64, f64)>, _>>()?;
        let count = clusters as f64;
        let mean = |value: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(value).sum::<f64>() / count;
        let (table, noise) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let product = |value: &dyn Fn(f64, f64) -> f64| {
            mean(&|pair| value(pair.0 - table, pair.1 - noise)) / (count - 1.0)
        };
        Ok(Self {
            table,
            noise,
            table_variance: product(&|a, _| a * a),
            noise_variance: product(&|_, b| b * b),
            covariance: product(&|a, b| a * b),
        })
    }

    fn add(&mut self, other: &Self, weight: f64) {
        let squared = weight * weight;
        self.table += weight * other.table;
        self.noise += weight * other.noise;
        self.table_variance += squared * other.table_variance;
        self.noise_variance += squared * other.noise_variance;
        self.covariance += squared * other.covariance;
    }

    fn estimate(&self) -> BoundEstimate {
        let ratio = self.table / self.noise;
        // First-order propagation of the two means' errors.
        let spread =
            self.table_variance - 2.0 * ratio * self.covariance + ratio * ratio * self.noise_variance;
        BoundEstimate {
            value: self.table,
            standard_error: self.table_variance.sqrt(),
            ratio_to_white_noise: ratio,
            ratio_standard_error: spread.max(0.0).sqrt() / self.noise,
        }
    }
}

/// Mean distance per touched sample of the table and of white noise, over the subsets of one direction.
fn distances<T: Copy + Into<f64>>(
    objective: &Objective,
    points: &[T],
    seed: u64,
    term: usize,
    (cluster, clusters, per_direction): (usize, usize, usize),
) -> Result<(f64, f64), TargetError> {
    let planned = &objective.terms[term];
    let dims = planned.spec.dims.len();
    let index = (term as u64) << 32 | cluster as u64;
    let mut generator = random::generator(seed, Purpose::Bound, 0, index);
    let direction = if dims == 2 {
        // Angles are stratified over the clusters.
        let angle = std::f64::consts::PI * (cluster as f64 + generator.random::<f64>()) / clusters as f64;
        vec![angle.cos(), angle.sin()]
    } else {
        let gaussian: Vec<f64> = (0..dims).map(|_| generator.sample(StandardNormal)).collect();
        let length = gaussian.iter().map(|component| component * component).sum::<f64>().sqrt();
        gaussian.iter().map(|component| component / length.max(f64::MIN_POSITIVE)).collect()
    };
    let scales = planned.spec.target.scales(dims);
    let direction: Vec<f64> =
        direction.iter().zip(scales).map(|(component, scale)| component * scale).collect();
    let law = planned.spec.target.project(&direction).sound(&direction)?;
    let is_cube = planned.spec.target == Target::UniformCube;
    let cut: Vec<f64> = (0..dims).map(|_| generator.random()).collect();
    let mut strata: Vec<usize> = (0..per_direction).collect();
    strata.shuffle(&mut generator);
    let mut weights = Vec::new();
    let mut slice = Slice { term, member: 0, level: 0.0, direction, cut };
    let (mut workspace, mut samples, mut projections) = Default::default();
    let workspace: &mut Workspace = &mut workspace;
    let (mut of_table, mut of_noise) = (0.0, 0.0);
    for stratum in strata {
        slice.member = planned.family.visited_member(generator.random_range(0..planned.family.visits()));
        slice.level = (stratum as f64 + generator.random::<f64>()) / per_direction as f64;
        planned.family.select(slice.member, slice.level, &mut samples);
        if samples.is_empty() {
            continue; // none of the class's samples at this level is demanded
        }
        planned.family.weigh(slice.member, &mut weights);
        let weights = planned.family.is_weighted().then_some(weights.as_slice());
        let mass = weights.map_or(samples.len() as f64, |weights| weights.iter().sum())
            * planned.family.emphasis(slice.member);
        objective.project(points, &slice, &samples, &mut projections);
        of_table += mass * workspace.w1(&law, &projections, weights);
        for projection in &mut projections {
            if !is_cube {
                *projection = law.quantile(generator.random());
                continue;
            }
            *projection = slice.direction.iter().map(|component| component * generator.random::<f64>()).sum();
        }
        of_noise += mass * workspace.w1(&law, &projections, weights);
    }
    let mass = per_direction as f64 * planned.family.mean_mass();
    Ok((of_table / mass, of_noise / mass))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Config, LabelSubsets};
    use crate::table::SampleTable;

    #[test]
    fn points_of_either_precision_are_measured_as_the_table_of_them() {
        let config = Config::classes(&[20, 30], 2, &LabelSubsets::EachAndAll);
        let (extent, dims) = (config.extent, config.dims);
        let objective = Objective::new(&config).unwrap();
        let table = SampleTable::white_noise(extent, dims, 1).unwrap();
        let wide: Vec<f64> = table.values().iter().map(|&value| value.into()).collect();
        let of_table = Bound::measure(&table, &objective, 2, 64).unwrap();
        for points in [Samples::points(&wide, dims), Samples::points(table.values(), dims)] {
            assert_eq!(Bound::measure(points.unwrap(), &objective, 2, 64).unwrap(), of_table);
        }
        let fewer = Samples::points(&wide[..40], dims).unwrap();
        let error = Bound::measure(fewer, &objective, 2, 64).unwrap_err();
        assert!(matches!(error, MeasureError::OtherShape { .. }), "{error}");
    }
}
