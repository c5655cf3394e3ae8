//! Samples as vectors: what an engine stores where it wants directions rather than random numbers.

use ndarray::Array5;

use crate::error::GroupError;
use crate::table::SampleTable;

/// How two coordinates in `[0, 1)` become a vector. All three preserve area, so that uniform stays uniform.
///
/// ```
/// use fsot::targets::VectorMap;
/// use fsot::{Extent, SampleTable};
///
/// let table = SampleTable::white_noise(Extent::still(8, 8), 2, 0)?;
/// let directions = table.mapped(VectorMap::CosineHemisphere, [0, 1])?;
/// assert_eq!(directions.shape(), [1, 8, 8, 1, 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorMap {
    /// The unit disc, by the concentric map[^disc]: two components.
    ///
    /// [^disc]: Shirley and Chiu 1997, "A low distortion map between disk and square".
    Disc,
    /// The unit sphere: `z = 1 - 2 u`, at the angle `2π v`. Three components.
    Sphere,
    /// The hemisphere `z ≥ 0` with density `z / π`: the disc, lifted (Malley). Three components.
    CosineHemisphere,
}

impl VectorMap {
    /// Components of a vector.
    pub fn components(self) -> usize {
        match self {
            VectorMap::Disc => 2,
            VectorMap::Sphere | VectorMap::CosineHemisphere => 3,
        }
    }

    /// The vector of a point; the third component of a disc is 0.
    pub fn map(self, [u, v]: [f32; 2]) -> [f32; 3] {
        self.vector([u.into(), v.into()]).map(|component| component as f32)
    }

    /// The same in double precision.
    pub fn vector(self, [u, v]: [f64; 2]) -> [f64; 3] {
        match self {
            VectorMap::Disc => {
                let [x, y] = disc(u, v);
                [x, y, 0.0]
            }
            VectorMap::Sphere => {
                let z = 1.0 - 2.0 * u;
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * v);
                let radius = (1.0 - z * z).max(0.0).sqrt();
                [radius * cos, radius * sin, z]
            }
            VectorMap::CosineHemisphere => {
                let [x, y] = disc(u, v);
                [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
            }
        }
    }
}

/// The concentric map.
fn disc(u: f64, v: f64) -> [f64; 2] {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0, 0.0];
    }
    let (radius, angle) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * (y / x)) } else { (y, FRAC_PI_2 - FRAC_PI_4 * (x / y)) };
    let (sin, cos) = libm::sincos(angle);
    [radius * cos, radius * sin]
}

impl SampleTable {
    /// Two dimensions of the table as vectors `[frame, y, x, sample, component]`.
    ///
    /// Components lie in `[-1, 1]`; `ndarray_npy::write_npy` writes them, and `0.5 * value + 0.5` fits them
    /// into a texture.
    ///
    /// # Errors
    /// A dimension that the table does not have, or the same one twice.
    pub fn mapped(&self, mapping: VectorMap, [first, second]: [usize; 2]) -> Result<Array5<f32>, GroupError> {
        let dims = self.dims();
        GroupError::check(&[first, second], dims)?;
        let count = mapping.components();
        let points = self.values().chunks_exact(dims);
        let vectors =
            points.flat_map(|point| mapping.map([point[first], point[second]]).into_iter().take(count));
        let [frames, height, width, spp, _] = self.shape();
        let shape = (frames, height, width, spp, count);
        Ok(Array5::from_shape_vec(shape, vectors.collect()).expect("one vector per sample"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::extent::Extent;

    /// First and second moments over 2^16 points; five standard errors of a component's square are 0.006.
    #[test]
    fn moments_are_those_of_the_shape() {
        let extent = Extent { frames: 1, height: 256, width: 256, spp: 1 };
        let table = SampleTable::white_noise(extent, 2, 5).unwrap();
        let cases = [
            (VectorMap::Disc, [0.0, 0.0, 0.0], [0.25, 0.25, 0.0]),
            (VectorMap::Sphere, [0.0, 0.0, 0.0], [1.0 / 3.0; 3]),
            (VectorMap::CosineHemisphere, [0.0, 0.0, 2.0 / 3.0], [0.25, 0.25, 0.5]),
        ];
        for (mapping, means, squares) in cases {
            let vectors = table.mapped(mapping, [0, 1]).unwrap();
            assert_eq!(vectors.shape(), [1, 256, 256, 1, mapping.components()]);
            for component in 0..mapping.components() {
                let values = vectors.index_axis(ndarray::Axis(4), component);
                let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / 65536.0;
                let square = values.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>() / 65536.0;
                // Components lie in [-1, 1]: five standard errors of their mean are below 0.0115.
                assert!((mean - means[component]).abs() < 0.0115, "{mapping:?} {component}: {mean}");
                assert!((square - squares[component]).abs() < 0.007, "{mapping:?} {component}: {square}");
            }
        }
    }

    #[test]
    fn dimensions_that_cannot_be_mapped_are_named() {
        let table = SampleTable::white_noise(Extent::points(3), 2, 0).unwrap();
        let error = |dims| table.mapped(VectorMap::Disc, dims).unwrap_err();
        assert_eq!(error([0, 2]), GroupError::NoSuchDimension { dimension: 2, dims: 2 });
        assert_eq!(error([1, 1]), GroupError::Repeated { dimension: 1 });
    }

    #[test]
    fn vectors_have_their_length() {
        for (u, v) in [(0.0, 0.0), (0.5, 0.5), (0.999_999_9, 0.0), (0.3, 0.8)] {
            for mapping in [VectorMap::Sphere, VectorMap::CosineHemisphere] {
                let length: f32 = mapping.map([u, v]).iter().map(|x| x * x).sum();
                assert!((length - 1.0).abs() < 1e-6, "{mapping:?} {u} {v}");
            }
            let [x, y, _] = VectorMap::Disc.map([u, v]);
            assert!(x * x + y * y <= 1.0 + 1e-6);
        }
    }
}
