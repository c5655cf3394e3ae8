//! Sixteen slices of one subset at once.
//!
//! The directions of a subset ride in the lanes of a vector: the subset is gathered once, its projections become
//! integer keys (value in the high bits, position in the low bits), a sorting network moves all lanes alike, and
//! the position comes out of the sort for free. Plain arrays of [`LANES`] numbers: the compiler turns them into
//! whatever vectors the processor has, without changing a bit of the result.

use pulp::Simd;

use crate::law::LaneLaw;
use crate::network::Network;
use crate::row::{LANES, Row};

/// Largest subset that is sorted in lanes; above it the network's O(n log² n) loses to a general sort.
pub(crate) const LONGEST: usize = 1024;

/// Low bits of a key, which hold the place; the others hold the value.
const PLACE_MASK: u32 = LONGEST as u32 - 1;

/// Buffers of one worker.
#[derive(Clone, Debug)]
pub(crate) struct LaneBuffers {
    /// Coordinates of the subset, sample by sample, from the middle of the cube.
    coordinates: Vec<f32>,
    projections: Vec<Row>,
    keys: Vec<[u32; LANES]>,
    means: Vec<Row>,
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
            self.means.resize(n, [0.0; LANES]);
        }
        if self.coordinates.len() < n * dims {
            self.coordinates.resize(n * dims, 0.0);
        }
    }
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
    /// Writes the coordinates of the subset, sample by sample, from the middle of the cube.
    #[inline(always)]
    fn gather(&self, coordinates: &mut [f32]) {
        let dims = self.dims.len();
        for (j, point) in coordinates.chunks_exact_mut(dims).enumerate() {
            for (dim, value) in point.iter_mut().enumerate() {
                *value = self.coordinate(j, dim) - 0.5;
            }
        }
    }

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
/// the subset's length, which is at most [`LONGEST`].
#[inline(always)]
pub(crate) fn transport<S: Simd>(
    simd: S,
    subset: &Gather,
    theta: &[Row],
    law: &LaneLaw,
    network: &Network,
    buffers: &mut LaneBuffers,
    moves: &mut [f32],
) -> f32 {
    // A number of dimensions that the compiler knows makes for loops without a counter.
    match theta {
        &[x] => in_dims(simd, subset, &[x], law, network, buffers, moves),
        &[x, y] => in_dims(simd, subset, &[x, y], law, network, buffers, moves),
        &[x, y, z] => in_dims(simd, subset, &[x, y, z], law, network, buffers, moves),
        &[x, y, z, w] => in_dims(simd, subset, &[x, y, z, w], law, network, buffers, moves),
        theta => in_dims(simd, subset, theta, law, network, buffers, moves),
    }
}

#[inline(always)]
fn in_dims<S: Simd>(
    simd: S,
    subset: &Gather,
    theta: &[Row],
    law: &LaneLaw,
    network: &Network,
    buffers: &mut LaneBuffers,
    moves: &mut [f32],
) -> f32 {
    let n = subset.samples.len();
    buffers.grow(n, theta.len());
    let LaneBuffers { coordinates, projections, keys, means, targets } = buffers;
    let (coordinates, projections) = (&mut coordinates[..n * theta.len()], &mut projections[..n]);
    subset.gather(coordinates);
    if n == 1 {
        project(coordinates, theta, projections);
        targets[0] = [0.0; LANES];
    } else {
        let (keys, means) = (&mut keys[..n], &mut means[..n / 2]);
        project(coordinates, theta, projections);
        encode(projections, law.extent(), keys);
        network.sort(simd, keys);
        law.lower_cell_means(n, means);
        match_targets(keys, means, targets);
    }
    let mut squares = displace(projections, &targets[..n], theta, moves);
    for (square, &extent) in squares.iter_mut().zip(law.extent()) {
        // An unused lane may have targets, but moves nothing.
        *square = if extent > 0.0 { *square } else { 0.0 };
    }
    sum(squares)
}

#[inline(always)]
fn project(coordinates: &[f32], theta: &[Row], projections: &mut [Row]) {
    for (point, projection) in coordinates.chunks_exact(theta.len()).zip(projections) {
        let mut sum = [0.0; LANES];
        for (value, theta) in point.iter().zip(theta) {
            for lane in 0..LANES {
                sum[lane] += value * theta[lane];
            }
        }
        *projection = sum;
    }
}

/// Keys that sort as the projections do. A projection scaled to (1, 2) has its value in the 23 bits of the
/// mantissa, which move up to make room for the position.
#[inline(always)]
fn encode(projections: &[Row], extent: &Row, keys: &mut [[u32; LANES]]) {
    /// Room for the rounding of projections at the ends of the support, in up to a thousand dimensions.
    const INSIDE: f32 = 1.0 - 1.0 / 4096.0;
    let mut scale = [0.0; LANES];
    for lane in 0..LANES {
        // An unused lane has extent 0; its keys need only be defined.
        scale[lane] = INSIDE / (extent[lane] + f32::MIN_POSITIVE);
    }
    for (place, (projection, key)) in projections.iter().zip(keys).enumerate() {
        for lane in 0..LANES {
            let bits = (1.5 + projection[lane] * scale[lane]).to_bits();
            key[lane] = (bits << 9) & !PLACE_MASK | place as u32;
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
