//! Filtered sliced optimal transport.

mod atomic;
mod demand;
mod domain;
mod error;
mod kernel;
mod lattice;
mod metadata;
mod npy;
pub mod render;
pub mod sampler;
mod stream;
mod table;

pub use demand::Demand;
pub use domain::{BELOW_ONE, Domain};
pub use error::{ConfigError, FormatError, TableError};
pub use kernel::{Kernel, SpatialKernel, SpatialTap, Tap, TemporalKernel};
pub use lattice::{Extent, Site};
pub use metadata::{BoundEstimate, BoundRecord, KernelTaps, Metadata, RunRecord, Tap as RecordedTap};
pub use table::SampleTable;
