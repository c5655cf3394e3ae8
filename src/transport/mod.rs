//! One-dimensional transport in `f32`: sixteen slices at once, or a long one.

pub(crate) mod cells;
pub(crate) mod lanes;
pub(crate) mod line;
pub(crate) mod network;
