//! Void and cluster: sites ranked so that the first of any number are spread evenly[^ulichney].
//!
//! [^ulichney]: Ulichney 1993, "The void-and-cluster method for dither array generation", SPIE 1913,
//!     <https://doi.org/10.1117/12.152707>.

use fsot::Extent;
use rand::seq::SliceRandom;

use super::anneal::Neighbours;
use crate::random::{self, Purpose};

/// Energies are integers, so that what is taken away is exactly what was put there.
const UNIT: f64 = 1e6;

/// Jitter of a site's energy, far below a neighbour's weight: ties go to a random site.
const JITTER: u32 = 16;

/// The rank of every site.
///
/// The paper's third phase, tight clusters of the unset, is its second here: with a linear filter on a torus
/// the tightest cluster of the unset is the largest void of the set.
pub(super) fn ranks(extent: &Extent, neighbours: &Neighbours, seed: u64) -> Vec<u32> {
    let sites = extent.sites();
    let mut field = Field::new(extent, neighbours);
    let mut order: Vec<usize> = (0..sites).collect();
    let mut generator = random::generator(seed, Purpose::Start, 2, 0);
    order.shuffle(&mut generator);
    for (place, &site) in order.iter().enumerate() {
        field.energy[site] = (place as u32 % JITTER) as i64;
    }
    // The prototype: a tenth of the sites at random, relaxed by moving the tightest cluster to the largest
    // void. That ends, since each move lowers the energy; the limit is for jitter that could make it circle.
    let ones = (sites / 10).max(1);
    order[..ones].iter().for_each(|&site| field.flip(site));
    field.refresh_all();
    for _ in 0..10 * sites {
        let Some(cluster) = field.tightest_cluster() else { break };
        field.flip(cluster);
        let void = field.largest_void().unwrap_or(cluster);
        field.flip(void);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0; sites];
    let mut thinned = field.clone();
    for rank in (0..ones).rev() {
        if let Some(site) = thinned.tightest_cluster() {
            thinned.flip(site);
            ranks[site] = rank as u32;
        }
    }
    for rank in ones..sites {
        if let Some(site) = field.largest_void() {
            field.flip(site);
            ranks[site] = rank as u32;
        }
    }
    ranks
}

/// Which sites are set, how crowded every site is, and the extremes of every row.
#[derive(Clone)]
struct Field<'a> {
    extent: &'a Extent,
    taps: Vec<(i32, i32, i32, i64)>,
    energy: Vec<i64>,
    set: Vec<bool>,
    /// Most crowded set site of a row.
    clusters: Vec<Option<(i64, usize)>>,
    /// Least crowded unset site of a row.
    voids: Vec<Option<(i64, usize)>>,
    /// Rows whose extremes may have changed.
    stale: Vec<bool>,
}

impl<'a> Field<'a> {
    fn new(extent: &'a Extent, neighbours: &Neighbours) -> Self {
        let rows = extent.frames * extent.height;
        let weight = |&(dt, dy, dx, weight): &(i32, i32, i32, f32)| {
            (dt, dy, dx, (f64::from(weight) * UNIT).round() as i64)
        };
        Self {
            extent,
            taps: neighbours.taps.iter().map(weight).collect(),
            energy: vec![0; extent.sites()],
            set: vec![false; extent.sites()],
            clusters: vec![None; rows],
            voids: vec![None; rows],
            stale: vec![true; rows],
        }
    }

    fn flip(&mut self, site: usize) {
        let sign = if self.set[site] { -1 } else { 1 };
        self.set[site] = !self.set[site];
        let here = self.extent.site(site);
        self.stale[site / self.extent.width] = true;
        for &(dt, dy, dx, weight) in &self.taps {
            let there = self.extent.wrapped(here, (dt.into(), dy.into(), dx.into()));
            let index = self.extent.site_index(there);
            self.energy[index] += sign * weight;
            self.stale[index / self.extent.width] = true;
        }
    }

    fn refresh_all(&mut self) {
        for row in 0..self.stale.len() {
            if !std::mem::take(&mut self.stale[row]) {
                continue;
            }
            let sites = row * self.extent.width..(row + 1) * self.extent.width;
            (self.clusters[row], self.voids[row]) = (None, None);
            for site in sites {
                let energy = self.energy[site];
                if self.set[site] {
                    if self.clusters[row].is_none_or(|(most, _)| energy > most) {
                        self.clusters[row] = Some((energy, site));
                    }
                } else if self.voids[row].is_none_or(|(least, _)| energy < least) {
                    self.voids[row] = Some((energy, site));
                }
            }
        }
    }

    fn tightest_cluster(&mut self) -> Option<usize> {
        self.refresh_all();
        let found = self.clusters.iter().flatten().max_by_key(|(energy, site)| (*energy, usize::MAX - site));
        found.map(|&(_, site)| site)
    }

    fn largest_void(&mut self) -> Option<usize> {
        self.refresh_all();
        self.voids.iter().flatten().min().map(|&(_, site)| site)
    }
}

#[cfg(test)]
mod tests {
    use fsot::kernel::{Kernel, SpatialKernel, TemporalKernel};

    use super::*;

    #[test]
    fn early_ranks_keep_apart() {
        let extent = Extent { frames: 1, height: 16, width: 16, spp: 1 };
        let spatial = SpatialKernel::gaussian_from_deviation(1.9);
        let kernel = Kernel::product(spatial, TemporalKernel::None);
        let neighbours = Neighbours::of_kernels(&[kernel], &extent).unwrap();
        let ranks = ranks(&extent, &neighbours, 3);
        let mut sorted = ranks.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..256).collect::<Vec<u32>>());
        // Of 16 random sites 10 pairs are closer than 2.5 pixels in the mean, Poisson: none has a chance of
        // 5e-5.
        let first: Vec<usize> = (0..256).filter(|&site| ranks[site] < 16).collect();
        let apart = |a: usize, b: usize| a.abs_diff(b).min(16 - a.abs_diff(b)).pow(2);
        for (i, p) in first.iter().enumerate() {
            for q in &first[..i] {
                let square = apart(p / 16, q / 16) + apart(p % 16, q % 16);
                assert!(square > 6, "{p} {q}");
            }
        }
    }
}
