//! What a caller sets: plain data.

pub(crate) mod point_sets;
pub(crate) mod term;
