//! Sixteen slices of one subset at once.
//!
//! The directions of a subset ride in the lanes of a vector: the subset is gathered once, its projections become
//! integer keys (value in the high bits, position in the low bits), a sorting network moves all lanes alike, and
//! the position comes out of the sort for free. Plain arrays of [`LANES`] numbers: the compiler turns them into
//! whatever vectors the processor has, without changing a bit of the result.

use crate::law::LaneLaw;
use crate::network::Network;
use crate::row::{LANES, Row};

/// Largest subset that is sorted in lanes; above it the network's O(n log² n) loses to a general sort.
pub(crate) const LONGEST: usize = 1024;

/// Buffers of one worker; they grow to the largest subset seen and stay.
#[derive(Clone, Debug, Default)]
pub(crate) struct LaneBuffers {
    projections: Vec<Row>,
    keys: Vec<[u32; LANES]>,
    means: Vec<Row>,
    targets: Vec<Row>,
}

/// Where the samples of a subset stand, seen from one dimension group.
pub(crate) struct Gather<'a> {
    /// Numbers of the samples.
    pub samples: &'a [u32],
    /// Values of the whole table.
    pub points: &'a [f32],
    /// Dimensions of the table.
    pub stride: usize,
    /// Dimensions of the group.
    pub dims: &'a [usize],
    /// Shift of each dimension of the group before it wraps; `None` for an interval.
    pub cut: &'a [Option<f32>],
}

impl Gather<'_> {
    /// Coordinate `dim` (of the group) of the subset's `j`th sample, shifted and wrapped where the dimension is
    /// a torus.
    #[inline(always)]
    pub(crate) fn coordinate(&self, j: usize, dim: usize) -> f32 {
        let value = self.points[self.samples[j] as usize * self.stride + self.dims[dim]];
        match self.cut[dim] {
            None => value,
            Some(cut) => {
                let shifted = value - cut;
                if shifted < 0.0 { shifted + 1.0 } else { shifted }
            }
        }
    }
}

/// Transports a subset along all lanes and writes, per sample and dimension of the group, the sum over lanes of
/// `displacement * theta` to `moves`. Returns the sum of squared displacements.
///
/// `theta` holds one row per dimension of the group; unused lanes are zero and move nothing. `network` sorts lists of
/// the subset's length or longer.
#[inline(always)]
pub(crate) fn transport(
    subset: &Gather,
    theta: &[Row],
    law: &LaneLaw,
    network: &Network,
    buffers: &mut LaneBuffers,
    moves: &mut [f32],
) -> f32 {
    let n = subset.samples.len();
    let place_mask = n.next_power_of_two() - 1;
    project(subset, theta, &mut buffers.projections);
    encode(&buffers.projections, law, place_mask as u32, &mut buffers.keys);
    // A network for longer lists sorts this one too, with the largest keys as filling at its end.
    buffers.keys.resize(network.len(), [u32::MAX; LANES]);
    network.sort(&mut buffers.keys);
    // A power of two long, so that a masked position is inside without a check.
    buffers.targets.resize(place_mask + 1, [0.0; LANES]);
    buffers.means.resize(n, [0.0; LANES]);
    law.cell_means(&mut buffers.means[..n]);
    match_targets(&buffers.keys, &buffers.means, &mut buffers.targets[..=place_mask]);
    let mut squares = displace(&buffers.projections, &buffers.targets, theta, moves);
    let (_, extent) = law.support();
    for lane in 0..LANES {
        // An unused lane may have targets, but moves nothing.
        squares[lane] = if extent[lane] > 0.0 { squares[lane] } else { 0.0 };
    }
    sum(squares)
}

#[inline(always)]
fn project(subset: &Gather, theta: &[Row], projections: &mut Vec<Row>) {
    projections.clear();
    for j in 0..subset.samples.len() {
        let mut sum = [0.0; LANES];
        for (dim, theta) in theta.iter().enumerate() {
            let value = subset.coordinate(j, dim);
            for lane in 0..LANES {
                sum[lane] += value * theta[lane];
            }
        }
        projections.push(sum);
    }
}

/// Keys that sort as the projections do. A projection scaled to [1, 2) has its value in the 23 bits of the
/// mantissa, which move up to make room for the position.
#[inline(always)]
fn encode(projections: &[Row], law: &LaneLaw, place_mask: u32, keys: &mut Vec<[u32; LANES]>) {
    const MANTISSA: u32 = (1 << 23) - 1;
    let (lowest, extent) = law.support();
    let mut scale = [0.0; LANES];
    for lane in 0..LANES {
        // An unused lane has extent 0; its keys need only be defined.
        scale[lane] = 1.0 / extent[lane].max(f32::MIN_POSITIVE);
    }
    keys.clear();
    for (place, projection) in projections.iter().enumerate() {
        let mut row = [0; LANES];
        for lane in 0..LANES {
            let unit = 1.0 + (projection[lane] - lowest[lane]) * scale[lane];
            let bits = unit.clamp(1.0, 2.0 - f32::EPSILON).to_bits() & MANTISSA;
            row[lane] = (bits << 9) & !place_mask | place as u32;
        }
        keys.push(row);
    }
}

/// Sends the target of each rank to the sample that has the rank.
#[inline(always)]
fn match_targets(keys: &[[u32; LANES]], means: &[Row], targets: &mut [Row]) {
    let place_mask = targets.len() - 1;
    for (key, mean) in keys.iter().zip(means) {
        for lane in 0..LANES {
            targets[key[lane] as usize & place_mask][lane] = mean[lane];
        }
    }
}

#[inline(always)]
fn displace(projections: &[Row], targets: &[Row], theta: &[Row], moves: &mut [f32]) -> Row {
    let mut squares = [0.0; LANES];
    for ((projection, target), moves) in
        projections.iter().zip(targets).zip(moves.chunks_exact_mut(theta.len()))
    {
        let mut displacement = [0.0; LANES];
        for lane in 0..LANES {
            displacement[lane] = target[lane] - projection[lane];
            squares[lane] += displacement[lane] * displacement[lane];
        }
        for (moved, theta) in moves.iter_mut().zip(theta) {
            let mut along = [0.0; LANES];
            for lane in 0..LANES {
                along[lane] = displacement[lane] * theta[lane];
            }
            *moved = sum(along);
        }
    }
    squares
}

/// Sum over lanes in a fixed order, the same on every processor.
#[inline(always)]
fn sum(row: Row) -> f32 {
    let mut eight = [0.0; 8];
    for lane in 0..8 {
        eight[lane] = row[lane] + row[lane + 8];
    }
    let four = [eight[0] + eight[4], eight[1] + eight[5], eight[2] + eight[6], eight[3] + eight[7]];
    (four[0] + four[2]) + (four[1] + four[3])
}
