//! Slices that ride in the lanes of one vector.

/// Slices that travel together.
pub(crate) const LANES: usize = 16;

/// One number per lane.
pub(crate) type Row = [f32; LANES];

/// Sum over lanes in a fixed order, the same on every processor.
#[inline(always)]
pub(crate) fn sum(row: Row) -> f32 {
    let mut eight = [0.0; 8];
    for lane in 0..8 {
        eight[lane] = row[lane] + row[lane + 8];
    }
    let four = [eight[0] + eight[4], eight[1] + eight[5], eight[2] + eight[6], eight[3] + eight[7]];
    (four[0] + four[2]) + (four[1] + four[3])
}
