//! What lies on the disk: tables, their metadata, and a writer whose files appear whole or not at all.

pub(crate) mod metadata;
pub(crate) mod npy;
mod whole;

pub use self::metadata::{BoundEstimate, BoundRecord, KernelTaps, Metadata, RunRecord};
pub use self::whole::WholeFile;
pub use crate::error::{FormatError, TableError};
