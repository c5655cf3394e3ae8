//! Sixteen subsets at once, each along the one direction that a line has.
//!
//! In one dimension all directions of a subset are the same, so that [`super::lanes`] would have a single
//! lane to fill. Here each lane holds a subset of its own. Those of a group are of about the same size; the
//! rows that a shorter one lacks hold the largest key, which sorts behind all others.

use pulp::Simd;

use super::lanes::{self, PLACE_MASK};
use super::network::Network;
use crate::simd::{LANES, Row};

/// A subset in one lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneSubset<'a> {
    /// Numbers of its samples, at most [`lanes::LONGEST`].
    pub samples: &'a [u32],
    /// Shift of the dimension before it wraps; `None` for an interval.
    pub cut: Option<f32>,
}

/// Buffers of one worker.
#[derive(Clone, Debug, Default)]
pub(crate) struct AbreastBuffers {
    coordinates: Vec<Row>,
    keys: Vec<[u32; LANES]>,
}

/// Transports up to [`LANES`] subsets along coordinate `dim` of the table to the uniform interval, and calls
/// `put(lane, position, displacement)` for all samples. Returns the sum of squared displacements.
///
/// `points` are the values of the table, `stride` is its number of dimensions; `networks` sort lists by their
/// number of blocks.
#[inline(always)]
pub(crate) fn transport<S: Simd>(
    simd: S,
    subsets: &[LaneSubset],
    (points, stride, dim): (&[f32], usize, usize),
    networks: &[Network],
    buffers: &mut AbreastBuffers,
    mut put: impl FnMut(usize, usize, f32),
) -> f64 {
    let longest = subsets.iter().map(|subset| subset.samples.len()).max().unwrap_or(0);
    let AbreastBuffers { coordinates, keys } = buffers;
    coordinates.resize(longest.max(coordinates.len()), [0.0; LANES]);
    keys.resize(longest.max(keys.len()), [0; LANES]);
    let (coordinates, keys) = (&mut coordinates[..longest], &mut keys[..longest]);
    for (lane, subset) in subsets.iter().enumerate() {
        for (row, &sample) in coordinates.iter_mut().zip(subset.samples) {
            let value = points[sample as usize * stride + dim];
            let shifted = value - subset.cut.unwrap_or(0.0);
            row[lane] = if shifted < 0.0 { shifted + 1.0 } else { shifted } - 0.5;
        }
    }
    lanes::encode(simd, coordinates, &[1.0; LANES], keys);
    for lane in 0..LANES {
        let len = subsets.get(lane).map_or(0, |subset| subset.samples.len());
        keys[len..].iter_mut().for_each(|row| row[lane] = u32::MAX);
    }
    networks[Network::blocks(longest)].sort(simd, keys);
    let mut squares = 0.0;
    for (lane, subset) in subsets.iter().enumerate() {
        let len = subset.samples.len();
        let width = 1.0 / len.max(1) as f32;
        for (rank, row) in keys[..len].iter().enumerate() {
            let position = (row[lane] & PLACE_MASK) as usize;
            let mean = (rank as f32 + 0.5) * width - 0.5;
            let displacement = mean - coordinates[position][lane];
            squares += f64::from(displacement * displacement);
            put(lane, position, displacement);
        }
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    /// Subsets of differing sizes, none and all lanes among them, against a sort in `f64`. A key has 22 bits
    /// of the value: what is as near may change places.
    #[test]
    fn each_lane_is_its_own_subset() {
        let (samples, stride) = (600, 3);
        let points = random::uniforms(5, samples * stride);
        let networks: Vec<Network> = (0..=Network::blocks(200)).map(Network::of_blocks).collect();
        for count in [1, 5, LANES] {
            let lists: Vec<Vec<u32>> = (0..count)
                .map(|lane| {
                    (0..(lane * lane * 7 % 200) as u32).map(|i| (i * 37 + lane as u32) % 600).collect()
                })
                .collect();
            let cut = |lane: usize| (lane % 3 == 1).then_some(0.3);
            let lane_subset = |(lane, samples)| LaneSubset { samples, cut: cut(lane) };
            let subsets: Vec<LaneSubset> =
                lists.iter().map(Vec::as_slice).enumerate().map(lane_subset).collect();
            let mut found: Vec<Vec<f32>> = lists.iter().map(|list| vec![f32::NAN; list.len()]).collect();
            let squares = transport(
                pulp::Scalar,
                &subsets,
                (&points, stride, 1),
                &networks,
                &mut AbreastBuffers::default(),
                |lane, position, displacement| found[lane][position] = displacement,
            );
            let mut expected_squares = 0.0;
            for (lane, list) in lists.iter().enumerate() {
                let shifted = |&sample: &u32| {
                    (f64::from(points[sample as usize * stride + 1]) - cut(lane).map_or(0.0, f64::from))
                        .rem_euclid(1.0)
                };
                let values: Vec<f64> = list.iter().map(shifted).collect();
                let mut order: Vec<usize> = (0..list.len()).collect();
                order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
                for (rank, position) in order.into_iter().enumerate() {
                    let mean = (rank as f64 + 0.5) / list.len() as f64;
                    let expected = mean - values[position];
                    expected_squares += expected * expected;
                    let error = (f64::from(found[lane][position]) - expected).abs();
                    assert!(error < 2e-6, "lane {lane}, {position}: {error}");
                }
            }
            assert!((squares - expected_squares).abs() < 1e-4 * (1.0 + expected_squares));
        }
    }
}
