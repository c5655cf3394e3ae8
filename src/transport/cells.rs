//! Quantile-cell means of the projected uniform cube, for all lanes at once.
//!
//! The `f64` twin of everything here is [`crate::targets::Projected`]. In one and two dimensions the law of a
//! projection has a closed form; in more, a bank holds tabulated laws of a fixed set of directions
//! ([`crate::directions::cube_bank`]), and sign changes and permutations of the axes (which leave a law
//! unchanged up to a shift) make many directions out of each.

use pulp::Simd;

use crate::directions::cube_bank::{Block, Boundary};
use crate::directions::{Directions, Laws};
use crate::laws::Pieces;
use crate::simd::{LANES, Row};

/// The laws of a subset's directions, of points whose coordinates are taken from the middle of the cube.
pub(crate) enum LaneLaws<'a> {
    /// Of the cube: each is symmetric around 0.
    Symmetric(SymmetricLaws<'a>),
    /// Of another target.
    Pieces(PieceLaws<'a>),
}

/// Laws that are symmetric around 0, so that half of their cells says all.
pub(crate) enum SymmetricLaws<'a> {
    /// At most two components differ from zero: a trapezoid.
    Trapezoid(Trapezoid),
    /// A block of tabulated laws.
    Tabulated(Tabulated<'a>),
}

impl<'a> LaneLaws<'a> {
    /// The laws of these directions, for subsets whose quantile cells end at the boundaries of `grid` (only
    /// asked where laws are tabulated).
    #[inline(always)]
    pub(crate) fn new<S: Simd>(
        simd: S,
        directions: &'a Directions,
        laws: Laws<'a>,
        grid: impl FnOnce() -> &'a [Boundary],
    ) -> Self {
        match laws {
            Laws::Closed => Self::Symmetric(SymmetricLaws::Trapezoid(Trapezoid::new(simd, directions))),
            Laws::Block { block, on_axis } => {
                Self::Symmetric(SymmetricLaws::Tabulated(Tabulated::new(directions, block, on_axis, grid())))
            }
            Laws::Pieces { bank, places } => {
                let law = |lane: usize| bank.law(places[lane] as usize);
                Self::Pieces(PieceLaws::new(directions, std::array::from_fn(law)))
            }
        }
    }

    /// Length of the support, per lane.
    #[inline(always)]
    pub(crate) fn extent(&self) -> &Row {
        match self {
            LaneLaws::Symmetric(SymmetricLaws::Trapezoid(law)) => &law.extent,
            LaneLaws::Symmetric(SymmetricLaws::Tabulated(law)) => &law.extent,
            LaneLaws::Pieces(law) => &law.extent,
        }
    }
}

impl SymmetricLaws<'_> {
    /// Writes the means of the quantile function over the lower `n / 2` of `n` equal cells. Those of the
    /// upper half are their negatives, and that of a cell in the middle is 0. `root_means` are those of
    /// [`root_mean`].
    #[inline(always)]
    pub(crate) fn lower_cell_means<S: Simd>(&self, simd: S, n: usize, root_means: &[f32], cells: &mut [Row]) {
        match self {
            SymmetricLaws::Trapezoid(law) => law.lower_cell_means(simd, n, root_means, cells),
            SymmetricLaws::Tabulated(law) => law.lower_cell_means(n, cells),
        }
    }
}

/// Laws of a target other than the cube.
pub(crate) struct PieceLaws<'a> {
    laws: [&'a Pieces; LANES],
    count: usize,
    extent: Row,
    /// Projection of the middle of the cube.
    centre: [f64; LANES],
}

impl<'a> PieceLaws<'a> {
    #[inline(always)]
    fn new(directions: &Directions, laws: [&'a Pieces; LANES]) -> Self {
        let (mut extent, mut centre) = ([0.0_f32; LANES], [0.0; LANES]);
        for row in &directions.theta {
            for lane in 0..LANES {
                extent[lane] += row[lane].abs();
                centre[lane] += 0.5 * f64::from(row[lane]);
            }
        }
        Self { laws, count: directions.count, extent, centre }
    }

    /// Writes the means of the quantile function over all cells.
    #[inline(always)]
    pub(crate) fn cell_means(&self, means: &mut [Row]) {
        let cells = means.len();
        for (lane, (law, centre)) in self.laws.iter().zip(&self.centre).enumerate().take(self.count) {
            law.for_each_cell(cells, |cell, mean| means[cell][lane] = (mean - centre) as f32);
        }
    }
}

/// Law of `a U + b V` for independent `U`, `V`, uniform on `[-1/2, 1/2]`, and `a ≥ b ≥ 0`.
///
/// Written with explicit vectors: left to itself, the compiler takes these few rows apart into scalars.
pub(crate) struct Trapezoid {
    extent: Row,
    longer: Row,
    shorter: Row,
    paired: bool,
}

impl Trapezoid {
    /// The laws of directions in at most two dimensions.
    #[inline(always)]
    pub(crate) fn new<S: Simd>(simd: S, directions: &Directions) -> Self {
        let [mut extent, mut longer, mut shorter] = [[0.0_f32; LANES]; 3];
        for theta in &directions.theta {
            let (theta, _) = S::as_simd_f32s(theta);
            let (extent, _) = S::as_mut_simd_f32s(&mut extent);
            let (longer, _) = S::as_mut_simd_f32s(&mut longer);
            let (shorter, _) = S::as_mut_simd_f32s(&mut shorter);
            for (((theta, extent), longer), shorter) in theta.iter().zip(extent).zip(longer).zip(shorter) {
                let length = simd.abs_f32s(*theta);
                *extent = simd.add_f32s(*extent, length);
                *shorter = simd.max_f32s(*shorter, simd.min_f32s(length, *longer));
                *longer = simd.max_f32s(*longer, length);
            }
        }
        Self { extent, longer, shorter, paired: directions.paired }
    }

    /// `root_means` holds the means of the square root over `[0, 1]`, `[1, 2]`, ….
    #[inline(always)]
    fn lower_cell_means<S: Simd>(&self, simd: S, n: usize, root_means: &[f32], means: &mut [Row]) {
        let (longer, _) = S::as_simd_f32s(&self.longer);
        let (shorter, _) = S::as_simd_f32s(&self.shorter);
        let (extent, _) = S::as_simd_f32s(&self.extent);
        let (means, _) = S::as_mut_simd_f32s(means.as_flattened_mut());
        let columns = longer.len();
        // The upper half of the lanes repeats the lower one, where vectors are short enough to tell.
        let repeats = self.paired && columns > 1;
        let distinct = if repeats { columns / 2 } else { columns };
        for column in 0..distinct {
            let cells = Cells::new(simd, n as f32, longer[column], shorter[column], extent[column]);
            for (rank, (row, root_mean)) in means.chunks_exact_mut(columns).zip(root_means).enumerate() {
                let mean = cells.mean(simd, rank as f32, *root_mean);
                row[column] = mean;
                if repeats {
                    row[column + distinct] = mean;
                }
            }
        }
    }
}

/// Quantile cells of one vector of trapezoids, counted from the lower end of the support.
///
/// In units of cells the rising edge of the trapezoid ends inside cell `split`, whose mean is `split_mean`.
/// Before it the quantile is `sqrt(2 a b u)`, after it `a u + b / 2`, less half the extent.
struct Cells<S: Simd> {
    split: S::f32s,
    split_mean: S::f32s,
    tail: S::f32s,
    slope: S::f32s,
    offset: S::f32s,
    half: S::f32s,
}

impl<S: Simd> Cells<S> {
    #[inline(always)]
    fn new(simd: S, cells: f32, longer: S::f32s, shorter: S::f32s, extent: S::f32s) -> Self {
        let number = |value: f32| simd.splat_f32s(value);
        let times = |a, b| simd.mul_f32s(a, b);
        let plus = |a, b| simd.add_f32s(a, b);
        let least = number(f32::MIN_POSITIVE);
        let (a, b) = (simd.max_f32s(longer, least), shorter);
        let share_of_cell = number(1.0 / cells);
        let edge = times(simd.div_f32s(b, a), number(0.5 * cells));
        let tail = simd.sqrt_f32s(times(times(a, b), times(number(2.0), share_of_cell)));
        let slope = times(a, share_of_cell);
        let half = times(extent, number(0.5));
        let half_cell = times(slope, number(0.5));
        let offset = plus(simd.sub_f32s(times(b, number(0.5)), half), half_cell);
        let split = floor(simd, edge);
        let share = simd.sub_f32s(edge, split);
        // Mean of sqrt over [split, edge] without cancellation.
        let (root_low, root_high) = (simd.sqrt_f32s(split), simd.sqrt_f32s(edge));
        let sum = plus(plus(edge, times(root_low, root_high)), split);
        let mean_root =
            simd.div_f32s(times(sum, number(2.0 / 3.0)), simd.max_f32s(plus(root_low, root_high), least));
        let rising = simd.sub_f32s(times(tail, mean_root), half);
        let linear = plus(times(half_cell, plus(edge, split)), offset);
        let rest = simd.sub_f32s(number(1.0), share);
        let split_mean = plus(times(share, rising), times(rest, linear));
        Self { split, split_mean, tail, slope, offset, half }
    }

    /// Mean over cell `rank`, which is the lower half of the cells at most.
    #[inline(always)]
    fn mean(&self, simd: S, rank: f32, root_mean: f32) -> S::f32s {
        let cell = simd.splat_f32s(rank);
        let rising = simd.sub_f32s(simd.mul_f32s(self.tail, simd.splat_f32s(root_mean)), self.half);
        let linear = simd.add_f32s(simd.mul_f32s(self.slope, cell), self.offset);
        let after = simd.select_f32s(simd.less_than_f32s(self.split, cell), linear, self.split_mean);
        simd.select_f32s(simd.less_than_f32s(cell, self.split), rising, after)
    }
}

/// The integer part of numbers from 0 to 2^22.
#[inline(always)]
fn floor<S: Simd>(simd: S, values: S::f32s) -> S::f32s {
    let shift = simd.splat_f32s(8_388_608.0);
    let rounded = simd.sub_f32s(simd.add_f32s(values, shift), shift);
    let lower = simd.sub_f32s(rounded, simd.splat_f32s(1.0));
    simd.select_f32s(simd.less_than_f32s(values, rounded), lower, rounded)
}

/// Laws of one block of a bank, with some lanes replaced by coordinate axes.
pub(crate) struct Tabulated<'a> {
    block: &'a Block,
    grid: &'a [Boundary],
    on_axis: &'a [bool; LANES],
    extent: Row,
}

impl<'a> Tabulated<'a> {
    #[inline(always)]
    fn new(
        directions: &Directions,
        block: &'a Block,
        on_axis: &'a [bool; LANES],
        grid: &'a [Boundary],
    ) -> Self {
        let mut extent = [0.0_f32; LANES];
        for row in &directions.theta {
            for lane in 0..LANES {
                extent[lane] += row[lane].abs();
            }
        }
        Self { block, grid, on_axis, extent }
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
pub(crate) fn root_mean(rank: usize) -> f32 {
    // Rounded from (2/3) ((r+1)^1.5 - r^1.5), rewritten without cancellation.
    let low = rank as f32;
    let high = low + 1.0;
    let (root_low, root_high) = (low.sqrt(), high.sqrt());
    (2.0 / 3.0) * (high + root_low * root_high + low) / (root_low + root_high)
}
