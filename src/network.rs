//! Oblivious sorting of many short lists at once.

use crate::row::LANES;

/// Batcher's odd-even merge exchange for lists of one length (Knuth, The Art of Computer Programming, volume 3,
/// Algorithm 5.2.2M): the places to compare do not depend on the data, so that all lanes sort together.
#[derive(Clone, Debug)]
pub(crate) struct Network {
    len: usize,
    exchanges: Vec<[u16; 2]>,
}

impl Network {
    /// The network for lists of `len` keys, at most 65536. O(len log² len) exchanges.
    pub(crate) fn new(len: usize) -> Self {
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
        Self { len, exchanges }
    }

    /// Length of the lists that it sorts.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Sorts every lane of `keys` by increasing value.
    #[inline(always)]
    pub(crate) fn sort(&self, keys: &mut [[u32; LANES]]) {
        for &[low, high] in &self.exchanges {
            let (a, b) = (keys[low as usize], keys[high as usize]);
            for lane in 0..LANES {
                keys[low as usize][lane] = a[lane].min(b[lane]);
                keys[high as usize][lane] = a[lane].max(b[lane]);
            }
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
            let network = Network::new(len);
            for first in (0..1_u32 << len).step_by(LANES) {
                let word = |lane: usize| first + lane as u32;
                let mut keys: Vec<[u32; LANES]> =
                    (0..len).map(|bit| std::array::from_fn(|lane| word(lane) >> bit & 1)).collect();
                network.sort(&mut keys);
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
            let network = Network::new(len);
            let scramble = |i: usize, lane: usize| (i as u32 * 2_654_435_761).rotate_left(lane as u32) % 1000;
            let mut keys: Vec<[u32; LANES]> =
                (0..len).map(|i| std::array::from_fn(|lane| scramble(i, lane))).collect();
            let columns: Vec<Vec<u32>> = (0..LANES)
                .map(|lane| {
                    let mut column: Vec<u32> = keys.iter().map(|row| row[lane]).collect();
                    column.sort_unstable();
                    column
                })
                .collect();
            network.sort(&mut keys);
            for (lane, column) in columns.iter().enumerate() {
                assert!(keys.iter().map(|row| row[lane]).eq(column.iter().copied()), "length {len}");
            }
        }
    }
}
