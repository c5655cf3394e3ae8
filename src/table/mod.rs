//! The sample table: points, extent, and views by frame, pixel, sample and dimension.

pub(crate) mod domain;
pub(crate) mod extent;
pub(crate) mod vectors;

use ndarray::ArrayView5;

use crate::error::TableError;
use crate::random;
use crate::table::extent::{Extent, Site, check_memory};

/// Random numbers for a renderer: `x[frame, y, x, sample, dim]` in `[0, 1)`.
///
/// A renderer reads pixel `(x mod width, y mod height)` of frame `t mod frames` and uses its `spp` points of
/// `[0, 1)^dims`. Values are `f32` in C order, the order of the axes above.
///
/// ```
/// use fsot::{Extent, SampleTable, Site};
///
/// let table = SampleTable::white_noise(Extent::still(16, 16), 2, 0)?;
/// // As a texture does, the table tiles the picture.
/// let [here, far] = [5, 16 + 5].map(|x| table.sample(Site { frame: 0, y: 3, x }, 0));
/// assert_eq!(here, far);
/// assert_eq!(table.view()[[0, 3, 5, 0, 1]], here[1]);
/// # Ok::<(), fsot::files::TableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SampleTable {
    extent: Extent,
    dims: usize,
    values: Vec<f32>,
}

impl SampleTable {
    /// A table from values in C order `[frame][y][x][sample][dim]`.
    ///
    /// # Errors
    /// An empty or oversized extent, a number of values that does not fit it, a value outside `[0, 1)`.
    pub fn new(extent: Extent, dims: usize, values: Vec<f32>) -> Result<Self, TableError> {
        extent.validate(dims)?;
        let expected = extent.samples() * dims;
        if values.len() != expected {
            return Err(TableError::Length { given: values.len(), expected });
        }
        if let Some(index) = values.iter().position(|v| !(0.0..1.0).contains(v)) {
            let (sample, dim) = (index / dims, index % dims);
            let site = extent.site(sample / extent.spp);
            let at = [site.frame, site.y, site.x, sample % extent.spp, dim];
            return Err(TableError::Value { at, value: values[index] });
        }
        Ok(Self { extent, dims, values })
    }

    /// Independent uniform numbers: white noise, the start of every optimisation.
    ///
    /// # Errors
    /// An empty or oversized extent, or one that memory does not hold.
    pub fn white_noise(extent: Extent, dims: usize, seed: u64) -> Result<Self, TableError> {
        extent.validate(dims)?;
        check_memory("the table", size_of::<f32>() * extent.samples() * dims)?;
        let values = random::uniforms(seed, extent.samples() * dims);
        Ok(Self { extent, dims, values })
    }

    /// A table whose values are known to lie in `[0, 1)` and to fit the extent.
    pub(crate) fn trusted(extent: Extent, dims: usize, values: Vec<f32>) -> Self {
        debug_assert_eq!(values.len(), extent.samples() * dims);
        Self { extent, dims, values }
    }

    /// Frames, height, width and samples per pixel.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Dimensions of a sample.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// All values in C order.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The values, without the table around them.
    pub fn into_values(self) -> Vec<f32> {
        self.values
    }

    /// View as a five-dimensional array `[frame, y, x, sample, dim]`.
    pub fn view(&self) -> ArrayView5<'_, f32> {
        ArrayView5::from_shape(self.shape(), &self.values).expect("length was checked on construction")
    }

    /// The `dims` coordinates of a sample. All four indices wrap, as a tiled texture does.
    pub fn sample(&self, site: Site, sample: usize) -> &[f32] {
        let Extent { frames, height, width, spp } = self.extent;
        let site = Site { frame: site.frame % frames, y: site.y % height, x: site.x % width };
        let at = (self.extent.site_index(site) * spp + sample % spp) * self.dims;
        &self.values[at..at + self.dims]
    }

    /// Lengths of the five axes `[frame, y, x, sample, dim]`.
    pub fn shape(&self) -> [usize; 5] {
        let Extent { frames, height, width, spp } = self.extent;
        [frames, height, width, spp, self.dims]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };

    #[test]
    fn views_agree_with_memory_order() {
        let values = (0..EXTENT.samples() * 3).map(|i| i as f32 / 1000.0).collect();
        let table = SampleTable::new(EXTENT, 3, values).unwrap();
        assert_eq!(table.view()[[1, 2, 3, 1, 2]], 0.143);
        assert_eq!(table.sample(Site { frame: 1, y: 2, x: 3 }, 1), [0.141, 0.142, 0.143]);
        assert_eq!(table.sample(Site { frame: 3, y: 5, x: 7 }, 3), [0.141, 0.142, 0.143]);
    }

    #[test]
    fn a_bad_value_is_located() {
        for bad in [1.0, -0.1, f32::NAN, f32::INFINITY] {
            let mut values = vec![0.5; EXTENT.samples() * 3];
            values[143] = bad;
            let error = SampleTable::new(EXTENT, 3, values).unwrap_err();
            let text = error.to_string();
            assert!(text.contains("[frame 1, y 2, x 3, sample 1, dim 2]"), "{text}");
            assert!(matches!(error, TableError::Value { at: [1, 2, 3, 1, 2], .. }));
        }
    }

    #[test]
    fn a_wrong_length_is_named() {
        let error = SampleTable::new(EXTENT, 3, vec![0.5; 7]).unwrap_err();
        assert!(matches!(error, TableError::Length { given: 7, expected: 144 }));
    }
}
