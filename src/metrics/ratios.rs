//! Means over test integrands, with their standard errors.

use rayon::prelude::*;

use super::integrand::Integrand;
use super::integrands::{Family, Integrands};

/// A mean and the uncertainty that the finite number of integrands leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean; NaN for a single value. It belongs to the choice of integrands: two tables
    /// measured with the *same* integrands differ by less noise than this.
    pub standard_error: f64,
}

/// A ratio to white noise (1 = independent random numbers), measured over test integrands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratios {
    families: [Estimate; 4],
    /// Mean of the four families.
    pub mean: Estimate,
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
    /// Mean over the integrands of one family.
    pub fn family(&self, family: Family) -> Estimate {
        self.families[family as usize]
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
        let ratios = Family::ALL.map(|family| {
            let chosen = integrands.family(family);
            let mut ratios = vec![[0.0; K]; chosen.len()];
            ratios
                .par_chunks_mut(2)
                .zip(chosen.par_chunks(2))
                .for_each_init(&scratch, |scratch, (ratios, pair)| measure(scratch, pair, ratios));
            ratios
        });
        std::array::from_fn(|k| {
            let families = ratios.each_ref().map(|family| Estimate::of(family.iter().map(|r| r[k])));
            let mean = families.iter().map(|f| f.mean).sum::<f64>() / 4.0;
            let variance = families.iter().map(|f| f.standard_error.powi(2)).sum::<f64>();
            Self { families, mean: Estimate { mean, standard_error: variance.sqrt() / 4.0 } }
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
        let mean = |family| integrands.family(family).iter().map(|f| f.variance()).sum::<f64>() / 5.0;
        approx::assert_relative_eq!(variance.mean.mean, Family::ALL.map(mean).iter().sum::<f64>() / 4.0);
        assert_eq!(one.mean, Estimate { mean: 1.0, standard_error: 0.0 });
    }
}
