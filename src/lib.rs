//! Filtered sliced optimal transport.

mod domain;
mod error;
mod lattice;
mod stream;
mod table;
mod target;

pub use domain::{BELOW_ONE, Domain};
pub use error::{ConfigError, TableError};
pub use lattice::{Extent, Site};
pub use table::SampleTable;
pub use target::{Projected, Target};
