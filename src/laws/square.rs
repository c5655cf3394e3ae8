//! The law of the unit square along a direction, and of the unit interval, without a table.

/// A trapezoid: the law of `a u + b v` for independent uniforms, widths `a ≥ b ≥ 0`, moved by the negative
/// components.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquareLaw {
    low: f64,
    wide: f64,
    narrow: f64,
}

impl SquareLaw {
    /// Along a direction of one or two components.
    pub(crate) fn new(direction: &[f64]) -> Self {
        let width = |k: usize| direction.get(k).map_or(0.0, |component| component.abs());
        let low = direction.iter().map(|component| component.min(0.0)).sum();
        Self { low, wide: width(0).max(width(1)), narrow: width(0).min(width(1)) }
    }

    /// The least and the greatest value.
    pub(crate) fn support(&self) -> (f64, f64) {
        (self.low, self.low + self.wide + self.narrow)
    }

    /// The quantile function, for `u` in `[0, 1]`: `√(2abu)` on the slope, `au + b/2` on the roof.
    pub(crate) fn quantile(&self, u: f64) -> f64 {
        let Self { low, wide, narrow } = *self;
        let from_the_end = |u: f64| {
            if 2.0 * wide * u < narrow { (2.0 * wide * narrow * u).sqrt() } else { wide * u + 0.5 * narrow }
        };
        let up = if u <= 0.5 { from_the_end(u) } else { wide + narrow - from_the_end(1.0 - u) };
        low + up
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Projected;

    #[test]
    fn it_is_the_law_of_the_cube() {
        for direction in [&[1.0][..], &[-1.0], &[0.6, 0.8], &[-0.96, 0.28], &[0.0, 1.0], &[0.5, -0.5]] {
            let (square, cube) = (SquareLaw::new(direction), Projected::of_cube(direction));
            let ends = [square.support(), cube.support()];
            assert!((ends[0].0 - ends[1].0).abs() < 1e-15 && (ends[0].1 - ends[1].1).abs() < 1e-15);
            for u in (0..=200).map(|i| f64::from(i) / 200.0) {
                let [a, b] = [square.quantile(u), cube.quantile(u)];
                assert!((a - b).abs() < 1e-12, "{direction:?} {u}: {a} {b}");
            }
        }
    }
}
