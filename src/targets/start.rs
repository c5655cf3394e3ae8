//! Draws from a target: where an optimisation starts.

use super::{Density, PointCloud, Target};

/// Turns uniform numbers into draws from a target.
pub(crate) enum Warp<'a> {
    /// Cumulative sums of the pixels, row by row.
    Density(&'a Density, Vec<f64>),
    Cloud(&'a PointCloud),
}

impl Target {
    /// How to draw from the target; `None` for the cube, and where only the caller would know.
    pub(crate) fn warp(&self) -> Option<Warp<'_>> {
        match self {
            Target::UniformCube | Target::Custom(_) => None,
            Target::Density(density) => {
                let mut sum = 0.0;
                let add = |&value: &f32| {
                    sum += f64::from(value);
                    sum
                };
                let sums = density.values().iter().map(add).collect();
                Some(Warp::Density(density, sums))
            }
            Target::Cloud(cloud) => Some(Warp::Cloud(cloud)),
        }
    }
}

impl Warp<'_> {
    /// Replaces one uniform number per dimension.
    pub(crate) fn place(&self, point: &mut [f64]) {
        match self {
            Warp::Density(density, sums) => {
                let [x, y] = point else { return };
                let [width, height] = density.size();
                // The row's share of the first number places the point inside a pixel of it.
                let sought = *y * sums[sums.len() - 1];
                let row =
                    sums.chunks_exact(width).position(|row| row[width - 1] > sought).unwrap_or(height - 1);
                let below = |pixel: usize| if pixel == 0 { 0.0 } else { sums[pixel - 1] };
                let (first, last) = (row * width, row * width + width - 1);
                let mass = sums[last] - below(first);
                let within = below(first) + *x * mass;
                let column = sums[first..last].partition_point(|&sum| sum <= within);
                let pixel = first + column;
                let share = |value: f64, low: f64, high: f64| ((value - low) / (high - low)).clamp(0.0, 1.0);
                *x = (column as f64 + share(within, below(pixel), sums[pixel])) / width as f64;
                *y = (row as f64 + share(sought, below(first), sums[last])) / height as f64;
            }
            Warp::Cloud(cloud) => {
                let count = cloud.points().len() / cloud.dims();
                let index = ((point[0] * count as f64) as usize).min(count - 1);
                let chosen = &cloud.points()[index * cloud.dims()..];
                point.iter_mut().zip(chosen).for_each(|(value, &of)| *value = of.into());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    /// 40,000 draws over 2 × 3 pixels; five standard errors of a count.
    #[test]
    fn draws_fall_into_pixels_by_their_density() {
        let density = Density::new(3, 2, vec![1.0, 0.0, 3.0, 2.0, 0.0, 4.0]).unwrap();
        let target = Target::Density(density.clone().into());
        let warp = target.warp().unwrap();
        let mut counts = [0.0; 6];
        for pair in random::uniforms(1, 80_000).chunks_exact(2) {
            let mut point = [f64::from(pair[0]), f64::from(pair[1])];
            warp.place(&mut point);
            assert!(point.iter().all(|value| (0.0..=1.0).contains(value)), "{point:?}");
            let column = ((point[0] * 3.0) as usize).min(2);
            counts[((point[1] * 2.0) as usize).min(1) * 3 + column] += 1.0;
        }
        for (count, value) in counts.into_iter().zip(density.values()) {
            let expected = 4000.0 * f64::from(*value);
            assert!((count - expected).abs() <= 5.0 * expected.sqrt(), "{counts:?}");
        }
    }
}
