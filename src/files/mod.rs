//! What lies on the disk: tables, their metadata, other people's files, and a writer whose files appear
//! whole or not at all.

mod bytes;
mod c_source;
mod dtype;
mod export;
mod header;
mod import;
mod layout;
mod levels;
mod literal;
pub(crate) mod metadata;
pub(crate) mod npy;
pub mod shell;
mod text;
mod whole;

pub(crate) use self::bytes::{hexadecimal, little_endian};
pub use self::dtype::Dtype;
pub use self::export::{Depth, ExportOptions, ExportRecord, Exported, Format, RecordedFile, Rounding};
pub use self::import::{ImportOptions, Imported};
pub use self::layout::Axis;
pub use self::metadata::{BoundEstimate, BoundRecord, KernelTaps, Metadata, RunRecord, RunStart};
pub use self::whole::WholeFile;
pub use crate::error::{ExportError, FormatError, ImportError, TableError};
