//! One test integrand on the unit cube, with its mean and variance.

use std::fmt;
use std::sync::Arc;

use super::error::MeasureError;
use super::integrand_kind::IntegrandKind;
use crate::error::RangeError;
use crate::table::extent::MOST_DIMS;

/// Points of an estimate: their values are kept, in a gibibyte.
const MOST_POINTS: usize = 1 << 27;

/// A function on `[0, 1)^D` whose mean and variance under the uniform distribution are known.
///
/// [`super::Integrands::random`] draws some with closed forms. [`Integrand::new`] takes a function of your
/// own, [`Integrand::estimated`] one of which nothing is known; [`super::Integrands::own`] makes families of
/// them.
///
/// ```
/// use fsot::metrics::Integrand;
///
/// // A light that a quarter circle of the square sees.
/// let share = std::f64::consts::FRAC_PI_4;
/// let light = |x: &[f64]| if x[0] * x[0] + x[1] * x[1] < 1.0 { 1.0 } else { 0.0 };
/// let quarter = Integrand::new(2, light, share, share * (1.0 - share))?;
/// assert_eq!(quarter.value(&[0.5, 0.5]), 1.0);
/// assert!((Integrand::estimated(2, light, 4096)?.integral() - share).abs() < 1e-2);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Integrand {
    function: Function,
    dims: usize,
    integral: f64,
    variance: f64,
}

/// Of ours, or a caller's.
#[derive(Clone)]
enum Function {
    Known(IntegrandKind),
    Own(Arc<OwnFunction>),
}

type OwnFunction = dyn Fn(&[f64]) -> f64 + Send + Sync;

impl fmt::Debug for Function {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Known(kind) => kind.fmt(out),
            Self::Own(_) => out.write_str("Own(..)"),
        }
    }
}

/// Functions of a caller are equal if they are one and the same.
impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Known(kind), Self::Known(other)) => kind == other,
            (Self::Own(function), Self::Own(other)) => Arc::ptr_eq(function, other),
            _ => false,
        }
    }
}

impl Integrand {
    /// A function of `dims` coordinates, with its mean and its variance over the unit cube.
    ///
    /// `value` is called from several threads, with points of exactly `dims` coordinates in `[0, 1)`; it must
    /// depend on nothing else. An integral that is off by `δ` adds `n δ² / variance` to ratios over `n`
    /// samples.
    ///
    /// # Errors
    /// No dimensions; an integral that is not finite; a variance that is not positive and finite.
    pub fn new(
        dims: usize,
        value: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
        integral: f64,
        variance: f64,
    ) -> Result<Self, MeasureError> {
        if dims == 0 {
            return Err(MeasureError::Nothing { what: "dimensions" });
        }
        if !integral.is_finite() {
            let (name, expected) = ("the integral of an integrand", "that is finite");
            return Err(RangeError::new(name, integral, expected).into());
        }
        if !(variance > 0.0 && variance.is_finite()) {
            let (name, expected) = ("the variance of an integrand", "above 0 that is finite");
            return Err(RangeError::new(name, variance, expected).into());
        }
        Ok(Self { function: Function::Own(Arc::new(value)), dims, integral, variance })
    }

    /// A function of `dims` coordinates whose mean and variance are estimated from `points` points of the
    /// Halton sequence.
    ///
    /// In few dimensions the mean is off by less than the `√(variance / points)` of random points, which
    /// would add `n / points` to ratios over `n` samples: take many more points than samples. O(points ·
    /// dims).
    ///
    /// # Errors
    /// No dimensions or points; more than [`MOST_DIMS`] dimensions, or than 2^27 points; values that are not
    /// finite, or all the same.
    pub fn estimated(
        dims: usize,
        value: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
        points: usize,
    ) -> Result<Self, MeasureError> {
        for (what, count) in [("dimensions", dims), ("points", points)] {
            if count == 0 {
                return Err(MeasureError::Nothing { what });
            }
        }
        let range =
            |is_good, name, count: usize, expected| RangeError::check(is_good, name, count as f64, expected);
        range(dims <= MOST_DIMS, "the number of dimensions", dims, "of at most 64")?;
        range(points <= MOST_POINTS, "the number of points", points, "of at most 134217728")?;
        let primes = (2..).filter(|number| (2..*number).all(|divisor| number % divisor != 0));
        let bases: Vec<usize> = primes.take(dims).collect();
        let mut point = vec![0.0; dims];
        // From 1 on: the first point would be the origin, where a function may be infinite.
        let values = (1..=points).map(|index| {
            for (coordinate, &base) in point.iter_mut().zip(&bases) {
                *coordinate = radical_inverse(index, base);
            }
            value(&point)
        });
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / points as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / points as f64;
        Self::new(dims, value, mean, variance)
    }

    pub(super) fn known(kind: IntegrandKind, dims: usize) -> Self {
        let (integral, variance) = kind.moments();
        Self { function: Function::Known(kind), dims, integral, variance }
    }

    /// Number of coordinates.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Mean over the unit cube.
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// Variance of the value at a uniformly distributed point: the expected squared error of one random
    /// sample.
    pub fn variance(&self) -> f64 {
        self.variance
    }

    /// Value at a point of `dims` coordinates.
    ///
    /// # Panics
    /// If the point has fewer coordinates than [`Integrand::dims`].
    #[inline]
    pub fn value(&self, point: &[f64]) -> f64 {
        let point = &point[..self.dims];
        match &self.function {
            Function::Known(kind) => kind.value(point),
            Function::Own(value) => value(point),
        }
    }
}

/// The digits of `index` in a base, mirrored at the point.
fn radical_inverse(index: usize, base: usize) -> f64 {
    let (mut inverse, mut place, mut rest) = (0.0, 1.0, index);
    while rest > 0 {
        place /= base as f64;
        inverse += place * (rest % base) as f64;
        rest /= base;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_ones_own_are_checked() {
        let make = |dims, integral, variance| Integrand::new(dims, |x| x[0], integral, variance);
        let moment = |error| match error {
            Err(MeasureError::Range(RangeError { name, value, .. })) => (name, value),
            other => panic!("{other:?}"),
        };
        assert_eq!(make(0, 0.5, 1.0), Err(MeasureError::Nothing { what: "dimensions" }));
        assert_eq!(moment(make(1, f64::INFINITY, 1.0)).0, "the integral of an integrand");
        for variance in [0.0, -1.0, f64::INFINITY] {
            assert_eq!(moment(make(1, 0.5, variance)), ("the variance of an integrand", variance));
        }
        assert!(make(1, 0.5, f64::NAN).is_err());
        let error = make(1, 0.5, 0.0).unwrap_err().to_string();
        assert_eq!(error, "the variance of an integrand is 0: give a value above 0 that is finite");
    }

    #[test]
    fn estimates_approach_the_closed_forms() {
        let product = |x: &[f64]| x[0] * x[1] * x[2];
        let estimated = Integrand::estimated(3, product, 1 << 16).unwrap();
        assert!((estimated.integral() - 0.125).abs() < 1e-4, "{estimated:?}");
        // 1/27 − 1/64
        assert!((estimated.variance() - 37.0 / 1728.0).abs() < 1e-4, "{estimated:?}");
        assert!(Integrand::estimated(1, |_| 3.0, 64).is_err());
        assert!(Integrand::estimated(1, |_| f64::NAN, 64).is_err());
        assert!(Integrand::estimated(1, |x| x[0], 0).is_err());
    }

    #[test]
    fn ones_own_are_equal_if_the_same() {
        let make = || Integrand::new(1, |x| x[0], 0.5, 1.0 / 12.0).unwrap();
        let one = make();
        assert_eq!(one, one.clone());
        assert_ne!(one, Integrand::known(IntegrandKind::Linear { gradient: vec![1.0] }, 1));
        assert!(format!("{one:?}").contains("Own(..)"));
    }
}
