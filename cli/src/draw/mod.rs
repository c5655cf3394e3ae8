//! Pages to draw on.

pub mod canvas;
pub mod page;
pub mod raster;
