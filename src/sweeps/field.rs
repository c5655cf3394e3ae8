//! Mean distance to the uniform measure on the unit cube, `φ(x) = E|x − u|`, and its gradient.
//!
//! In one dimension `φ = x² − x + ½`. In more, `|v| = π^{−½} ∫₀^∞ (1 − exp(−q²|v|²)) q^{−2} dq` makes the
//! mean over the cube factor into integrals over single coordinates, so that one quadrature over `q` serves
//! any number of dimensions:
//!
//! ```text
//! φ(x) = π^{−½} ∫₀^∞ (1 − Π_k g(x_k)) q^{−2} dq,     ∂_k φ(x) = 2 π^{−½} ∫₀^∞ h(x_k) Π_{l≠k} g(x_l) dq,
//! g(x) = ∫₀¹ exp(−q²(x−u)²) du,     h(x) = ∫₀¹ (x−u) exp(−q²(x−u)²) du.
//! ```

use std::f64::consts::{FRAC_2_SQRT_PI, PI};

use crate::simd::{LANES, Row};

/// `φ`, its gradient and its mean, in `f64`.
#[derive(Clone, Debug)]
pub(super) struct MeanDistance {
    nodes: Vec<Node>,
}

/// A node of the quadrature; its weight holds `π^{−½} dq`.
#[derive(Clone, Copy, Debug)]
struct Node {
    q: f64,
    weight: f64,
}

/// Nodes of the quadrature: good for 1e-9 of the value in two and more dimensions, and for 1e-6 of the
/// gradient, which has the sharper edges near the faces of the square.
const NODES: usize = 48;

impl MeanDistance {
    pub(super) fn new() -> Self {
        Self::with_nodes(NODES)
    }

    fn with_nodes(count: usize) -> Self {
        let nodes = gauss_legendre(count).into_iter().map(|(t, weight)| {
            // q = t / (1 - t)
            let rest = 1.0 - t;
            Node { q: t / rest, weight: weight / (rest * rest) * 0.5 * FRAC_2_SQRT_PI }
        });
        Self { nodes: nodes.collect() }
    }

    /// `φ(x)`.
    pub(super) fn value(&self, point: &[f64]) -> f64 {
        if let &[x] = point {
            return x * x - x + 0.5;
        }
        self.integral(|q| point.iter().map(|&x| bump(q, x)).product())
    }

    /// `E|u − u'|` for two independent uniform points of the cube.
    pub(super) fn mean(&self, dims: usize) -> f64 {
        if dims == 1 {
            return 1.0 / 3.0;
        }
        self.integral(|q| {
            let mean_bump = libm::erf(q) / (0.5 * FRAC_2_SQRT_PI * q) + (-q * q).exp_m1() / (q * q);
            mean_bump.powi(dims as i32)
        })
    }

    fn integral(&self, product: impl Fn(f64) -> f64) -> f64 {
        self.nodes.iter().map(|node| node.weight * (1.0 - product(node.q)) / (node.q * node.q)).sum()
    }

    /// Writes the gradient of `φ`.
    pub(super) fn gradient(&self, point: &[f64], gradient: &mut [f64]) {
        if let &[x] = point {
            gradient[0] = 2.0 * x - 1.0;
            return;
        }
        gradient.fill(0.0);
        for node in &self.nodes {
            for (k, slope) in gradient.iter_mut().enumerate() {
                let others = (0..point.len()).filter(|&l| l != k).map(|l| bump(node.q, point[l]));
                *slope += 2.0 * node.weight * lean(node.q, point[k]) * others.product::<f64>();
            }
        }
    }
}

/// `g`.
fn bump(q: f64, x: f64) -> f64 {
    (libm::erf(q * x) + libm::erf(q * (1.0 - x))) / (q * FRAC_2_SQRT_PI)
}

/// `h`.
fn lean(q: f64, x: f64) -> f64 {
    // (exp(−q²(1−x)²) − exp(−q²x²)) / 2q², without cancellation and from the side that does not overflow.
    let (near, far, sign) = if x < 0.5 { (x, 1.0 - x, 1.0) } else { (1.0 - x, x, -1.0) };
    sign * libm::exp(-q * q * near * near) * libm::expm1(-q * q * (far - near)) / (2.0 * q * q)
}

/// Nodes and weights of Gauss and Legendre on `[0, 1]`, by Newton's method on the three-term recurrence.
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = n as f64 * (x * value - before) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// The gradient of `φ`, tabulated in `f32`.
#[derive(Clone, Debug)]
pub(super) enum FieldTable {
    /// One dimension needs no table.
    Line,
    /// `∂₀φ` at `(i, j) / GRID`; `∂₁φ` by symmetry.
    Plane(Vec<f32>),
    /// `h` times its node's weight, and `g`, of all nodes at `i / GRID`: one node per lane.
    Nodes { leans: Vec<Row>, bumps: Vec<Row> },
}

/// Intervals of a table per coordinate.
const GRID: usize = 128;

impl FieldTable {
    pub(super) fn new(dims: usize) -> Self {
        let at = |i: usize| i as f64 / GRID as f64;
        match dims {
            1 => Self::Line,
            2 => {
                let mut slopes = vec![0.0; (GRID + 1) * (GRID + 1)];
                for Node { q, weight } in MeanDistance::new().nodes {
                    let bumps: [f64; GRID + 1] = std::array::from_fn(|i| bump(q, at(i)));
                    for (i, row) in slopes.chunks_exact_mut(GRID + 1).enumerate() {
                        let lean = 2.0 * weight * lean(q, at(i));
                        row.iter_mut().zip(&bumps).for_each(|(slope, bump)| *slope += lean * bump);
                    }
                }
                Self::Plane(slopes.iter().map(|&slope| slope as f32).collect())
            }
            _ => {
                // In more dimensions the faces are smoother: as many nodes as lanes are good for 1e-5.
                let nodes = MeanDistance::with_nodes(LANES).nodes;
                let table = |of: &dyn Fn(&Node, f64) -> f64| {
                    (0..=GRID).map(|i| std::array::from_fn(|node| of(&nodes[node], at(i)) as f32)).collect()
                };
                let leans = table(&|node, x| 2.0 * node.weight * lean(node.q, x));
                Self::Nodes { leans, bumps: table(&|node, x| bump(node.q, x)) }
            }
        }
    }

    /// Writes the gradient at the points of all lanes, one row per dimension.
    #[inline(always)]
    pub(super) fn gradient(&self, points: &[Row], gradient: &mut [Row]) {
        match self {
            Self::Line => {
                for lane in 0..LANES {
                    gradient[0][lane] = 2.0 * points[0][lane] - 1.0;
                }
            }
            Self::Plane(slopes) => {
                for lane in 0..LANES {
                    let (x, y) = (Cell::of(points[0][lane]), Cell::of(points[1][lane]));
                    let slope = |a: Cell, b: Cell| {
                        let at = a.index * (GRID + 1);
                        a.between(b.look(&slopes[at..]), b.look(&slopes[at + GRID + 1..]))
                    };
                    gradient[0][lane] = slope(x, y);
                    gradient[1][lane] = slope(y, x);
                }
            }
            Self::Nodes { leans, bumps } => {
                for lane in 0..LANES {
                    let mut product = [1.0; LANES];
                    for row in points {
                        let bump = Cell::of(row[lane]).look_up(bumps);
                        for node in 0..LANES {
                            product[node] *= bump[node];
                        }
                    }
                    for (slope, row) in gradient.iter_mut().zip(points) {
                        let cell = Cell::of(row[lane]);
                        let (lean, bump) = (cell.look_up(leans), cell.look_up(bumps));
                        let mut sum = 0.0;
                        for node in 0..LANES {
                            // A bump is never 0: it is at least ½ erf(q) / q at an end of the interval.
                            sum += lean[node] * (product[node] / bump[node]);
                        }
                        slope[lane] = sum;
                    }
                }
            }
        }
    }
}

/// Interval of a table that holds a coordinate, and where inside.
#[derive(Clone, Copy)]
struct Cell {
    index: usize,
    share: f32,
}

impl Cell {
    #[inline(always)]
    fn of(x: f32) -> Self {
        let scaled = x * GRID as f32;
        let index = (scaled as usize).min(GRID - 1);
        Self { index, share: scaled - index as f32 }
    }

    #[inline(always)]
    fn between(self, low: f32, high: f32) -> f32 {
        low + self.share * (high - low)
    }

    #[inline(always)]
    fn look_up(self, table: &[Row]) -> Row {
        let (low, high) = (&table[self.index], &table[self.index + 1]);
        let mut between = [0.0; LANES];
        for node in 0..LANES {
            between[node] = self.between(low[node], high[node]);
        }
        between
    }

    #[inline(always)]
    fn look(self, table: &[f32]) -> f32 {
        self.between(table[self.index], table[self.index + 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_have_their_known_values() {
        let field = MeanDistance::new();
        // Mean distance of the unit square's points to a corner, to its centre, and to each other.
        let root = 2.0_f64.sqrt();
        let corner = (root + (1.0 + root).ln()) / 3.0;
        assert!((field.value(&[0.0, 0.0]) - corner).abs() < 1e-10);
        assert!((field.value(&[0.5, 0.5]) - 0.5 * corner).abs() < 1e-10);
        assert!((field.mean(2) - 0.521_405_433_164_720_7).abs() < 1e-10);
        // Robbins's constant, the mean distance in the cube.
        assert!((field.mean(3) - 0.661_707_182_267_176_2).abs() < 1e-10);
        assert_eq!((field.value(&[0.25]), field.mean(1)), (0.3125, 1.0 / 3.0));
    }

    #[test]
    fn the_gradient_is_the_slope_of_the_value() {
        let field = MeanDistance::new();
        for dims in 1..=8 {
            let point: Vec<f64> = (0..dims).map(|k| (0.07 + 0.618 * k as f64).fract()).collect();
            let mut gradient = vec![0.0; dims];
            field.gradient(&point, &mut gradient);
            for k in 0..dims {
                let at = |step: f64| {
                    let mut moved = point.clone();
                    moved[k] += step;
                    field.value(&moved)
                };
                let slope = (at(1e-4) - at(-1e-4)) / 2e-4;
                // Second-order differences: about 1e-8 times a third derivative of order 10.
                assert!((gradient[k] - slope).abs() < 2e-7, "{dims} {k}: {} {slope}", gradient[k]);
            }
        }
    }

    #[test]
    fn tables_follow_the_field() {
        let field = MeanDistance::new();
        for dims in 1..=6 {
            let table = FieldTable::new(dims);
            let (mut gradient, mut exact) = (vec![[0.0; LANES]; dims], vec![0.0; dims]);
            let point = |lane: usize, k: usize| (0.37 * lane as f64 + 0.618 * (k * lane) as f64).fract();
            let rows: Vec<Row> =
                (0..dims).map(|k| std::array::from_fn(|lane| point(lane, k) as f32)).collect();
            table.gradient(&rows, &mut gradient);
            for lane in 0..LANES {
                let at: Vec<f64> = rows.iter().map(|row| f64::from(row[lane])).collect();
                field.gradient(&at, &mut exact);
                for k in 0..dims {
                    // Linear interpolation: (1 / 128)² / 8 times a curvature of a few units; largest at the
                    // faces.
                    let error = f64::from(gradient[k][lane]) - exact[k];
                    assert!(error.abs() < 2e-4, "{dims} {k} {at:?}: {error}");
                }
            }
        }
    }
}
