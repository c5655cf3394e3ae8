//! Targets that the caller writes.

use std::any::Any;

use crate::laws::Projected;
use crate::named::{ByName, Named};

/// A target measure of the caller's own, on the unit cube.
///
/// It is asked for the laws of a fixed set of directions when an objective is planned, and never during the
/// optimisation. `CustomTarget::get` gives it back as `&dyn Any`, so that who made it finds it again.
///
/// ```
/// use fsot::targets::{Measure, Projected, Target};
///
/// /// Uniform on the diagonal of the square.
/// #[derive(Debug)]
/// struct Diagonal;
///
/// impl Measure for Diagonal {
///     fn name(&self) -> &str {
///         "diagonal"
///     }
///     fn dims(&self) -> usize {
///         2
///     }
///     fn project(&self, direction: &[f64]) -> Projected {
///         let length = direction[0] + direction[1];
///         Projected::from_quantile(move |u| if length < 0.0 { (1.0 - u) * length } else { u * length })
///     }
/// }
///
/// let target = Target::custom(Diagonal);
/// assert!((target.project(&[0.6, 0.8]).mean() - 0.7).abs() < 1e-12);
/// ```
pub trait Measure: Any + std::fmt::Debug + Send + Sync {
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
