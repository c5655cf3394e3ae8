//! Filtered sliced optimal transport.

mod atomic;
mod domain;
mod error;
mod lattice;
mod metadata;
mod npy;
mod stream;
mod table;

pub use domain::{BELOW_ONE, Domain};
pub use error::{ConfigError, FormatError, TableError};
pub use lattice::{Extent, Site};
pub use metadata::{BoundEstimate, BoundRecord, KernelTaps, Metadata, RunRecord, Tap};
pub use table::SampleTable;
