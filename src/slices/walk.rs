//! Descent: updates of a table in place. Owns its moments, knows nothing of transport.

use serde::{Deserialize, Serialize};

use crate::error::ConfigError;
use crate::slices::part::Part;
use crate::table::domain::Domain;

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

/// Moves the samples of a part by `rate` times their mean pull and clears the pull. `domains` has one entry per
/// dimension.
pub(crate) fn project(rate: f64, domains: &[Domain], part: &mut Part) {
    let rate = rate as f32;
    let pulls = part.sums.iter_mut().zip(&mut *part.hits).map(|(sum, hits)| take_mean(sum, hits));
    move_points(domains, part.points, pulls.map(|pull| rate * pull));
}

/// A descent on its way: its moments and the number of steps that made them.
#[derive(Clone, Debug)]
pub(crate) struct Walker {
    descent: Descent,
    steps: i32,
    first: Vec<f32>,
    second: Vec<f32>,
}

/// One step of a descent, for any part of a table.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Walk {
    Barycentric { rate: f64 },
    Sgd { rate: f32, momentum: f32 },
    Adam { rate: f32, betas: [f32; 2], unbias: [f32; 2], epsilon: f32 },
}

impl Walker {
    pub(crate) fn new(descent: Descent, coordinates: usize) -> Self {
        let (first, second) = match descent {
            Descent::Barycentric { .. } => (0, 0),
            Descent::Sgd { .. } => (coordinates, 0),
            Descent::Adam { .. } => (coordinates, coordinates),
        };
        Self { descent, steps: 0, first: vec![0.0; first], second: vec![0.0; second] }
    }

    /// Begins a step of size `rate`.
    pub(crate) fn step(&mut self, rate: f64) -> Walk {
        self.steps = self.steps.saturating_add(1);
        match self.descent {
            Descent::Barycentric { .. } => Walk::Barycentric { rate },
            Descent::Sgd { momentum, .. } => Walk::Sgd { rate: rate as f32, momentum: momentum as f32 },
            Descent::Adam { beta1, beta2, epsilon, .. } => Walk::Adam {
                rate: rate as f32,
                betas: [beta1, beta2].map(|beta| beta as f32),
                unbias: [beta1, beta2].map(|beta| 1.0 / (1.0 - beta.powi(self.steps)) as f32),
                epsilon: epsilon as f32,
            },
        }
    }

    /// First and second moments of all coordinates; empty where the descent has none.
    pub(crate) fn moments(&mut self) -> [&mut [f32]; 2] {
        [&mut self.first, &mut self.second]
    }
}

impl Walk {
    /// Moves the samples of a part by what pulls them and clears the pull. `domains` has one entry per dimension.
    pub(crate) fn advance(self, domains: &[Domain], part: &mut Part) {
        let pulls = |sums, hits| Iterator::zip(sums, hits).map(|(sum, hits)| take_mean(sum, hits));
        match self {
            Walk::Barycentric { rate } => project(rate, domains, part),
            Walk::Sgd { rate, momentum } => {
                let [velocities, _] = &mut part.moments;
                let pulls = pulls(part.sums.iter_mut(), part.hits.iter_mut());
                let motion = velocities.iter_mut().zip(pulls).map(|(velocity, pull)| {
                    *velocity = momentum * *velocity + pull;
                    rate * *velocity
                });
                move_points(domains, part.points, motion);
            }
            Walk::Adam { rate, betas: [beta1, beta2], unbias: [unbias1, unbias2], epsilon } => {
                let [first, second] = &mut part.moments;
                let moments = first.iter_mut().zip(second.iter_mut());
                let pulls = pulls(part.sums.iter_mut(), part.hits.iter_mut());
                let motion = moments.zip(pulls).map(|((first, second), pull)| {
                    *first = beta1 * *first + (1.0 - beta1) * pull;
                    *second = beta2 * *second + (1.0 - beta2) * pull * pull;
                    rate * (unbias1 * *first) / ((unbias2 * *second).sqrt() + epsilon)
                });
                move_points(domains, part.points, motion);
            }
        }
    }
}

/// Mean pull on a coordinate, 0 if no slice held it; clears both.
#[inline(always)]
fn take_mean(sum: &mut f32, hits: &mut f32) -> f32 {
    // Where there were no hits the sum is 0 as well, and no branch keeps the loop from being vectorised.
    let mean = *sum / hits.max(f32::MIN_POSITIVE);
    (*sum, *hits) = (0.0, 0.0);
    mean
}

/// Adds the `i`th motion to the `i`th coordinate and brings it back into its domain.
#[inline(always)]
fn move_points(domains: &[Domain], points: &mut [f32], motion: impl Iterator<Item = f32>) {
    if domains.iter().all(|&domain| domain == Domain::Interval) {
        // The common case by itself, so that it is vectorised.
        for (coordinate, motion) in points.iter_mut().zip(motion) {
            *coordinate = Domain::Interval.admit(*coordinate + motion);
        }
    } else {
        for ((coordinate, domain), motion) in points.iter_mut().zip(domains.iter().cycle()).zip(motion) {
            *coordinate = domain.admit(*coordinate + motion);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slices::pull::Pull;

    /// Moves the point by what pulls it.
    fn step(walker: &mut Walker, rate: f64, point: &mut [f32; 1], pull: &mut Pull) {
        let walk = walker.step(rate);
        let (sums, hits) = (&mut pull.sums, &mut pull.hits);
        let mut part = Part { first: 0, dims: 1, points: point, sums, hits, moments: walker.moments() };
        walk.advance(&[Domain::Interval], &mut part);
    }

    fn walk(descent: Descent, pulls: &[f32], rate: f64) -> Vec<f32> {
        let mut walker = Walker::new(descent, 1);
        let mut points = [0.5];
        let mut trace = Vec::new();
        for &sum in pulls {
            let mut pull = Pull { sums: vec![sum], hits: vec![2.0], ..Pull::default() };
            step(&mut walker, rate, &mut points, &mut pull);
            assert_eq!((pull.sums[0], pull.hits[0]), (0.0, 0.0));
            trace.push(points[0]);
        }
        trace
    }

    fn assert_close(trace: &[f32], expected: &[f64]) {
        for (at, expected) in trace.iter().zip(expected) {
            assert!((f64::from(*at) - expected).abs() < 1e-6, "{trace:?}"); // a few roundings of f32 near 0.5
        }
    }

    #[test]
    fn barycentric_moves_to_the_mean_of_the_pulls() {
        assert_close(&walk(Descent::barycentric(), &[0.2, -0.1], 0.5), &[0.55, 0.525]);
    }

    #[test]
    fn a_coordinate_that_no_slice_held_stays() {
        let mut walker = Walker::new(Descent::barycentric(), 1);
        let mut points = [0.3];
        let mut pull = Pull { sums: vec![0.0], hits: vec![0.0], ..Pull::default() };
        step(&mut walker, 1.0, &mut points, &mut pull);
        assert_eq!(points, [0.3]);
    }

    #[test]
    fn sgd_follows_its_recurrence() {
        // Two slices each, so mean pulls 0.1, -0.05, 0.2; v: 0.1, 0.04, 0.236; x += 0.1 v.
        let descent = Descent::Sgd { rate: Schedule::constant(0.1), momentum: 0.9 };
        assert_close(&walk(descent, &[0.2, -0.1, 0.4], 0.1), &[0.51, 0.514, 0.5376]);
    }

    #[test]
    fn adam_follows_its_recurrence() {
        // Kingma and Ba's Algorithm 1 by hand with beta1 = 0.5, beta2 = 0.75, epsilon = 0.01, rate = 0.1 and the
        // mean pulls 0.1 and 0.3. Step 1: m = .05, v = .0025, unbiased .1 and .01, x += .1 * .1 / .11.
        // Step 2: m = .175, v = .024375, unbiased .175/.75 and .024375/.4375.
        let descent = Descent::Adam { rate: Schedule::constant(0.1), beta1: 0.5, beta2: 0.75, epsilon: 0.01 };
        let first = 0.5 + 0.1 * 0.1 / 0.11;
        let second = first + 0.1 * (0.175 / 0.75) / ((0.024375_f64 / 0.4375).sqrt() + 0.01);
        assert_close(&walk(descent, &[0.2, 0.6], 0.1), &[first, second]);
    }

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
