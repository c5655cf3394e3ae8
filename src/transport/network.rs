//! Oblivious sorting of many short lists at once.
//!
//! Places to compare do not depend on the data, so that all lanes sort together. Blocks of eight rows are
//! sorted in registers; a list of more rows is sorted by a network of blocks, where comparing two blocks
//! means merging them and putting the lower half first (Knuth, The Art of Computer Programming, volume 3,
//! exercise 5.3.4-38). That takes about a quarter more comparisons than a network of rows, but an eighth of
//! the loads and stores.

use pulp::Simd;

use crate::simd::LANES;

/// Rows that are sorted, or merged with as many, in registers.
const BLOCK: usize = 8;

/// Sorts lists of one length, and of any that takes as many blocks.
#[derive(Clone, Debug)]
pub(crate) struct Network {
    blocks: usize,
    /// Pairs of blocks to merge.
    merges: Vec<[u16; 2]>,
}

impl Network {
    /// The network for lists of this many blocks. O(len log² len) comparisons.
    pub(crate) fn of_blocks(blocks: usize) -> Self {
        Self { blocks, merges: exchanges(blocks) }
    }

    /// Blocks that a list of this length takes.
    pub(crate) fn blocks(len: usize) -> usize {
        len.div_ceil(BLOCK)
    }

    /// Sorts every lane of `keys` by increasing value.
    #[inline(always)]
    pub(crate) fn sort<S: Simd>(&self, simd: S, keys: &mut [[u32; LANES]]) {
        assert_eq!(Self::blocks(keys.len()), self.blocks);
        let last = keys.len() - BLOCK * self.blocks.saturating_sub(1);
        let (keys, _) = S::as_mut_simd_u32s(keys.as_flattened_mut());
        let per_block = BLOCK * columns::<S>();
        for block in keys.chunks_mut(per_block) {
            sort_block(simd, block);
        }
        for &[low, high] in &self.merges {
            let (low, high) = (low as usize, high as usize);
            let (before, after) = keys.split_at_mut(high * per_block);
            let low = &mut before[low * per_block..][..per_block];
            if high + 1 == self.blocks && last < BLOCK {
                merge_last(simd, low, after);
            } else {
                merge::<S, BLOCK>(simd, low, &mut after[..per_block]);
            }
        }
    }
}

/// Batcher's odd-even merge exchange (Knuth, Algorithm 5.2.2M) for lists of `len` entries, at most 65536.
fn exchanges(len: usize) -> Vec<[u16; 2]> {
    let mut exchanges = Vec::new();
    let top = len.next_power_of_two() / 2;
    let mut block = top;
    while block > 0 {
        let (mut from, mut distance, mut ahead) = (top, block, 0);
        loop {
            for low in 0..len.saturating_sub(distance) {
                if low & block == ahead {
                    exchanges.push([low as u16, (low + distance) as u16]);
                }
            }
            if from == block {
                break;
            }
            (distance, from, ahead) = (from - block, from / 2, block);
        }
        block /= 2;
    }
    exchanges
}

/// Vectors in a row.
fn columns<S: Simd>() -> usize {
    LANES / S::U32_LANES
}

/// Orders pairs of rows, given as literals so that all of them stay in registers; those that touch a row from
/// `$rows` on are left out, as if it held the largest keys.
macro_rules! exchange {
    ($simd:ident, $keys:ident, $rows:expr, $($low:literal $high:literal),+) => {
        $(if $high < $rows {
            let (a, b) = ($keys[$low], $keys[$high]);
            ($keys[$low], $keys[$high]) = ($simd.min_u32s(a, b), $simd.max_u32s(a, b));
        })+
    };
}

/// Sorts up to [`BLOCK`] rows.
#[inline(always)]
fn sort_block<S: Simd>(simd: S, rows: &mut [S::u32s]) {
    match rows.len() / columns::<S>() {
        8 => sort_rows::<S, 8>(simd, rows),
        7 => sort_rows::<S, 7>(simd, rows),
        6 => sort_rows::<S, 6>(simd, rows),
        5 => sort_rows::<S, 5>(simd, rows),
        4 => sort_rows::<S, 4>(simd, rows),
        3 => sort_rows::<S, 3>(simd, rows),
        2 => sort_rows::<S, 2>(simd, rows),
        _ => {}
    }
}

#[inline(always)]
fn sort_rows<S: Simd, const ROWS: usize>(simd: S, rows: &mut [S::u32s]) {
    let columns = columns::<S>();
    let rows = &mut rows[..ROWS * columns];
    for column in 0..columns {
        let mut keys = [simd.splat_u32s(0); BLOCK];
        for row in 0..ROWS {
            keys[row] = rows[row * columns + column];
        }
        exchange!(simd, keys, ROWS, 0 4, 1 5, 2 6, 3 7, 0 2, 1 3, 4 6, 5 7, 2 4, 3 5, 0 1, 2 3, 4 5, 6 7);
        exchange!(simd, keys, ROWS, 1 4, 3 6, 1 2, 3 4, 5 6);
        for row in 0..ROWS {
            rows[row * columns + column] = keys[row];
        }
    }
}

/// Merges a sorted block with the last one, which has fewer rows.
#[inline(always)]
fn merge_last<S: Simd>(simd: S, low: &mut [S::u32s], last: &mut [S::u32s]) {
    match last.len() / columns::<S>() {
        7 => merge::<S, 7>(simd, low, last),
        6 => merge::<S, 6>(simd, low, last),
        5 => merge::<S, 5>(simd, low, last),
        4 => merge::<S, 4>(simd, low, last),
        3 => merge::<S, 3>(simd, low, last),
        2 => merge::<S, 2>(simd, low, last),
        1 => merge::<S, 1>(simd, low, last),
        _ => {}
    }
}

/// Merges two sorted blocks; the lower half of the keys goes to `low`.
#[inline(always)]
fn merge<S: Simd, const ROWS: usize>(simd: S, low: &mut [S::u32s], high: &mut [S::u32s]) {
    let columns = columns::<S>();
    let (low, high) = (&mut low[..BLOCK * columns], &mut high[..ROWS * columns]);
    for column in 0..columns {
        let mut keys = [simd.splat_u32s(0); 2 * BLOCK];
        for row in 0..BLOCK {
            keys[row] = low[row * columns + column];
        }
        for row in 0..ROWS {
            keys[BLOCK + row] = high[row * columns + column];
        }
        exchange!(simd, keys, BLOCK + ROWS, 0 8, 1 9, 2 10, 3 11, 4 12, 5 13, 6 14, 7 15);
        exchange!(simd, keys, BLOCK + ROWS, 4 8, 5 9, 6 10, 7 11);
        exchange!(simd, keys, BLOCK + ROWS, 2 4, 3 5, 6 8, 7 9, 10 12, 11 13);
        exchange!(simd, keys, BLOCK + ROWS, 1 2, 3 4, 5 6, 7 8, 9 10, 11 12, 13 14);
        for row in 0..BLOCK {
            low[row * columns + column] = keys[row];
        }
        for row in 0..ROWS {
            high[row * columns + column] = keys[BLOCK + row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A network sorts everything if it sorts all sequences of zeros and ones (Knuth, Theorem 5.3.4Z).
    #[test]
    fn short_networks_sort_every_sequence_of_zeros_and_ones() {
        for len in 0..=16_usize {
            let network = Network::of_blocks(Network::blocks(len));
            for first in (0..1_u32 << len).step_by(LANES) {
                let word = |lane: usize| first + lane as u32;
                let mut keys: Vec<[u32; LANES]> =
                    (0..len).map(|bit| std::array::from_fn(|lane| word(lane) >> bit & 1)).collect();
                network.sort(pulp::Scalar, &mut keys);
                for lane in 0..LANES {
                    assert!(keys.is_sorted_by_key(|row| row[lane]), "length {len}, word {:b}", word(lane));
                    let ones = keys.iter().filter(|row| row[lane] == 1).count() as u32;
                    assert_eq!(ones, (word(lane) & ((1 << len) - 1)).count_ones());
                }
            }
        }
    }

    #[test]
    fn long_networks_sort_as_the_standard_library_does() {
        for len in [17, 31, 64, 97, 100, 255, 256, 257, 700, 1024] {
            let network = Network::of_blocks(Network::blocks(len));
            let hash = |i: usize| (i as u32).wrapping_mul(2_654_435_761);
            let scramble = |i: usize, lane: usize| hash(i).rotate_left(lane as u32) % 1000;
            let mut keys: Vec<[u32; LANES]> =
                (0..len).map(|i| std::array::from_fn(|lane| scramble(i, lane))).collect();
            let columns: Vec<Vec<u32>> = (0..LANES)
                .map(|lane| {
                    let mut column: Vec<u32> = keys.iter().map(|row| row[lane]).collect();
                    column.sort_unstable();
                    column
                })
                .collect();
            network.sort(pulp::Scalar, &mut keys);
            for (lane, column) in columns.iter().enumerate() {
                assert!(keys.iter().map(|row| row[lane]).eq(column.iter().copied()), "length {len}");
            }
        }
    }
}
