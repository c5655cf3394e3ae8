//! Three-dimensional discrete Fourier transforms of images on the torus.

use std::sync::Arc;

use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// Forward transform of arrays `[frame][y][x]`: `E(k) = Σ e(p) exp(−2πi k·p)`, unnormalised.
///
/// Planned once, O(n log n) for any lengths.
pub(crate) struct Transform {
    frames: usize,
    height: usize,
    width: usize,
    plans: [Arc<dyn Fft<f64>>; 3],
}

/// Buffers of one thread.
pub(crate) struct TransformBuffers {
    /// Input of [`Transform::forward`] in order `[frame][y][x]`; output in order `[kx][ky][kt]`.
    pub data: Vec<Complex64>,
    turned: Vec<Complex64>,
    work: Vec<Complex64>,
}

impl Transform {
    pub fn new(frames: usize, height: usize, width: usize) -> Self {
        let mut planner = FftPlanner::new();
        let plans = [frames, height, width].map(|len| planner.plan_fft_forward(len));
        Self { frames, height, width, plans }
    }

    pub fn len(&self) -> usize {
        self.frames * self.height * self.width
    }

    pub fn scratch(&self) -> TransformBuffers {
        let zeros = |len| vec![Complex64::default(); len];
        let work = self.plans.iter().map(|plan| plan.get_inplace_scratch_len()).max().unwrap_or(0);
        TransformBuffers { data: zeros(self.len()), turned: zeros(self.len()), work: zeros(work) }
    }

    /// Transforms `scratch.data`. The axes come out reversed, which saves turning them back.
    pub fn forward(&self, scratch: &mut TransformBuffers) {
        let TransformBuffers { data, turned, work } = scratch;
        let [along_t, along_y, along_x] = &self.plans;
        along_x.process_with_scratch(data, work);
        let frame = self.height * self.width;
        for (from, to) in data.chunks_exact(frame).zip(turned.chunks_exact_mut(frame)) {
            transpose(from, to, self.width);
        }
        along_y.process_with_scratch(turned, work);
        transpose(turned, data, frame);
        along_t.process_with_scratch(data, work);
    }

    /// Position of frequency `(kt, ky, kx)` in the output, each in `0..len`.
    pub fn index(&self, [kt, ky, kx]: [usize; 3]) -> usize {
        (kx * self.height + ky) * self.frames + kt
    }

    /// Position of the conjugate frequency `−k` of every output position.
    pub fn mirrors(&self) -> Vec<u32> {
        let negative = |k: usize, len: usize| (len - k) % len;
        let mut mirrors = Vec::with_capacity(self.len());
        for kx in 0..self.width {
            for ky in 0..self.height {
                for kt in 0..self.frames {
                    let mirror =
                        [negative(kt, self.frames), negative(ky, self.height), negative(kx, self.width)];
                    mirrors.push(self.index(mirror) as u32);
                }
            }
        }
        mirrors
    }
}

/// Rows of `columns` entries become columns.
fn transpose(from: &[Complex64], to: &mut [Complex64], columns: usize) {
    let rows = from.len() / columns;
    for (column, out) in to.chunks_exact_mut(rows).enumerate() {
        for (out, row) in out.iter_mut().zip(from.chunks_exact(columns)) {
            *out = row[column];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    #[test]
    fn agrees_with_the_sum_of_its_definition() {
        let shape = [3, 4, 6];
        let [frames, height, width] = shape;
        let transform = Transform::new(frames, height, width);
        let mut scratch = transform.scratch();
        let noise = random::uniforms(3, 2 * transform.len());
        let input: Vec<_> = noise.chunks_exact(2).map(|v| Complex64::new(v[0].into(), v[1].into())).collect();
        scratch.data.copy_from_slice(&input);
        transform.forward(&mut scratch);
        let axes = |index: usize| [index / (height * width), index / width % height, index % width];
        for k in (0..input.len()).map(axes) {
            let mut sum = Complex64::default();
            for (index, value) in input.iter().enumerate() {
                let p = axes(index);
                let turns: f64 = (0..3).map(|a| (k[a] * p[a]) as f64 / shape[a] as f64).sum();
                sum += value * Complex64::cis(-std::f64::consts::TAU * turns);
            }
            let difference = (scratch.data[transform.index(k)] - sum).norm();
            assert!(difference < 1e-11, "{k:?}: {difference}");
        }
    }
}
