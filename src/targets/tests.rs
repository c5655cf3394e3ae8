//! Facts about projected laws, each against an independent twin.

use super::*;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

fn law(direction: &[f64]) -> Projected {
    Target::UniformCube.project(direction)
}

/// Density of a sum of uniforms on `[0, wᵢ)` by the positive, stable recurrence of box splines: exponential
/// cost.
fn density(x: f64, widths: &[f64]) -> f64 {
    let sum: f64 = widths.iter().sum();
    if x < 0.0 || x >= sum {
        return 0.0;
    }
    if let [width] = *widths {
        return 1.0 / width;
    }
    let t = x / sum;
    let mut others = widths.to_vec();
    let parts = (0..widths.len()).map(|i| {
        let width = others.remove(i);
        let part = t * density(x, &others) + (1.0 - t) * density(x - width, &others);
        others.insert(i, width);
        part
    });
    parts.sum::<f64>() / (widths.len() - 1) as f64
}

/// A box at least as wide as the support turns the density into the distribution function over its width.
fn recurrence_cdf(x: f64, widths: &[f64]) -> f64 {
    let sum: f64 = widths.iter().sum();
    let mut widened = widths.to_vec();
    widened.push(sum);
    sum * density(x, &widened)
}

/// Distribution function and its integral at `x` by the Fourier series of the law, of period `L`.
fn fourier(x: f64, widths: &[f64]) -> (f64, f64) {
    use std::f64::consts::PI;
    let sum: f64 = widths.iter().sum();
    let y = x - sum / 2.0;
    let (mut cdf, mut integral) = (0.5 + y / sum, x / 2.0 + (y * y - sum * sum / 4.0) / (2.0 * sum));
    for k in (1..4000).map(f64::from) {
        let sinc = |width: &f64| (PI * k * width / sum).sin() / (PI * k * width / sum);
        let transform: f64 = widths.iter().map(sinc).product();
        let angle = 2.0 * PI * k * y / sum;
        cdf += transform * angle.sin() / (PI * k);
        integral += transform * sum / (2.0 * PI * PI * k * k) * ((PI * k).cos() - angle.cos());
    }
    (cdf, integral)
}

/// Awkward directions: equal, dominated, graded, negligible, zero and negative components.
fn directions() -> Vec<Vec<f64>> {
    let mut all = vec![
        vec![0.6, -0.8],
        vec![1.0, 1e-30],
        vec![0.7, 0.7, 1e-7],
        vec![1.0, 0.3, 1e-7, 1e-30, -1e-300],
        vec![0.0, 0.5, 0.0, -0.5, 0.0],
        vec![1.0, 0.5, 0.5 + 1e-15, 0.25],
        vec![1.0, 1e-3, 1e-3, -1e-3, 1e-3],
        (0..16).map(|i| 0.5_f64.powi(i)).collect(),
        (0..16).map(|i| if i == 3 { 1.0 } else { -1e-3 }).collect(),
        vec![3e-300, -1e-300, 2e-300],
        vec![-2.0, 1e5, 3e7],
    ];
    for dims in 1..=16 {
        all.push(vec![-0.25; dims]);
        all.push((0..dims).map(|i| 1.0 + 0.37 * i as f64).collect());
    }
    all.push(vec![0.1; 64]);
    all.push(vec![0.1; 400]); // the first cell's 1/400! underflows
    all
}

#[test]
fn no_component_is_a_point_mass_at_zero() {
    for direction in [&[][..], &[0.0], &[0.0, -0.0, 0.0]] {
        let law = law(direction);
        assert_eq!((law.support(), law.mean(), law.second_moment()), ((0.0, 0.0), 0.0, 0.0));
        assert_eq!([law.cdf(-1e-300), law.cdf(0.0), law.cdf(1.0)], [0.0, 1.0, 1.0]);
        assert_eq!([law.quantile(0.3), law.quantile_integral(0.9), law.cell_mean(0.2, 0.2)], [0.0; 3]);
        assert_eq!(law.cell_means(3).collect::<Vec<_>>(), [0.0; 3]);
        assert_eq!(law.w1_cell(0.25, 0.75, -2.0), 1.0);
    }
}

#[test]
fn one_component_is_linear_and_two_are_a_trapezoid() {
    let line = law(&[-2.0]);
    // One rounding of each operation on numbers up to 2.
    for u in [0.0, 0.1, 0.5, 0.8, 1.0_f64] {
        assert!((line.quantile(u) - (2.0 * u - 2.0)).abs() < 1e-15);
        assert!((line.quantile_integral(u) - (u * u - 2.0 * u)).abs() < 1e-15);
    }
    // a = 0.8, b = 0.6: Q = √(2ab u) below u = b/2a = 0.375, then a·u + b/2, then mirrored; 0.6 less for the
    // sign.
    let law = law(&[-0.6, 0.8]);
    for u in [1e-12, 0.01, 0.2, 0.374_f64] {
        let tail = (0.96 * u).sqrt();
        assert!((law.quantile(u) + 0.6 - tail).abs() < 1e-15);
        assert!((law.quantile(1.0 - u) - (0.8 - tail)).abs() < 1e-15 + 1e-16 / tail); // 1 − u is rounded
        assert!((law.quantile_integral(u) + 0.6 * u - 2.0 / 3.0 * tail * u).abs() < 1e-15);
    }
    assert!((law.quantile(0.45) - (0.36 + 0.3 - 0.6)).abs() < 1e-15);
    assert!((law.cell_mean(0.4, 0.44) - (0.8 * 0.42 + 0.3 - 0.6)).abs() < 1e-15);
    assert!((law.cdf(0.06) - 0.45).abs() < 1e-15);
}

#[test]
fn equal_components_are_irwin_halls() {
    // P(sum of n uniforms ≤ 1) = 1/n!, of ≤ 2: (2ⁿ − n)/n!, and 1/2 in the middle.
    let mut factorial = 1.0;
    for n in 1..=16 {
        factorial *= n as f64;
        let law = law(&vec![1.0; n]);
        assert!((law.cdf(1.0) - 1.0 / factorial).abs() < 1e-11, "{n}");
        if n >= 2 {
            assert!((law.cdf(2.0) - (2.0_f64.powi(n as i32) - n as f64) / factorial).abs() < 1e-11, "{n}");
        }
        assert!((law.cdf(n as f64 / 2.0) - 0.5).abs() < 1e-15, "{n}");
    }
}

#[test]
fn up_to_five_components_agree_with_the_recurrence() {
    // Four components are exact: what remains is rounding over the narrowest width (1e-7: 1e-9 of L). Five
    // have one degree more than the pieces: 6e-10 where one component dominates four of a thousandth.
    for direction in directions().iter().filter(|direction| direction.len() <= 5) {
        let law = law(direction);
        let (low, high) = law.support();
        let widths: Vec<f64> = direction.iter().map(|w| w.abs()).filter(|&w| w > 0.0).collect();
        for i in 1..40 {
            let x = (high - low) * (i as f64 - 0.3) / 40.0;
            let twin = recurrence_cdf(x, &widths);
            let cdf = law.cdf(low + x);
            assert!((cdf - twin).abs() < 2e-9, "{direction:?} {x} {cdf} {twin}");
        }
        for i in 1..40 {
            let u = i as f64 / 40.0;
            let x = law.quantile(u) - low;
            let back = recurrence_cdf(x, &widths);
            // Probabilities are compared: they do not need a bound on the density.
            assert!((back - u).abs() < 2e-8, "{direction:?} {u} {x} {back}");
        }
    }
}

#[test]
fn comparable_components_agree_with_the_fourier_series() {
    // The series' tail is below (L/(4000 π w))^D < 1e-13 from five components on; the law's own error is
    // below 1e-9·L except where the density is small: hence the share of 1/u.
    for dims in 5..=16 {
        for spread in [0.0, 0.1, 0.37] {
            let widths: Vec<f64> = (0..dims).map(|i| 1.0 + spread * ((i * 7) % 5) as f64).collect();
            let law = law(&widths);
            let sum: f64 = widths.iter().sum();
            for x in [0.22, 0.31, 0.45, 0.5, 0.58, 0.74].map(|share| share * sum) {
                let (u, integral) = fourier(x, &widths);
                assert!((law.cdf(x) - u).abs() < 1e-10, "{widths:?} {x}");
                if u > 1e-4 && u < 1.0 - 1e-4 {
                    let error = (law.quantile(u) - x).abs() / sum;
                    assert!(error < 1e-9, "{widths:?} {x} {error:e}");
                    let error = (law.quantile_integral(u) - (x * u - integral)).abs() / sum;
                    assert!(error < 1e-11, "{widths:?} {x} {error:e}");
                    let error = (law.cell_mean(0.0, u) - (x - integral / u)).abs() / sum;
                    assert!(error < 1e-9, "{widths:?} {x} {error:e}");
                }
            }
        }
    }
}

/// `[widths, x, F(x), ∫₀ᵘ Q]` with `u = F(x)`, from the alternating sum in integers (Python,
/// `fractions.Fraction`):
///
/// ```text
/// S = subset sums s with sign g;  F = sum(g*(x-s)**D for s < x) / (D! * prod(w))
/// ∫F = sum(g*(x-s)**(D+1) for s < x) / ((D+1)! * prod(w));  ∫Q = x*F - ∫F
/// ```
#[test]
fn many_scales_agree_with_exact_arithmetic() {
    let halves: Vec<f64> = (0..16).map(|i| 0.5_f64.powi(i)).collect();
    let one_wide: Vec<f64> = (0..16).map(|i| if i == 0 { 1.0 } else { 1e-3 }).collect();
    let two_wide = [1.0, 0.7, 1e-4, 1.1e-4, 1.2e-4, 1.3e-4, 1.4e-4, 1.5e-4];
    let facts = [
        (&halves[..], 0.1332159305363676, 0.00010263177081178089, 1.1827874592163184e-05),
        (&one_wide, 0.008626750109152804, 0.0012185120969783528, 9.297273884043684e-06),
        (&one_wide, 0.07956476240044726, 0.07206476240044725, 0.003136525707919813),
        (&[0.25; 16], 1.6256934708589341, 0.09832596951068569, 0.14671889778863742),
        (&two_wide, 0.017007500000000002, 0.000197605724702381, 2.2651572589434533e-06),
        (&two_wide, 0.817174984509068, 0.466799984509068, 0.25208948669536446),
    ];
    for (widths, x, u, integral) in facts {
        let law = law(widths);
        let length = law.support().1;
        let errors = [
            law.cdf(x) - u,
            (law.quantile(u) - x) / length,
            (law.quantile_integral(u) - integral) / length,
            (law.cell_mean(0.0, u) - integral / u) / length,
        ];
        // The accuracy that `Projected` documents for these levels of u, with room for rounding.
        assert!(errors.iter().all(|error| error.abs() < 1e-8), "{widths:?} {x} {errors:?}");
    }
}

#[test]
fn monte_carlo_agrees_in_awkward_directions() {
    // 2^17 draws; 12 directions × 7 points, each within 5 standard errors: significance 84 · 6e-7 = 5e-5, at
    // a fixed seed.
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(7);
    let draws = 1 << 17;
    for direction in directions().iter().filter(|direction| direction.len() % 5 == 1 || direction.len() > 14)
    {
        let law = law(direction);
        let levels = [0.001, 0.02, 0.2, 0.5, 0.7, 0.95, 0.999];
        let quantiles = levels.map(|u| law.quantile(u));
        let mut below = [0; 7];
        for _ in 0..draws {
            let value: f64 = direction.iter().map(|w| w * generator.random::<f64>()).sum();
            for (count, quantile) in below.iter_mut().zip(quantiles) {
                *count += usize::from(value <= quantile);
            }
        }
        for (u, count) in levels.iter().zip(below) {
            let error = count as f64 / draws as f64 - u;
            assert!(error.abs() < 5.0 * (u * (1.0 - u) / draws as f64).sqrt(), "{direction:?} {u} {error}");
        }
    }
}

/// The whole list of facts that hold for any law; failures print the direction.
fn check_consistency(direction: &[f64]) {
    let law = law(direction);
    let (low, high) = law.support();
    let length = high - low;
    // Rounding of some hundred sums; supports of 1e-300 stay above the least number.
    let tiny = (1e-12 * length).max(f64::MIN_POSITIVE);

    assert_eq!((law.quantile(0.0), law.quantile(1.0)), (low, high), "{direction:?}");
    assert_eq!((law.cdf(low - length), law.cdf(low), law.cdf(high)), (0.0, 0.0, 1.0), "{direction:?}");
    let mut before = (low, 0.0);
    for i in 0..=500 {
        let u = i as f64 / 500.0;
        let (q, f) = (law.quantile(u), law.cdf(low + u * length));
        assert!(q >= before.0 && f >= before.1 - 1e-15 && f <= 1.0, "{direction:?} {u} {q} {f} {before:?}");
        assert!((law.cdf(q) - u).abs() < 1e-7, "{direction:?} {u}"); // a width of 1e-8 is as steep as 1e8
        // 1 − u is rounded, and Q is no steeper than L/u.
        assert!((law.quantile(1.0 - u) - (low + high - q)).abs() <= tiny, "{direction:?} {u}");
        before = (q, f);
    }

    for cells in [1, 2, 7, 64, 1000] {
        let means: Vec<f64> = law.cell_means(cells).collect();
        let average = means.iter().sum::<f64>() / cells as f64;
        assert!((average - law.mean()).abs() <= tiny, "{direction:?} {cells} {average}");
        assert!(means.is_sorted(), "{direction:?} {cells}");
        for (i, mean) in means.iter().enumerate() {
            let (lower, upper) = (i as f64 / cells as f64, (i + 1) as f64 / cells as f64);
            let (least, greatest) = (law.quantile(lower), law.quantile(upper));
            assert!(least - tiny <= *mean && *mean <= greatest + tiny, "{direction:?} {cells} {i}");
            // Ends near 1 are rounded: 1e-16 of a mass of 1/1000.
            let alone = law.cell_mean(lower, upper);
            assert!((mean - alone).abs() <= tiny, "{direction:?} {cells} {i} {mean} {alone}");
            let part = (law.quantile_integral(upper) - law.quantile_integral(lower)) * cells as f64;
            // The difference of two integrals loses three digits to 1000 cells.
            assert!((mean - part).abs() <= tiny, "{direction:?} {cells} {i} {mean} {part}");
        }
    }

    // The means' squares lack the variances within cells: 2e-10 for a uniform; otherwise mostly those of the
    // two end cells, of mass 5e-5 and a spread of at most 0.1·L.
    let square: f64 = law.cell_means(20_000).map(|mean| mean / 20_000.0 * mean).sum();
    assert!((square - law.second_moment()).abs() <= 1e-6 * length * length, "{direction:?} {square}");

    for u in [1e-9, 0.003, 0.25, 0.499_999, 0.5, 0.77] {
        let q = law.quantile(u);
        for width in [0.0, 1e-15, 1e-12, 1e-9] {
            let (lower, upper) = (u, u + u * width);
            let (mean, end) = (law.cell_mean(lower, upper), law.quantile(upper));
            assert!(q - tiny <= mean && mean <= end + tiny, "{direction:?} {u} {width} {q} {mean} {end}");
        }
    }
}

#[test]
fn quantiles_cells_and_moments_are_consistent() {
    directions().iter().for_each(|direction| check_consistency(direction));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn consistent_at_any_scale_of_components(
        components in prop::collection::vec((-9.0..0.0_f64, any::<bool>()), 1..17),
    ) {
        let sign = |negative| if negative { -1.0 } else { 1.0 };
        let direction: Vec<f64> =
            components.iter().map(|&(log, negative)| sign(negative) * 10_f64.powf(log)).collect();
        check_consistency(&direction);
    }
}

#[test]
fn cost_of_a_cell_is_the_integral_of_the_distance() {
    // Midpoint rule of 20000 steps over a Lipschitz integrand away from the ends: 1e-4² · slope, and the kink
    // at a.
    for direction in [vec![0.5], vec![0.6, -0.8], vec![1.0; 7], vec![1.0, 0.2, -0.1, 0.01]] {
        let law = law(&direction);
        let length = law.support().1 - law.support().0;
        for (lower, upper) in [(0.0, 1.0), (0.1, 0.2), (0.45, 0.6), (0.9, 1.0), (0.3, 0.3)] {
            for share in [-0.5, 0.05, 0.3, 0.52, 0.97, 1.5] {
                let a = law.support().0 + share * length;
                let step = (upper - lower) / 20_000.0;
                let distance = |i| (a - law.quantile(lower + (f64::from(i) + 0.5) * step)).abs();
                let twin = step * (0..20_000).map(distance).sum::<f64>();
                let cost = law.w1_cell(lower, upper, a);
                assert!(
                    cost >= 0.0 && (cost - twin).abs() < 2e-6 * length,
                    "{direction:?} {a} {cost} {twin}"
                );
            }
        }
    }
}

#[test]
fn only_sorted_magnitudes_and_the_negative_sum_matter() {
    let (plain, mixed) = (law(&[0.2, 0.9, 0.4]), law(&[-0.9, 0.4, -0.2]));
    for u in [0.0, 0.1, 0.5, 0.93, 1.0] {
        assert!((plain.quantile(u) - 1.1 - mixed.quantile(u)).abs() < 1e-15);
    }
    assert!((mixed.mean() + 0.35).abs() < 1e-15);
}
