//! Pictures of what was measured.

mod spectrum;

pub use spectrum::{gray, write_gray_png, write_radial_csv};
