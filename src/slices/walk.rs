//! Descent: updates of a table in place. Owns its moments, knows nothing of transport.

use super::part::TablePart;
use crate::config::Descent;
use crate::table::domain::Domain;
use crate::table::extent::bytes_of;

/// Moves the samples of a part by `rate` times their mean pull and clears the pull. `domains` has one entry
/// per dimension.
pub(crate) fn project(rate: f64, domains: &[Domain], part: &mut TablePart) {
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
    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.first) + bytes_of(&self.second)
    }

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
    pub(crate) fn moments(&self) -> [&[f32]; 2] {
        [&self.first, &self.second]
    }

    pub(crate) fn moments_mut(&mut self) -> [&mut [f32]; 2] {
        [&mut self.first, &mut self.second]
    }

    /// Steps that made them.
    pub(crate) fn steps(&self) -> i32 {
        self.steps
    }

    /// Goes on with these moments, made by so many steps; `None` if they are none of this descent's.
    pub(crate) fn with_moments(self, [first, second]: [Vec<f32>; 2], steps: i32) -> Option<Self> {
        let fits = first.len() == self.first.len() && second.len() == self.second.len();
        (fits && steps >= 0).then_some(Self { first, second, steps, ..self })
    }
}

impl Walk {
    /// Moves the samples of a part by what pulls them and clears the pull. `domains` has one entry per
    /// dimension.
    pub(crate) fn advance(self, domains: &[Domain], part: &mut TablePart) {
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
    use crate::config::Schedule;
    use crate::slices::part::Pull;

    /// Moves the point by what pulls it.
    fn step(walker: &mut Walker, rate: f64, point: &mut [f32; 1], pull: &mut Pull) {
        let walk = walker.step(rate);
        let (sums, hits) = (&mut pull.sums, &mut pull.hits);
        let mut part =
            TablePart { first: 0, dims: 1, points: point, sums, hits, moments: walker.moments_mut() };
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
        // Kingma and Ba's Algorithm 1 by hand with beta1 = 0.5, beta2 = 0.75, epsilon = 0.01, rate = 0.1 and
        // the mean pulls 0.1 and 0.3. Step 1: m = .05, v = .0025, unbiased .1 and .01, x += .1 * .1 / .11.
        // Step 2: m = .175, v = .024375, unbiased .175/.75 and .024375/.4375.
        let descent = Descent::Adam { rate: Schedule::constant(0.1), beta1: 0.5, beta2: 0.75, epsilon: 0.01 };
        let first = 0.5 + 0.1 * 0.1 / 0.11;
        let second = first + 0.1 * (0.175 / 0.75) / ((0.024375_f64 / 0.4375).sqrt() + 0.01);
        assert_close(&walk(descent, &[0.2, 0.6], 0.1), &[first, second]);
    }
}
