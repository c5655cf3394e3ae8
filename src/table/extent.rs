//! The lattice on which samples live, and the only file that knows the order of samples in memory.
//!
//! A sample table is `[frame][y][x][sample][dim]` in C order. A *site* is one pixel of one frame; sites are
//! numbered `(frame * height + y) * width + x`, samples `site * spp + sample`.

use serde::{Deserialize, Serialize};

use crate::error::ExtentError;

/// Number of frames, rows, columns and samples per pixel of a table; every one at least 1.
///
/// ```
/// use fsot::Extent;
///
/// let extent = Extent::animation(8, 64, 32).with_spp(4);
/// assert_eq!((extent.frames, extent.height, extent.width, extent.spp), (8, 64, 32, 4));
/// assert_eq!((extent.sites(), extent.samples()), (8 * 64 * 32, 4 * 8 * 64 * 32));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extent {
    /// Frames; the animation wraps, frame `frames` is frame 0 again.
    pub frames: usize,
    /// Rows of a frame, in pixels; the tile wraps.
    pub height: usize,
    /// Columns of a frame, in pixels; the tile wraps.
    pub width: usize,
    /// Samples per pixel and frame.
    pub spp: usize,
}

/// Most dimensions of a sample: directions take time and memory by the square of them and more.
pub const MOST_DIMS: usize = 64;

/// A step of the R2 sequence, across and down, as shares of a side.
const R2: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// Most values of a table: half of what 32 bits number, so that an offset may be added before it wraps.
pub(crate) const MOST_VALUES: usize = i32::MAX as usize;

/// Position of a pixel of one frame.
///
/// ```
/// use fsot::{Extent, Site};
///
/// let extent = Extent::animation(2, 4, 8);
/// let site = Site { frame: 1, y: 2, x: 3 };
/// assert_eq!(extent.site(extent.site_index(site)), site);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Site {
    /// Frame, in `0..frames`.
    pub frame: usize,
    /// Row, in `0..height`.
    pub y: usize,
    /// Column, in `0..width`.
    pub x: usize,
}

impl Extent {
    /// One frame of `height` rows and `width` columns with one sample per pixel: a still picture.
    ///
    /// More samples: `Extent::still(64, 64).with_spp(4)`.
    pub const fn still(height: usize, width: usize) -> Self {
        Self::animation(1, height, width)
    }

    /// So many frames of `height` rows and `width` columns with one sample per pixel.
    pub const fn animation(frames: usize, height: usize, width: usize) -> Self {
        Self { frames, height, width, spp: 1 }
    }

    /// The same with so many samples per pixel.
    #[must_use]
    pub const fn with_spp(self, spp: usize) -> Self {
        Self { spp, ..self }
    }

    /// A point set: one frame of one row, one sample per site, so that a demand may name single points.
    pub const fn points(count: usize) -> Self {
        Self { frames: 1, height: 1, width: count, spp: 1 }
    }

    /// Sites (pixels × frames) of the table; `usize::MAX` if they are more.
    pub fn sites(&self) -> usize {
        self.frames.saturating_mul(self.height).saturating_mul(self.width)
    }

    /// Samples of the table; `usize::MAX` if they are more.
    pub fn samples(&self) -> usize {
        self.sites().saturating_mul(self.spp)
    }

    /// Number of the site. The position must lie inside the extent; others have a number that is no site's,
    /// or another's.
    pub fn site_index(&self, site: Site) -> usize {
        let row = site.frame.wrapping_mul(self.height).wrapping_add(site.y);
        row.wrapping_mul(self.width).wrapping_add(site.x)
    }

    /// Position of the site with this number. Numbers from [`Extent::sites`] on lie in frames beyond the
    /// last; an empty axis counts as one of length 1.
    pub fn site(&self, index: usize) -> Site {
        let [height, width] = [self.height, self.width].map(|len| len.max(1));
        let (x, row) = (index % width, index / width);
        Site { frame: row / height, y: row % height, x }
    }

    /// Where the `use_number`th use of a table in a frame should read it: the table displaced as a whole, by
    /// so many rows and columns. Use 0 stays in place. Wraps, and takes any number.
    ///
    /// Nearby samples of a table are correlated (those of the released 64×64 tile by −0.42 one pixel away,
    /// and still by up to 0.2 seven pixels away), so that uses that should be independent of each other, such
    /// as further pairs of dimensions or further samples, must lie apart. The steps of the R2 sequence
    /// (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences") keep the first 36 uses of a
    /// 64×64 tile at least 8 pixels from each other, and 128 uses of one of 128×128. There correlations are
    /// at most 0.08 in the released tables, and 0.006 to 0.035 in the root mean square, where independent
    /// numbers would have 0.01 (64×64).
    ///
    /// ```
    /// use fsot::{Extent, SampleTable, Site};
    ///
    /// let table = SampleTable::white_noise(Extent::still(64, 64), 2, 0)?;
    /// // The second pair of numbers that the pixel (x 7, y 5) takes.
    /// let by = table.extent().displacement(1);
    /// let pair = table.sample(Site { frame: 0, y: 5 + by.y, x: 7 + by.x }, 0);
    /// assert_eq!((by.y, by.x, pair.len()), (36, 48, 2));
    /// # Ok::<(), fsot::files::TableError>(())
    /// ```
    pub fn displacement(&self, use_number: u64) -> Site {
        let at = |step: f64, len: usize| ((use_number as f64 * step).fract() * len as f64) as usize;
        Site { frame: 0, y: at(R2[1], self.height), x: at(R2[0], self.width) }
    }

    /// The site that lies `(dt, dy, dx)` away, wrapping in all three axes; an empty one counts as one of
    /// length 1.
    pub fn wrapped(&self, site: Site, (dt, dy, dx): (i64, i64, i64)) -> Site {
        let wrap = |at: usize, by: i64, len: usize| {
            let len = len.clamp(1, i64::MAX as usize);
            (at % len + by.rem_euclid(len as i64) as usize) % len
        };
        Site {
            frame: wrap(site.frame, dt, self.frames),
            y: wrap(site.y, dy, self.height),
            x: wrap(site.x, dx, self.width),
        }
    }

    /// Checks that no axis is empty, that there are at most [`MOST_DIMS`] dimensions, and that `samples *
    /// dims` values can be numbered with 31 bits.
    ///
    /// # Errors
    /// The first axis that is empty, or what there is too much of.
    pub fn validate(&self, dims: usize) -> Result<(), ExtentError> {
        let axes = [
            ("frames", self.frames),
            ("height", self.height),
            ("width", self.width),
            ("spp", self.spp),
            ("dims", dims),
        ];
        let mut values = 1_u64;
        for (axis, len) in axes {
            if len == 0 {
                return Err(ExtentError::EmptyAxis { axis });
            }
            values = values.saturating_mul(len as u64);
        }
        if dims > MOST_DIMS {
            return Err(ExtentError::TooManyDims { dims, most: MOST_DIMS });
        }
        if values > MOST_VALUES as u64 {
            return Err(ExtentError::TooLarge { values });
        }
        Ok(())
    }
}

/// Refuses what the system would not give memory for. It is asked for that and gets it back at once; systems
/// that promise more than they have refuse what is beyond all of it.
pub(crate) fn check_memory(what: &'static str, bytes: usize) -> Result<(), ExtentError> {
    let mut room = Vec::<u8>::new();
    let reserved = room.try_reserve_exact(bytes);
    // Else the compiler may find that nobody uses it, and not ask.
    std::hint::black_box(room.as_ptr());
    reserved.map_err(|_| ExtentError::NoMemory { what, bytes })
}

/// Bytes that a buffer holds, used or not.
pub(crate) fn bytes_of<T>(buffer: &Vec<T>) -> usize {
    size_of::<T>() * buffer.capacity()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As far from each other as the documentation and the README say.
    #[test]
    fn displacements_lie_apart() {
        let steps = crate::random::kronecker_steps(2);
        assert!(R2.iter().zip(steps).all(|(r2, step)| (r2 - step).abs() < 1e-15));
        for (side, uses) in [(64, 36), (128, 128)] {
            let tile = Extent::still(side, side);
            let places: Vec<Site> = (0..uses).map(|index| tile.displacement(index)).collect();
            let along = |a: usize, b: usize| a.abs_diff(b).min(side - a.abs_diff(b)) as f64;
            let apart = |a: &Site, b: &Site| along(a.y, b.y).hypot(along(a.x, b.x));
            let pairs =
                places.iter().enumerate().flat_map(|(i, a)| places[..i].iter().map(move |b| apart(a, b)));
            let nearest = pairs.fold(f64::INFINITY, f64::min);
            assert!(nearest >= 8.0, "{side}: {nearest}");
        }
        assert_eq!(Extent::still(64, 32).displacement(0), Site { frame: 0, y: 0, x: 0 });
    }

    #[test]
    fn sites_are_numbered_in_c_order_and_back() {
        let extent = Extent { frames: 3, height: 5, width: 7, spp: 2 };
        let mut expected = 0;
        for frame in 0..3 {
            for y in 0..5 {
                for x in 0..7 {
                    let site = Site { frame, y, x };
                    assert_eq!(extent.site_index(site), expected);
                    assert_eq!(extent.site(expected), site);
                    expected += 1;
                }
            }
        }
        assert_eq!(extent.sites(), expected);
        assert_eq!(extent.samples(), 2 * expected);
    }

    #[test]
    fn all_three_axes_wrap_both_ways() {
        let extent = Extent { frames: 3, height: 5, width: 7, spp: 1 };
        let corner = Site { frame: 0, y: 0, x: 0 };
        assert_eq!(extent.wrapped(corner, (-1, -1, -1)), Site { frame: 2, y: 4, x: 6 });
        assert_eq!(extent.wrapped(corner, (-7, 12, 16)), Site { frame: 2, y: 2, x: 2 });
    }

    #[test]
    fn what_no_memory_holds_is_refused() {
        let bytes = usize::MAX / 4;
        assert_eq!(check_memory("a table", 1 << 20), Ok(()));
        let error = check_memory("a table", bytes).unwrap_err();
        assert_eq!(error, ExtentError::NoMemory { what: "a table", bytes });
    }

    #[test]
    fn empty_and_oversized_extents_are_named() {
        let extent = Extent { frames: 1, height: 0, width: 7, spp: 1 };
        assert_eq!(extent.validate(2), Err(ExtentError::EmptyAxis { axis: "height" }));
        let extent = Extent { frames: 1 << 12, height: 1 << 12, width: 1 << 12, spp: 1 };
        assert_eq!(extent.validate(1), Err(ExtentError::TooLarge { values: 1 << 36 }));
        let extent = Extent { frames: usize::MAX, height: usize::MAX, width: 2, spp: 1 };
        assert_eq!(extent.validate(1), Err(ExtentError::TooLarge { values: u64::MAX }));
    }
}
