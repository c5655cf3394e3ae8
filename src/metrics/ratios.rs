//! Means over test integrands, with their standard errors.

use std::sync::Arc;

use rayon::prelude::*;

use super::integrand::Integrand;
use super::integrands::Integrands;

/// A mean and the uncertainty that the finite number of integrands leaves.
///
/// ```
/// use fsot::metrics::{Integrands, Samples, SetError};
///
/// let points = Samples::points(&[0.25, 0.75], 1)?;
/// let single = SetError::measure(points, &[0], &Integrands::random(1, 1, 0)?)?.ratios;
/// assert!(single.mean.mean > 0.0 && single.mean.standard_error.is_nan());
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean; NaN for a single value. It belongs to the choice of integrands: two tables
    /// measured with the *same* integrands differ by less noise than this.
    pub standard_error: f64,
}

/// A ratio to white noise (1 = independent random numbers), measured over test integrands.
///
/// ```
/// use fsot::metrics::{Family, Integrands, Samples, SetError};
///
/// let points = Samples::points(&[0.25, 0.75], 1)?;
/// let ratios = SetError::measure(points, &[0], &Integrands::random(1, 8, 0)?)?.ratios;
/// for family in &ratios.families {
///     println!("{:10} {:.3} ± {:.3}", family.name, family.ratio.mean, family.ratio.standard_error);
/// }
/// assert_eq!(ratios.family(Family::SMOOTH), Some(ratios.families[1].ratio));
/// assert_eq!(ratios.family("stained glass"), None);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ratios {
    /// Mean of every family, in the order of [`Integrands::families`].
    pub families: Vec<FamilyRatio>,
    /// Mean of the families, which count alike.
    pub mean: Estimate,
}

/// The ratio of one family.
///
/// ```
/// use fsot::metrics::{Integrand, Integrands, Samples, SetError};
///
/// let linear = Integrand::new(1, |x| x[0], 0.5, 1.0 / 12.0)?;
/// let points = Samples::points(&[0.25, 0.75], 1)?;
/// let error = SetError::measure(points, &[0], &Integrands::own(1, "linear", vec![linear])?)?;
/// let [family] = error.ratios.families.as_slice() else { panic!() };
/// assert_eq!((&*family.name, family.ratio.mean), ("linear", 0.0));
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FamilyRatio {
    /// Name of the family.
    pub name: Arc<str>,
    /// Mean over its integrands.
    pub ratio: Estimate,
}

impl Estimate {
    /// Mean and standard error of independent values.
    pub(super) fn of(values: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let count = values.len() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
        Self { mean, standard_error: (squares / (count - 1.0) / count).sqrt() }
    }
}

impl Ratios {
    /// Mean over the integrands of the family with this name, if there is one.
    pub fn family(&self, name: &str) -> Option<Estimate> {
        self.families.iter().find(|family| &*family.name == name).map(|family| family.ratio)
    }

    /// `K` ratios of every integrand, averaged.
    ///
    /// `measure` gets one or two integrands (two fit into one complex transform) and writes the ratios of as
    /// many. The order of sums does not depend on the number of threads.
    pub(super) fn over<const K: usize, S>(
        integrands: &Integrands,
        scratch: impl Fn() -> S + Sync,
        measure: impl Fn(&mut S, &[Integrand], &mut [[f64; K]]) + Sync,
    ) -> [Self; K] {
        let measured: Vec<Vec<[f64; K]>> = integrands
            .families()
            .iter()
            .map(|family| {
                let mut ratios = vec![[0.0; K]; family.integrands().len()];
                ratios
                    .par_chunks_mut(2)
                    .zip(family.integrands().par_chunks(2))
                    .for_each_init(&scratch, |scratch, (ratios, pair)| measure(scratch, pair, ratios));
                ratios
            })
            .collect();
        std::array::from_fn(|k| {
            let of_family = |ratios: &Vec<[f64; K]>| Estimate::of(ratios.iter().map(|ratio| ratio[k]));
            let estimates: Vec<Estimate> = measured.iter().map(of_family).collect();
            let count = estimates.len() as f64;
            let mean = estimates.iter().map(|family| family.mean).sum::<f64>() / count;
            let variance = estimates.iter().map(|family| family.standard_error.powi(2)).sum::<f64>();
            let named = integrands.families().iter().zip(estimates);
            let families = named.map(|(family, ratio)| FamilyRatio { name: family.shared_name(), ratio });
            let mean = Estimate { mean, standard_error: variance.sqrt() / count };
            Self { families: families.collect(), mean }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_are_textbook_ones() {
        let estimate = Estimate::of([1.0, 2.0, 3.0, 6.0].into_iter());
        assert_eq!(estimate.mean, 3.0);
        // Variance (4 + 1 + 0 + 9) / 3, over 4 values.
        approx::assert_relative_eq!(estimate.standard_error, (14.0_f64 / 12.0).sqrt());
    }

    #[test]
    fn families_count_alike_and_odd_numbers_are_measured() {
        let integrands = Integrands::random(2, 5, 1).unwrap();
        let [variance, one] = Ratios::over(
            &integrands,
            || (),
            |(), pair, ratios| {
                for (integrand, ratio) in pair.iter().zip(ratios) {
                    *ratio = [integrand.variance(), 1.0];
                }
            },
        );
        let mean = integrands.iter().map(|f| f.variance()).sum::<f64>() / 20.0;
        approx::assert_relative_eq!(variance.mean.mean, mean, max_relative = 1e-14);
        assert_eq!(one.mean, Estimate { mean: 1.0, standard_error: 0.0 });
    }
}
