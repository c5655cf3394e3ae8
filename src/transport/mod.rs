//! One-dimensional transport in `f32`: sixteen slices at once, or a long one.

pub(crate) mod abreast;
pub(crate) mod cells;
pub(crate) mod gather;
pub(crate) mod lanes;
pub(crate) mod line;
pub(crate) mod network;
mod sort;

pub(crate) use self::sort::SHARED;
