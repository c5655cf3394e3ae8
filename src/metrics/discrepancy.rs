//! L2-star discrepancy by Warnock's formula.

use rayon::prelude::*;

use super::coordinates::Coordinates;
use super::error::MeasureError;
use super::samples::Samples;

/// Squared L2-star discrepancy of the samples of a frame, averaged over frames.
///
/// The discrepancy compares the share of samples in every box `[0, z)` with its volume, `T² = ∫ (#{x_i < z} /
/// n − Π z_d)² dz`, and has the closed form (Warnock 1972, "Computational investigations of low-discrepancy
/// point sets") `T² = 3^−D − 2/n Σ_i Π_d (1 − x_id²)/2 + 1/n² Σ_ij Π_d (1 − max(x_id, x_jd))`.
///
/// ```
/// use fsot::metrics::{Discrepancy, Samples};
///
/// // n centred points on the line: T² = 1 / (12 n²).
/// let points = Samples::points(&[0.125, 0.375, 0.625, 0.875], 1)?;
/// let discrepancy = Discrepancy::measure(points, &[0])?;
/// assert!((discrepancy.squared - 1.0 / 192.0).abs() < 1e-15);
/// assert!((discrepancy.ratio_to_white_noise - 1.0 / 8.0).abs() < 1e-13);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Discrepancy {
    /// `T²`, in `[0, 1]`.
    pub squared: f64,
    /// `T²` over the expectation `(2^−D − 3^−D) / n` of `n` independent random samples: 1 is random, 0 is
    /// perfect.
    pub ratio_to_white_noise: f64,
}

impl Discrepancy {
    /// Measures the dimension group `dims` of samples.
    ///
    /// O(frames · n² · D), n samples per frame: 64 × 64 pixels take some 10 ms, 256 × 256 some 5 s on one
    /// core. Parallel, and independent of the number of threads.
    ///
    /// # Errors
    /// A dimension group that is empty, repeats a dimension or exceeds those of the samples.
    pub fn measure<'a>(samples: impl Into<Samples<'a>>, dims: &[usize]) -> Result<Self, MeasureError> {
        let points = Coordinates::gather(samples, dims)?;
        let extent = points.extent;
        let per_frame = extent.samples() / extent.frames;
        let frames = points.values().chunks_exact(per_frame * dims.len());
        let squared = frames.map(|frame| squared(frame, dims.len())).sum::<f64>() / extent.frames as f64;
        let half_third = 0.5_f64.powi(dims.len() as i32) - 3.0_f64.powi(-(dims.len() as i32));
        Ok(Self { squared, ratio_to_white_noise: squared * per_frame as f64 / half_third })
    }
}

/// Squared discrepancy of points `[point][dim]`.
fn squared(points: &[f64], dims: usize) -> f64 {
    let count = points.len() / dims;
    // One column per dimension, so that the pairs of one point are summed in straight lines.
    let columns: Vec<Vec<f64>> =
        (0..dims).map(|d| points.iter().skip(d).step_by(dims).copied().collect()).collect();
    let rows: Vec<[f64; 2]> = (0..count)
        .into_par_iter()
        .map_init(
            || vec![0.0; count],
            |products, i| {
                let products = &mut products[..i];
                products.fill(1.0);
                let (mut single, mut own) = (1.0, 1.0);
                for column in &columns {
                    let x = column[i];
                    single *= 0.5 * (1.0 - x * x);
                    own *= 1.0 - x;
                    for (product, &other) in products.iter_mut().zip(&column[..i]) {
                        *product *= 1.0 - x.max(other);
                    }
                }
                // Pairs count twice, a point with itself once.
                [single, own + 2.0 * products.iter().sum::<f64>()]
            },
        )
        .collect();
    let sum = |k: usize| rows.iter().map(|row| row[k]).sum::<f64>();
    let n = count as f64;
    3.0_f64.powi(-(dims as i32)) - 2.0 / n * sum(0) + sum(1) / (n * n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Estimate;
    use crate::random;
    use crate::table::SampleTable;
    use crate::table::extent::Extent;

    /// The integral itself: the integrand is a polynomial of degree 2 per axis between the points'
    /// coordinates, which a two-point Gauss rule on every cell of their grid integrates exactly.
    fn by_integration(points: &[f64], dims: usize) -> f64 {
        let grids: Vec<Vec<(f64, f64)>> = (0..dims)
            .map(|d| {
                let mut edges: Vec<f64> = points.iter().skip(d).step_by(dims).copied().collect();
                edges.extend([0.0, 1.0]);
                edges.sort_by(f64::total_cmp);
                let nodes = edges.windows(2).flat_map(|edge| {
                    let half = 0.5 * (edge[1] - edge[0]);
                    [-1.0, 1.0].map(|side| (edge[0] + half * (1.0 + side / 3.0_f64.sqrt()), half))
                });
                nodes.collect()
            })
            .collect();
        let mut sum = 0.0;
        let total: usize = grids.iter().map(Vec::len).product();
        for mut node in 0..total {
            let (mut z, mut weight) = (Vec::new(), 1.0);
            for grid in &grids {
                z.push(grid[node % grid.len()].0);
                weight *= grid[node % grid.len()].1;
                node /= grid.len();
            }
            let inside = points.chunks_exact(dims).filter(|x| x.iter().zip(&z).all(|(x, z)| x < z)).count();
            let share = inside as f64 * dims as f64 / points.len() as f64;
            sum += weight * (share - z.iter().product::<f64>()).powi(2);
        }
        sum
    }

    #[test]
    fn warnock_agrees_with_the_integral() {
        for dims in 1..=3 {
            for count in [1, 2, 7] {
                let points: Vec<f64> =
                    random::uniforms(dims as u64, count * dims).into_iter().map(f64::from).collect();
                let (fast, slow) = (squared(&points, dims), by_integration(&points, dims));
                assert!((fast - slow).abs() < 1e-14, "D = {dims}, n = {count}: {fast} {slow}");
            }
        }
    }

    /// Mean over 200 tables within 4 standard errors of 1.
    #[test]
    fn white_noise_is_one_and_a_grid_is_better() {
        let extent = Extent { frames: 2, height: 4, width: 8, spp: 2 };
        let ratios: Vec<f64> = (0..200)
            .map(|seed| {
                let table = SampleTable::white_noise(extent, 3, seed).unwrap();
                Discrepancy::measure(&table, &[2, 0]).unwrap().ratio_to_white_noise
            })
            .collect();
        let over = Estimate::of(ratios.into_iter());
        assert!((over.mean - 1.0).abs() < 4.0 * over.standard_error, "{over:?}");
        let extent = Extent { frames: 1, height: 1, width: 100, spp: 1 };
        let values = (0..100).map(|i| (i as f32 + 0.5) / 100.0).collect();
        let table = SampleTable::new(extent, 1, values).unwrap();
        // In one dimension T² = 1/(12 n²) for centred points, so the ratio is 1/(2 n).
        let ratio = Discrepancy::measure(&table, &[0]).unwrap().ratio_to_white_noise;
        assert!((ratio - 0.005).abs() < 1e-7, "{ratio}");
    }
}
