//! Quantile-cell means of the projected uniform cube, for all lanes at once.
//!
//! The `f64` twin of everything here is [`crate::Projected`]. In one and two dimensions the law of a projection
//! has a closed form; in more, [`crate::bank::Bank`] holds tabulated laws of a fixed set of directions, and sign changes and
//! permutations of the axes (which leave a law unchanged up to a shift) make many directions out of each.

use crate::bank::{Block, Boundary};
use crate::direction::Directions;
use crate::row::{LANES, Row};

/// The laws of one group of directions, of points whose coordinates are taken from the middle of the cube: each is
/// symmetric around 0.
pub(crate) enum LaneLaw<'a> {
    /// At most two components differ from zero: a trapezoid.
    Trapezoid(Trapezoid),
    /// A block of tabulated laws.
    Tabulated(Tabulated<'a>),
}

impl LaneLaw<'_> {
    /// Length of the support, per lane.
    #[inline(always)]
    pub(crate) fn extent(&self) -> &Row {
        match self {
            LaneLaw::Trapezoid(law) => &law.extent,
            LaneLaw::Tabulated(law) => &law.extent,
        }
    }

    /// Writes the means of the quantile function over the lower `n / 2` of `n` equal cells. Those of the upper half are
    /// their negatives, and that of a cell in the middle is 0.
    #[inline(always)]
    pub(crate) fn lower_cell_means(&self, n: usize, cells: &mut [Row]) {
        match self {
            LaneLaw::Trapezoid(law) if law.paired => law.lower_cell_means::<{ LANES / 2 }>(n, cells),
            LaneLaw::Trapezoid(law) => law.lower_cell_means::<LANES>(n, cells),
            LaneLaw::Tabulated(law) => law.lower_cell_means(n, cells),
        }
    }
}

/// Law of `a U + b V` for independent `U`, `V`, uniform on `[-1/2, 1/2]`, and `a ≥ b ≥ 0`.
pub(crate) struct Trapezoid {
    extent: Row,
    longer: Row,
    shorter: Row,
    paired: bool,
}

impl Trapezoid {
    /// The laws of directions in at most two dimensions.
    #[inline(always)]
    pub(crate) fn new(directions: &Directions) -> Self {
        let [mut extent, mut longer, mut shorter] = [[0.0_f32; LANES]; 3];
        for row in &directions.theta {
            for lane in 0..LANES {
                let length = row[lane].abs();
                extent[lane] += length;
                shorter[lane] = greater(shorter[lane], lesser(length, longer[lane]));
                longer[lane] = greater(longer[lane], length);
            }
        }
        Self { extent, longer, shorter, paired: directions.paired }
    }

    /// Cell means of the first `WIDTH` lanes, repeated in the others.
    #[inline(always)]
    fn lower_cell_means<const WIDTH: usize>(&self, n: usize, means: &mut [Row]) {
        let cells = n as f32;
        // In units of cells, from the lower end of the support: the rising edge of the trapezoid ends at `edge`, inside
        // cell `split`, whose mean is `split_mean`. Before it the quantile is sqrt(2 a b u), after it a u + b / 2.
        let [mut split, mut split_mean, mut tail, mut slope, mut offset, mut half] = [[0.0_f32; WIDTH]; 6];
        for lane in 0..WIDTH {
            let (a, b) = (greater(self.longer[lane], f32::MIN_POSITIVE), self.shorter[lane]);
            let edge = cells * (b / a) * 0.5;
            tail[lane] = (2.0 * a * b / cells).sqrt();
            slope[lane] = a / cells;
            // From the middle of the support, and to the middle of a cell.
            half[lane] = 0.5 * self.extent[lane];
            offset[lane] = b * 0.5 - half[lane] + 0.5 * slope[lane];
            split[lane] = edge.floor();
            let share = edge - split[lane];
            // Mean of sqrt over [split, edge] without cancellation.
            let (root_low, root_high) = (split[lane].sqrt(), edge.sqrt());
            let rising = tail[lane] * (2.0 / 3.0) * (edge + root_low * root_high + split[lane])
                / greater(root_low + root_high, f32::MIN_POSITIVE);
            let linear = slope[lane] * (edge + split[lane]) * 0.5 + offset[lane];
            split_mean[lane] = share * (rising - half[lane]) + (1.0 - share) * linear;
        }
        for (rank, mean) in means[..n / 2].iter_mut().enumerate() {
            let (cell, root_mean) = (rank as f32, root_mean(rank));
            for lane in 0..WIDTH {
                let rising = tail[lane] * root_mean - half[lane];
                let linear = slope[lane] * cell + offset[lane];
                let after = if cell > split[lane] { linear } else { split_mean[lane] };
                let value = if cell < split[lane] { rising } else { after };
                mean[lane] = value;
                mean[lane + LANES - WIDTH] = value;
            }
        }
    }
}

/// The greater of two numbers, in one instruction: `f32::max` would take care of NaN as well.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The lesser of two numbers.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Laws of one block of a bank, with some lanes replaced by coordinate axes.
pub(crate) struct Tabulated<'a> {
    block: &'a Block,
    grid: &'a [Boundary],
    on_axis: &'a [bool; LANES],
    extent: Row,
}

impl<'a> Tabulated<'a> {
    /// The laws of these directions for subsets whose quantile cells end at the boundaries of `grid`.
    #[inline(always)]
    pub(crate) fn new(directions: &'a Directions, block: &'a Block, grid: &'a [Boundary]) -> Self {
        let mut extent = [0.0_f32; LANES];
        for row in &directions.theta {
            for lane in 0..LANES {
                extent[lane] += row[lane].abs();
            }
        }
        Self { block, grid, on_axis: &directions.on_axis, extent }
    }

    #[inline(always)]
    fn lower_cell_means(&self, n: usize, means: &mut [Row]) {
        let cells = n as f64;
        let mut below = [0.0; LANES];
        for (rank, (mean, boundary)) in means[..n / 2].iter_mut().zip(self.grid).enumerate() {
            let integral = self.block.integral(boundary);
            let uniform = (rank as f32 + 0.5) / n as f32;
            for lane in 0..LANES {
                let tabulated = ((integral[lane] - below[lane]) * cells) as f32;
                let above = if self.on_axis[lane] { uniform } else { tabulated };
                mean[lane] = above - 0.5 * self.extent[lane];
            }
            below = integral;
        }
    }
}

/// Mean of the square root over `[rank, rank + 1]`.
#[inline(always)]
fn root_mean(rank: usize) -> f32 {
    // Rounded from (2/3) ((r+1)^1.5 - r^1.5), rewritten without cancellation.
    let low = rank as f32;
    let high = low + 1.0;
    let (root_low, root_high) = (low.sqrt(), high.sqrt());
    (2.0 / 3.0) * (high + root_low * root_high + low) / (root_low + root_high)
}
