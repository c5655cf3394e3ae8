//! Laws in pieces: linear density between knots, jumps where a piece has no width.

/// A law whose distribution function is quadratic between knots.
///
/// Over a piece that starts at `s` with width `w` and mass `m`, the probability rises by `m ((1 − k) t + k
/// t²)` at `s + w t`; the skewness `k` in `[-1, 1]` gives the piece its mean, at `t = 1/2 + k/6`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    knots: Vec<Knot>,
    mean: f64,
    variance: f64,
}

/// Start of a piece; the last one starts none.
#[derive(Clone, Copy, Debug)]
struct Knot {
    place: f64,
    /// Probability below.
    below: f64,
    /// Integral of the quantile function up to there.
    integral: f64,
    /// Skewness of the piece.
    skew: f64,
}

/// Samples that are kept one by one; pieces that more of them become.
const MOST_ATOMS: usize = 2048;
/// Levels at which a quantile function is tabulated.
const LEVELS: usize = 1024;

impl Pieces {
    /// Pieces between increasing places, with these masses and relative places of their means in `[0, 1]`;
    /// the masses are divided by their sum.
    pub(crate) fn new(places: &[f64], masses: &[f64], means: impl IntoIterator<Item = f64>) -> Self {
        let total: f64 = masses.iter().sum();
        let mut knots = Vec::with_capacity(places.len());
        let (mut below, mut integral, mut square) = (0.0, 0.0, 0.0);
        for ((ends, mass), mean) in places.windows(2).zip(masses).zip(means) {
            let (place, width, mass) = (ends[0], ends[1] - ends[0], mass / total);
            let skew = (6.0 * (mean - 0.5)).clamp(-1.0, 1.0);
            knots.push(Knot { place, below, integral, skew });
            let (first, second) = (0.5 + skew / 6.0, 1.0 / 3.0 + skew / 6.0);
            below += mass;
            integral += mass * (place + width * first);
            square += mass * (place * place + width * (2.0 * place * first + width * second));
        }
        let place = places.last().copied().unwrap_or(0.0);
        knots.push(Knot { place, below: 1.0, integral, skew: 0.0 });
        Self { knots, mean: integral, variance: (square - integral * integral).max(0.0) }
    }

    /// What stands for anything that is no law: it is refused when it is used.
    fn unsound() -> Self {
        Self { knots: Vec::new(), mean: f64::NAN, variance: f64::NAN }
    }

    /// Equally likely values.
    pub(crate) fn of_samples(mut values: Vec<f64>) -> Self {
        if values.is_empty() {
            return Self::unsound();
        }
        values.sort_unstable_by(f64::total_cmp);
        let count = values.len();
        if count <= MOST_ATOMS {
            // An atom is a piece of no width; between atoms lie pieces without mass.
            let places: Vec<f64> = values.iter().flat_map(|&value| [value, value]).collect();
            let masses: Vec<f64> =
                (1..places.len()).map(|piece| if piece % 2 == 1 { 1.0 } else { 0.0 }).collect();
            return Self::new(&places, &masses, std::iter::repeat(0.5));
        }
        let run = |piece: usize| &values[piece * count / MOST_ATOMS..(piece + 1) * count / MOST_ATOMS];
        let mut places: Vec<f64> = (0..MOST_ATOMS).map(|piece| run(piece)[0]).collect();
        places.push(values[count - 1]);
        let masses: Vec<f64> = (0..MOST_ATOMS).map(|piece| run(piece).len() as f64).collect();
        let means = (0..MOST_ATOMS).map(|piece| {
            let mean = run(piece).iter().sum::<f64>() / run(piece).len() as f64;
            let width = places[piece + 1] - places[piece];
            if width > 0.0 { (mean - places[piece]) / width } else { 0.5 }
        });
        Self::new(&places, &masses, means)
    }

    /// A quantile function.
    pub(crate) fn of_quantile(quantile: impl Fn(f64) -> f64) -> Self {
        let level = |knot: f64| knot / LEVELS as f64;
        let mut places: Vec<f64> = (0..=LEVELS).map(|knot| quantile(level(knot as f64))).collect();
        // What falls is not a quantile function; NaN stays, and is refused later.
        for knot in 1..places.len() {
            if places[knot] < places[knot - 1] {
                places[knot] = places[knot - 1];
            }
        }
        let means: Vec<f64> = (0..LEVELS)
            .map(|piece| {
                // Three points of Gauss and Legendre.
                let at = |node: f64| quantile(level(piece as f64 + 0.5 + node));
                let outer = 0.5 * 0.6_f64.sqrt();
                let mean = (5.0 * at(-outer) + 8.0 * at(0.0) + 5.0 * at(outer)) / 18.0;
                let width = places[piece + 1] - places[piece];
                if width > 0.0 { (mean - places[piece]) / width } else { 0.5 }
            })
            .collect();
        Self::new(&places, &[1.0; LEVELS], means)
    }

    /// A piecewise linear density.
    pub(crate) fn of_density(places: &[f64], densities: &[f64]) -> Self {
        let is_density = densities.iter().all(|&density| density >= 0.0 && density.is_finite());
        let mass = densities.iter().sum::<f64>();
        if places.len() != densities.len()
            || !places.is_sorted()
            || !is_density
            || mass == 0.0
            || mass.is_infinite()
        {
            return Self::unsound();
        }
        let pairs = || places.windows(2).zip(densities.windows(2));
        let masses: Vec<f64> = pairs().map(|(x, f)| (x[1] - x[0]) * 0.5 * (f[0] + f[1])).collect();
        let means = pairs().map(|(_, f)| {
            let sum = f[0] + f[1];
            if sum > 0.0 { 0.5 + (f[1] - f[0]) / sum / 6.0 } else { 0.5 }
        });
        Self::new(places, &masses, means)
    }

    pub(crate) fn support(&self) -> (f64, f64) {
        let place = |knot: Option<&Knot>| knot.map_or(0.0, |knot| knot.place);
        // Pieces without mass at the ends don't count.
        let first = self.knots.windows(2).find(|ends| ends[1].below > 0.0).map(|ends| &ends[0]);
        let last = self.knots.iter().find(|knot| knot.below >= 1.0);
        (place(first), place(last))
    }

    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    pub(crate) fn variance(&self) -> f64 {
        self.variance
    }

    pub(crate) fn cdf(&self, a: f64) -> f64 {
        let index = self.knots.partition_point(|knot| knot.place <= a);
        match (index.checked_sub(1).map(|index| &self.knots[index]), self.knots.get(index)) {
            (None, _) => 0.0,
            (Some(_), None) => 1.0,
            (Some(knot), Some(next)) => {
                let t = ((a - knot.place) / (next.place - knot.place)).clamp(0.0, 1.0);
                knot.below + (next.below - knot.below) * t * (1.0 - knot.skew + knot.skew * t)
            }
        }
    }

    /// The piece where the distribution function reaches `u`.
    fn piece(&self, u: f64) -> usize {
        self.knots.partition_point(|knot| knot.below < u).clamp(1, self.knots.len().saturating_sub(1).max(1))
            - 1
    }

    pub(crate) fn quantile(&self, u: f64) -> f64 {
        let u = u.clamp(0.0, 1.0);
        let index = match u {
            // The first place of all, but for pieces without mass.
            0.0 => return self.support().0,
            _ => self.piece(u),
        };
        let Some(next) = self.knots.get(index + 1) else { return self.mean };
        let knot = &self.knots[index];
        knot.place + (next.place - knot.place) * knot.reach(next, u).1
    }

    pub(crate) fn quantile_integral(&self, u: f64) -> f64 {
        let u = u.clamp(0.0, 1.0);
        let index = self.piece(u);
        match self.knots.get(index + 1) {
            Some(next) => self.knots[index].integral_to(next, u),
            None => u * self.mean,
        }
    }

    pub(crate) fn cell_mean(&self, lower: f64, upper: f64) -> f64 {
        let (lower, upper) = (lower.min(upper).clamp(0.0, 1.0), lower.max(upper).clamp(0.0, 1.0));
        let (low, high) = (self.quantile(lower), self.quantile(upper));
        // A narrow cell inside one piece; a difference of integrals would have no digits.
        if upper - lower < 1e-9 {
            return 0.5 * (low + high);
        }
        let mean = (self.quantile_integral(upper) - self.quantile_integral(lower)) / (upper - lower);
        // No `clamp`: it panics where the law is no law.
        mean.max(low).min(high)
    }

    pub(crate) fn cell_means_into(&self, means: &mut [f64]) {
        self.for_each_cell(means.len(), |cell, mean| means[cell] = mean);
    }

    /// Calls `visit(cell, mean of the quantile function)` for equal cells, in rising order. O(cells +
    /// pieces).
    #[inline(always)]
    pub(crate) fn for_each_cell(&self, cells: usize, mut visit: impl FnMut(usize, f64)) {
        let (n, width) = (cells as f64, 1.0 / cells as f64);
        let mut below = 0.0;
        let mut pieces = self.knots.windows(2);
        let Some(mut piece) = pieces.next() else {
            return (0..cells).for_each(|cell| visit(cell, self.mean));
        };
        for cell in 0..cells {
            let integral = if cell + 1 == cells {
                self.mean
            } else {
                let u = (cell + 1) as f64 * width;
                while piece[1].below < u {
                    match pieces.next() {
                        Some(next) => piece = next,
                        None => break,
                    }
                }
                piece[0].integral_to(&piece[1], u)
            };
            visit(cell, (integral - below) * n);
            below = integral;
        }
    }
}

impl Knot {
    /// Share of the piece's mass and of its width where the distribution function is `u`.
    #[inline(always)]
    fn reach(&self, next: &Knot, u: f64) -> (f64, f64) {
        let mass = next.below - self.below;
        let share = ((u - self.below) / mass.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let even = 1.0 - self.skew;
        let root = (even * even + 4.0 * self.skew * share).max(0.0).sqrt();
        (share, 2.0 * share / (even + root).max(f64::MIN_POSITIVE))
    }

    /// Integral of the quantile function from 0 to `u`.
    #[inline(always)]
    fn integral_to(&self, next: &Knot, u: f64) -> f64 {
        let (share, t) = self.reach(next, u);
        let moment = t * t * (0.5 * (1.0 - self.skew) + (2.0 / 3.0) * self.skew * t);
        self.integral + (next.below - self.below) * (self.place * share + (next.place - self.place) * moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle on [0, 1] with density 2x: Q(u) = sqrt(u), integral (2/3) u^1.5, mean 2/3, variance 1/18.
    #[test]
    fn a_triangle_is_exact() {
        let law = Pieces::of_density(&[0.0, 0.25, 0.5, 1.0], &[0.0, 0.25, 0.5, 1.0]);
        assert!((law.mean() - 2.0 / 3.0).abs() < 1e-15 && (law.variance() - 1.0 / 18.0).abs() < 1e-15);
        for step in 0..=100 {
            let u = f64::from(step) / 100.0;
            assert!((law.quantile(u) - u.sqrt()).abs() < 1e-12, "{u}");
            assert!((law.cdf(u) - u * u).abs() < 1e-14, "{u}");
            assert!((law.quantile_integral(u) - 2.0 / 3.0 * u.powf(1.5)).abs() < 1e-14, "{u}");
        }
    }

    #[test]
    fn atoms_are_met_by_whole_cells() {
        let law = Pieces::of_samples(vec![0.5, 0.1, 0.9, 0.5]);
        let mut means = [0.0; 4];
        law.cell_means_into(&mut means);
        for (mean, expected) in means.into_iter().zip([0.1, 0.5, 0.5, 0.9]) {
            assert!((mean - expected).abs() < 1e-14, "{means:?}");
        }
        assert_eq!(law.support(), (0.1, 0.9));
        assert_eq!([law.cdf(0.09), law.cdf(0.1), law.cdf(0.5), law.cdf(0.7)], [0.0, 0.25, 0.75, 0.75]);
        assert_eq!([0.0, 0.25, 0.3, 1.0].map(|u| law.quantile(u)), [0.1, 0.1, 0.5, 0.9]);
    }

    #[test]
    fn cells_add_up_to_the_law() {
        let laws = [
            Pieces::of_quantile(|u| u * u - 0.3),
            Pieces::of_samples((0..5000).map(|i| f64::from(i * i % 4999)).collect()),
            Pieces::of_density(&[-1.0, 0.0, 0.5, 2.0], &[0.0, 0.0, 1.0, 0.0]),
        ];
        for law in laws {
            for cells in [1, 2, 3, 100, 7001] {
                let mut means = vec![0.0; cells];
                law.cell_means_into(&mut means);
                assert!(means.is_sorted_by(|a, b| a <= &(b + 1e-9)), "{cells}");
                let scale = law.support().1 - law.support().0;
                assert!((means.iter().sum::<f64>() / cells as f64 - law.mean()).abs() < 1e-12 * scale);
                let middle =
                    law.cell_mean((cells / 2) as f64 / cells as f64, (cells / 2 + 1) as f64 / cells as f64);
                assert!((means[cells / 2] - middle).abs() < 1e-9 * scale, "{cells}");
            }
        }
    }
}
