//! The law of the uniform cube along one direction.

use super::boxes;
use super::piece::Piece;

/// Components below this share of the sum of all are replaced by their mean.
const NEGLIGIBLE: f64 = 1e-8;
/// Up to so many whole pieces are added one by one, more are a difference of two running sums.
const FEW_PIECES: usize = 16;

/// Law of a sum of independent uniforms: see [`super::Projected`] for its accuracy.
#[derive(Clone, Debug)]
pub(super) struct CubeLaw {
    low: f64,
    high: f64,
    variance: f64,
    /// Lower half of the distribution function, for a support scaled to `[0, 1]`; empty for a point mass.
    pieces: Vec<Piece>,
    /// Integral of the scaled quantile function up to the start of each piece.
    integrals: Vec<f64>,
}

/// A point of the lower half: a piece and `t` in `[0, 1]` inside it.
#[derive(Clone, Copy)]
struct Place {
    piece: usize,
    t: f64,
}

impl CubeLaw {
    pub(super) fn new(direction: &[f64]) -> Self {
        debug_assert!(direction.iter().all(|component| component.is_finite()), "{direction:?}");
        let low = direction.iter().map(|component| component.min(0.0)).sum();
        let high = direction.iter().map(|component| component.max(0.0)).sum();
        let variance = direction.iter().map(|component| component * component / 12.0).sum();

        let mut widths: Vec<f64> = direction.iter().map(|component| component.abs()).collect();
        widths.sort_unstable_by(|a, b| b.total_cmp(a));
        // Divided by the greatest first: sums of the least positive numbers would have no digits.
        let greatest = widths.first().copied().unwrap_or(0.0);
        widths.retain(|&width| width > 0.0);
        widths.iter_mut().for_each(|width| *width /= greatest);
        let sum: f64 = widths.iter().sum();
        widths.retain(|&width| width >= NEGLIGIBLE * sum);
        let kept: f64 = widths.iter().sum();
        widths.iter_mut().for_each(|width| *width /= kept);

        let pieces = boxes::lower_half(&widths);
        let mut total = 0.0;
        let mut integrals = Vec::with_capacity(pieces.len());
        for piece in &pieces {
            integrals.push(total);
            let (mass, mean) = piece.mass_and_mean(0.0, 1.0);
            total += mass * mean;
        }
        Self { low, high, variance, pieces, integrals }
    }

    /// The least and the greatest value: the sums of the negative and of the positive components.
    pub(super) fn support(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// The mean, which is also the median.
    pub(super) fn mean(&self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }

    /// The variance, Σ theta_i² / 12.
    pub(super) fn variance(&self) -> f64 {
        self.variance
    }

    /// Probability of values up to `a`: nondecreasing, 0 left of the support, 1 from its right end on.
    ///
    /// O(log grid). A point mass jumps at its place.
    pub(super) fn cdf(&self, a: f64) -> f64 {
        if a >= self.high {
            1.0
        } else if a <= self.low || self.pieces.is_empty() {
            0.0
        } else if a <= self.mean() {
            self.lower_cdf((a - self.low) / self.scale())
        } else {
            1.0 - self.lower_cdf((self.high - a) / self.scale())
        }
    }

    /// The quantile function `Q` at `u`, clamped to `[0, 1]`: nondecreasing, from one end of the support to
    /// the other.
    ///
    /// O(log grid).
    pub(super) fn quantile(&self, u: f64) -> f64 {
        let u = u.clamp(0.0, 1.0);
        let unscaled = if u <= 0.5 {
            self.low + self.scale() * self.position(self.place(u))
        } else {
            self.high - self.scale() * self.position(self.place(1.0 - u))
        };
        unscaled.clamp(self.low, self.high)
    }

    /// `∫₀ᵘ Q`, with `u` clamped to `[0, 1]`. O(log grid).
    pub(super) fn quantile_integral(&self, u: f64) -> f64 {
        let u = u.clamp(0.0, 1.0);
        if u <= 0.5 {
            u * self.low + self.scale() * self.lower_integral(u)
        } else {
            // ∫₀¹ Q is the mean, and Q(1 − v) = high + low − Q(v).
            let v = 1.0 - u;
            self.mean() - (v * self.high - self.scale() * self.lower_integral(v))
        }
    }

    /// Mean of `Q` over `[lower, upper]`, in either order, both clamped to `[0, 1]`.
    ///
    /// A cell of width 0 has its quantile as mean, and narrow cells lose no digits. O(log grid).
    pub(super) fn cell_mean(&self, lower: f64, upper: f64) -> f64 {
        let (lower, upper) = (lower.min(upper).clamp(0.0, 1.0), lower.max(upper).clamp(0.0, 1.0));
        let middle = Place { piece: self.pieces.len().saturating_sub(1), t: 1.0 };
        let mean = if upper <= 0.5 {
            self.low + self.scale() * self.lower_mean(self.place(lower), self.place(upper))
        } else if lower >= 0.5 {
            self.high - self.scale() * self.lower_mean(self.place(1.0 - upper), self.place(1.0 - lower))
        } else {
            let left = self.low + self.scale() * self.lower_mean(self.place(lower), middle);
            let right = self.high - self.scale() * self.lower_mean(self.place(1.0 - upper), middle);
            let share = (0.5 - lower) / (upper - lower);
            share * left + (1.0 - share) * right
        };
        mean.clamp(self.low, self.high)
    }

    /// Writes the means of `Q` over `means.len()` equal cells, in rising order. O(cells·log grid).
    pub(super) fn cell_means_into(&self, means: &mut [f64]) {
        let cells = means.len();
        let scale = self.scale();
        let mut from = self.place(0.0);
        for i in 0..cells / 2 {
            let to = self.place((i + 1) as f64 / cells as f64);
            let lower = scale * self.lower_mean(from, to);
            means[i] = self.low + lower;
            means[cells - 1 - i] = self.high - lower;
            from = to;
        }
        if cells % 2 == 1 {
            means[cells / 2] = self.mean();
        }
    }

    fn scale(&self) -> f64 {
        self.high - self.low
    }

    /// The distribution function at a scaled position in `[0, 1/2]`.
    fn lower_cdf(&self, x: f64) -> f64 {
        let index = self.pieces.partition_point(|piece| piece.start < x).saturating_sub(1);
        let piece = &self.pieces[index];
        piece.cdf(((x - piece.start) / piece.width).clamp(0.0, 1.0)).clamp(piece.below, self.above(index))
    }

    /// Probability left of the end of a piece.
    fn above(&self, index: usize) -> f64 {
        self.pieces.get(index + 1).map_or(0.5, |next| next.below)
    }

    /// Where the distribution function is `u`, in `[0, 1/2]`.
    fn place(&self, u: f64) -> Place {
        let index = self.pieces.partition_point(|piece| piece.below < u).saturating_sub(1);
        let t = self.pieces.get(index).map_or(0.0, |piece| piece.quantile(u, self.above(index)));
        Place { piece: index, t }
    }

    /// Scaled position of a place.
    fn position(&self, place: Place) -> f64 {
        self.pieces.get(place.piece).map_or(0.0, |piece| piece.position(place.t))
    }

    /// Integral of the scaled quantile function up to `u`, in `[0, 1/2]`.
    fn lower_integral(&self, u: f64) -> f64 {
        let place = self.place(u);
        self.pieces.get(place.piece).map_or(0.0, |piece| {
            let (mass, mean) = piece.mass_and_mean(0.0, place.t);
            self.integrals[place.piece] + mass * mean
        })
    }

    /// Mean of the scaled quantile function between two places.
    fn lower_mean(&self, from: Place, to: Place) -> f64 {
        let Some(first) = self.pieces.get(from.piece) else { return 0.0 };
        if from.piece == to.piece {
            return first.mass_and_mean(from.t, to.t).1;
        }
        let last = &self.pieces[to.piece];
        let (mut mass, mean) = first.mass_and_mean(from.t, 1.0);
        let mut moment = mass * mean;
        let mut add = |(more, mean): (f64, f64)| {
            mass += more;
            moment += more * mean;
        };
        let between = from.piece + 1..to.piece;
        if between.len() > FEW_PIECES {
            let more = last.below - self.pieces[between.start].below;
            let part = self.integrals[to.piece] - self.integrals[between.start];
            add((more, if more > 0.0 { part / more } else { 0.0 }));
        } else {
            self.pieces[between].iter().for_each(|piece| add(piece.mass_and_mean(0.0, 1.0)));
        }
        add(last.mass_and_mean(0.0, to.t));
        let (from, to) = (self.position(from), self.position(to));
        if mass > 0.0 { (moment / mass).clamp(from, to) } else { 0.5 * (from + to) }
    }
}
