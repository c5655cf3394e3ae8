//! Sixteen slices of one subset at once.
//!
//! The directions of a subset ride in the lanes of a vector: the subset is gathered once, its projections
//! become integer keys (value in the high bits, position in the low bits), a sorting network moves all lanes
//! alike, and the position comes out of the sort for free. Plain arrays of [`LANES`] numbers: the compiler
//! turns them into whatever vectors the processor has, without changing a bit of the result.

use pulp::Simd;

use crate::simd::{self, LANES, Row};
use crate::transport::cells::{self, LaneLaws};
use crate::transport::gather::Gather;
use crate::transport::network::Network;

/// Largest subset that is sorted in lanes; above it the network's O(n log² n) loses to a general sort.
pub(crate) const LONGEST: usize = 1024;

/// Low bits of a key, which hold the place; the others hold the value.
pub(super) const PLACE_MASK: u32 = LONGEST as u32 - 1;

/// Buffers of one worker.
#[derive(Clone, Debug)]
pub(crate) struct LaneBuffers {
    /// Coordinates of the subset, sample by sample, from the middle of the cube.
    coordinates: Vec<f32>,
    projections: Vec<Row>,
    keys: Vec<[u32; LANES]>,
    means: Vec<Row>,
    /// Means of the square root over `[0, 1]`, `[1, 2]`, ….
    root_means: Vec<f32>,
    /// Sums of products over the lanes that are four apart, per sample and dimension.
    quarters: Vec<[f32; LANES / 4]>,
    /// As many as a masked position can name, so that it is inside without a check.
    targets: Box<[Row; LONGEST]>,
}

impl Default for LaneBuffers {
    fn default() -> Self {
        let targets = vec![[0.0; LANES]; LONGEST].into_boxed_slice();
        Self {
            coordinates: Vec::new(),
            projections: Vec::new(),
            keys: Vec::new(),
            means: Vec::new(),
            root_means: Vec::new(),
            quarters: Vec::new(),
            targets: targets.try_into().unwrap_or_else(|_| unreachable!("as many rows as places")),
        }
    }
}

impl LaneBuffers {
    /// Makes room for `n` samples; what is there stays.
    fn grow(&mut self, n: usize, dims: usize) {
        if self.keys.len() < n {
            self.projections.resize(n, [0.0; LANES]);
            self.keys.resize(n, [0; LANES]);
            self.means.resize((n / 2).max(self.means.len()), [0.0; LANES]);
            self.root_means.extend((self.root_means.len()..n / 2).map(cells::root_mean));
        }
        if self.coordinates.len() < n * dims {
            self.coordinates.resize(n * dims, 0.0);
            self.quarters.resize(n * dims, [0.0; LANES / 4]);
        }
    }
}

/// Transports a subset along all lanes and writes, per sample and dimension of the group, the sum over lanes
/// of `displacement * theta` to `moves`. Returns the sum of squared displacements.
///
/// `theta` holds one row per dimension of the group; unused lanes are zero and move nothing. `network` sorts
/// lists of the subset's length, which is at most [`LONGEST`].
#[inline(always)]
pub(crate) fn transport<S: Simd>(
    simd: S,
    subset: &Gather,
    theta: &[Row],
    laws: &LaneLaws,
    network: &Network,
    buffers: &mut LaneBuffers,
    moves: &mut [f32],
) -> f32 {
    let n = subset.samples.len();
    buffers.grow(n, theta.len());
    let LaneBuffers { coordinates, projections, keys, means, root_means, quarters, targets } = buffers;
    let (coordinates, projections) = (&mut coordinates[..n * theta.len()], &mut projections[..n]);
    subset.gather(coordinates);
    project(coordinates, theta, projections);
    match laws {
        LaneLaws::Pieces(laws_of_pieces) => {
            let keys = &mut keys[..n];
            means.resize(n.max(means.len()), [0.0; LANES]);
            encode(simd, projections, laws.extent(), keys);
            network.sort(simd, keys);
            laws_of_pieces.cell_means(&mut means[..n]);
            match_all_targets(keys, &means[..n], targets);
        }
        LaneLaws::Symmetric(_) if n == 1 => targets[0] = [0.0; LANES],
        LaneLaws::Symmetric(symmetric) => {
            let (keys, means) = (&mut keys[..n], &mut means[..n / 2]);
            encode(simd, projections, laws.extent(), keys);
            network.sort(simd, keys);
            symmetric.lower_cell_means(simd, n, root_means, means);
            match_targets(keys, means, targets);
        }
    }
    let quarters = &mut quarters[..n * theta.len()];
    let mut squares = displace(projections, &targets[..n], theta, quarters);
    add_up(quarters, moves);
    for (square, &extent) in squares.iter_mut().zip(laws.extent()) {
        // An unused lane may have targets, but moves nothing.
        *square = if extent > 0.0 { *square } else { 0.0 };
    }
    simd::sum(squares)
}

#[inline(always)]
fn project(coordinates: &[f32], theta: &[Row], projections: &mut [Row]) {
    // A number of dimensions that the compiler knows makes for a loop without inner counters.
    match theta.len() {
        1 => project_in::<1>(coordinates, theta, projections),
        2 => project_in::<2>(coordinates, theta, projections),
        3 => project_in::<3>(coordinates, theta, projections),
        4 => project_in::<4>(coordinates, theta, projections),
        dims => {
            for (point, projection) in coordinates.chunks_exact(dims).zip(projections) {
                *projection = projected(point, theta);
            }
        }
    }
}

#[inline(always)]
fn project_in<const DIMS: usize>(coordinates: &[f32], theta: &[Row], projections: &mut [Row]) {
    let (points, _) = coordinates.as_chunks::<DIMS>();
    let theta = theta.first_chunk::<DIMS>();
    for (point, projection) in points.iter().zip(projections) {
        *projection = theta.map_or([0.0; LANES], |theta| projected(point, theta));
    }
}

#[inline(always)]
fn projected(point: &[f32], theta: &[Row]) -> Row {
    let mut sum = [0.0; LANES];
    for (value, theta) in point.iter().zip(theta) {
        for lane in 0..LANES {
            sum[lane] += value * theta[lane];
        }
    }
    sum
}

/// Keys that sort as the projections do. A projection scaled to (1, 2) has its value in the 23 bits of the
/// mantissa, which move up to make room for the position.
#[inline(always)]
pub(super) fn encode<S: Simd>(simd: S, projections: &[Row], extent: &Row, keys: &mut [[u32; LANES]]) {
    /// Room for the rounding of projections at the ends of the support, in up to a thousand dimensions.
    const INSIDE: f32 = 1.0 - 1.0 / 4096.0;
    const MANTISSA: u32 = f32::MANTISSA_DIGITS - 1;
    let mut scale = [0.0; LANES];
    let (inside, least) = (simd.splat_f32s(INSIDE), simd.splat_f32s(f32::MIN_POSITIVE));
    for (scale, extent) in S::as_mut_simd_f32s(&mut scale).0.iter_mut().zip(S::as_simd_f32s(extent).0) {
        // An unused lane has extent 0; its keys need only be defined.
        *scale = simd.div_f32s(inside, simd.max_f32s(*extent, least));
    }
    let (scale, _) = S::as_simd_f32s(&scale);
    let (projections, _) = S::as_simd_f32s(projections.as_flattened());
    let (keys, _) = S::as_mut_simd_u32s(keys.as_flattened_mut());
    let (middle, shift) = (simd.splat_f32s(1.5), simd.splat_u32s(u32::BITS - MANTISSA));
    let value_mask = simd.splat_u32s(!PLACE_MASK);
    let rows = projections.chunks_exact(scale.len()).zip(keys.chunks_exact_mut(scale.len()));
    for (place, (projection, key)) in rows.enumerate() {
        let place = simd.splat_u32s(place as u32);
        for ((key, projection), scale) in key.iter_mut().zip(projection).zip(scale) {
            let unit = simd.add_f32s(middle, simd.mul_f32s(*projection, *scale));
            let bits = simd.wrapping_dyn_shl_u32s(simd.transmute_u32s_f32s(unit), shift);
            *key = simd.or_u32s(simd.and_u32s(bits, value_mask), place);
        }
    }
}

/// Sends the target of each rank to the sample that has the rank.
#[inline(always)]
fn match_targets(keys: &[[u32; LANES]], means: &[Row], targets: &mut [Row; LONGEST]) {
    let (lower, upper) = keys.split_at(keys.len() - means.len());
    for ((low, high), mean) in lower.iter().zip(upper.iter().rev()).zip(means) {
        for lane in 0..LANES {
            targets[(low[lane] & PLACE_MASK) as usize][lane] = mean[lane];
            targets[(high[lane] & PLACE_MASK) as usize][lane] = -mean[lane];
        }
    }
    if lower.len() > upper.len() {
        for (lane, middle) in lower[upper.len()].iter().enumerate() {
            targets[(middle & PLACE_MASK) as usize][lane] = 0.0;
        }
    }
}

/// The same for laws that are not symmetric.
#[inline(always)]
fn match_all_targets(keys: &[[u32; LANES]], means: &[Row], targets: &mut [Row; LONGEST]) {
    for (key, mean) in keys.iter().zip(means) {
        for lane in 0..LANES {
            targets[(key[lane] & PLACE_MASK) as usize][lane] = mean[lane];
        }
    }
}

/// Writes the first steps of the sum over lanes of `displacement * theta`, per sample and dimension. Returns
/// the sums of squared displacements.
#[inline(always)]
fn displace(projections: &[Row], targets: &[Row], theta: &[Row], quarters: &mut [[f32; LANES / 4]]) -> Row {
    match theta.len() {
        1 => displace_in::<1>(projections, targets, theta, quarters),
        2 => displace_in::<2>(projections, targets, theta, quarters),
        3 => displace_in::<3>(projections, targets, theta, quarters),
        4 => displace_in::<4>(projections, targets, theta, quarters),
        dims => {
            let mut squares = [0.0; LANES];
            let samples = projections.iter().zip(targets).zip(quarters.chunks_exact_mut(dims));
            for ((from, to), quarters) in samples {
                displaced(from, to, theta, quarters, &mut squares);
            }
            squares
        }
    }
}

#[inline(always)]
fn displace_in<const DIMS: usize>(
    projections: &[Row],
    targets: &[Row],
    theta: &[Row],
    quarters: &mut [[f32; LANES / 4]],
) -> Row {
    let mut squares = [0.0; LANES];
    let (quarters, _) = quarters.as_chunks_mut::<DIMS>();
    let Some(theta) = theta.first_chunk::<DIMS>() else { return squares };
    let samples = projections.iter().zip(targets).zip(quarters);
    // A loop and no `for_each`, which might be compiled apart, for another instruction set.
    for ((from, to), quarters) in samples {
        displaced(from, to, theta, quarters, &mut squares);
    }
    squares
}

#[inline(always)]
fn displaced(from: &Row, to: &Row, theta: &[Row], quarters: &mut [[f32; LANES / 4]], squares: &mut Row) {
    let mut displacement = [0.0; LANES];
    for lane in 0..LANES {
        displacement[lane] = to[lane] - from[lane];
        squares[lane] += displacement[lane] * displacement[lane];
    }
    for (quarter, theta) in quarters.iter_mut().zip(theta) {
        let mut eight = [0.0; 8];
        for lane in 0..8 {
            eight[lane] = displacement[lane] * theta[lane] + displacement[lane + 8] * theta[lane + 8];
        }
        for lane in 0..4 {
            quarter[lane] = eight[lane] + eight[lane + 4];
        }
    }
}

/// Adds up the four numbers of each row. In a loop of its own, so that several rows are added at once.
#[inline(always)]
fn add_up(quarters: &[[f32; LANES / 4]], sums: &mut [f32]) {
    for ([a, b, c, d], sum) in quarters.iter().zip(sums) {
        *sum = (a + c) + (b + d);
    }
}
