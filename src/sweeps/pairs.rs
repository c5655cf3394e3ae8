//! The gradient of one term at one run of samples: a pass over the pairs that some filter holds together.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;

use super::field::FieldTable;
use super::tiles::{Cell, Run, Tiles};
use crate::kernel::{Tap, autocorrelation};
use crate::objective::plan::PlannedTerm;
use crate::simd::{LANES, Row};
use crate::table::extent::{Extent, MOST_DIMS};

/// Lattice terms that see the same dimensions, ready for sweeps.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    pub dims: Vec<usize>,
    spp: usize,
    taps: Vec<Tap>,
    /// Taps of one row of neighbours each.
    spans: Vec<Range<usize>>,
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

impl Pairs {
    /// Plans the closed form of lattice terms that see the same dimensions, each without pairs below
    /// `truncation` of its strongest.
    pub(super) fn new(terms: &[&PlannedTerm], extent: Extent, truncation: f64) -> Self {
        let weights: f64 = terms.iter().map(|term| term.spec.weight).sum();
        // Every term is meant over pixels by the square of what a filter holds, as in `Objective::cramer`.
        let mut sums = BTreeMap::new();
        for term in terms {
            let of_term = autocorrelation(term.family.taps().unwrap_or_default(), &extent, truncation);
            let total: f64 = of_term.iter().map(|tap| tap.weight).sum();
            for tap in of_term {
                *sums.entry((tap.dt, tap.dy, tap.dx)).or_insert(0.0) +=
                    term.spec.weight / weights * tap.weight / total;
            }
        }
        let taps: Vec<Tap> =
            sums.into_iter().map(|((dt, dy, dx), weight)| Tap { dt, dy, dx, weight }).collect();
        let mut spans: Vec<Range<usize>> = Vec::new();
        for (index, tap) in taps.iter().enumerate() {
            match spans.last_mut() {
                Some(span) if (taps[span.start].dt, taps[span.start].dy) == (tap.dt, tap.dy) => {
                    span.end = index + 1;
                }
                _ => spans.push(index..index + 1),
            }
        }
        let total: f64 = taps.iter().map(|tap| tap.weight).sum();
        Self {
            dims: terms[0].spec.dims.clone(),
            spp: extent.spp,
            total: (total * extent.spp as f64) as f32,
            crowd: total * extent.spp as f64 / taps.iter().map(|tap| tap.weight).fold(0.0, f64::max),
            field: FieldTable::new(terms[0].spec.dims.len()),
            softness: NEAREST,
            steepness: (RAMP * NEAREST.sqrt()).recip(),
            spans,
            taps,
        }
    }

    /// How far a unit of the pull should move a sample: `n r`, see [`crate::config::Sweeps`].
    pub(super) fn natural_step(&self) -> f64 {
        self.crowd * self.room()
    }

    /// The room around a sample. In one dimension the pull is a sum of signs, flat between one neighbour and
    /// the next: there it takes the room of several to feel where to go.
    fn room(&self) -> f64 {
        let dims = self.dims.len() as f64;
        let ball = PI.powf(0.5 * dims) / libm::tgamma(0.5 * dims + 1.0);
        let room = (ball * self.crowd).powf(-1.0 / dims);
        if self.dims.len() == 1 { ROOMS_ON_A_LINE * room } else { room }
    }

    /// Distances up to about this share of a sample's room count as longer than they are, from now on.
    pub(super) fn soften(&mut self, share: f64) {
        self.softness = ((share * self.room()) as f32).powi(2) + NEAREST;
        self.steepness = (RAMP * self.softness.sqrt()).recip();
    }

    /// Neighbours that the pull on a sample looks at.
    pub(super) fn per_sample(&self) -> f64 {
        (self.taps.len() * self.spp) as f64
    }

    /// Offsets of the neighbours, and how strongly some filter holds each.
    pub(super) fn taps(&self) -> &[Tap] {
        &self.taps
    }

    /// Adds `factor` times the pull on the samples of a run, one row of lanes per dimension of the table: the
    /// mean unit vector away from their neighbours, less that away from a uniform point.
    #[inline(always)]
    pub(super) fn add_pull(&self, tiles: &Tiles, run: Run, factors: &[f32], pulls: &mut [Row]) {
        match self.dims.len() {
            1 => self.add::<1>(1, tiles, run, factors, pulls),
            2 => self.add::<2>(2, tiles, run, factors, pulls),
            3 => self.add::<3>(3, tiles, run, factors, pulls),
            4 => self.add::<4>(4, tiles, run, factors, pulls),
            dims @ 5..=8 => self.add::<8>(dims, tiles, run, factors, pulls),
            dims => self.add::<MOST_DIMS>(dims, tiles, run, factors, pulls),
        }
    }

    /// The unit vector on a line, a sign, as soft as `d / √(d² + softness)` is, without a root.
    #[inline(always)]
    fn ramp(&self, away: f32) -> f32 {
        let at = (self.steepness * away).clamp(-1.0, 1.0);
        at * (1.5 - 0.5 * at * at)
    }

    /// `MOST` is the number of dimensions where that is known when compiling, so that all sums stay in
    /// registers.
    #[inline(always)]
    fn add<const MOST: usize>(
        &self,
        dims: usize,
        tiles: &Tiles,
        run: Run,
        factors: &[f32],
        pulls: &mut [Row],
    ) {
        let mut own = [[0.0; LANES]; MOST];
        let mut sums = [[0.0; LANES]; MOST];
        let partial = tiles.is_partial();
        let mut total = [if partial { 0.0 } else { self.total }; LANES];
        let mut places = [0; MOST];
        places[..dims].copy_from_slice(&self.dims);
        for k in 0..dims {
            own[k] = tiles.row(run.sample, run, [0; 2])[tiles.column(run, 0) + places[k]].0;
        }
        for span in &self.spans {
            let taps = &self.taps[span.clone()];
            for sample in 0..self.spp {
                let row = tiles.row(sample, run, [taps[0].dt, taps[0].dy]);
                for tap in taps {
                    let weight = tap.weight as f32;
                    let others = &row[tiles.column(run, tap.dx)..][..tiles.planes()];
                    let mut strengths = [0.0; LANES];
                    if MOST == 1 {
                        let Cell(other) = others[places[0]];
                        for lane in 0..LANES {
                            strengths[lane] = weight * self.ramp(own[0][lane] - other[lane]);
                        }
                    } else {
                        let mut squares = [self.softness; LANES];
                        for k in 0..dims {
                            let Cell(other) = others[places[k]];
                            for lane in 0..LANES {
                                let away = own[k][lane] - other[lane];
                                squares[lane] += away * away;
                            }
                        }
                        for lane in 0..LANES {
                            strengths[lane] = weight * inverse_root(squares[lane]);
                        }
                    }
                    if partial {
                        let Cell(demanded) = others[tiles.planes() - 1];
                        for lane in 0..LANES {
                            strengths[lane] *= demanded[lane];
                            total[lane] += weight * demanded[lane];
                        }
                    }
                    if MOST == 1 {
                        for lane in 0..LANES {
                            sums[0][lane] += strengths[lane];
                        }
                        continue;
                    }
                    for k in 0..dims {
                        let Cell(other) = others[places[k]];
                        for lane in 0..LANES {
                            sums[k][lane] += strengths[lane] * (own[k][lane] - other[lane]);
                        }
                    }
                }
            }
        }
        let mut field = [[0.0; LANES]; MOST];
        self.field.gradient(&own[..dims], &mut field[..dims]);
        for k in 0..dims {
            let (pull, factor) = (&mut pulls[self.dims[k]], factors[k]);
            for lane in 0..LANES {
                pull[lane] += factor * (sums[k][lane] / total[lane].max(f32::MIN_POSITIVE) - field[k][lane]);
            }
        }
    }
}

/// Of a sample on a line, see [`Pairs::room`]: 64×64 with one dimension ends at 0.12 with 1, at 0.06 with 4 (200
/// sweeps).
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
