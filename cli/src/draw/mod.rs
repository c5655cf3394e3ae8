//! Pictures.

pub mod page;
pub mod raster;
