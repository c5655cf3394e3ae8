//! Lines that a picture projects on, and the knots of its laws there.

use super::planes::Kink;
use crate::laws::Pieces;

/// A direction, in a picture of some size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Where a pixel's step to the right and down leads.
    step: [f64; 2],
    low: f64,
    high: f64,
    /// The axis that it runs along, if it does: pixels project on intervals then.
    pub axis: Option<usize>,
}

/// The lesser component of a direction that is no axis, as a share of the greater: with less, the slopes of
/// bright pixels would have no digits left.
const NARROWEST: f64 = 1e-5;

/// What happens in a piece: changes of slope, each times the powers 0 to 3 of its distance from the end of
/// the piece, over their factorials. An interval's end is a change of density, one power earlier.
pub(super) type Change = [f64; 4];

/// Knots of a law, and where to look for a place among them.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    pub knots: Vec<f64>,
    /// For even parts of the line, the piece where they begin.
    guide: Vec<u32>,
    per_length: f64,
}

impl Line {
    /// `None` where all directions are 0.
    pub(super) fn new(direction: &[f64], size: [usize; 2]) -> Option<Self> {
        let mut along = [0, 1].map(|axis| direction.get(axis).copied().unwrap_or(0.0));
        let greater = along[0].abs().max(along[1].abs());
        if greater == 0.0 {
            return None;
        }
        let lesser = usize::from(along[1].abs() < along[0].abs());
        let is_axis = along[lesser].abs() < NARROWEST * greater;
        if is_axis {
            along[lesser] = 0.0;
        }
        let step = [along[0] / size[0] as f64, along[1] / size[1] as f64];
        let mut line = Self { step, low: 0.0, high: 0.0, axis: is_axis.then_some(1 - lesser) };
        let corners = line.corners(size);
        line.low = corners.iter().copied().fold(f64::INFINITY, f64::min);
        line.high = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Some(line)
    }

    /// Where a corner of the grid projects.
    #[inline(always)]
    pub(super) fn place(&self, x: usize, y: usize) -> f64 {
        self.step[0] * x as f64 + self.step[1] * y as f64
    }

    /// Projections of the corners of a picture.
    pub(super) fn corners(&self, [width, height]: [usize; 2]) -> [f64; 4] {
        [self.place(0, 0), self.place(width, 0), self.place(0, height), self.place(width, height)]
    }

    /// A place by its share of the way from one end of the picture to the other.
    pub(super) fn at(&self, share: f64) -> f64 {
        self.low + (self.high - self.low) * share
    }

    /// What the slopes that kinks add are multiplied by, for a picture of this mass.
    fn scale(&self, mass: f64) -> f64 {
        match self.axis {
            Some(axis) => 1.0 / (mass * self.step[axis].abs()),
            None => 1.0 / (mass * self.step[0] * self.step[1]),
        }
    }

    /// Adds kinks to the pieces where they are.
    pub(super) fn add(&self, kinks: &[Kink], grid: &Grid, changes: &mut [Change]) {
        for kink in kinks {
            let at = self.place(kink.x.into(), kink.y.into());
            let piece = grid.piece(at);
            let (size, rest) = (kink.size, grid.knots[piece + 1] - at);
            let [slope, density, mass, area] = &mut changes[piece];
            *slope += size;
            *density += size * rest;
            *mass += size * rest * rest / 2.0;
            *area += size * rest * rest * rest / 6.0;
        }
    }

    /// Adds the columns or rows of a picture, by their sums.
    pub(super) fn add_sums(&self, axis: usize, sums: &[f64], grid: &Grid, changes: &mut [Change]) {
        // Along a falling axis the later end of an interval comes first.
        let sign = self.step[axis].signum();
        let ends = sums.iter().copied().chain([0.0]);
        let mut before = 0.0;
        for (index, sum) in ends.enumerate() {
            let size = sign * (sum - before);
            before = sum;
            let at = self.step[axis] * index as f64;
            let piece = grid.piece(at);
            let rest = grid.knots[piece + 1] - at;
            let [_, density, mass, area] = &mut changes[piece];
            *density += size;
            *mass += size * rest;
            *area += size * rest * rest / 2.0;
        }
    }

    /// Masses of the pieces and relative places of their means, of a picture of mass `mass`.
    pub(super) fn masses(
        &self,
        mass: f64,
        grid: &Grid,
        changes: impl Iterator<Item = Change>,
    ) -> impl Iterator<Item = (f64, f64)> {
        let scale = self.scale(mass);
        let [mut slope, mut density] = [0.0; 2];
        grid.knots.windows(2).zip(changes).map(move |(ends, change)| {
            let change = change.map(|change| scale * change);
            let width = ends[1] - ends[0];
            let mass = width * (density + width * slope / 2.0) + change[2];
            // Integral of the distribution function, less what was below at the start.
            let area = width * width * (density / 2.0 + width * slope / 6.0) + change[3];
            density += width * slope + change[1];
            slope += change[0];
            // What rounding leaves where the picture is empty must not draw points.
            if mass <= EMPTY || width <= 0.0 { (0.0, 0.5) } else { (mass, 1.0 - area / (mass * width)) }
        })
    }

    /// The law of a picture of mass `mass`.
    pub(super) fn law(&self, mass: f64, grid: &Grid, changes: impl Iterator<Item = Change>) -> Pieces {
        let (mut places, mut masses, mut means) = (vec![grid.knots[0]], Vec::new(), Vec::new());
        for (ends, (mass, mean)) in grid.knots.windows(2).zip(self.masses(mass, grid, changes)) {
            let width = ends[1] - ends[0];
            // A linear density has its mean in the middle third. One further out is that of a triangle at
            // this end, and of nothing beside it.
            let mut push = |place: f64, mass: f64, mean: f64| {
                places.push(place);
                masses.push(mass);
                means.push(mean);
            };
            if mass > 0.0 && mean < 1.0 / 3.0 {
                push(ends[0] + 3.0 * mean.max(0.0) * width, mass, 1.0 / 3.0);
                push(ends[1], 0.0, 0.5);
            } else if mass > 0.0 && mean > 2.0 / 3.0 {
                push(ends[1] - 3.0 * (1.0 - mean).max(0.0) * width, 0.0, 0.5);
                push(ends[1], mass, 2.0 / 3.0);
            } else {
                push(ends[1], mass, mean);
            }
        }
        debug_assert!((masses.iter().sum::<f64>() - 1.0).abs() < 1e-4, "{self:?}");
        Pieces::new(&places, &masses, means)
    }
}

/// Mass of a piece that rounding may leave.
const EMPTY: f64 = 1e-11;

impl Grid {
    /// Knots in any order, of which those of the line's ends are two.
    pub(super) fn new(line: &Line, mut knots: Vec<f64>) -> Self {
        knots.extend([line.low, line.high]);
        knots.retain(|knot| (line.low..=line.high).contains(knot));
        knots.sort_unstable_by(f64::total_cmp);
        knots.dedup();
        let pieces = knots.len().saturating_sub(1);
        let parts = 2 * pieces;
        let per_length = parts as f64 / (line.high - line.low);
        let mut piece = 0;
        let guide = (0..=parts).map(|part| {
            let begin = line.low + part as f64 / per_length;
            while piece + 1 < pieces && knots[piece + 1] <= begin {
                piece += 1;
            }
            piece as u32
        });
        let guide = guide.collect();
        Self { knots, guide, per_length }
    }

    /// Evenly spaced knots.
    pub(super) fn even(line: &Line, pieces: usize) -> Self {
        Self::new(line, (1..pieces).map(|knot| line.at(knot as f64 / pieces as f64)).collect())
    }

    pub(super) fn pieces(&self) -> usize {
        self.knots.len().saturating_sub(1)
    }

    /// The piece of a place.
    #[inline(always)]
    fn piece(&self, at: f64) -> usize {
        let part = (((at - self.knots[0]) * self.per_length) as usize).min(self.guide.len() - 2);
        let (first, last) = (self.guide[part] as usize, self.guide[part + 1] as usize);
        if first == last {
            return first;
        }
        // By rounding a place may lie in the part beside.
        first + self.knots[first + 1..=last].partition_point(|&knot| knot <= at)
    }
}
