//! Filtered sliced optimal transport.

mod atomic;
mod bank;
mod class;
mod descent;
mod direction;
mod domain;
mod engine;
mod error;
mod kernel;
mod lanes;
mod lattice;
mod law;
mod long;
mod metadata;
pub mod metrics;
mod network;
mod npy;
mod objective;
mod optimizer;
mod stream;
mod table;
mod target;
mod transport;

pub use class::{Classes, Form};
pub use descent::{Descent, Schedule, Shape};
pub use domain::{BELOW_ONE, Domain};
pub use error::{ConfigError, FormatError, TableError};
pub use kernel::{Kernel, SpatialKernel, SpatialTap, Tap, TemporalKernel};
pub use lattice::{Extent, Site};
pub use metadata::{BoundEstimate, BoundRecord, KernelTaps, Metadata, RunRecord};
pub use objective::{DimensionGroup, Objective, Role, Slice, Slicing, Term};
pub use optimizer::{Config, Ended, Optimizer, RunReport, StepReport, Until};
pub use table::SampleTable;
pub use target::{Projected, Target};
