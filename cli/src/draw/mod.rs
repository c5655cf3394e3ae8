//! Pictures.

pub mod chart;
pub mod page;
pub mod raster;
