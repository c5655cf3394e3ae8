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

use crate::simd::{LANES, Row};

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

/// Sum of frequencies up to which modes are silenced, by the number of dimensions: as many modes as cost less
/// than the pairs of a sample.
fn degree(dims: usize) -> usize {
    if let Ok(v) = std::env::var("DEGREE") { return v.parse().unwrap(); }
    match dims {
        1 | 2 => 6,
        3 => 5,
        4..=6 => 4,
        7..=12 => 3,
        _ => 2,
    }
}

/// `cos(π k x)` and `sin(π k x)` of one coordinate, for `k` from 0 on.
#[derive(Clone, Debug)]
struct Wave {
    cos: Row,
    sin: Row,
}

/// Room for the waves of a vector.
#[derive(Clone, Debug, Default)]
pub(super) struct Waves(Vec<Wave>);

impl Modes {
    pub(super) fn new(dims: &[usize]) -> Self {
        let highest = degree(dims.len());
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
            modes.push(Mode::new(&frequencies));
        }
    }

    pub(super) fn len(&self) -> usize {
        self.modes.len()
    }

    /// Adds every mode's values at the samples of a vector, whose coordinates are given, times `counts`.
    #[inline(always)]
    pub(super) fn add(&self, at: impl Fn(usize) -> Row, counts: &Row, waves: &mut Waves, sums: &mut [Row]) {
        self.wave(at, waves);
        for (sum, mode) in sums.iter_mut().zip(&self.modes) {
            let mut product = *counts;
            for &(dim, frequency) in &mode.factors {
                let Wave { cos, .. } = &waves.0[dim * (self.highest + 1) + frequency];
                for lane in 0..LANES {
                    product[lane] *= cos[lane];
                }
            }
            for lane in 0..LANES {
                sum[lane] += product[lane];
            }
        }
    }

    /// Adds to `motions`, a vector per dimension of the table, what silences modes of these means.
    #[inline(always)]
    pub(super) fn silence(&self, at: impl Fn(usize) -> Row, means: &[Row], waves: &mut Waves, motions: &mut [Row]) {
        self.wave(at, waves);
        for (mean, mode) in means.iter().zip(&self.modes) {
            for (&(dim, frequency), pull) in mode.factors.iter().zip(&mode.pulls) {
                let mut product = waves.0[dim * (self.highest + 1) + frequency].sin;
                for lane in 0..LANES {
                    product[lane] *= pull * mean[lane];
                }
                for &(other, frequency) in mode.factors.iter().filter(|&&(other, _)| other != dim) {
                    let Wave { cos, .. } = &waves.0[other * (self.highest + 1) + frequency];
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
    fn wave(&self, at: impl Fn(usize) -> Row, Waves(waves): &mut Waves) {
        waves.resize(self.dims.len() * (self.highest + 1), Wave { cos: [1.0; LANES], sin: [0.0; LANES] });
        for (waves, &dim) in waves.chunks_exact_mut(self.highest + 1).zip(&self.dims) {
            let first = Wave::of(&at(dim));
            for k in 1..=self.highest {
                let last = waves[k - 1].clone();
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
    /// `cos(π x)` and `sin(π x)` for `x` in `[0, 1]`, by their series at ½: good for 4e-6 there, and for 2e-5 in
    /// the faces.
    #[inline(always)]
    fn of(at: &Row) -> Self {
        let mut wave = Self { cos: [0.0; LANES], sin: [0.0; LANES] };
        for lane in 0..LANES {
            let angle = PI * (at[lane] - 0.5);
            let square = angle * angle;
            let odd = 1.0 + square * (-1.0 / 6.0 + square * (1.0 / 120.0 + square * (-1.0 / 5040.0 + square / 362_880.0)));
            let even = 1.0 + square * (-0.5 + square * (1.0 / 24.0 + square * (-1.0 / 720.0 + square / 40_320.0)));
            wave.cos[lane] = -angle * odd;
            wave.sin[lane] = even;
        }
        wave
    }
}
