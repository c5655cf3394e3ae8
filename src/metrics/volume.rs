//! Closed-form volumes of simple bodies inside the unit cube.

use std::f64::consts::PI;

use crate::targets::Target;

/// Volume of `{x in [0, 1]^D : normal · x < offset}`, the CDF of a sum of independent uniforms.
pub(super) fn half_space(normal: &[f64], offset: f64) -> f64 {
    Target::UniformCube.project(normal).cdf(offset)
}

/// Area of the disc around `centre` inside the unit square; any centre, `radius > 0`.
pub(super) fn disc_in_square([x, y]: [f64; 2], radius: f64) -> f64 {
    let quadrant = |right: f64, top: f64| disc_in_quadrant(right, top, radius);
    quadrant(1.0 - x, 1.0 - y) - quadrant(-x, 1.0 - y) - quadrant(1.0 - x, -y) + quadrant(-x, -y)
}

/// Area of the disc around the origin inside the quadrant `{x ≤ right, y ≤ top}`.
fn disc_in_quadrant(right: f64, top: f64, radius: f64) -> f64 {
    let (a, b) = (right.clamp(-radius, radius), top.clamp(-radius, radius));
    let r_sq = radius * radius;
    // Area of the disc left of the vertical line at `a`.
    let left_of = |a: f64| a * (r_sq - a * a).max(0.0).sqrt() + r_sq * ((a / radius).asin() + 0.5 * PI);
    if a * a + b * b < r_sq {
        // The corner lies in the disc: its derivative in `a` is the chord `b + sqrt(r² - a²)`.
        return 0.5 * (left_of(a) + left_of(b)) + a * b - 0.25 * PI * r_sq;
    }
    match (a < 0.0, b < 0.0) {
        (true, true) => 0.0,
        (true, false) => left_of(a),
        (false, true) => left_of(b),
        (false, false) => left_of(a) + left_of(b) - PI * r_sq,
    }
}

/// Volume of a ball in `dims` dimensions.
pub(super) fn ball(dims: usize, radius: f64) -> f64 {
    // V_D = V_{D-2} · 2π r² / D, from V_0 = 1 and V_1 = 2 r.
    match dims {
        0 => 1.0,
        1 => 2.0 * radius,
        _ => ball(dims - 2, radius) * 2.0 * PI * radius * radius / dims as f64,
    }
}

/// Average over `[0, 1]` of the Gaussian `exp(-(x - centre)² / (2 deviation²))`.
pub(super) fn gaussian(centre: f64, deviation: f64) -> f64 {
    let scaled = |x: f64| libm::erf((x - centre) / (deviation * std::f64::consts::SQRT_2));
    (0.5 * PI).sqrt() * deviation * (scaled(1.0) - scaled(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// Midpoint rule over `[0, 1]`.
    fn midpoint(steps: usize, f: impl Fn(f64) -> f64) -> f64 {
        (0..steps).map(|i| f((i as f64 + 0.5) / steps as f64)).sum::<f64>() / steps as f64
    }

    /// Length of `[low, high] ∩ [0, 1]`.
    fn inside(low: f64, high: f64) -> f64 {
        (high.min(1.0) - low.max(0.0)).max(0.0)
    }

    #[test]
    fn half_planes_agree_with_quadrature() {
        for angle in [0.0, 1e-9, 0.3, 0.785, 1.6, 2.5, 3.5, 4.4, 6.0_f64] {
            let (b, a) = angle.sin_cos();
            for share in [0.02, 0.3, 0.5, 0.77, 0.99] {
                let offset = (a.min(0.0) + b.min(0.0)) + share * (a.abs() + b.abs());
                // A chord in x at every y. Midpoint rule of a piecewise linear function: error below
                // h²·slope.
                let expected = midpoint(100_000, |y| {
                    let edge = (offset - b * y) / a;
                    if a > 0.0 { inside(0.0, edge) } else { inside(edge, 1.0) }
                });
                assert_abs_diff_eq!(half_space(&[a, b], offset), expected, epsilon = 2e-5);
            }
        }
        assert_abs_diff_eq!(half_space(&[-1.0], -0.25), 0.75, epsilon = 1e-15);
    }

    #[test]
    fn half_spaces_agree_with_the_alternating_sum() {
        // Irwin-Hall: Σ_S (−1)^|S| (t − Σ_S a)_+^D / (D! Π a), over all subsets S of the components.
        let textbook = |a: &[f64], t: f64| {
            let sum: f64 = (0..1_u32 << a.len())
                .map(|subset| {
                    let chosen = |d: &usize| subset >> d & 1 == 1;
                    let shift: f64 = (0..a.len()).filter(chosen).map(|d| a[d]).sum();
                    let sign = if subset.count_ones() % 2 == 0 { 1.0 } else { -1.0 };
                    sign * (t - shift).max(0.0).powi(a.len() as i32)
                })
                .sum();
            sum / a.iter().enumerate().map(|(d, a)| (d + 1) as f64 * a).product::<f64>()
        };
        for a in [vec![0.6, 0.3, 0.7], vec![0.5; 4], vec![0.9, 0.05, 0.2, 0.3], vec![0.4; 6]] {
            let length: f64 = a.iter().sum();
            for share in [0.05, 0.3, 0.5, 0.9] {
                let t = share * length;
                assert_abs_diff_eq!(half_space(&a, t), textbook(&a, t), epsilon = 1e-10);
                let mirrored: Vec<f64> = a.iter().map(|a| -a).collect();
                assert_abs_diff_eq!(half_space(&mirrored, t - length), textbook(&a, t), epsilon = 1e-10);
            }
        }
        // Vanishing components leave the plane, or the interval.
        let plane = half_space(&[0.6, 0.8], 0.5);
        assert_abs_diff_eq!(half_space(&[0.6, 1e-12, 0.8], 0.5), plane, epsilon = 1e-6);
        assert_abs_diff_eq!(half_space(&[1e-20, 1e-12, 0.8], 0.5), 0.625, epsilon = 1e-6);
    }

    #[test]
    fn discs_agree_with_quadrature_wherever_they_lie() {
        for &x in &[-0.3, 0.0, 0.2, 0.5, 0.9, 1.0, 1.4_f64] {
            for &y in &[-0.1, 0.1, 0.5, 0.95, 1.2] {
                for &radius in &[0.05, 0.3, 0.5, 0.8, 1.1, 3.0_f64] {
                    let expected = midpoint(40_000, |u| {
                        let half = (radius * radius - (u - x) * (u - x)).max(0.0).sqrt();
                        inside(y - half, y + half)
                    });
                    // The square root at the rim costs the midpoint rule O(h^1.5) = 1.2e-7 · constant.
                    assert_abs_diff_eq!(disc_in_square([x, y], radius), expected, epsilon = 1e-6);
                }
            }
        }
        assert_abs_diff_eq!(disc_in_square([0.5, 0.5], 0.5), 0.25 * PI, epsilon = 1e-15);
    }

    #[test]
    fn balls_have_their_textbook_volumes() {
        assert_abs_diff_eq!(ball(2, 0.5), PI * 0.25, epsilon = 1e-15);
        assert_abs_diff_eq!(ball(3, 2.0), 4.0 / 3.0 * PI * 8.0, epsilon = 1e-12);
        assert_abs_diff_eq!(ball(4, 1.0), PI * PI / 2.0, epsilon = 1e-15);
    }

    #[test]
    fn gaussians_agree_with_quadrature() {
        for (centre, deviation) in [(0.0, 0.1), (0.4, 0.2), (1.3, 0.5), (0.5, 5.0_f64)] {
            let f = |x: f64| (-(x - centre).powi(2) / (2.0 * deviation * deviation)).exp();
            // Midpoint error is h²/24 times the change of slope, at most 12 here.
            assert_abs_diff_eq!(gaussian(centre, deviation), midpoint(10_000, f), epsilon = 5e-9);
        }
    }
}
