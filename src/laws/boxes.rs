//! The law of a sum of independent uniforms on `[0, wᵢ]`: the univariate box spline.
//!
//! The textbook formula, an alternating sum over the 2^D subset sums of the widths, loses all digits by D ≈
//! 10. Here one box after the other is averaged in, `F_k(x) = mean of F_{k−1} over [x − w_k, x]`, on a mesh
//! that holds the points where the law is not smooth. Windows are sums of positive parts, so nothing cancels
//! and no width is too small. Only the lower half of the support is kept: the law is symmetric, and averages
//! look left.
//!
//! De Boor, Höllig, Riemenschneider 1993, *Box Splines*.

use super::piece::{Piece, Rise};

/// Widths whose subset sums all become nodes.
const EXACT_WIDTHS: usize = 6;
/// Cells that the sum of the other widths is cut into, after every such node.
const CELLS_PER_REST: usize = 4;
/// Cells of the whole support at least.
const CELLS: f64 = 256.0;
/// Rounding of the slopes (1e-16 over the square of this) stays harmless in cells of any length.
const EXACT_NARROWEST: f64 = 1e-4;
/// Extra nodes near the end of the support: the first, as a share of the sum of the other widths, ...
const LADDER_START: f64 = 0.01;
/// ... the ratio of neighbours ...
const LADDER_RATIO: f64 = 1.25;
/// ... and how many.
const LADDER_STEPS: i32 = 24;
/// Nodes closer than this are one node.
const SAME_NODE: f64 = 1e-13;
/// Windows of at most this many cells are summed; longer ones are differences of a running sum.
const SHORT_WINDOW: usize = 16;

/// Lower half of the distribution function, on `[0, 1/2]`, for `widths` that fall, are positive and sum to 1.
pub(super) fn lower_half(widths: &[f64]) -> Vec<Piece> {
    match *widths {
        [] => Vec::new(),
        [_] => vec![power(0.5, 0.5, 1.0)],
        [a, b] => {
            let edge = b.min(0.5);
            let mass = edge / a / 2.0;
            let mut pieces = vec![power(edge, mass.min(0.5), 2.0)];
            if edge < 0.5 && mass < 0.5 {
                let rise = Rise::Power { mass: 0.5 - mass, exponent: 1.0 };
                pieces.push(Piece { start: edge, width: 0.5 - edge, below: mass, rise });
            }
            pieces
        }
        [a, b, ref rest @ ..] => {
            let mut sum = Sum::of_two(a, b, mesh(widths));
            for &width in rest {
                sum = sum.plus(width);
            }
            sum.into_pieces()
        }
    }
}

fn power(width: f64, mass: f64, exponent: f64) -> Piece {
    Piece { start: 0.0, width, below: 0.0, rise: Rise::Power { mass, exponent } }
}

/// Nodes in `[0, 1/2]`, both ends included.
///
/// Every subset sum of the widest `EXACT_WIDTHS` is a node. The others blur what happens there over a stretch
/// as long as their sum, which is cut finely; the rest of the support is cut into cells of 1/`CELLS`.
fn mesh(widths: &[f64]) -> Vec<f64> {
    let (wide, narrow) = widths.split_at(widths.len().min(EXACT_WIDTHS));
    let mut nodes = vec![0.0];
    for width in wide {
        for i in 0..nodes.len() {
            nodes.push(nodes[i] + width);
        }
    }
    let rest: f64 = narrow.iter().sum();
    if rest > 0.0 {
        for i in 0..nodes.len() {
            let parts = (1..=CELLS_PER_REST).map(|part| part as f64 / CELLS_PER_REST as f64);
            let node = nodes[i];
            nodes.extend(parts.map(|part| node + part * rest));
        }
    }
    let narrowest = widths[widths.len() - 1];
    // Up to the narrowest width the law is a power; above it, x^D asks for cells in proportion to x.
    nodes.retain(|&node| node > narrowest);
    nodes.push(0.0);
    nodes.push(narrowest);
    if widths.len() > 4 {
        let first = narrowest.max(LADDER_START * rest);
        nodes.extend((0..LADDER_STEPS).map(|step| first * LADDER_RATIO.powi(step)));
    }
    nodes.retain(|&node| node < 0.5 - SAME_NODE);
    nodes.sort_unstable_by(f64::total_cmp);
    nodes.dedup_by(|next, kept| *next - *kept < SAME_NODE);
    nodes.push(0.5);
    if widths.len() <= 4 && narrowest > EXACT_NARROWEST {
        return nodes; // quartics are exact
    }
    let least_cuts = if rest > 0.0 { 1.0 } else { 2.0 };
    let mut fine = vec![0.0];
    for pair in nodes.windows(2) {
        let length = pair[1] - pair[0];
        // Cell 0 holds a power law, not a quartic.
        let exact = pair[0] == 0.0;
        let cuts = if exact { 1.0 } else { (length * CELLS).ceil().max(least_cuts) };
        fine.extend((1..cuts as usize).map(|cut| pair[0] + length * (cut as f64 / cuts)));
        fine.push(pair[1]);
    }
    fine
}

/// The law of the boxes added so far, at the nodes and over the cells of a mesh.
///
/// Inside cell `c` the distribution function is the quartic (in cell 0: the power law) that has its values
/// and slopes at both nodes and its mean over the cell.
struct Sum {
    nodes: Vec<f64>,
    cdf: Vec<f64>,
    density: Vec<f64>,
    /// Mean over cell `c` of the distribution function, less its value at node `c`.
    excess: Vec<f64>,
    /// Integral of the distribution function up to each node.
    integral: Vec<f64>,
}

/// What happens between a point and the right node of its cell.
struct RightOf {
    /// Integral of the distribution function.
    area: f64,
    /// Rise of the distribution function.
    rise: f64,
    /// Rise of the density.
    bend: f64,
}

impl Sum {
    /// The trapezoid of two boxes, `wide` ≥ `narrow`.
    fn of_two(wide: f64, narrow: f64, nodes: Vec<f64>) -> Self {
        let end = wide + narrow;
        let tail = |x: f64| (x / wide) * (x / narrow) / 2.0;
        let cdf = nodes
            .iter()
            .map(|&x| match x {
                _ if x <= narrow => tail(x),
                _ if x <= wide => (x - narrow / 2.0) / wide,
                _ => 1.0 - tail((end - x).max(0.0)),
            })
            .collect();
        let density: Vec<f64> =
            nodes.iter().map(|&x| x.min(narrow).min(end - x).max(0.0) / wide / narrow).collect();
        let cells = nodes.windows(2).zip(density.windows(2));
        let excess = cells.map(|(x, f)| (x[1] - x[0]) * (f[0] / 3.0 + f[1] / 6.0)).collect();
        Self { cdf, density, excess, integral: Vec::new(), nodes }.integrated()
    }

    fn cells(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Exponent of the power law of cell 0, which has the value and the slope of its right node.
    fn exponent(&self) -> f64 {
        let exponent = self.nodes[1] * self.density[1] / self.cdf[1];
        // A sum of boxes is log-concave, so 1 is the least possible; it also serves where all has
        // underflowed.
        if exponent.is_finite() { exponent.max(1.0) } else { 1.0 }
    }

    fn integrated(mut self) -> Self {
        self.excess[0] = self.cdf[1] / (self.exponent() + 1.0);
        let mut total = 0.0;
        self.integral = Vec::with_capacity(self.nodes.len());
        self.integral.push(total);
        for cell in 0..self.cells() {
            total += self.area(cell);
            self.integral.push(total);
        }
        self
    }

    /// Integral of the distribution function over a cell.
    fn area(&self, cell: usize) -> f64 {
        (self.nodes[cell + 1] - self.nodes[cell]) * (self.cdf[cell] + self.excess[cell])
    }

    fn right_of(&self, cell: usize, x: f64, exponent: f64) -> RightOf {
        let (start, end) = (self.nodes[cell], self.nodes[cell + 1]);
        let width = end - start;
        let s = ((end - x) / width).clamp(0.0, 1.0);
        let (cdf, density) = (self.cdf[cell + 1], self.density[cell + 1]);
        if cell == 0 {
            let log = (-s).ln_1p();
            let lost = |power: f64| if power > 0.0 { -(power * log).exp_m1() } else { 0.0 };
            return RightOf {
                area: width * self.excess[0] * lost(exponent + 1.0),
                rise: cdf * lost(exponent),
                bend: density * lost(exponent - 1.0),
            };
        }
        // Bernstein coefficients of cdf(end) − F, counted from the right.
        let mass = cdf - self.cdf[cell];
        let first = width * density / 4.0;
        let third = mass - width * self.density[cell] / 4.0;
        let second = 5.0 * (mass - self.excess[cell]) - first - third - mass;
        let a = 4.0 * first;
        let b = 6.0 * (second - 2.0 * first);
        let c = 4.0 * (third - 3.0 * second + 3.0 * first);
        let d = mass - 4.0 * third + 6.0 * second - 4.0 * first;
        RightOf {
            area: width * s * (cdf - s * (a / 2.0 + s * (b / 3.0 + s * (c / 4.0 + s * d / 5.0)))),
            rise: s * (a + s * (b + s * (c + s * d))),
            bend: -s * (2.0 * b + s * (3.0 * c + s * 4.0 * d)) / width,
        }
    }

    /// The law with one more box.
    fn plus(&self, width: f64) -> Self {
        let count = self.nodes.len();
        let exponent = self.exponent();
        let mut cdf = Vec::with_capacity(count);
        let mut density = Vec::with_capacity(count);
        let mut slope = Vec::with_capacity(count);
        let mut cell = 0;
        for (node, &x) in self.nodes.iter().enumerate() {
            let left = x - width;
            let mut area = self.integral[node];
            let mut rise = self.cdf[node];
            let mut bend = self.density[node];
            if left > 0.0 {
                while self.nodes[cell + 1] <= left {
                    cell += 1;
                }
                let right = self.right_of(cell, left, exponent);
                area = right.area
                    + if node - cell > SHORT_WINDOW {
                        self.integral[node] - self.integral[cell + 1]
                    } else {
                        (cell + 1..node).map(|cell| self.area(cell)).sum()
                    };
                rise = right.rise + (self.cdf[node] - self.cdf[cell + 1]);
                bend = right.bend + (self.density[node] - self.density[cell + 1]);
            }
            cdf.push(area / width);
            density.push(rise / width);
            slope.push(bend / width);
        }
        // Quadrature of order 6 from values, slopes and second derivatives at both ends.
        let excess = (0..count - 1)
            .map(|i| {
                let h = self.nodes[i + 1] - self.nodes[i];
                (cdf[i + 1] - cdf[i]) / 2.0
                    + h * (density[i] - density[i + 1]) / 10.0
                    + h * h * (slope[i] + slope[i + 1]) / 120.0
            })
            .collect();
        Self { nodes: self.nodes.clone(), cdf, density, excess, integral: Vec::new() }.integrated()
    }

    fn into_pieces(mut self) -> Vec<Piece> {
        // By symmetry half of the probability lies left of the middle, exactly.
        let mut greatest = 0.0_f64;
        for cdf in &mut self.cdf {
            greatest = greatest.max(cdf.min(0.5));
            *cdf = greatest;
        }
        self.cdf[self.nodes.len() - 1] = 0.5;
        let mut pieces = vec![power(self.nodes[1], self.cdf[1], self.exponent())];
        for cell in 1..self.cells() {
            let width = self.nodes[cell + 1] - self.nodes[cell];
            let slopes = (width * self.density[cell], width * self.density[cell + 1]);
            let below = self.cdf[cell];
            let rise = Rise::monotone(self.cdf[cell + 1] - below, slopes, self.excess[cell]);
            pieces.push(Piece { start: self.nodes[cell], width, below, rise });
        }
        pieces
    }
}
