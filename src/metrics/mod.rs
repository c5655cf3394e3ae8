//! Measuring tables.

mod bound;

pub use bound::{Bound, bound};
