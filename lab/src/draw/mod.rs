//! Pictures of what was measured.

mod exr;
mod spectrum;

pub use exr::write_exr;
pub use spectrum::{gray, write_gray_png, write_radial_csv};
