//! Sweeps of samples that lie so far apart that a pass over all neighbours of each would look mostly at what
//! is not demanded: neighbours are listed, one by one.

use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::pairs::Pairs;
use super::reflect;
use crate::objective::Objective;
use crate::simd::{self, LANES, Row};
use crate::table::domain::Domain;
use crate::table::extent::{Extent, MOST_DIMS, bytes_of};

/// The demanded samples of a table, packed.
///
/// Places number the demanded sites frame by frame, with the same number of places in each frame, so that
/// they are a table of their own: frames × 1 × places.
#[derive(Clone, Debug)]
pub(super) struct Scattered {
    /// The site at each place; [`NOWHERE`] where a frame has fewer than others.
    sites: Vec<u32>,
    frames: usize,
    spp: usize,
    dims: usize,
    /// Values in the order of places.
    points: Vec<f32>,
    /// By term.
    neighbours: Vec<Neighbours>,
}

/// For each place the others that a term's filters hold together with it.
#[derive(Clone, Debug)]
struct Neighbours {
    /// Where the list of each place begins, and the end of the last.
    starts: Vec<usize>,
    /// Where the first coordinate that the term sees of each neighbour's first sample is.
    offsets: Vec<u32>,
    weights: Vec<f32>,
    /// Sum of the weights of each place, over all samples of its neighbours.
    totals: Vec<f32>,
    /// What a unit of its pull should move a sample of each place.
    steps: Vec<f32>,
}

/// The place of no site.
const NOWHERE: u32 = u32::MAX;

/// What a listed pair costs, in pairs of tiles, 5 to 13: its coordinates are gathered one by one.
const LISTED_COST: f64 = 11.0;

/// Memory of the lists, in tables; longer ones also leave the caches.
const MOST_TABLES: f64 = 16.0;

/// Samples whose lists are counted before all are.
const PROBES: usize = 256;

/// Pairs that are worth sharing between threads.
const WORTH_SHARING: f64 = 8192.0;

impl Scattered {
    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        let of = |list: &Neighbours| {
            let floats = bytes_of(&list.weights) + bytes_of(&list.totals) + bytes_of(&list.steps);
            bytes_of(&list.starts) + bytes_of(&list.offsets) + floats
        };
        let lists: usize = self.neighbours.iter().map(of).sum();
        bytes_of(&self.sites) + bytes_of(&self.points) + lists
    }

    /// Lists the neighbours of what is demanded, where that costs less than `pairs` of tiles, and not too
    /// much memory; `None` where it doesn't.
    pub(super) fn new(objective: &Objective, terms: &[Pairs], pairs: f64) -> Option<Self> {
        let Objective { extent, dims, ref wanted, .. } = *objective;
        if !wanted.is_partial() {
            return None;
        }
        let frame = extent.height * extent.width;
        let mut sites = vec![Vec::new(); extent.frames];
        for (index, sites) in sites.iter_mut().enumerate() {
            wanted.for_each(index * frame..(index + 1) * frame, |site| sites.push(site));
        }
        let width = sites.iter().map(Vec::len).max().unwrap_or(0);
        sites.iter_mut().for_each(|sites| sites.resize(width, NOWHERE));
        let (sites, frames, spp) = (sites.concat(), extent.frames, extent.spp);
        let mut places = vec![NOWHERE; extent.sites()];
        let somewhere = |site: &u32| *site != NOWHERE;
        for (place, &site) in sites.iter().enumerate().filter(|(_, site)| somewhere(site)) {
            places[site as usize] = place as u32;
        }
        let step = sites.len().div_ceil(PROBES);
        let probed: Vec<u32> = sites.iter().copied().step_by(step).filter(somewhere).collect();
        let held = |pairs: &Pairs| {
            let mut held = 0;
            for &site in &probed {
                let count = |other: usize, _| held += usize::from(places[other] != NOWHERE);
                pairs.for_each_neighbour(&extent, site as usize, count);
            }
            held as f64 / probed.len().max(1) as f64
        };
        let samples = (sites.iter().filter(|site| somewhere(site)).count() * spp) as f64;
        let held = terms.iter().map(held).sum::<f64>();
        let bytes = held * samples / spp as f64 * (size_of::<u32>() + size_of::<f32>()) as f64;
        let table = (extent.samples() * dims * size_of::<f32>()) as f64;
        if LISTED_COST * held * samples * spp as f64 >= pairs || bytes > MOST_TABLES * table {
            return None;
        }
        let stride = (spp * dims) as u32;
        let neighbours = terms.iter().map(|pairs| Neighbours::new(pairs, &extent, &sites, &places, stride));
        let neighbours = neighbours.collect();
        let points = vec![0.0; sites.len() * spp * dims];
        Some(Self { sites, frames, spp, dims, points, neighbours })
    }

    /// The table that the places make, and which of them have a site.
    pub(super) fn extent(&self) -> (Extent, Vec<bool>) {
        let Self { sites, frames, spp, .. } = self;
        let extent = Extent { frames: *frames, height: 1, width: sites.len() / frames, spp: *spp };
        (extent, sites.iter().map(|&site| site != NOWHERE).collect())
    }

    /// Numbers of all samples that have a site.
    pub(super) fn samples(&self) -> impl Iterator<Item = u32> {
        let places = self.sites.iter().enumerate().filter(|&(_, &site)| site != NOWHERE);
        places.flat_map(|(place, _)| (place * self.spp) as u32..((place + 1) * self.spp) as u32)
    }

    /// The number of a sample in the whole table.
    #[cfg(test)]
    pub(super) fn in_table(&self, sample: u32) -> usize {
        self.sites[sample as usize / self.spp] as usize * self.spp + sample as usize % self.spp
    }

    /// Listed pairs of samples, in pairs of tiles.
    pub(super) fn pairs(&self) -> f64 {
        let listed: usize = self.neighbours.iter().map(|neighbours| neighbours.offsets.len()).sum();
        LISTED_COST * (listed * self.spp * self.spp) as f64
    }

    /// Largest number of a unit of the pull that a sample should move.
    pub(super) fn largest_step(&self) -> f64 {
        let steps = self.neighbours.iter().flat_map(|neighbours| &neighbours.steps);
        steps.copied().fold(0.0, f32::max).into()
    }

    /// Reads the demanded samples of a table.
    pub(super) fn load(&mut self, points: &[f32]) {
        let len = self.spp * self.dims;
        for (packed, &site) in self.points.chunks_exact_mut(len).zip(&self.sites) {
            if site != NOWHERE {
                packed.copy_from_slice(&points[site as usize * len..][..len]);
            }
        }
    }

    /// Writes them back.
    pub(super) fn store(&self, points: &mut [f32]) {
        let len = self.spp * self.dims;
        for (packed, &site) in self.points.chunks_exact(len).zip(&self.sites) {
            if site != NOWHERE {
                points[site as usize * len..][..len].copy_from_slice(packed);
            }
        }
    }

    /// Values in the order of places.
    pub(super) fn points(&self) -> &[f32] {
        &self.points
    }

    /// See [`Scattered::points`].
    pub(super) fn points_mut(&mut self) -> &mut [f32] {
        &mut self.points
    }

    /// Writes the pulls on samples, sixteen to a vector: a row of lanes per dimension of the table.
    pub(super) fn pull(
        &self,
        arch: Arch,
        terms: &[Pairs],
        shares: &[Vec<f32>],
        samples: &[u32],
        pulls: &mut [Row],
    ) {
        let share = samples.len() as f64 / (self.sites.len() * self.spp).max(1) as f64;
        let pull = |(samples, pulls): (&[u32], &mut [Row])| {
            arch.dispatch(PullsOfSamples { scattered: self, terms, shares, samples, pulls });
        };
        if share * self.pairs() < WORTH_SHARING {
            samples.chunks(LANES).zip(pulls.chunks_exact_mut(self.dims)).for_each(pull);
        } else {
            samples.par_chunks(LANES).zip(pulls.par_chunks_exact_mut(self.dims)).for_each(pull);
        }
    }

    /// Moves a coordinate of a sample.
    #[inline(always)]
    pub(super) fn shift(&mut self, sample: u32, dim: usize, motion: f32, domain: Domain) {
        let value = &mut self.points[sample as usize * self.dims + dim];
        *value = match domain {
            Domain::Interval => reflect(*value + motion),
            Domain::Torus => domain.admit(*value + motion),
        };
    }
}

impl Neighbours {
    /// The values of a place are `stride` numbers.
    fn new(pairs: &Pairs, extent: &Extent, sites: &[u32], places: &[u32], stride: u32) -> Self {
        let mut lists = Self {
            starts: vec![0],
            offsets: Vec::new(),
            weights: Vec::new(),
            totals: Vec::new(),
            steps: Vec::new(),
        };
        for &site in sites {
            let begin = lists.offsets.len();
            if site != NOWHERE {
                pairs.for_each_neighbour(extent, site as usize, |other, weight| {
                    if places[other] != NOWHERE {
                        lists.offsets.push(places[other] * stride + pairs.dims[0] as u32);
                        lists.weights.push(weight);
                    }
                });
            }
            let weights = &lists.weights[begin..];
            let total = weights.iter().sum::<f32>() * extent.spp as f32;
            lists.starts.push(lists.offsets.len());
            lists.totals.push(total);
            lists.steps.push(pairs.natural_step_of(total.into()) as f32);
        }
        lists
    }

    fn list(&self, place: usize) -> Range<usize> {
        self.starts[place]..self.starts[place + 1]
    }
}

/// The pulls on up to sixteen samples, compiled once per instruction set.
struct PullsOfSamples<'a> {
    scattered: &'a Scattered,
    terms: &'a [Pairs],
    /// What a term's pull counts on each of its coordinates, beside those of others.
    shares: &'a [Vec<f32>],
    samples: &'a [u32],
    pulls: &'a mut [Row],
}

impl NullaryFnOnce for PullsOfSamples<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { scattered, terms, shares, samples, pulls } = self;
        pulls.fill([0.0; LANES]);
        for ((pairs, shares), neighbours) in terms.iter().zip(shares).zip(&scattered.neighbours) {
            // Calls, and no pointer to a function, which would be compiled for no instruction set.
            match pairs.dims.len() {
                1 => scattered.add::<1>(pairs, neighbours, shares, samples, pulls),
                2 => scattered.add::<2>(pairs, neighbours, shares, samples, pulls),
                3 => scattered.add::<3>(pairs, neighbours, shares, samples, pulls),
                4 => scattered.add::<4>(pairs, neighbours, shares, samples, pulls),
                5..=8 => scattered.add::<8>(pairs, neighbours, shares, samples, pulls),
                _ => scattered.add::<MOST_DIMS>(pairs, neighbours, shares, samples, pulls),
            }
        }
    }
}

impl Scattered {
    /// Adds a term's pull on some samples, as [`Pairs::add_pulls`] does.
    #[inline(always)]
    fn add<const MOST: usize>(
        &self,
        pairs: &Pairs,
        neighbours: &Neighbours,
        shares: &[f32],
        samples: &[u32],
        pulls: &mut [Row],
    ) {
        let zero = [[0.0; LANES]; MOST];
        let (mut own, mut sums) = (zero, zero);
        let (mut totals, mut steps) = ([1.0; LANES], [0.0; LANES]);
        let mut gathered = Gathered { others: [zero; ROWS], weights: [[0.0; LANES]; ROWS] };
        for (lane, &sample) in samples.iter().enumerate() {
            let place = sample as usize / self.spp;
            let values = &self.points[sample as usize * self.dims..];
            let mut around = zero;
            for (k, &dim) in pairs.dims.iter().enumerate() {
                own[k][lane] = values[dim];
                around[k] = [values[dim]; LANES];
            }
            let list = neighbours.list(place);
            let list = (&neighbours.offsets[list.clone()], &neighbours.weights[list]);
            let sum = self.seen(pairs, &around, list, &mut gathered);
            sums.iter_mut().zip(sum).for_each(|(sums, sum)| sums[lane] = sum);
            (totals[lane], steps[lane]) = (neighbours.totals[place], neighbours.steps[place]);
        }
        let mut field = zero;
        let dims = pairs.dims.len();
        pairs.field(&own[..dims], &mut field[..dims]);
        for (k, &dim) in pairs.dims.iter().enumerate() {
            for lane in 0..LANES {
                let mean = sums[k][lane] / totals[lane];
                pulls[dim][lane] += shares[k] * steps[lane] * (mean - field[k][lane]);
            }
        }
    }

    /// Sum of the unit vectors from listed neighbours to a sample, which stands in all lanes.
    #[inline(always)]
    fn seen<const MOST: usize>(
        &self,
        pairs: &Pairs,
        own: &[Row; MOST],
        (offsets, weights): (&[u32], &[f32]),
        gathered: &mut Gathered<MOST>,
    ) -> [f32; MOST] {
        let mut sums = [[0.0; LANES]; MOST];
        let Gathered { others, weights: heavy } = gathered;
        let dims = pairs.dims.len();
        let mut steps = [0; MOST];
        steps.iter_mut().zip(&pairs.dims).for_each(|(step, dim)| *step = dim.wrapping_sub(pairs.dims[0]));
        // The common case by itself: one check for all coordinates of a sample.
        let together = dims == MOST && steps.iter().enumerate().all(|(k, &step)| k == step);
        for sample in 0..self.spp {
            let points = &self.points[sample * self.dims..];
            for (offsets, weights) in offsets.chunks(ROWS * LANES).zip(weights.chunks(ROWS * LANES)) {
                let rows = offsets.len().div_ceil(LANES);
                // Lanes without a neighbour weigh nothing.
                (others[rows - 1], heavy[rows - 1]) = (*own, [0.0; LANES]);
                heavy.as_flattened_mut()[..weights.len()].copy_from_slice(weights);
                for (offsets, others) in offsets.chunks(LANES).zip(&mut *others) {
                    for (lane, &offset) in offsets.iter().enumerate() {
                        let values = &points[offset as usize..];
                        if together && let Some(values) = values.first_chunk::<MOST>() {
                            others.iter_mut().zip(values).for_each(|(others, value)| others[lane] = *value);
                            continue;
                        }
                        for (others, &step) in others[..dims].iter_mut().zip(&steps) {
                            // A dimension before the first one of the group is a step back.
                            others[lane] = points[(offset as usize).wrapping_add(step)];
                        }
                    }
                }
                for (others, weights) in others[..rows].iter().zip(&*heavy) {
                    pairs.push(dims, own, |k| others[k], weights, &mut sums);
                }
            }
        }
        sums.map(simd::sum)
    }
}

/// Coordinates of neighbours, and their weights. They are gathered first and looked at later, because a
/// vector cannot be loaded while its parts are on their way to memory.
struct Gathered<const MOST: usize> {
    others: [[Row; MOST]; ROWS],
    weights: [Row; ROWS],
}

/// Vectors of neighbours that are gathered together.
const ROWS: usize = 8;

#[cfg(test)]
#[path = "scattered_tests.rs"]
mod tests;
