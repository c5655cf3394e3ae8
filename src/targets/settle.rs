//! Bright pixels get back the points that lie just beside them.
//!
//! Points in a bright pixel have neighbours a hundredth of a pixel away, those around it many pixels. Along a
//! direction, one of the latter too many or too few moves the ranks of all points of the pixel by one. Inside
//! that is nothing; but the point at the pixel's edge is drawn to the next one around, as far away as those
//! are. So some of the points along a bright pixel's edge end up outside of it, by a few hundredths of its
//! side.

use super::density::Density;

/// Points that a pixel must call for, to get points back.
const LEAST: f64 = 1.0;
/// Its density over that of a pixel from which it gets them.
const CONTRAST: f64 = 8.0;

/// Points by pixel.
struct Held<'a> {
    densities: &'a [Density],
    size: [usize; 2],
    /// Points per unit of the density.
    scale: f64,
    /// Pixels with their points, in order.
    pixels: Vec<(usize, u32)>,
    /// Whether a point has been given away.
    is_given: Vec<bool>,
}

/// Moves points that lie beside a pixel that is much brighter, and short of points, into that pixel: at most
/// as many as it lacks, the nearest first, and none that their own pixel calls for.
pub(super) fn settle(densities: &[Density], points: &mut [[f32; 2]]) {
    let Some(size) = densities.first().map(Density::size) else { return };
    let mass: f64 = densities.iter().map(Density::mass).sum();
    let pixels = points.iter().map(|point| pixel_of(*point, size)).zip(0..);
    let scale = points.len() as f64 / mass;
    let is_given = vec![false; points.len()];
    let mut held = Held { densities, size, scale, pixels: pixels.collect(), is_given };
    held.pixels.sort_unstable();
    for pixel in 0..size[0] * size[1] {
        let expected = held.expected(pixel);
        if expected >= LEAST {
            held.fill(pixel, expected, points);
        }
    }
}

impl Held<'_> {
    /// Points that a pixel calls for.
    fn expected(&self, pixel: usize) -> f64 {
        self.scale * self.densities.iter().map(|density| f64::from(density.values()[pixel])).sum::<f64>()
    }

    /// Those that it had at first.
    fn of(&self, pixel: usize) -> &[(usize, u32)] {
        let first = self.pixels.partition_point(|of| of.0 < pixel);
        let count = self.pixels[first..].iter().take_while(|of| of.0 == pixel).count();
        &self.pixels[first..first + count]
    }

    fn fill(&mut self, pixel: usize, expected: f64, points: &mut [[f32; 2]]) {
        let lacking = (expected - self.of(pixel).len() as f64).round();
        if lacking < 1.0 {
            return;
        }
        let mut near: Vec<(f64, usize, u32)> = Vec::new();
        for beside in neighbours(pixel, self.size) {
            if self.expected(beside) * CONTRAST > expected {
                continue;
            }
            for &(_, point) in self.of(beside) {
                let [x, y] = outside(points[point as usize], pixel, self.size);
                near.push((x.hypot(y), beside, point));
            }
        }
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        let mut wanted = lacking as usize;
        for (_, beside, point) in near {
            let left = self.of(beside).iter().filter(|of| !self.is_given[of.1 as usize]).count() as f64;
            if wanted == 0 || self.is_given[point as usize] || left - 0.5 < self.expected(beside) {
                continue;
            }
            let place = &mut points[point as usize];
            let moved = inside(*place, pixel, self.size, expected);
            if pixel_of(moved, self.size) == pixel {
                *place = moved;
                self.is_given[point as usize] = true;
                wanted -= 1;
            }
        }
    }
}

/// The pixel in which a point lies.
fn pixel_of(point: [f32; 2], [width, height]: [usize; 2]) -> usize {
    let at = |value: f32, len: usize| ((f64::from(value) * len as f64) as usize).min(len - 1);
    at(point[1], height) * width + at(point[0], width)
}

/// The up to eight pixels around one.
fn neighbours(pixel: usize, [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let (x, y) = (pixel % width, pixel / width);
    let around = |at: usize, len: usize| at.saturating_sub(1)..=(at + 1).min(len - 1);
    let all = around(y, height).flat_map(move |y| around(x, width).map(move |x| y * width + x));
    all.filter(move |&beside| beside != pixel)
}

/// How far a point lies beyond a pixel, along both axes, in pixels; negative to the left and above.
fn outside(point: [f32; 2], pixel: usize, [width, height]: [usize; 2]) -> [f64; 2] {
    let beyond = |value: f32, len: usize, index: usize| {
        let at = f64::from(value) * len as f64 - index as f64;
        if at < 0.0 { at } else { (at - 1.0).max(0.0) }
    };
    [beyond(point[0], width, pixel % width), beyond(point[1], height, pixel / width)]
}

/// A point mirrored into a pixel, but no deeper than half the distance of the points there.
fn inside(point: [f32; 2], pixel: usize, size: [usize; 2], expected: f64) -> [f32; 2] {
    let beyond = outside(point, pixel, size);
    let index = [pixel % size[0], pixel / size[0]];
    std::array::from_fn(|axis| {
        // Coordinates are rounded to f32.
        let least = 4.0 * f64::from(f32::EPSILON) * size[axis] as f64;
        let depth = beyond[axis].abs().min(0.5 / expected.sqrt()).max(least);
        let at = match beyond[axis] {
            before if before < 0.0 => index[axis] as f64 + depth,
            after if after > 0.0 => (index[axis] + 1) as f64 - depth,
            _ => return point[axis],
        };
        (at / size[axis] as f64) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One pixel of 5 × 5 calls for 90 of 100 points and has 83; six lie beside it, and one farther.
    #[test]
    fn a_bright_pixel_gets_back_what_lies_beside_it() {
        let mut values = vec![10.0 / 24.0; 25];
        values[12] = 90.0;
        let density = Density::new(5, 5, values).unwrap();
        let place = |x: f64, y: f64| [(x / 5.0) as f32, (y / 5.0) as f32];
        let mut points: Vec<[f32; 2]> =
            (0..83).map(|i| place(2.5, 2.0 + (f64::from(i) + 0.5) / 83.0)).collect();
        let beside = [[1.9, 2.5], [3.05, 2.5], [1.97, 1.97], [2.5, 3.2], [2.5, 1.5], [3.7, 1.2], [4.2, 2.5]];
        points.extend(beside.map(|[x, y]| place(x, y)));
        points.extend((0..10).map(|i| place(0.5, f64::from(i) / 2.0)));
        let before = points.clone();
        settle(&[density.clone()], &mut points);
        let inside =
            |points: &[[f32; 2]]| points.iter().filter(|&&point| pixel_of(point, [5, 5]) == 12).count();
        assert_eq!((inside(&before), inside(&points)), (83, 89));
        assert!(points[..83] == before[..83] && points[89..] == before[89..]);
        // At most half a distance deep, which is 1 / sqrt(90) pixels.
        assert!((points[83][0] * 5.0 - 2.0 - 0.5 / 90.0_f32.sqrt()).abs() < 1e-5, "{:?}", points[83]);

        // A pixel that has its points takes none.
        let full: Vec<[f32; 2]> =
            before[..83].iter().chain(&before[..77]).chain(&before[83..]).copied().collect();
        let mut settled = full.clone();
        settle(&[density], &mut settled);
        assert_eq!(settled, full);
        // It calls for five and has three; one that is hardly brighter than those around it takes none either.
        for (around, taken) in [(12.0, 0), (10.0, 2)] {
            let mut values = vec![around; 25];
            values[12] = 90.0;
            let mut few = before[80..].to_vec();
            settle(&[Density::new(5, 5, values).unwrap()], &mut few);
            assert_eq!(inside(&few), 3 + taken, "{around}");
        }
    }
}
