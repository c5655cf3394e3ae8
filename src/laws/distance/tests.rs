//! One-dimensional distances against brute force: all assignments, and quadrature of distribution functions
//! that are written down here from the textbook.

use proptest::prelude::*;

use super::*;

/// Distribution function of a sum of at most three independent uniforms on `[0, wᵢ]`: the alternating sum,
/// harmless for few widths of similar size.
fn textbook_cdf(x: f64, widths: &[f64]) -> f64 {
    let degree = widths.len() as i32;
    let mut sum = 0.0;
    for subset in 0..1_u32 << degree {
        let inside = |i: &usize| subset >> i & 1 == 1;
        let corner: f64 = (0..widths.len()).filter(inside).map(|i| widths[i]).sum();
        let sign = if subset.count_ones() % 2 == 0 { 1.0 } else { -1.0 };
        sum += sign * (x - corner).max(0.0).powi(degree);
    }
    let factorial: f64 = (1..=degree).map(f64::from).product();
    (sum / (factorial * widths.iter().product::<f64>())).clamp(0.0, 1.0)
}

/// `∫ |F_n − F| dx` for weighted points, with nodes at the points and at the kinks of `F`, one more where the
/// difference changes sign, and Gauss–Legendre with three points between: exact for polynomials of degree 5.
fn area_between(direction: &[f64], points: &[(f64, f64)]) -> f64 {
    let widths: Vec<f64> = direction.iter().map(|component| component.abs()).collect();
    let low: f64 = direction.iter().map(|component| component.min(0.0)).sum();
    let total: f64 = points.iter().map(|point| point.1).sum();
    let mut nodes: Vec<f64> = points.iter().map(|point| point.0).collect();
    for subset in 0..1_u32 << widths.len() {
        let inside = |i: &usize| subset >> i & 1 == 1;
        nodes.push(low + (0..widths.len()).filter(inside).map(|i| widths[i]).sum::<f64>());
    }
    nodes.sort_unstable_by(f64::total_cmp);
    let mut area = 0.0;
    for pair in nodes.windows(2) {
        let (left, right) = (pair[0], pair[1]);
        // The empirical distribution function is constant inside.
        let below: f64 = points.iter().filter(|point| point.0 <= left).map(|point| point.1).sum();
        let difference = |x: f64| textbook_cdf(x - low, &widths) - below / total;
        // F rises, so the difference changes sign at most once: bisection to the last bit.
        let (mut from, mut to) = (left, right);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if difference(middle) < 0.0 { from = middle } else { to = middle }
        }
        for (from, to) in [(left, from), (from, right)] {
            let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
            let spread = half * 0.6_f64.sqrt();
            let [a, b, c] = [centre - spread, centre, centre + spread].map(difference);
            area += (half * (5.0 * a + 8.0 * b + 5.0 * c) / 9.0).abs();
        }
    }
    area
}

/// Calls `visit` with every permutation of `items[at..]`.
fn permutations(items: &mut [usize], at: usize, visit: &mut impl FnMut(&[usize])) {
    if at == items.len() {
        return visit(items);
    }
    for other in at..items.len() {
        items.swap(at, other);
        permutations(items, at + 1, visit);
        items.swap(at, other);
    }
}

/// Directions with no component below a twentieth of the largest, for the sake of the textbook sum; any sign.
fn direction() -> impl Strategy<Value = Vec<f64>> {
    let component = (0.05..1.0_f64, any::<bool>()).prop_map(|(size, sign)| if sign { size } else { -size });
    prop::collection::vec(component, 1..=3)
}

/// Points along a direction, as shares of the support (a little beyond it too), some of them twice.
fn shares(most: usize) -> impl Strategy<Value = Vec<f64>> {
    let share = prop_oneof![4 => -0.1..1.1_f64, 1 => Just(0.25), 1 => Just(0.0), 1 => Just(1.0)];
    prop::collection::vec(share, 1..=most)
}

fn along(direction: &[f64], shares: &[f64]) -> Vec<f64> {
    let low: f64 = direction.iter().map(|component| component.min(0.0)).sum();
    let extent: f64 = direction.iter().map(|component| component.abs()).sum();
    shares.iter().map(|share| low + share * extent).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Each of n points takes one of n equal cells of the target whole: the sorted assignment is the cheapest
    /// of all n!, for both costs, and its cost is what is returned. (Splitting cells cannot do better:
    /// Birkhoff.)
    #[test]
    fn no_assignment_is_cheaper(direction in direction(), shares in shares(7)) {
        let law = Projected::of_cube(&direction);
        let points = along(&direction, &shares);
        let n = points.len();
        let cell = |i: usize| (i as f64 / n as f64, (i + 1) as f64 / n as f64);
        let table = |cost: &dyn Fn(usize, f64) -> f64| -> Vec<Vec<f64>> {
            points.iter().map(|&point| (0..n).map(|i| cost(i, point)).collect()).collect()
        };
        let first = table(&|i, point| law.w1_cell(cell(i).0, cell(i).1, point));
        // The spread of the law inside the cells is the same for every assignment.
        let means: Vec<f64> = (0..n).map(|i| law.cell_mean(cell(i).0, cell(i).1)).collect();
        let second = table(&|i, point| (point - means[i]).powi(2) / n as f64);
        let spread = law.second_moment() - means.iter().map(|mean| mean * mean).sum::<f64>() / n as f64;
        let (mut least1, mut least2) = (f64::INFINITY, f64::INFINITY);
        permutations(&mut (0..n).collect::<Vec<_>>(), 0, &mut |order| {
            let cost = |table: &[Vec<f64>]| order.iter().zip(table).map(|(&i, row)| row[i]).sum::<f64>();
            (least1, least2) = (least1.min(cost(&first)), least2.min(cost(&second)));
        });
        let mut workspace = Workspace::default();
        // Sums of at most seven numbers below 4.
        let w1 = workspace.w1(&law, &points, None);
        prop_assert!((w1 - least1).abs() < 1e-12, "{w1} {least1}");
        let squared = workspace.displacements(&law, &points, None, &mut vec![0.0; n]);
        prop_assert!((squared - (least2 + spread)).abs() < 1e-12, "{squared} {least2} {spread}");
    }

    /// The 1-Wasserstein distance is the area between the distribution functions, for masses of any size.
    #[test]
    fn w1_is_the_area_between_distribution_functions(
        direction in direction(),
        shares in shares(40),
        weights in prop::collection::vec(0.01..1.0_f64, 40),
        weighted in any::<bool>(),
    ) {
        let law = Projected::of_cube(&direction);
        let mut projections = along(&direction, &shares);
        // Points beyond the support are dearer by their distance; the area is taken between the outermost
        // nodes.
        let weights = weighted.then(|| &weights[..projections.len()]);
        let masses = |i: usize| weights.map_or(1.0, |weights| weights[i]);
        let places = projections.iter().enumerate();
        let points: Vec<(f64, f64)> = places.map(|(i, &at)| (at, masses(i))).collect();
        let area = area_between(&direction, &points);
        let w1 = Workspace::default().w1(&law, &projections, weights);
        // The twin's alternating sum of three cubes loses up to 1 / (6 · 0.05²) = 70 roundings of 1e-16 to
        // 3e-15.
        prop_assert!((w1 - area).abs() < 1e-12, "{w1} {area}");
        // The order of the points does not matter without weights.
        if weights.is_none() {
            projections.reverse();
            let reversed = Workspace::default().w1(&law, &projections, None);
            prop_assert!((w1 - reversed).abs() < 1e-14);
        }
    }
}
