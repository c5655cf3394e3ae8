//! Slices that ride in the lanes of one vector.

/// Slices that travel together.
pub(crate) const LANES: usize = 16;

/// One number per lane.
pub(crate) type Row = [f32; LANES];
