//! The gradient of one term at one run of samples: a pass over the pairs that some filter holds together.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;

use super::field::FieldTable;
use super::tiles::{Cell, Run, Tiles};
use crate::kernel::{Tap, autocorrelation};
use crate::objective::plan::PlannedTerm;
use crate::simd::{LANES, Row};
use crate::table::extent::{Extent, MOST_DIMS, Site};

/// Lattice terms that see the same dimensions, ready for sweeps.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    pub dims: Vec<usize>,
    spp: usize,
    /// By offset in time, then in y.
    spans: Vec<Span>,
    /// Spans of the same offset in time.
    frames: Vec<Range<usize>>,
    taps: Vec<RowTap>,
    /// `Σ_j F_ij`, the same for every sample of a table that is demanded whole.
    total: f32,
    /// `Σ_j F_ij / F_ii`: the number of neighbours, each as much as it is held together.
    crowd: f64,
    /// Added to squared distances.
    softness: f32,
    /// On a line, the inverse of the distance that counts in full.
    steepness: f32,
    field: FieldTable,
}

/// The taps of one row of neighbours.
#[derive(Clone, Debug)]
struct Span {
    dt: i32,
    dy: i32,
    taps: Range<usize>,
}

#[derive(Clone, Copy, Debug)]
struct RowTap {
    dx: i32,
    weight: f32,
}

/// What the samples of a run have seen of others.
#[derive(Clone, Copy)]
struct Seen<const MOST: usize> {
    own: [Row; MOST],
    /// Unit vectors away from others, by weight.
    sums: [Row; MOST],
    /// Weights, where not all samples count.
    total: Row,
}

impl Pairs {
    /// Plans the closed form of lattice terms that see the same dimensions, each without pairs below
    /// `truncation` of its strongest.
    pub(super) fn new(terms: &[&PlannedTerm], extent: Extent, truncation: f64) -> Self {
        let weights: f64 = terms.iter().map(|term| term.spec.weight).sum();
        // Every term is meant over pixels by the square of what a filter holds, as in `Objective::cramer`.
        let mut sums = BTreeMap::new();
        for term in terms {
            let taps = term.family.taps().unwrap_or_default();
            let of_term = autocorrelation(taps, &extent, truncation).expect("the taps of a planned kernel");
            let total: f64 = of_term.iter().map(|tap| tap.weight).sum();
            for tap in of_term {
                *sums.entry((tap.dt, tap.dy, tap.dx)).or_insert(0.0) +=
                    term.spec.weight / weights * tap.weight / total;
            }
        }
        let (mut spans, mut frames, mut taps) = (Vec::<Span>::new(), Vec::<Range<usize>>::new(), Vec::new());
        for (&(dt, dy, dx), &weight) in &sums {
            let is_new = |last: &Span| (last.dt, last.dy) != (dt, dy);
            if spans.last().is_none_or(is_new) {
                if spans.last().is_none_or(|last| last.dt != dt) {
                    frames.push(spans.len()..spans.len());
                }
                spans.push(Span { dt, dy, taps: taps.len()..taps.len() });
                frames.last_mut().expect("one was pushed").end += 1;
            }
            taps.push(RowTap { dx, weight: weight as f32 });
            spans.last_mut().expect("one was pushed").taps.end += 1;
        }
        let total = sums.values().sum::<f64>() * extent.spp as f64;
        let dims = terms[0].spec.dims.clone();
        Self {
            spp: extent.spp,
            total: total as f32,
            crowd: total / sums.values().copied().fold(0.0, f64::max),
            softness: NEAREST,
            steepness: (RAMP * NEAREST.sqrt()).recip(),
            field: FieldTable::new(dims.len()),
            dims,
            spans,
            frames,
            taps,
        }
    }

    /// How far a unit of the pull should move a sample: `n r`, see [`crate::config::Sweeps`].
    pub(super) fn natural_step(&self) -> f64 {
        self.crowd * self.room(self.crowd)
    }

    /// The same of a sample whose neighbours have weights of this sum.
    pub(super) fn natural_step_of(&self, total: f64) -> f64 {
        let crowd = self.crowd * total / f64::from(self.total);
        crowd * self.room(crowd)
    }

    /// The room around a sample with such a crowd. In one dimension the pull is a sum of signs, flat between
    /// one neighbour and the next: there it takes the room of several to feel where to go.
    fn room(&self, crowd: f64) -> f64 {
        let dims = self.dims.len() as f64;
        let ball = PI.powf(0.5 * dims) / libm::tgamma(0.5 * dims + 1.0);
        let room = (ball * crowd).powf(-1.0 / dims);
        if self.dims.len() == 1 { ROOMS_ON_A_LINE * room } else { room }
    }

    /// Distances up to about this share of a sample's room count as longer than they are, from now on.
    pub(super) fn soften(&mut self, share: f64) {
        self.softness = ((share * self.room(self.crowd)) as f32).powi(2) + NEAREST;
        self.steepness = (RAMP * self.softness.sqrt()).recip();
    }

    /// Writes the pull of the cube at the points of all lanes, one row per dimension.
    #[inline(always)]
    pub(super) fn field(&self, points: &[Row], field: &mut [Row]) {
        self.field.gradient(points, field);
    }

    /// Neighbours that the pull on a sample looks at.
    pub(super) fn per_sample(&self) -> f64 {
        (self.taps.len() * self.spp) as f64
    }

    /// Offsets of the neighbours, and how strongly filters hold each.
    pub(super) fn taps(&self) -> impl Iterator<Item = Tap> {
        self.spans.iter().flat_map(|&Span { dt, dy, ref taps }| {
            let of_row = self.taps[taps.clone()].iter();
            of_row.map(move |&RowTap { dx, weight }| Tap { dt, dy, dx, weight: weight.into() })
        })
    }

    /// Visits the sites that filters hold together with a site, itself among them, and how strongly.
    pub(super) fn for_each_neighbour(&self, extent: &Extent, site: usize, mut visit: impl FnMut(usize, f32)) {
        // Offsets are at most half as long as an axis.
        let wrap = |at: usize, by: i32, len: usize| {
            let sum = at as i64 + i64::from(by);
            let sum = if sum < 0 { sum + len as i64 } else { sum };
            if sum < len as i64 { sum as usize } else { sum as usize - len }
        };
        let Site { frame, y, x } = extent.site(site);
        for &Span { dt, dy, ref taps } in &self.spans {
            let frame = wrap(frame, dt, extent.frames);
            let row = (frame * extent.height + wrap(y, dy, extent.height)) * extent.width;
            for &RowTap { dx, weight } in &self.taps[taps.clone()] {
                visit(row + wrap(x, dx, extent.width), weight);
            }
        }
    }

    /// Adds `factor` times the pull on the samples of some runs, at most [`BLOCK`], to `pulls`, for each run
    /// a row of lanes per dimension of the table: the mean unit vector away from their neighbours, less that
    /// away from a uniform point.
    #[inline(always)]
    pub(super) fn add_pulls(&self, tiles: &Tiles, runs: &[Run], factors: &[f32], pulls: &mut [Row]) {
        match self.dims.len() {
            1 => self.add::<1>(1, tiles, runs, factors, pulls),
            2 => self.add::<2>(2, tiles, runs, factors, pulls),
            3 => self.add::<3>(3, tiles, runs, factors, pulls),
            4 => self.add::<4>(4, tiles, runs, factors, pulls),
            dims @ 5..=8 => self.add::<8>(dims, tiles, runs, factors, pulls),
            dims => self.add::<MOST_DIMS>(dims, tiles, runs, factors, pulls),
        }
    }

    /// `MOST` is the number of dimensions where that is known when compiling, so that all sums stay in
    /// registers.
    #[inline(always)]
    fn add<const MOST: usize>(
        &self,
        dims: usize,
        tiles: &Tiles,
        runs: &[Run],
        factors: &[f32],
        pulls: &mut [Row],
    ) {
        let zero = [[0.0; LANES]; MOST];
        let total = [if tiles.is_partial() { 0.0 } else { self.total }; LANES];
        let mut seen = [Seen { own: zero, sums: zero, total }; BLOCK];
        let seen = &mut seen[..runs.len()];
        for (seen, &run) in seen.iter_mut().zip(runs) {
            let cell = &tiles.row(run.sample, run, [0; 2])[tiles.column(run, 0)..];
            seen.own.iter_mut().zip(&self.dims).for_each(|(own, &dim)| *own = cell[dim].0);
        }
        // One frame of one sample after the other: what the runs of a block see of it stays in the cache.
        for sample in 0..self.spp {
            for frame in &self.frames {
                for (seen, &run) in seen.iter_mut().zip(runs) {
                    self.see(dims, tiles, run, sample, frame, seen);
                }
            }
        }
        let per_run = pulls.len() / runs.len();
        for (Seen { own, sums, total }, pulls) in seen.iter().zip(pulls.chunks_exact_mut(per_run)) {
            let mut field = zero;
            self.field.gradient(&own[..dims], &mut field[..dims]);
            for k in 0..dims {
                let (pull, factor) = (&mut pulls[self.dims[k]], factors[k]);
                for lane in 0..LANES {
                    pull[lane] +=
                        factor * (sums[k][lane] / total[lane].max(f32::MIN_POSITIVE) - field[k][lane]);
                }
            }
        }
    }

    /// Adds what a run sees of one of the samples of its neighbours in some frame.
    #[inline(always)]
    fn see<const MOST: usize>(
        &self,
        dims: usize,
        tiles: &Tiles,
        run: Run,
        sample: usize,
        frame: &Range<usize>,
        seen: &mut Seen<MOST>,
    ) {
        let Seen { own, mut sums, mut total } = *seen;
        let (partial, planes) = (tiles.is_partial(), tiles.planes());
        let mut places = [0; MOST];
        places[..dims].copy_from_slice(&self.dims);
        for span in &self.spans[frame.clone()] {
            let row = tiles.row(sample, run, [span.dt, span.dy]);
            for &RowTap { dx, weight } in &self.taps[span.taps.clone()] {
                let others = &row[tiles.column(run, dx)..][..planes];
                let mut weights = [weight; LANES];
                if partial {
                    let Cell(demanded) = others[planes - 1];
                    for lane in 0..LANES {
                        weights[lane] *= demanded[lane];
                        total[lane] += weights[lane];
                    }
                }
                self.push(dims, &own, |k| others[places[k]].0, &weights, &mut sums);
            }
        }
        (seen.sums, seen.total) = (sums, total);
    }

    /// Adds the unit vectors away from other samples, one per lane, by weight.
    #[inline(always)]
    pub(super) fn push<const MOST: usize>(
        &self,
        dims: usize,
        own: &[Row; MOST],
        other: impl Fn(usize) -> Row,
        weights: &Row,
        sums: &mut [Row; MOST],
    ) {
        if MOST == 1 {
            let other = other(0);
            for lane in 0..LANES {
                sums[0][lane] += weights[lane] * self.ramp(own[0][lane] - other[lane]);
            }
            return;
        }
        let (mut squares, mut strengths) = ([self.softness; LANES], [0.0; LANES]);
        for (k, own) in own[..dims].iter().enumerate() {
            let other = other(k);
            for lane in 0..LANES {
                let away = own[lane] - other[lane];
                squares[lane] += away * away;
            }
        }
        for lane in 0..LANES {
            strengths[lane] = weights[lane] * inverse_root(squares[lane]);
        }
        for k in 0..dims {
            let other = other(k);
            for lane in 0..LANES {
                sums[k][lane] += strengths[lane] * (own[k][lane] - other[lane]);
            }
        }
    }

    /// The unit vector on a line, a sign, as soft as `d / √(d² + softness)` is, without a root.
    #[inline(always)]
    fn ramp(&self, away: f32) -> f32 {
        let at = (self.steepness * away).clamp(-1.0, 1.0);
        at * (1.5 - 0.5 * at * at)
    }
}

/// Runs whose pulls are computed together.
pub(super) const BLOCK: usize = 8;

/// Of a sample on a line, see [`Pairs::room`]: 64×64 with one dimension ends at 0.12 with 1, at 0.06 with 4
/// (200 sweeps).
const ROOMS_ON_A_LINE: f64 = 4.0;

/// Length of a ramp, in lengths of a soft root.
const RAMP: f32 = 2.0;

/// Squared distance that is added to every other, so that a sample is not divided by its distance from
/// itself.
const NEAREST: f32 = 1e-14;

/// `1 / √x` to 5e-6, by a shift of the exponent and two Newton steps (Lomont 2003, "Fast inverse square
/// root"): the same bits on every processor, unlike instructions that estimate it, and vectorised, unlike
/// division.
#[inline(always)]
fn inverse_root(x: f32) -> f32 {
    let guess = f32::from_bits(0x5f37_5a86 - (x.to_bits() >> 1));
    let half = 0.5 * x;
    let once = guess * (1.5 - half * guess * guess);
    once * (1.5 - half * once * once)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_roots_are_accurate_over_all_distances() {
        for i in 0..100_000 {
            let x = NEAREST * 1.000_34_f32.powi(i % 97_000);
            let error = f64::from(inverse_root(x)) * f64::from(x).sqrt() - 1.0;
            assert!(error.abs() < 5e-6, "{x}: {error}");
        }
    }
}
