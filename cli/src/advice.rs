//! What the library refuses, with the flags that say otherwise: it has fields, and a command line has none.

use fsot::ConfigError;
use fsot::config::{ExtentError, RangeError, TermError};
use fsot::kernel::KernelError;

use crate::Failure;

/// Adds the flags, where they are known.
pub fn with_flags(failure: Failure, flags: fn(&ConfigError) -> Option<&'static str>) -> Failure {
    match failure.downcast_ref().and_then(flags) {
        Some(flags) => format!("{failure} ({flags})").into(),
        None => failure,
    }
}

/// Those of `fsot table`.
pub fn of_table(error: &ConfigError) -> Option<&'static str> {
    Some(match error {
        ConfigError::Extent(ExtentError::EmptyAxis { axis }) => match *axis {
            "width" => "--width",
            "height" => "--height",
            "frames" => "--frames",
            "spp" => "--spp",
            "dims" => "--dims",
            _ => return None,
        },
        ConfigError::Extent(ExtentError::TooManyDims { .. }) => "--dims",
        ConfigError::Extent(ExtentError::TooLarge { .. }) => "--width, --height, --frames, --spp, --dims",
        ConfigError::Range(range) => match range.name {
            "the number of sweeps" => "--sweeps",
            "the number of sweeps of a frame" => "--frame-sweeps",
            "the number of slices per class" => "--slices-per-class",
            "the number of seconds" => "--seconds",
            _ => return None,
        },
        ConfigError::TooShort { .. } => "--seconds",
        ConfigError::Uneven { .. } => "--groups",
        ConfigError::NotInClosedForm { .. } => "--slices-per-class instead of --sweeps",
        ConfigError::Term { problem, .. } => match problem {
            TermError::Kernel(KernelError::Range(RangeError { name: "sigma_px", .. })) => "--sigma",
            TermError::Kernel(_) => "--temporal",
            TermError::Group(_) | TermError::Range(RangeError { name: "the weight of a term", .. }) => {
                "--groups"
            }
            _ => return None,
        },
        _ => return None,
    })
}

/// Those of `fsot points`.
pub fn of_points(error: &ConfigError) -> Option<&'static str> {
    match error {
        ConfigError::Extent(_) => Some("--count or --counts"),
        ConfigError::Range(RangeError { name: "the number of slices per class", .. }) => Some("--slices"),
        _ => None,
    }
}
