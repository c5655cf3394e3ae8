//! Densities in the plane: constant over the pixels of a picture.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::{RangeError, TargetError};

/// A density on the unit square, constant over each pixel of a picture. Pixel `(row, column)` covers
/// `[column, column + 1) / width × [row, row + 1) / height`: the first coordinate of a point runs to the
/// right, the second down.
///
/// Distances are measured in the picture: its longer side is 1 long, so that a picture of any aspect ratio
/// gets an even arrangement of points. Clones share the values.
///
/// # Detail
///
/// A law along a direction is exact at its knots: up to 2048 that lie densely where there are many points,
/// and the corners of up to 1024 pixels that differ from their neighbours by a quarter of a point or more. A
/// bright pixel draws its share of the points whatever surrounds it, at any size of the picture.
///
/// Where pixels are so many that points cannot tell them apart, the laws that an optimiser plans are those of
/// means over blocks of up to 16 by 16 pixels, as far as a block holds at most 1/64 of a point, both by its
/// mass and by its area; see [`Density::with_averaging`].
///
/// ```
/// use fsot::targets::Density;
/// use fsot::{Config, Until};
///
/// // Three quarters of the points go to the right.
/// let density = Density::new(2, 1, vec![1.0, 3.0])?;
/// let points = Config::stippling(64, density).optimize(Until::SlicesPerClass(512))?;
/// let right = points.values().chunks_exact(2).filter(|point| point[0] > 0.5).count();
/// assert!((46..=50).contains(&right));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Density {
    width: usize,
    height: usize,
    values: Arc<Vec<f32>>,
    averaging: bool,
}

/// A density as a file says it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    width: usize,
    height: usize,
    values: Vec<f32>,
    #[serde(default = "averaged")]
    averaging: bool,
}

fn averaged() -> bool {
    true
}

impl TryFrom<Unchecked> for Density {
    type Error = TargetError;

    fn try_from(given: Unchecked) -> Result<Self, TargetError> {
        Ok(Self::new(given.width, given.height, given.values)?.with_averaging(given.averaging))
    }
}

impl PartialEq for Density {
    fn eq(&self, other: &Self) -> bool {
        let same = || Arc::ptr_eq(&self.values, &other.values) || self.values == other.values;
        self.size() == other.size() && self.averaging == other.averaging && same()
    }
}

impl Density {
    /// A density in proportion to `values`, row by row from the top.
    ///
    /// # Errors
    /// A side of 0 or beyond 65535, a wrong number of values, a value that is negative or not finite, no
    /// value above 0.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Result<Self, TargetError> {
        Self::check_size([width, height])?;
        if values.len() != width * height {
            let expected = width * height;
            return Err(TargetError::DensityCount { given: values.len(), width, height, expected });
        }
        if let Some(index) = values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            let [x, y] = [index % width, index / width];
            return Err(TargetError::BadDensity { x, y, value: values[index].into() });
        }
        if values.iter().all(|&value| value == 0.0) {
            return Err(TargetError::NoDensity { width, height });
        }
        Ok(Self { width, height, values: values.into(), averaging: true })
    }

    /// Lets laws be those of blocks of pixels where points are too few to tell pixels apart (the default, see
    /// [Detail](Density#detail)), or always those of all pixels. Planning 24 megapixels for
    /// 10,000 points takes three seconds of processor time with averaging, and thirty without.
    #[must_use]
    pub fn with_averaging(self, averaging: bool) -> Self {
        Self { averaging, ..self }
    }

    /// Whether laws may be those of blocks of pixels.
    pub(super) fn is_averaged(&self) -> bool {
        self.averaging
    }

    /// Whether it is a clone.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.size() == other.size() && Arc::ptr_eq(&self.values, &other.values)
    }

    /// Refuses sides of 0 or beyond 65535 pixels.
    pub(super) fn check_size([width, height]: [usize; 2]) -> Result<(), TargetError> {
        for (axis, len) in [("the width of the density", width), ("the height of the density", height)] {
            if len == 0 {
                return Err(TargetError::Empty { what: axis });
            }
            if len > usize::from(u16::MAX) {
                let expected = "of at most 65535 pixels";
                return Err(RangeError::new(axis, len as f64, expected).into());
            }
        }
        Ok(())
    }

    /// The sum of densities of equal size, each scaled to the mass that is given with it.
    ///
    /// # Errors
    /// Nothing to add, pictures of different sizes, a mass that is negative or not finite, all masses 0.
    pub fn mixture(parts: &[(f64, &Density)]) -> Result<Self, TargetError> {
        let Some(&(_, first)) = parts.first() else {
            return Err(TargetError::Empty { what: "the number of densities" });
        };
        let mut values = with_room(first.values.len())?;
        values.resize(first.values.len(), 0.0_f32);
        for &(mass, part) in parts {
            if !(mass >= 0.0 && mass.is_finite()) {
                let expected = "finite and at least 0";
                return Err(RangeError::new("the mass of a density", mass, expected).into());
            }
            if (part.width, part.height) != (first.width, first.height) {
                let (given, expected) = ([part.width, part.height], [first.width, first.height]);
                return Err(TargetError::OtherDensity { given, expected });
            }
            let scale = mass / part.mass();
            let sum = values.iter_mut().zip(part.values.iter());
            sum.for_each(|(sum, &value)| *sum += (scale * f64::from(value)) as f32);
        }
        Self::new(first.width, first.height, values)
    }

    /// The same density with at most `most_pixels` pixels: what is beneath a new pixel becomes its mean, by
    /// exact areas, so that every part of the picture keeps its share of the mass. A picture that is small
    /// enough stays as it is.
    ///
    /// Optimisers average by themselves what points cannot tell apart, and spare bright pixels; this is for
    /// saving memory, where bright pixels may spread over the new ones. Sides keep their ratio as far as
    /// whole pixels can. O(pixels).
    ///
    /// # Errors
    /// No pixels; not enough memory.
    ///
    /// ```
    /// use fsot::targets::Density;
    ///
    /// let density = Density::new(3, 2, vec![1.0, 2.0, 3.0, 1.0, 2.0, 9.0])?.averaged_down(3)?;
    /// assert_eq!((density.size(), density.values()), ([2, 1], &[4.0 / 3.0, 14.0 / 3.0][..]));
    /// # Ok::<(), fsot::targets::TargetError>(())
    /// ```
    pub fn averaged_down(&self, most_pixels: usize) -> Result<Self, TargetError> {
        if most_pixels == 0 {
            return Err(TargetError::Empty { what: "the number of pixels" });
        }
        let pixels = self.width * self.height;
        if pixels <= most_pixels {
            return Ok(self.clone());
        }
        let shrink = (most_pixels as f64 / pixels as f64).sqrt();
        let shorter = ((self.width.min(self.height) as f64 * shrink).round() as usize).clamp(1, most_pixels);
        let longer = (self.width.max(self.height) as f64 * shrink).round() as usize;
        let longer = longer.clamp(1, most_pixels / shorter);
        let [width, height] = if self.width < self.height { [shorter, longer] } else { [longer, shorter] };
        let mut values = with_room(width * height)?;
        let mut sums = vec![0.0; width];
        let mut flush = |sums: &mut [f64]| {
            let area = (self.width as f64 / width as f64) * (self.height as f64 / height as f64);
            values.extend(sums.iter().map(|&sum| (sum / area) as f32));
            sums.fill(0.0);
        };
        for (row, line) in self.values.chunks_exact(self.width).enumerate() {
            let (ends, share) = overlap(row, self.height, height);
            add_overlapping(line, share, &mut sums);
            if ends {
                flush(&mut sums);
                add_overlapping(line, 1.0 - share, &mut sums);
            }
        }
        Ok(Self::new(width, height, values)?.with_averaging(self.averaging))
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Values row by row, as they were given.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Sum of all values.
    pub fn mass(&self) -> f64 {
        self.values.iter().map(|&value| f64::from(value)).sum()
    }

    /// The value at a point of the unit square.
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let pixel = |at: f64, len: usize| ((at * len as f64).max(0.0) as usize).min(len - 1);
        f64::from(self.values[pixel(y, self.height) * self.width + pixel(x, self.width)])
    }

    /// Lengths of the picture's sides, the longer one being 1.
    pub(super) fn scales(&self) -> [f64; 2] {
        let longer = self.width.max(self.height) as f64;
        [self.width as f64 / longer, self.height as f64 / longer]
    }
}

/// An empty list with room for a value per pixel.
pub(super) fn with_room(pixels: usize) -> Result<Vec<f32>, TargetError> {
    let mut values = Vec::new();
    match values.try_reserve_exact(pixels) {
        Ok(()) => Ok(values),
        Err(_) => Err(TargetError::Memory { pixels }),
    }
}

/// A share of one of `from` equal parts that lies in the first of the `to` parts that it overlaps, and
/// whether that one ends within it. Parts are not narrower than those.
fn overlap(index: usize, from: usize, to: usize) -> (bool, f64) {
    // In units of 1 / (from · to).
    let (begin, end) = (index * to, (index + 1) * to);
    let boundary = (begin / from + 1) * from;
    (end >= boundary, (boundary.min(end) - begin) as f64 / to as f64)
}

/// Adds `factor` times the integral of a line of pixels over the wider pixels of `sums`.
fn add_overlapping(line: &[f32], factor: f64, sums: &mut [f64]) {
    let len = sums.len();
    for (index, &value) in line.iter().enumerate() {
        let (ends, share) = overlap(index, line.len(), len);
        let (value, to) = (factor * f64::from(value), index * len / line.len());
        sums[to] += share * value;
        if ends && to + 1 < len {
            sums[to + 1] += (1.0 - share) * value;
        }
    }
}
