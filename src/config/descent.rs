//! How slices move the samples, and how a number changes over a run.

use serde::{Deserialize, Serialize};

use crate::error::ConfigError;

/// How a step moves the samples.
///
/// All three follow the same *pull*: for each coordinate, `d` times its mean displacement along the slices of the step
/// that held it, in a group of `d` dimensions. That is the negative gradient of the objective, divided by the number of
/// slices that held the coordinate: its unit is that of a coordinate, whatever the size of the table or the batch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Descent {
    /// `x ← x + rate · pull`: a fixed point iteration towards the barycentre of the targets (`E[theta thetaᵀ] = I / d`),
    /// with `rate = 1` as its natural step and nothing to tune.
    Barycentric {
        /// Step size; 1 moves to the barycentre of the targets.
        rate: Schedule,
    },
    /// Stochastic gradient descent with momentum: `v ← momentum · v + pull`, `x ← x + rate · v`.
    Sgd {
        /// Step size.
        rate: Schedule,
        /// Share of the velocity that is kept, in `[0, 1)`.
        momentum: f64,
    },
    /// Adam (Kingma and Ba 2015, Algorithm 1), with bias correction.
    Adam {
        /// Step size: roughly the distance that a coordinate moves per step.
        rate: Schedule,
        /// Decay of the first moment, in `[0, 1)`.
        beta1: f64,
        /// Decay of the second moment, in `[0, 1)`.
        beta2: f64,
        /// Added to the root of the second moment; in `[1e-30, 1e6]`.
        epsilon: f64,
    },
}

/// A number that changes over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Schedule {
    /// Value at the first step; in `(0, 1e6]`.
    pub first: f64,
    /// Value that the last step approaches; in `(0, 1e6]`.
    pub last: f64,
    /// How the value gets there.
    pub shape: Shape,
}

/// How a schedule goes from its first to its last value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Stays at the first value.
    Constant,
    /// By equal factors.
    Geometric,
    /// Along half a period of a cosine: flat, steep, flat.
    Cosine,
}

impl Schedule {
    /// From `first` to `last` by equal factors.
    pub const fn geometric(first: f64, last: f64) -> Self {
        Self { first, last, shape: Shape::Geometric }
    }

    /// Always `value`.
    pub const fn constant(value: f64) -> Self {
        Self { first: value, last: value, shape: Shape::Constant }
    }

    /// From `first` to `last` along half a cosine.
    pub const fn cosine(first: f64, last: f64) -> Self {
        Self { first, last, shape: Shape::Cosine }
    }

    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        for (name, value) in [("the first step size", self.first), ("the last step size", self.last)] {
            if !(value > 0.0 && value <= 1e6) {
                return Err(ConfigError::OutOfRange { name, value, expected: "above 0, at most 1e6" });
            }
        }
        Ok(())
    }

    /// Value after the share `progress` of the run; clamped to `[0, 1]`.
    pub fn at(&self, progress: f64) -> f64 {
        let progress = progress.clamp(0.0, 1.0);
        match self.shape {
            Shape::Constant => self.first,
            Shape::Geometric => self.first * (self.last / self.first).powf(progress),
            Shape::Cosine => {
                self.last + (self.first - self.last) * 0.5 * (1.0 + (std::f64::consts::PI * progress).cos())
            }
        }
    }
}

impl Descent {
    /// Barycentric steps from 2 to 0.03: the default. Overshooting at first gets further than the natural step of 1.
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

    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        let check = |name, value: f64, good: bool, expected| {
            if good { Ok(()) } else { Err(ConfigError::OutOfRange { name, value, expected }) }
        };
        let share = |name, value| check(name, value, (0.0..1.0).contains(&value), "in [0, 1)");
        self.rate().validate()?;
        match *self {
            Descent::Barycentric { .. } => Ok(()),
            Descent::Sgd { momentum, .. } => share("momentum", momentum),
            Descent::Adam { beta1, beta2, epsilon, .. } => {
                share("beta1", beta1)?;
                share("beta2", beta2)?;
                // A smaller one would be 0 in f32, and a coordinate that nothing pulls 0 / 0.
                check("epsilon", epsilon, (1e-30..=1e6).contains(&epsilon), "from 1e-30 to 1e6")
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
        let name = |descent: Descent| match descent.validate() {
            Err(ConfigError::OutOfRange { name, .. }) => name,
            other => panic!("{other:?}"),
        };
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
