//! What is wrong with the recipe of a sampler.

use fsot::ConfigError;
use fsot::config::{ExtentError, RangeError};
use fsot::kernel::KernelError;
use thiserror::Error;

/// A recipe that makes no table.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SamplerError {
    /// A parameter lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// No table has this extent, or so many dimensions.
    #[error(transparent)]
    Extent(#[from] ExtentError),
    /// A filter that is none.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The library refuses it.
    #[error(transparent)]
    Config(#[from] ConfigError),
}
