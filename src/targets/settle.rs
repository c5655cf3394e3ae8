//! Bright pixels get back the points that lie beside and between them.
//!
//! Points in a bright pixel have neighbours a hundredth of a pixel away, those around it many pixels. Along a
//! direction, one of the latter too many or too few moves the ranks of all points of the pixel by one. Inside
//! that is nothing; but the point at the pixel's edge is drawn to the next one around, as far away as those
//! are. So some of the points along a bright pixel's edge end up outside of it, by a few hundredths of its
//! side. Where hundreds of bright pixels call for a few points each, slices leave many of their points
//! between them, also farther away: those come after the nearest.

use std::collections::HashMap;

use super::density::Density;
use crate::random::kronecker_steps;

/// Points that a pixel must call for, to get points back.
const LEAST: f64 = 1.0;
/// Its density over that of a pixel from which it gets them.
const CONTRAST: f64 = 8.0;
/// Pixels to each side whose numbers of points count together: along a bright line, what one lacks by chance
/// the next has.
const TOGETHER: usize = 2;

/// Columns and rows that a point may lie from a bright pixel, one after the other: those beside it come
/// first.
const REACHES: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
/// Pixels that all points together look at in one go, at most: some tenths of a second.
const MOST_LOOKS: usize = 1 << 28;

/// Times that points choose a pixel within one of these, at most.
const MOST_ROUNDS: usize = 16;

/// How many points pixels have and call for.
struct Held<'a> {
    densities: &'a [Density],
    size: [usize; 2],
    /// Points per unit of the density.
    scale: f64,
    /// Points by pixel.
    counts: HashMap<usize, usize>,
    /// Whole points that each pixel should have that calls for [`LEAST`] or more. They are rounded so that
    /// their sums are right, not each by itself: hundreds of pixels may call for six points and a bit.
    wanted: HashMap<usize, f64>,
    /// Most points that a pixel calls for.
    brightest: f64,
}

/// A point beside a bright pixel.
struct Beside {
    point: usize,
    from: usize,
    to: usize,
    /// In pixels.
    distance: f64,
}

/// Moves points that lie beside a pixel that is much brighter into that pixel, the nearest first: as long as
/// it and the bright ones around it lack points, and none that their own pixel calls for.
pub(super) fn settle(densities: &[Density], points: &mut [[f32; 2]]) {
    let Some(size) = densities.first().map(Density::size) else { return };
    let mass: f64 = densities.iter().map(Density::mass).sum();
    let scale = points.len() as f64 / mass;
    let (counts, wanted) = (HashMap::new(), HashMap::new());
    let mut held = Held { densities, size, scale, counts, wanted, brightest: 0.0 };
    let mut sum = 0.0_f64;
    for pixel in 0..size[0] * size[1] {
        let expected = held.expected(pixel);
        held.brightest = held.brightest.max(expected);
        if expected >= LEAST {
            let before = sum.round();
            sum += expected;
            held.wanted.insert(pixel, sum.round() - before);
        }
    }
    points.iter().for_each(|&point| *held.counts.entry(pixel_of(point, size)).or_default() += 1);
    for reach in REACHES {
        // Several points may have chosen the same pixel: those that it had no room for choose again.
        let mut rounds = 0..MOST_ROUNDS;
        while rounds.next().is_some() && settle_within(reach, &mut held, points) > 0 {}
    }
}

/// The same for points in the pixels around a bright one, up to so many columns and rows from it. Returns how
/// many it has moved.
fn settle_within(reach: usize, held: &mut Held, points: &mut [[f32; 2]]) -> usize {
    let mut count = 0;
    let size = held.size;
    let is_spare = |&point: &usize| held.is_spare(pixel_of(points[point], size));
    let spare: Vec<usize> = (0..points.len()).filter(is_spare).collect();
    if reach > 1 && spare.len().saturating_mul((2 * reach + 1).pow(2)) > MOST_LOOKS {
        return 0;
    }
    let beside = spare.into_iter().filter_map(|point| held.beside(point, points[point], reach));
    let mut beside: Vec<Beside> = beside.collect();
    beside.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.point.cmp(&b.point)));
    for Beside { point, from, to, .. } in beside {
        if held.is_free(from, to) {
            let moved = match reach {
                1 => inside(points[point], to, size, held.expected(to)),
                // From farther away many come by the same corner.
                _ => scattered(to, held.count(to), size),
            };
            if pixel_of(moved, size) == to {
                points[point] = moved;
                held.counts.entry(from).and_modify(|count| *count -= 1);
                *held.counts.entry(to).or_default() += 1;
                count += 1;
            }
        }
    }
    count
}

impl Held<'_> {
    /// Points that a pixel calls for.
    fn expected(&self, pixel: usize) -> f64 {
        self.scale * self.densities.iter().map(|density| f64::from(density.values()[pixel])).sum::<f64>()
    }

    /// Points that it has.
    fn count(&self, pixel: usize) -> f64 {
        self.counts.get(&pixel).copied().unwrap_or(0) as f64
    }

    /// Points that a bright pixel has too few of, or too many.
    fn lacking(&self, pixel: usize) -> f64 {
        self.wanted.get(&pixel).map_or(0.0, |wanted| wanted - self.count(pixel))
    }

    /// Points that a pixel must call for, to be bright beside another one.
    fn bright_beside(&self, pixel: usize) -> f64 {
        LEAST.max(CONTRAST * self.expected(pixel))
    }

    /// Whether a pixel has a point that it does not call for, and is dark beside any other.
    fn is_spare(&self, pixel: usize) -> bool {
        self.count(pixel) - 0.5 >= self.expected(pixel) && self.bright_beside(pixel) <= self.brightest
    }

    /// The nearest bright pixel around a point that its own pixel doesn't call for, if there is one.
    fn beside(&self, point: usize, at: [f32; 2], reach: usize) -> Option<Beside> {
        let from = pixel_of(at, self.size);
        let least = self.bright_beside(from);
        let bright = around(from, reach, self.size).filter(|&to| self.expected(to) >= least);
        // Farther away, only those that lack some by themselves.
        let bright = bright.filter(|&to| reach == 1 || self.lacking(to) >= 1.0);
        let near = bright.map(|to| {
            let [x, y] = outside(at, to, self.size);
            Beside { point, from, to, distance: x.hypot(y) }
        });
        near.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Whether a pixel has a point too many, and the bright ones around another lack one.
    fn is_free(&self, from: usize, to: usize) -> bool {
        let least = self.bright_beside(from);
        let bright = around(to, TOGETHER, self.size).filter(|&pixel| self.expected(pixel) >= least);
        let lacking: f64 = bright.map(|pixel| self.lacking(pixel)).sum();
        lacking >= 0.5 && self.count(from) - 0.5 >= self.expected(from)
    }
}

/// The pixel in which a point lies.
fn pixel_of(point: [f32; 2], [width, height]: [usize; 2]) -> usize {
    let at = |value: f32, len: usize| ((f64::from(value) * len as f64) as usize).min(len - 1);
    at(point[1], height) * width + at(point[0], width)
}

/// Pixels up to some columns and rows from one, and that one.
fn around(pixel: usize, reach: usize, [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let (x, y) = (pixel % width, pixel / width);
    let range = move |at: usize, len: usize| at.saturating_sub(reach)..=(at + reach).min(len - 1);
    range(y, height).flat_map(move |y| range(x, width).map(move |x| y * width + x))
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

/// The place of the `count`th point of a pixel, by the R2 sequence.
fn scattered(pixel: usize, count: f64, [width, height]: [usize; 2]) -> [f32; 2] {
    let steps = kronecker_steps(2);
    let at = |index: usize, step: f64, len: usize| {
        ((index as f64 + (0.5 + count * step).fract()) / len as f64) as f32
    };
    [at(pixel % width, steps[0], width), at(pixel / width, steps[1], height)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One pixel of 5 × 5 calls for 90 of 100 points and has 83; six lie beside it, and one farther, which
    /// comes last.
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
        settle(std::slice::from_ref(&density), &mut points);
        let inside =
            |points: &[[f32; 2]]| points.iter().filter(|&&point| pixel_of(point, [5, 5]) == 12).count();
        assert_eq!((inside(&before), inside(&points)), (83, 90));
        assert!(points[..83] == before[..83] && points[90..] == before[90..]);
        // At most half a distance deep, which is 1 / sqrt(90) pixels.
        assert!((points[83][0] * 5.0 - 2.0 - 0.5 / 90.0_f32.sqrt()).abs() < 1e-5, "{:?}", points[83]);

        // A pixel that has its points takes none.
        let full: Vec<[f32; 2]> =
            before[..83].iter().chain(&before[..77]).chain(&before[83..]).copied().collect();
        let mut settled = full.clone();
        settle(&[density], &mut settled);
        assert_eq!(settled, full);
        // It calls for five, or nine, and has three; one that is hardly brighter than those around it takes
        // none either.
        for (around, taken) in [(12.0, 0), (5.0, 6)] {
            let mut values = vec![around; 25];
            values[12] = 90.0;
            let mut few = before[80..].to_vec();
            settle(&[Density::new(5, 5, values).unwrap()], &mut few);
            assert_eq!(inside(&few), 3 + taken, "{around}");
        }
    }
}
