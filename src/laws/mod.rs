//! Laws on the line: what a target looks like along one direction, and exact distances to it.

mod boxes;
mod cube;
pub(crate) mod distance;
mod piece;
mod pieces;
mod projected;
mod square;

pub(crate) use pieces::Pieces;
pub use projected::Projected;
pub(crate) use square::SquareLaw;
