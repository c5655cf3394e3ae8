//! What a caller got wrong, with the values that show it, by owner. Every message ends in what to do about
//! it.

mod checkpoint;
mod config;
mod export;
mod files;
mod import;
mod kernel;
mod objective;
#[cfg(feature = "image")]
mod picture;
mod shape;
mod short;
mod target;

pub use self::checkpoint::CheckpointError;
pub use self::config::{ClassError, ConfigError, TermError};
pub use self::export::ExportError;
pub use self::files::{FormatError, TableError};
pub use self::import::ImportError;
pub use self::kernel::KernelError;
pub use self::objective::{ObjectiveError, SliceError};
#[cfg(feature = "image")]
pub use self::picture::PictureError;
pub use self::shape::{ExtentError, GroupError, RangeError};
pub use self::short::Short;
pub(crate) use self::short::ShortList;
pub use self::target::TargetError;

/// What to do about the system's word.
pub(crate) fn io_advice(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::OutOfMemory => "give a smaller file, or a machine with more memory",
        std::io::ErrorKind::StorageFull => "make room there, or choose another place",
        _ => "check the path and its permissions",
    }
}
