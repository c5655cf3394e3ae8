//! Directions themselves: evenly spread, or rows of random orthonormal frames.

use nalgebra::DMatrix;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use crate::random::{self, Purpose};

/// The `index`th of `count` directions that are spread evenly: over the half circle in the plane, at random
/// in more dimensions.
pub(crate) fn spread(dims: usize, index: usize, count: usize) -> Vec<f64> {
    if dims == 1 {
        return vec![1.0];
    }
    if dims == 2 {
        let angle = std::f64::consts::PI * (index as f64 + 0.5) / count as f64;
        let (sin, cos) = libm::sincos(angle);
        return vec![cos, sin];
    }
    let mut generator = random::generator(0, Purpose::Frames, dims as u64, 1 << 32 | index as u64);
    let gaussian: Vec<f64> = (0..dims).map(|_| generator.sample(StandardNormal)).collect();
    let length = gaussian.iter().map(|component| component * component).sum::<f64>().sqrt();
    gaussian.iter().map(|component| component / length.max(f64::MIN_POSITIVE)).collect()
}

/// A random orthonormal frame: the orthonormal factor of a Gaussian matrix, uniform up to signs.
pub(crate) fn random_frame(dims: usize, generator: &mut impl Rng) -> Vec<Vec<f64>> {
    let gaussian = DMatrix::from_fn(dims, dims, |_, _| generator.sample(StandardNormal));
    let frame: DMatrix<f64> = gaussian.qr().q();
    frame.column_iter().map(|column| column.iter().copied().collect()).collect()
}

/// Rows of random orthonormal frames, one frame after the other.
pub(crate) fn frames(dims: usize, count: usize) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count + dims);
    for index in 0..count.div_ceil(dims) {
        let mut generator = random::generator(0, Purpose::Frames, dims as u64, 1 << 33 | index as u64);
        rows.extend(random_frame(dims, &mut generator));
    }
    rows.truncate(count);
    rows
}
