//! Pictures of what was measured.

pub mod canvas;
mod exr;
mod spectrum;
mod srgb;

pub use exr::write_exr;
pub use spectrum::{gray, write_gray_png, write_radial_csv};
pub use srgb::srgb;
