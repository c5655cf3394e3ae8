//! Quantile-cell means of the projected uniform cube, for all lanes at once.
//!
//! The `f64` twin of everything here is [`crate::Projected`]. In one and two dimensions the law of a projection
//! has a closed form; in more, [`crate::bank::Bank`] holds tabulated laws of a fixed set of directions, and sign changes and
//! permutations of the axes (which leave a law unchanged up to a shift) make many directions out of each.

use crate::bank::{Block, Boundary};
use crate::direction::Directions;
use crate::row::{LANES, Row};

/// The laws of one group of directions.
pub(crate) enum LaneLaw<'a> {
    /// At most two components differ from zero: a trapezoid.
    Trapezoid(Trapezoid),
    /// A block of tabulated laws.
    Tabulated(Tabulated<'a>),
}

impl LaneLaw<'_> {
    /// Lowest projection and length of the support, per lane.
    #[inline(always)]
    pub(crate) fn support(&self) -> (&Row, &Row) {
        match self {
            LaneLaw::Trapezoid(law) => (&law.lowest, &law.extent),
            LaneLaw::Tabulated(law) => (&law.lowest, &law.extent),
        }
    }

    /// Writes the means of the quantile function over `cells.len()` equal cells.
    #[inline(always)]
    pub(crate) fn cell_means(&self, cells: &mut [Row]) {
        match self {
            LaneLaw::Trapezoid(law) => law.cell_means(cells),
            LaneLaw::Tabulated(law) => law.cell_means(cells),
        }
    }
}

/// Law of `a U + b V + lowest` for independent uniform `U`, `V` and `a ≥ b ≥ 0`.
pub(crate) struct Trapezoid {
    lowest: Row,
    extent: Row,
    longer: Row,
    shorter: Row,
}

impl Trapezoid {
    /// The laws of these directions, given by the rows of their components; at most two rows.
    #[inline(always)]
    pub(crate) fn new(theta: &[Row]) -> Self {
        let [mut lowest, mut extent, mut longer, mut shorter] = [[0.0_f32; LANES]; 4];
        for row in theta {
            for lane in 0..LANES {
                let length = row[lane].abs();
                lowest[lane] += row[lane].min(0.0);
                extent[lane] += length;
                shorter[lane] = shorter[lane].max(length.min(longer[lane]));
                longer[lane] = longer[lane].max(length);
            }
        }
        Self { lowest, extent, longer, shorter }
    }

    #[inline(always)]
    fn cell_means(&self, means: &mut [Row]) {
        let n = means.len();
        let cells = n as f32;
        // In units of cells: the rising edge of the trapezoid ends at `edge`, inside cell `split`, whose mean is
        // `split_mean`. Before it the quantile is sqrt(2 a b u), after it a u + b / 2.
        let [mut split, mut split_mean, mut tail, mut slope, mut offset] = [[0.0; LANES]; 5];
        for lane in 0..LANES {
            let (a, b) = (self.longer[lane].max(f32::MIN_POSITIVE), self.shorter[lane]);
            let edge = cells * (b / a) * 0.5;
            tail[lane] = (2.0 * a * b / cells).sqrt();
            slope[lane] = a / cells;
            offset[lane] = b * 0.5;
            split[lane] = edge.floor();
            let share = edge - split[lane];
            // Mean of sqrt over [split, edge] without cancellation.
            let (root_low, root_high) = (split[lane].sqrt(), edge.sqrt());
            let rising = tail[lane] * (2.0 / 3.0) * (edge + root_low * root_high + split[lane])
                / (root_low + root_high).max(f32::MIN_POSITIVE);
            let linear = slope[lane] * (edge + split[lane] + 1.0) * 0.5 + offset[lane];
            split_mean[lane] = share * rising + (1.0 - share) * linear;
        }
        let (lower, upper) = means.split_at_mut(n.div_ceil(2));
        for (rank, (mean, mirrored)) in lower.iter_mut().zip(upper.iter_mut().rev()).enumerate() {
            let (cell, root_mean) = (rank as f32, root_mean(rank));
            for lane in 0..LANES {
                let rising = tail[lane] * root_mean;
                let linear = slope[lane] * (cell + 0.5) + offset[lane];
                let after = if cell > split[lane] { linear } else { split_mean[lane] };
                let above = if cell < split[lane] { rising } else { after };
                mean[lane] = self.lowest[lane] + above;
                mirrored[lane] = self.lowest[lane] + (self.extent[lane] - above);
            }
        }
        if n % 2 == 1 {
            for (lane, middle) in lower[n / 2].iter_mut().enumerate() {
                *middle = self.lowest[lane] + 0.5 * self.extent[lane];
            }
        }
    }
}

/// Laws of one block of a bank, with some lanes replaced by coordinate axes.
pub(crate) struct Tabulated<'a> {
    block: &'a Block,
    grid: &'a [Boundary],
    on_axis: &'a [bool; LANES],
    lowest: Row,
    extent: Row,
}

impl<'a> Tabulated<'a> {
    /// The laws of these directions for subsets whose quantile cells end at the boundaries of `grid`.
    #[inline(always)]
    pub(crate) fn new(directions: &'a Directions, block: &'a Block, grid: &'a [Boundary]) -> Self {
        let (mut lowest, mut extent) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for row in &directions.theta {
            for lane in 0..LANES {
                lowest[lane] += row[lane].min(0.0);
                extent[lane] += row[lane].abs();
            }
        }
        Self { block, grid, on_axis: &directions.on_axis, lowest, extent }
    }

    #[inline(always)]
    fn cell_means(&self, means: &mut [Row]) {
        let n = means.len();
        let cells = n as f64;
        let mut below = [0.0; LANES];
        let (lower, upper) = means.split_at_mut(n / 2);
        let mirrored = upper.iter_mut().rev();
        for (rank, ((mean, mirrored), boundary)) in lower.iter_mut().zip(mirrored).zip(self.grid).enumerate()
        {
            let integral = self.block.integral(boundary);
            let uniform = (rank as f32 + 0.5) / n as f32;
            for lane in 0..LANES {
                let tabulated = ((integral[lane] - below[lane]) * cells) as f32;
                let above = if self.on_axis[lane] { uniform } else { tabulated };
                mean[lane] = self.lowest[lane] + above;
                mirrored[lane] = self.lowest[lane] + (self.extent[lane] - above);
            }
            below = integral;
        }
        if n % 2 == 1 {
            for (lane, middle) in upper[0].iter_mut().enumerate() {
                *middle = self.lowest[lane] + 0.5 * self.extent[lane];
            }
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
