//! Densities in the plane: constant over the pixels of a picture.

use serde::{Deserialize, Serialize};

use crate::error::{RangeError, TargetError};
use crate::laws::Pieces;

/// A density on the unit square, constant over each pixel of a picture. Pixel `(row, column)` covers
/// `[column, column + 1) / width × [row, row + 1) / height`: the first coordinate of a point runs to the
/// right, the second down.
///
/// Distances are measured in the picture: its longer side is 1 long, so that a picture of any aspect ratio
/// gets an even arrangement of points.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Density {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

/// A density as a file says it.
#[derive(Deserialize)]
struct Unchecked {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl TryFrom<Unchecked> for Density {
    type Error = TargetError;

    fn try_from(given: Unchecked) -> Result<Self, TargetError> {
        Self::new(given.width, given.height, given.values)
    }
}

/// Pieces along a direction per pixel of the longer side, within limits.
const PIECES_PER_PX: usize = 2;
const PIECES: std::ops::RangeInclusive<usize> = 256..=2048;
/// Up to so many corners of pixels are knots themselves; the law is exact then.
const MOST_CORNERS: usize = 1024;
/// The lesser component of a direction, as a share of the greater: a pixel must not project on a point.
const NARROWEST: f64 = 1e-6;

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
        Ok(Self { width, height, values })
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
        let mut values = vec![0.0_f32; first.values.len()];
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
            let sum = values.iter_mut().zip(&part.values);
            sum.for_each(|(sum, &value)| *sum += (scale * f64::from(value)) as f32);
        }
        Self::new(first.width, first.height, values)
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

    /// The law of the projection on a direction.
    ///
    /// A pixel projects on a trapezoid, whose density has kinks where its corners project, with slopes that
    /// change by `±1 / (|px| |py|)` for pixels that project on lengths `px` and `py`. All kinks of the
    /// picture lie at corners of the grid and sum up to the mixed second difference of the values there, so
    /// that one pass over the corners gives slope, density, distribution function and its integral at the
    /// knots, exactly. The density between knots is then linear, with the exact mass and mean.
    pub(super) fn project(&self, direction: &[f64]) -> Pieces {
        let [x, y] = [0, 1].map(|axis| direction.get(axis).copied().unwrap_or(0.0));
        let greater = x.abs().max(y.abs());
        if greater == 0.0 {
            return Pieces::of_samples(vec![0.0]);
        }
        let widened = |component: f64| {
            let least = NARROWEST * greater;
            if component.abs() < least { least.copysign(component) } else { component }
        };
        let [step_x, step_y] = [widened(x) / self.width as f64, widened(y) / self.height as f64];
        let (columns, rows) = (self.width + 1, self.height + 1);
        let place = |row: usize, column: usize| step_x * column as f64 + step_y * row as f64;
        let corners =
            [place(0, 0), place(0, self.width), place(self.height, 0), place(self.height, self.width)];
        let low = corners.iter().copied().fold(f64::INFINITY, f64::min);
        let high = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let count = (PIECES_PER_PX * self.width.max(self.height)).clamp(*PIECES.start(), *PIECES.end());
        let mut knots: Vec<f64> =
            (0..=count).map(|knot| low + (high - low) * (knot as f64 / count as f64)).collect();
        let few = columns * rows <= MOST_CORNERS;
        if few {
            knots.extend((0..rows).flat_map(|row| (0..columns).map(move |column| place(row, column))));
            knots.retain(|&knot| knot <= high);
            knots.sort_unstable_by(f64::total_cmp);
            knots.dedup();
        }
        let per_length = count as f64 / (high - low);
        let pieces = knots.len() - 1;
        // Kinks of each piece: their sum, and moments about its end.
        let mut kinks = vec![[0.0_f64; 4]; pieces];
        let scale = 1.0 / (self.mass() * step_x * step_y);
        let none = vec![0.0_f32; self.width];
        let mut above: &[f32] = &none;
        for row in 0..rows {
            let values = self.values.get(row * self.width..(row + 1) * self.width).unwrap_or(&none);
            let mut left = 0.0;
            for column in 0..columns {
                let difference = match column {
                    _ if column < self.width => f64::from(values[column]) - f64::from(above[column]),
                    _ => 0.0,
                };
                let kink = difference - left;
                left = difference;
                if kink == 0.0 {
                    continue;
                }
                let at = place(row, column);
                let piece = match few {
                    true => knots.partition_point(|&knot| knot < at).max(1) - 1,
                    false => ((at - low) * per_length) as usize,
                };
                let piece = piece.min(pieces - 1);
                let (kink, rest) = (scale * kink, knots[piece + 1] - at);
                let sums = &mut kinks[piece];
                sums[0] += kink;
                sums[1] += kink * rest;
                sums[2] += kink * rest * rest / 2.0;
                sums[3] += kink * rest * rest * rest / 6.0;
            }
            above = values;
        }
        let [mut slope, mut density, mut below] = [0.0; 3];
        let (mut masses, mut means) = (Vec::with_capacity(pieces), Vec::with_capacity(pieces));
        for (ends, kinks) in knots.windows(2).zip(&kinks) {
            let width = ends[1] - ends[0];
            let mass = width * (density + width * slope / 2.0) + kinks[2];
            // Integral of the distribution function, less what was below at the start.
            let area = width * width * (density / 2.0 + width * slope / 6.0) + kinks[3];
            // What rounding leaves where the picture is empty must not draw points.
            let is_empty = mass <= EMPTY || width <= 0.0;
            masses.push(if is_empty { 0.0 } else { mass });
            means.push(if is_empty { 0.5 } else { 1.0 - area / (mass * width) });
            below += mass;
            density += width * slope + kinks[1];
            slope += kinks[0];
        }
        // A bright pixel among a hundred thousand dark ones: 2e-6.
        debug_assert!((below - 1.0).abs() < 1e-4, "{below} along {direction:?}");
        Pieces::new(&knots, &masses, means)
    }
}

/// Mass of a piece that rounding may leave.
const EMPTY: f64 = 1e-11;
