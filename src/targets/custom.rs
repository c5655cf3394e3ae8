//! Targets that the caller writes.

use crate::laws::Projected;
use crate::named::{ByName, Named};

/// A target measure of the caller's own, on the unit cube.
///
/// It is asked for the laws of a fixed set of directions when an objective is planned, and never during the
/// optimisation.
pub trait Measure: std::fmt::Debug + Send + Sync {
    /// Name for messages and for a serialised [`crate::Config`].
    fn name(&self) -> &str;

    /// Number of dimensions.
    fn dims(&self) -> usize;

    /// The law of `x·direction` where `x` follows the measure, with one component of any sign per dimension:
    /// [`Projected::from_quantile`], [`Projected::from_density`] or [`Projected::from_samples`] make one.
    fn project(&self, direction: &[f64]) -> Projected;
}

impl Named for dyn Measure {
    const KIND: &'static str = "target";
    const CONSTRUCTOR: &'static str = "Target::custom";

    fn name(&self) -> &str {
        Measure::name(self)
    }
}

/// A [`Measure`] behind a shared pointer; [`Target::custom`](super::Target::custom) makes one.
pub type CustomTarget = ByName<dyn Measure>;
