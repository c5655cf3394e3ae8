//! Cosines over the cube: what they say of where samples lie, and how these move to silence them.
//!
//! For a mode `φ_k(x) = Π cos(π k_d x_d)` the samples' mean `m_k` is 0 if they are uniform. With
//! `Δψ = ρ − 1`, linear transport of a density `ρ` close to uniform is the motion along `∇ψ`, in modes
//!
//! ```text
//! x ← x − Σ_k m_k ∇φ_k(x) / (π² |k|² 2^{−nnz k}),
//! ```
//!
//! which does not cross a face, since its component there is 0.

use std::f32::consts::PI;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::lines::PARTS;
use super::reflect;
use super::tiles::{Cell, CellRow, Tiles};
use crate::simd::{LANES, Row};
use crate::table::extent::{MOST_DIMS, bytes_of};

/// Products of cosines in some dimensions of a table.
#[derive(Clone, Debug)]
pub(super) struct Modes {
    dims: Vec<usize>,
    /// Greatest frequency along a dimension.
    highest: usize,
    modes: Vec<Mode>,
}

#[derive(Clone, Debug)]
struct Mode {
    /// Place of a dimension in the group, and frequency along it; only those above 0.
    factors: Vec<(usize, usize)>,
    /// `π k_d / (π² |k|² 2^{−nnz k})` for each factor.
    pulls: Vec<f32>,
}

/// Which modes are silenced: all up to a sum of frequencies, and even ones up to a higher one. What the pulls
/// of filters do to the density has the symmetries of the cube, and those are even along every dimension;
/// odd modes are but noise.
fn degrees(dims: usize) -> [usize; 2] {
    match dims {
        1..=4 => [5, 10],
        5..=8 => [2, 6],
        9..=16 => [2, 4],
        _ => [1, 2],
    }
}

/// `cos(π k x)` and `sin(π k x)` of one coordinate, for `k` from 0 on.
#[derive(Clone, Copy, Debug)]
struct Wave {
    cos: Row,
    sin: Row,
}

/// The waves of a vector: by dimension of the group, and frequency.
type Waves = [Wave; MOST_WAVES];

/// Four dimensions with frequencies up to 10, or 64 up to 2.
const MOST_WAVES: usize = 192;

const SILENCE: Wave = Wave { cos: [1.0; LANES], sin: [0.0; LANES] };

/// More than any number of dimensions has.
const MOST_MODES: usize = 384;

/// Parts times frames that are added up apart.
const MOST_SUMS: usize = 512;

/// Buffers that stay.
#[derive(Clone, Debug, Default)]
pub(super) struct ModeBuffers {
    /// Of the rows that the parts are at.
    sums: Vec<Row>,
    /// By part and frame.
    totals: Vec<f64>,
    /// By frame.
    means: Vec<f32>,
}

impl ModeBuffers {
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.sums) + bytes_of(&self.totals) + bytes_of(&self.means)
    }
}

impl Modes {
    pub(super) fn new(dims: &[usize]) -> Self {
        let [any, even] = degrees(dims.len());
        let highest = any.max(even);
        let mut modes = Vec::new();
        let mut frequencies = vec![0; dims.len()];
        // Counts up, the first frequency fastest, and skips what exceeds the degree.
        loop {
            let mut place = 0;
            frequencies[0] += 1;
            while frequencies.iter().sum::<usize>() > highest {
                frequencies[place] = 0;
                place += 1;
                if place == dims.len() {
                    return Self { dims: dims.to_vec(), highest, modes };
                }
                frequencies[place] += 1;
            }
            let is_even = frequencies.iter().all(|frequency| frequency % 2 == 0);
            if is_even || frequencies.iter().sum::<usize>() <= any {
                modes.push(Mode::new(&frequencies));
            }
        }
    }

    /// Moves all samples, or those of each frame, `share` of the way to where the modes are silent.
    pub(super) fn advance(
        &self,
        arch: Arch,
        tiles: &mut Tiles,
        buffers: &mut ModeBuffers,
        per_frame: bool,
        share: f64,
    ) {
        let ModeBuffers { sums, totals, means } = buffers;
        let (len, rows) = (self.modes.len() + 1, tiles.cell_rows());
        let frames = if per_frame { tiles.frames() } else { 1 };
        let of = |frame: usize| if per_frame { frame * len } else { 0 };
        sums.resize(PARTS * len, [0.0; LANES]);
        totals.clear();
        // Sums of all frames in every part would be as large as the table where frames are many and small.
        let count = PARTS.min((MOST_SUMS / frames).max(1));
        totals.resize(count * frames * len, 0.0);
        let parts = totals.par_chunks_exact_mut(frames * len).zip(sums.par_chunks_exact_mut(len)).enumerate();
        parts.for_each(|(part, (totals, sums))| {
            for row in rows.len() * part / count..rows.len() * (part + 1) / count {
                arch.dispatch(Sum { modes: self, tiles, row, sums });
                for (lane, frame) in tiles.frames_of_row(row).into_iter().enumerate() {
                    let totals = totals[of(frame)..].iter_mut().zip(&*sums);
                    totals.for_each(|(total, sum)| *total += f64::from(sum[lane]));
                }
            }
        });
        let (totals, others) = totals.split_at_mut(frames * len);
        for other in others.chunks_exact(frames * len) {
            totals.iter_mut().zip(other).for_each(|(total, other)| *total += other);
        }
        means.clear();
        for totals in totals.chunks_exact(len) {
            let (count, totals) = totals.split_last().unwrap_or((&0.0, &[]));
            means.extend(totals.iter().map(|total| (share * total / count.max(1.0)) as f32));
        }
        tiles.for_each_row(|row| arch.dispatch(Silence { modes: self, means, per_frame, row }));
    }

    /// Adds every mode's values at the samples of a vector, whose coordinates are given, times `counts`, and
    /// then the counts.
    #[inline(always)]
    fn add(&self, at: impl Fn(usize) -> Row, counts: &Row, waves: &mut Waves, sums: &mut [Row]) {
        self.wave(at, waves);
        for (sum, mode) in sums.iter_mut().zip(&self.modes) {
            let mut product = *counts;
            for &(dim, frequency) in &mode.factors {
                let Wave { cos, .. } = &waves[dim * (self.highest + 1) + frequency];
                for lane in 0..LANES {
                    product[lane] *= cos[lane];
                }
            }
            for lane in 0..LANES {
                sum[lane] += product[lane];
            }
        }
        let count = &mut sums[self.modes.len()];
        for lane in 0..LANES {
            count[lane] += counts[lane];
        }
    }

    /// Adds to `motions`, a vector per dimension of the table, what silences modes of these means.
    #[inline(always)]
    fn silence(&self, at: impl Fn(usize) -> Row, means: &[Row], waves: &mut Waves, motions: &mut [Row]) {
        self.wave(at, waves);
        for (mean, mode) in means.iter().zip(&self.modes) {
            for (&(dim, frequency), pull) in mode.factors.iter().zip(&mode.pulls) {
                let mut product = waves[dim * (self.highest + 1) + frequency].sin;
                for lane in 0..LANES {
                    product[lane] *= pull * mean[lane];
                }
                for &(other, frequency) in mode.factors.iter().filter(|&&(other, _)| other != dim) {
                    let Wave { cos, .. } = &waves[other * (self.highest + 1) + frequency];
                    for lane in 0..LANES {
                        product[lane] *= cos[lane];
                    }
                }
                let motion = &mut motions[self.dims[dim]];
                for lane in 0..LANES {
                    motion[lane] += product[lane];
                }
            }
        }
    }

    /// Cosines and sines of all frequencies, by the addition theorem.
    #[inline(always)]
    fn wave(&self, at: impl Fn(usize) -> Row, waves: &mut Waves) {
        for (waves, &dim) in waves.chunks_exact_mut(self.highest + 1).zip(&self.dims) {
            let first = Wave::of(&at(dim));
            for k in 1..=self.highest {
                let last = waves[k - 1];
                for lane in 0..LANES {
                    waves[k].cos[lane] = last.cos[lane] * first.cos[lane] - last.sin[lane] * first.sin[lane];
                    waves[k].sin[lane] = last.sin[lane] * first.cos[lane] + last.cos[lane] * first.sin[lane];
                }
            }
        }
    }
}

impl Mode {
    fn new(frequencies: &[usize]) -> Self {
        let factors: Vec<(usize, usize)> =
            frequencies.iter().copied().enumerate().filter(|&(_, frequency)| frequency > 0).collect();
        let squares: usize = factors.iter().map(|&(_, frequency)| frequency * frequency).sum();
        let norm = PI * squares as f32 * 0.5_f32.powi(factors.len() as i32);
        let pulls = factors.iter().map(|&(_, frequency)| frequency as f32 / norm).collect();
        Self { factors, pulls }
    }
}

impl Wave {
    /// `cos(π x)` and `sin(π x)` for `x` in `[0, 1]`, by their series at ½, which are good for 4e-6 and
    /// 2.6e-5 at the faces.
    #[inline(always)]
    fn of(at: &Row) -> Self {
        let mut wave = Self { cos: [0.0; LANES], sin: [0.0; LANES] };
        for (lane, at) in at.iter().enumerate() {
            let angle = PI * (at - 0.5);
            let square = angle * angle;
            let odd = 1.0
                + square
                    * (-1.0 / 6.0 + square * (1.0 / 120.0 + square * (-1.0 / 5040.0 + square / 362_880.0)));
            let even =
                1.0 + square * (-0.5 + square * (1.0 / 24.0 + square * (-1.0 / 720.0 + square / 40_320.0)));
            wave.cos[lane] = -angle * odd;
            wave.sin[lane] = even;
        }
        wave
    }
}

/// Sums of all modes over a row of cells, and the number of samples there.
struct Sum<'a> {
    modes: &'a Modes,
    tiles: &'a Tiles,
    row: usize,
    sums: &'a mut [Row],
}

impl NullaryFnOnce for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { modes, tiles, row, sums } = self;
        sums.fill([0.0; LANES]);
        let mut waves = [SILENCE; MOST_WAVES];
        for (cell, owners) in tiles.cells_of(row) {
            let counts = std::array::from_fn(|lane| f32::from(owners >> lane & 1));
            modes.add(|dim| cell[dim].0, &counts, &mut waves, sums);
        }
    }
}

/// What silences the modes, over a row of vectors.
struct Silence<'a> {
    modes: &'a Modes,
    means: &'a [f32],
    per_frame: bool,
    row: CellRow<'a>,
}

impl NullaryFnOnce for Silence<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { modes, means, per_frame, row: CellRow { frames, dims, cells, stride } } = self;
        let len = modes.modes.len();
        let mut of_lanes = [[0.0; LANES]; MOST_MODES];
        for (mode, of_lanes) in of_lanes[..len].iter_mut().enumerate() {
            *of_lanes = frames.map(|frame| means[if per_frame { frame * len } else { 0 } + mode]);
        }
        let (mut motions, mut waves) = ([[0.0; LANES]; MOST_DIMS], [SILENCE; MOST_WAVES]);
        for cell in cells.chunks_exact_mut(stride) {
            motions[..dims].fill([0.0; LANES]);
            modes.silence(|dim| cell[dim].0, &of_lanes[..len], &mut waves, &mut motions);
            for (Cell(values), motion) in cell.iter_mut().zip(&motions[..dims]) {
                for lane in 0..LANES {
                    values[lane] = reflect(values[lane] + motion[lane]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_hold_the_modes_of_any_group() {
        for dims in 1..=MOST_DIMS {
            let modes = Modes::new(&(0..dims).collect::<Vec<_>>());
            assert!(modes.modes.len() <= MOST_MODES, "{dims}: {}", modes.modes.len());
            assert!(dims * (modes.highest + 1) <= MOST_WAVES, "{dims}");
        }
    }

    #[test]
    fn waves_are_cosines_and_sines() {
        for step in 0..=64 {
            let x = step as f32 / 64.0;
            let Wave { cos, sin } = Wave::of(&[x; LANES]);
            let (exact_sin, exact_cos) = (std::f64::consts::PI * f64::from(x)).sin_cos();
            // The next terms of the series at the faces: (π/2)^11 / 11! and (π/2)^10 / 10!.
            assert!((f64::from(cos[0]) - exact_cos).abs() < 4e-6, "{x}");
            assert!((f64::from(sin[3]) - exact_sin).abs() < 2.6e-5, "{x}");
        }
    }
}
