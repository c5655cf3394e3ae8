//! Sorting one list of projections: by comparison, by digits, or shared between threads.

use rayon::prelude::*;

use crate::table::extent::bytes_of;

/// Above this many samples a sort is worth sharing between threads.
pub(crate) const SHARED: usize = 1 << 17;

/// From this many samples on, a radix sort beats the comparisons of the standard library.
const RADIX: usize = 256;
/// Up to this many samples it also beats a sort shared between threads, and its positions leave room for a
/// digit.
const LARGEST_RADIX: usize = 1 << (u32::BITS - DIGIT);
/// Bits of a digit of the radix sort, which takes two.
const DIGIT: u32 = 11;

/// Buffers of one worker; they grow to the largest subset seen and stay.
#[derive(Clone, Debug, Default)]
pub(super) struct SortBuffers {
    /// Value and position in one number.
    keys: Vec<u64>,
    /// Digits and positions on their way through the radix sort.
    entries: Vec<u32>,
    starts: Vec<[u32; 1 << DIGIT]>,
}

impl SortBuffers {
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.keys) + bytes_of(&self.entries) + bytes_of(&self.starts)
    }

    /// Writes the positions of the projections by increasing value. These lie between `lowest` and `lowest +
    /// extent`, up to rounding.
    pub(super) fn sort(&mut self, projections: &[f32], (lowest, extent): (f64, f64), order: &mut [u32]) {
        let n = projections.len();
        match n {
            0..RADIX => sort_few(projections, &mut self.keys, order),
            RADIX..=LARGEST_RADIX => {
                self.entries.resize(n.max(self.entries.len()), 0);
                sort_digits(projections, (lowest, extent), (&mut self.entries, &mut self.starts), order);
            }
            _ => sort_shared(projections, &mut self.keys, order),
        }
    }
}

/// The projection in the high bits and its position in the low ones.
fn key((position, projection): (usize, &f32)) -> u64 {
    u64::from(ordered_bits(*projection)) << 32 | position as u64
}

fn sort_few(projections: &[f32], keys: &mut Vec<u64>, order: &mut [u32]) {
    keys.clear();
    keys.extend(projections.iter().enumerate().map(key));
    keys.sort_unstable();
    order.iter_mut().zip(keys).for_each(|(order, key)| *order = *key as u32);
}

fn sort_shared(projections: &[f32], keys: &mut Vec<u64>, order: &mut [u32]) {
    keys.resize(projections.len(), 0);
    let pairs = keys.par_iter_mut().zip(projections.par_iter().enumerate()).with_min_len(1 << 12);
    pairs.for_each(|(to, from)| *to = key(from));
    keys.par_sort_unstable();
    order.par_iter_mut().zip(keys).with_min_len(1 << 12).for_each(|(order, key)| *order = *key as u32);
}

/// Sorts by two digits of the projection's place in the support, to a 4-millionth of it, and by comparison
/// what is closer.
fn sort_digits(
    projections: &[f32],
    (lowest, extent): (f64, f64),
    (entries, starts): (&mut [u32], &mut Vec<[u32; 1 << DIGIT]>),
    order: &mut [u32],
) {
    const DIGITS: u32 = 2 * DIGIT;
    const LOW: u32 = (1 << DIGIT) - 1;
    let scale = (f64::from(1_u32 << DIGITS) / extent) as f32;
    let shift = (-lowest * f64::from(scale)) as f32;
    // A float becomes 0 rather than negative; rounding may exceed the last place.
    let place = |projection: f32| ((projection * scale + shift) as u32).min((1 << DIGITS) - 1);
    starts.clear();
    starts.resize(2, [0; 1 << DIGIT]);
    let [low, high] = starts.as_mut_slice() else { return };
    for (order, &projection) in order.iter_mut().zip(projections) {
        *order = place(projection);
    }
    for &place in &*order {
        low[(place & LOW) as usize] += 1;
        high[(place >> DIGIT & LOW) as usize] += 1;
    }
    for counts in [&mut *low, &mut *high] {
        let mut sum = 0;
        counts.iter_mut().for_each(|count| sum += std::mem::replace(count, sum));
    }
    for (position, &place) in order.iter().enumerate() {
        let start = &mut low[(place & LOW) as usize];
        entries[*start as usize] = (place & !LOW) << (32 - DIGITS) | position as u32;
        *start += 1;
    }
    for &entry in entries.iter().take(order.len()) {
        let start = &mut high[(entry >> (32 - DIGIT)) as usize];
        order[*start as usize] = entry & (u32::MAX >> DIGIT);
        *start += 1;
    }
    // What the digits leave equal is next to each other.
    let place_of = |position: u32| place(projections[position as usize]);
    let value = |&position: &u32| projections[position as usize];
    for equal in order.chunk_by_mut(|&a, &b| place_of(a) == place_of(b)).filter(|equal| equal.len() > 1) {
        equal.sort_unstable_by(|a, b| value(a).total_cmp(&value(b)).then(a.cmp(b)));
    }
}

/// Bits that sort as the numbers do.
fn ordered_bits(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_sort_as_numbers_do() {
        let values = [-1.0, -0.5, -1e-30, -0.0, 0.0, 1e-30, 0.25, 1.0, 1.5];
        assert!(values.map(ordered_bits).is_sorted());
    }
}
