//! What lies on the disk: tables, their metadata, and a writer whose files appear whole or not at all.

pub(crate) mod metadata;
pub(crate) mod npy;
pub(crate) mod whole;
