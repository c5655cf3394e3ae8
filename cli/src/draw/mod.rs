//! Pages to draw on.

pub mod canvas;
pub mod chart;
pub mod page;
pub mod raster;
