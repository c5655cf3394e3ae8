//! How slices move the samples, and how a number changes over a run.

use serde::{Deserialize, Serialize};

use crate::error::RangeError;

/// How a step moves the samples.
///
/// All three follow the same *pull*: for each coordinate, `d` times its mean displacement along the slices of
/// the step that held it, in a group of `d` dimensions. That is the negative gradient of the objective,
/// divided by the number of slices that held the coordinate: its unit is that of a coordinate, whatever the
/// size of the table or the batch.
///
/// ```
/// use fsot::config::{Descent, Schedule};
/// use fsot::{Config, Extent};
///
/// let slow = Descent::Barycentric { rate: Schedule::cosine(1.0, 0.01) };
/// let config = Config::new(Extent::still(32, 32), 2).with_descent(slow);
/// assert_eq!(config.descent.rate().ends(), [1.0, 0.01]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Descent {
    /// `x ← x + rate · pull`: a fixed point iteration towards the barycentre of the targets (`E[theta thetaᵀ]
    /// = I / d`), with `rate = 1` as its natural step and nothing to tune.
    Barycentric {
        /// Step size; 1 moves to the barycentre of the targets.
        rate: Schedule,
    },
    /// Stochastic gradient descent with momentum: `v ← momentum · v + pull`, `x ← x + rate · v`.
    Sgd {
        /// Step size.
        rate: Schedule,
        /// Share of the velocity that is kept, from 0 to 0.999999.
        momentum: f64,
    },
    /// Adam (Kingma and Ba 2015, Algorithm 1), with bias correction.
    Adam {
        /// Step size: roughly the distance that a coordinate moves per step.
        rate: Schedule,
        /// Decay of the first moment, from 0 to 0.999999.
        beta1: f64,
        /// Decay of the second moment, from 0 to 0.999999.
        beta2: f64,
        /// Added to the root of the second moment; in `[1e-30, 1e6]`.
        epsilon: f64,
    },
}

/// A number from 1e-30 to 1e6 that changes over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Schedule {
    /// Stays as it is.
    Constant {
        /// Value at every step.
        #[serde(alias = "first")]
        value: f64,
    },
    /// Goes from the first to the last value by equal factors.
    Geometric {
        /// Value at the first step.
        first: f64,
        /// Value that the last step approaches.
        last: f64,
    },
    /// Goes along half a period of a cosine: flat, steep, flat.
    Cosine {
        /// Value at the first step.
        first: f64,
        /// Value that the last step approaches.
        last: f64,
    },
}

/// Least and largest value of a schedule: their ratios stay finite.
const LEAST: f64 = 1e-30;
const MOST: f64 = 1e6;

/// Refuses a step that is none: see [`crate::Optimizer::step`].
pub(crate) fn check_step(rate: f64, balance: f64) -> Result<(), RangeError> {
    let check = |name, value| RangeError::check((0.0..=MOST).contains(&value), name, value, "from 0 to 1e6");
    check("the step size", rate)?;
    check("the share of a balance", balance)
}

impl Schedule {
    /// From `first` to `last` by equal factors.
    pub const fn geometric(first: f64, last: f64) -> Self {
        Self::Geometric { first, last }
    }

    /// Always `value`.
    pub const fn constant(value: f64) -> Self {
        Self::Constant { value }
    }

    /// From `first` to `last` along half a cosine.
    pub const fn cosine(first: f64, last: f64) -> Self {
        Self::Cosine { first, last }
    }

    /// The values at the first step and at the end.
    pub fn ends(&self) -> [f64; 2] {
        match *self {
            Self::Constant { value } => [value; 2],
            Self::Geometric { first, last } | Self::Cosine { first, last } => [first, last],
        }
    }

    /// The same way between other values; what is constant stays at the first.
    #[must_use]
    pub fn between(&self, [first, last]: [f64; 2]) -> Self {
        match self {
            Self::Constant { .. } => Self::constant(first),
            Self::Geometric { .. } => Self::geometric(first, last),
            Self::Cosine { .. } => Self::cosine(first, last),
        }
    }

    /// Refuses ends that are not from 1e-30 to 1e6.
    ///
    /// # Errors
    /// The first number that lies outside its range.
    pub fn validate(&self) -> Result<(), RangeError> {
        for (name, value) in ["the first step size", "the last step size"].into_iter().zip(self.ends()) {
            RangeError::check((LEAST..=MOST).contains(&value), name, value, "from 1e-30 to 1e6")?;
        }
        Ok(())
    }

    /// Value after the share `progress` of the run; clamped to `[0, 1]`, and 0 if it is not a number.
    ///
    /// ```
    /// use fsot::config::Schedule;
    ///
    /// assert!((Schedule::geometric(1.0, 0.01).at(0.5) - 0.1).abs() < 1e-12);
    /// ```
    #[allow(clippy::manual_clamp)] // `clamp` would let NaN through
    pub fn at(&self, progress: f64) -> f64 {
        let progress = progress.max(0.0).min(1.0);
        match *self {
            Self::Constant { value } => value,
            Self::Geometric { first, last } => first * (last / first).powf(progress),
            Self::Cosine { first, last } => {
                last + (first - last) * 0.5 * (1.0 + (std::f64::consts::PI * progress).cos())
            }
        }
    }
}

/// Largest share of a moment that is kept from step to step.
const MOST_DECAY: f64 = 0.999_999;

impl Descent {
    /// Barycentric steps from 2 to 0.03: the default. Overshooting at first gets further than the natural
    /// step of 1.
    pub const fn barycentric() -> Self {
        Descent::Barycentric { rate: Schedule::geometric(2.0, 0.03) }
    }

    /// Gradient descent with momentum 0.9 and a decaying step.
    pub const fn sgd() -> Self {
        Descent::Sgd { rate: Schedule::geometric(0.2, 0.005), momentum: 0.9 }
    }

    /// Adam with a decaying step.
    pub const fn adam() -> Self {
        Descent::Adam { rate: Schedule::geometric(0.1, 0.004), beta1: 0.9, beta2: 0.99, epsilon: 1e-8 }
    }

    /// The step size's schedule.
    pub fn rate(&self) -> &Schedule {
        match self {
            Descent::Barycentric { rate } | Descent::Sgd { rate, .. } | Descent::Adam { rate, .. } => rate,
        }
    }

    /// Refuses settings that no step could follow.
    ///
    /// # Errors
    /// The first number that lies outside its range.
    pub fn validate(&self) -> Result<(), RangeError> {
        // Closer to 1, a decay would be 1 in `f32`.
        let share = |name, value: f64| {
            RangeError::check((0.0..=MOST_DECAY).contains(&value), name, value, "from 0 to 0.999999")
        };
        self.rate().validate()?;
        match *self {
            Descent::Barycentric { .. } => Ok(()),
            Descent::Sgd { momentum, .. } => share("momentum", momentum),
            Descent::Adam { beta1, beta2, epsilon, .. } => {
                share("beta1", beta1)?;
                share("beta2", beta2)?;
                // A smaller one would be 0 in f32, and a coordinate that nothing pulls 0 / 0.
                let is_good = (1e-30..=1e6).contains(&epsilon);
                RangeError::check(is_good, "epsilon", epsilon, "from 1e-30 to 1e6")
            }
        }
    }
}

impl Default for Descent {
    fn default() -> Self {
        Self::barycentric()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schedules_begin_and_end_where_they_say() {
        for schedule in [Schedule::geometric(1.0, 0.02), Schedule::cosine(1.0, 0.02)] {
            assert!((schedule.at(0.0) - 1.0).abs() < 1e-12);
            assert!((schedule.at(1.0) - 0.02).abs() < 1e-12);
            assert!(
                (0..100).all(|i| schedule.at(f64::from(i) / 100.0) > schedule.at(f64::from(i + 1) / 100.0))
            );
        }
        assert!((Schedule::geometric(1.0, 0.01).at(0.5) - 0.1).abs() < 1e-12);
        assert!((Schedule::cosine(1.0, 0.0).at(1.0 / 3.0) - 0.75).abs() < 1e-12);
        assert_eq!(Schedule::constant(0.3).at(0.7), 0.3);
    }

    #[test]
    fn bad_settings_are_named() {
        let name = |descent: Descent| descent.validate().unwrap_err().name;
        assert_eq!(name(Descent::Barycentric { rate: Schedule::constant(0.0) }), "the first step size");
        assert_eq!(
            name(Descent::Barycentric { rate: Schedule::geometric(1.0, f64::NAN) }),
            "the last step size"
        );
        assert_eq!(name(Descent::Sgd { rate: Schedule::constant(1.0), momentum: 1.0 }), "momentum");
        let adam =
            |beta1, beta2, epsilon| Descent::Adam { rate: Schedule::constant(1.0), beta1, beta2, epsilon };
        assert_eq!(name(adam(-0.1, 0.9, 1e-8)), "beta1");
        assert_eq!(name(adam(0.9, 1.0, 1e-8)), "beta2");
        assert_eq!(name(adam(0.9, 0.99, 0.0)), "epsilon");
        assert_eq!(name(adam(0.9, 0.99, 1e-50)), "epsilon");
    }
}
