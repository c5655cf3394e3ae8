//! Draws from a target: where an optimisation starts.

use std::ops::Range;

use super::{Density, PointCloud, Target};

/// Pixels per stored sum.
const BLOCK: usize = 64;

/// Densities on top of each other, with sums up to each of their pixels at hand.
pub(crate) struct Sums<'a> {
    parts: &'a [Density],
    width: usize,
    height: usize,
    /// Sums, row by row, up to the end of each block of a row and of the row.
    at_ends: Vec<f64>,
}

/// Turns uniform numbers into draws from a target.
pub(crate) enum Warp<'a> {
    Density(Sums<'a>),
    Cloud(&'a PointCloud),
}

impl Target {
    /// Whether an optimisation starts from draws of it.
    pub(crate) fn has_warp(&self) -> bool {
        !matches!(self, Target::UniformCube | Target::Custom(_))
    }

    /// How to draw from the target; `None` for the cube, and where only the caller would know.
    pub(crate) fn warp(&self) -> Option<Warp<'_>> {
        match self {
            Target::UniformCube | Target::Custom(_) => None,
            Target::Density(_) | Target::Densities(_) => Some(Warp::Density(Sums::new(self.densities()))),
            Target::Cloud(cloud) => Some(Warp::Cloud(cloud)),
        }
    }
}

impl Warp<'_> {
    /// Replaces one uniform number per dimension.
    pub(crate) fn place(&self, point: &mut [f64]) {
        match self {
            Warp::Density(sums) => {
                if let [x, y] = point {
                    [*x, *y] = sums.place([*x, *y]);
                }
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

impl<'a> Sums<'a> {
    /// Of at least one density, all of one size.
    fn new(parts: &'a [Density]) -> Self {
        let [width, height] = parts.first().map_or([0, 0], Density::size);
        let mut sums = Self { parts, width, height, at_ends: Vec::new() };
        let (mut sum, mut at_ends) = (0.0, Vec::with_capacity(height * width.div_ceil(BLOCK)));
        for block in 0..height * width.div_ceil(BLOCK) {
            sum = sums.block(block).fold(sum, |sum, value| sum + value);
            at_ends.push(sum);
        }
        sums.at_ends = at_ends;
        sums
    }

    /// The values of a block.
    fn block(&self, block: usize) -> impl Iterator<Item = f64> {
        let per_row = self.width.div_ceil(BLOCK);
        let (row, begin) = (block / per_row, block % per_row * BLOCK);
        let pixels = begin..(begin + BLOCK).min(self.width);
        pixels.map(move |column| {
            let values = self.parts.iter().map(|part| f64::from(part.values()[row * self.width + column]));
            values.sum()
        })
    }

    /// The sum before a block.
    fn before(&self, block: usize) -> f64 {
        if block == 0 { 0.0 } else { self.at_ends[block - 1] }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |value: f64, low: f64, high: f64| ((value - low) / (high - low)).clamp(0.0, 1.0);
        let per_row = self.width.div_ceil(BLOCK);
        // The row's share of the first number places the point inside a pixel of it.
        let sought = y * self.at_ends[self.at_ends.len() - 1];
        let rows = 0..self.height - 1;
        let row = partition_point(rows, |row| self.at_ends[(row + 1) * per_row - 1] <= sought);
        let (first, last) = (row * per_row, (row + 1) * per_row - 1);
        let [low, high] = [self.before(first), self.at_ends[last]];
        let within = low + x * (high - low);
        let block = partition_point(first..last, |block| self.at_ends[block] <= within);
        let (mut column, mut below) = (block % per_row * BLOCK, self.before(block));
        let mut upto = below;
        for value in self.block(block) {
            upto = below + value;
            if upto > within || column + 1 == self.width {
                break;
            }
            (column, below) = (column + 1, upto);
        }
        let column = column.min(self.width - 1);
        let x = (column as f64 + share(within, below, upto)) / self.width as f64;
        [x, (row as f64 + share(sought, low, high)) / self.height as f64]
    }
}

/// The first of a range of numbers where `is_before` no longer holds, or the range's end.
fn partition_point(range: Range<usize>, is_before: impl Fn(usize) -> bool) -> usize {
    let Range { start: mut low, end: mut high } = range;
    while low < high {
        let middle = low + (high - low) / 2;
        if is_before(middle) { low = middle + 1 } else { high = middle }
    }
    low
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
