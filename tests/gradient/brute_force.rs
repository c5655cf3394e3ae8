//! The squared 2-Wasserstein distance of a slice, from the distribution function of a sum of uniforms.
//!
//! Nothing is shared with the crate: the distribution function is the textbook's alternating sum (good to
//! 1e-12 for up to five components that are not small), quantiles are found by bisection, and each cell is
//! integrated by parts.

/// Law of `theta·U` for uniform `U` in the cube; all components differ from 0.
pub struct Law<'a> {
    theta: &'a [f64],
    low: f64,
    high: f64,
}

impl<'a> Law<'a> {
    /// The law along this direction.
    pub fn new(theta: &'a [f64]) -> Self {
        let low = theta.iter().map(|t| t.min(0.0)).sum();
        let high = theta.iter().map(|t| t.max(0.0)).sum();
        Self { theta, low, high }
    }

    fn cdf(&self, x: f64) -> f64 {
        let d = self.theta.len();
        let above = |subset: u32| {
            let corner: f64 = (0..d).filter(|i| subset >> i & 1 == 1).map(|i| self.theta[i].abs()).sum();
            let sign = if subset.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * (x - self.low - corner).max(0.0).powi(d as i32)
        };
        let volume: f64 = self.theta.iter().enumerate().map(|(i, t)| (i + 1) as f64 * t.abs()).product();
        ((0..1 << d).map(above).sum::<f64>() / volume).clamp(0.0, 1.0)
    }

    fn quantile(&self, u: f64) -> f64 {
        if u <= 0.0 {
            return self.low;
        }
        if u >= 1.0 {
            return self.high;
        }
        let (mut low, mut high) = (self.low, self.high);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.cdf(middle) < u { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// `∫ (Q(u) − a)² du` over `[lower, upper]`, as `∫ (x − a)² dF` by parts and by the midpoint rule.
    fn cell(&self, lower: f64, upper: f64, a: f64) -> f64 {
        const PARTS: usize = 2000;
        let (from, to) = (self.quantile(lower), self.quantile(upper));
        let step = (to - from) / PARTS as f64;
        let inner: f64 = (0..PARTS)
            .map(|part| from + (part as f64 + 0.5) * step)
            .map(|x| 2.0 * (x - a) * self.cdf(x) * step)
            .sum();
        (to - a).powi(2) * upper - (from - a).powi(2) * lower - inner
    }

    /// Squared distance between these projections, with their masses, and the law.
    pub fn w2_squared(&self, projections: &[(f64, f64)]) -> f64 {
        let mut sorted = projections.to_vec();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = sorted.iter().map(|(_, mass)| mass).sum();
        let (mut below, mut sum) = (0.0, 0.0);
        for (projection, mass) in sorted {
            sum += self.cell(below / total, (below + mass) / total, projection);
            below += mass;
        }
        sum
    }
}
