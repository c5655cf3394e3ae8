//! The Monte Carlo error of every pixel.

use ndarray::Array3;

use super::integrand::Integrand;
use crate::error::ConfigError;
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// Error `e[t, y, x] = (1/spp) Σ_s f(x_s) − ∫f` of every pixel of every frame.
///
/// `dims` names the table dimensions that the integrand's coordinates are read from. O(samples · dims).
///
/// # Errors
/// `dims` is empty, names a dimension twice or one that the table doesn't have, or has another length than the
/// integrand has coordinates.
pub fn error_image(
    table: &SampleTable,
    dims: &[usize],
    integrand: &Integrand,
) -> Result<Array3<f64>, ConfigError> {
    let points = Points::new(table, dims, integrand.dims())?;
    let Extent { frames, height, width, .. } = table.extent();
    let errors = points.errors(integrand).collect();
    Ok(Array3::from_shape_vec((frames, height, width), errors).expect("one error per site"))
}

/// The coordinates of one dimension group, gathered once for many integrands.
pub(super) struct Points {
    pub extent: Extent,
    dims: usize,
    coordinates: Vec<f64>,
}

impl Points {
    /// Gathers `dims`, for integrands of `expected` coordinates.
    pub fn new(table: &SampleTable, dims: &[usize], expected: usize) -> Result<Self, ConfigError> {
        check_group(dims, table.dims())?;
        if dims.len() != expected {
            return Err(ConfigError::ValueCount { what: "the dimension group", given: dims.len(), expected });
        }
        let samples = table.values().chunks_exact(table.dims());
        let coordinates = samples.flat_map(|x| dims.iter().map(|&d| f64::from(x[d]))).collect();
        Ok(Self { extent: table.extent(), dims: dims.len(), coordinates })
    }

    /// All coordinates, `[site][sample][dim]`.
    pub fn coordinates(&self) -> &[f64] {
        &self.coordinates
    }

    /// Error of every site, in the order of sites.
    pub fn errors(&self, integrand: &Integrand) -> impl Iterator<Item = f64> {
        let share = 1.0 / self.extent.spp as f64;
        self.coordinates.chunks_exact(self.extent.spp * self.dims).map(move |pixel| {
            let sum: f64 = pixel.chunks_exact(self.dims).map(|x| integrand.value(x)).sum();
            sum * share - integrand.integral()
        })
    }
}

/// Checks a dimension group of a table with `dims` dimensions.
pub(super) fn check_group(group: &[usize], dims: usize) -> Result<(), ConfigError> {
    if group.is_empty() {
        return Err(ConfigError::EmptyGroup { group: 0 });
    }
    for (position, &dimension) in group.iter().enumerate() {
        if dimension >= dims {
            return Err(ConfigError::NoSuchDimension { group: 0, dimension, dims });
        }
        if group[..position].contains(&dimension) {
            return Err(ConfigError::RepeatedDimension { group: 0, dimension });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::integrand::Shape;
    use approx::assert_abs_diff_eq;

    #[test]
    fn the_error_is_the_mean_of_the_pixel_less_the_integral() {
        let extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };
        let values = (0..extent.samples() * 3).map(|i| i as f32 / 256.0).collect();
        let table = SampleTable::new(extent, 3, values).unwrap();
        let gradient = vec![0.6, -0.8];
        let integrand = Integrand::new(Shape::Linear { gradient }, 2);
        let image = error_image(&table, &[2, 0], &integrand).unwrap();
        let [a, b] = [0, 1].map(|s| f64::from(table.view()[[1, 2, 3, s, 2]]));
        let [c, d] = [0, 1].map(|s| f64::from(table.view()[[1, 2, 3, s, 0]]));
        let expected = 0.6 * 0.5 * (a + b) - 0.8 * 0.5 * (c + d) - (0.3 - 0.4);
        assert_abs_diff_eq!(image[[1, 2, 3]], expected, epsilon = 1e-14);
    }

    #[test]
    fn bad_groups_are_named() {
        let extent = Extent { frames: 1, height: 1, width: 1, spp: 1 };
        let table = SampleTable::white_noise(extent, 2, 0).unwrap();
        let integrand = Integrand::new(Shape::Linear { gradient: vec![1.0, 0.0] }, 2);
        let error = |dims: &[usize]| error_image(&table, dims, &integrand).unwrap_err();
        assert_eq!(error(&[]), ConfigError::EmptyGroup { group: 0 });
        assert_eq!(error(&[1, 1]), ConfigError::RepeatedDimension { group: 0, dimension: 1 });
        assert_eq!(error(&[0, 2]), ConfigError::NoSuchDimension { group: 0, dimension: 2, dims: 2 });
        assert!(matches!(error(&[0]), ConfigError::ValueCount { given: 1, expected: 2, .. }));
    }
}
