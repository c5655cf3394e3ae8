//! Filtered sliced optimal transport.

mod domain;
mod error;
mod kernel;
mod lattice;
pub mod metrics;
mod stream;
mod table;
mod target;

pub use domain::{BELOW_ONE, Domain};
pub use error::{ConfigError, TableError};
pub use kernel::{Kernel, SpatialKernel, SpatialTap, Tap, TemporalKernel};
pub use lattice::{Extent, Site};
pub use table::SampleTable;
pub use target::{Projected, Target};
