//! What a table is worth, measured: filtered error, bias, uniformity and spectra.
//!
//! Every figure that can be one is a *ratio to white noise*: 1 means as good as independent random numbers in
//! a table of the same shape, 0 means no error. The denominator is the analytic expectation, never a draw, so
//! a ratio has no noise but that of the test integrands, which [`Estimate`] states.
//!
//! Every metric is a type with one verb, `measure`. Its arguments are, in this order: the samples, which are
//! a `&`[`SampleTable`](crate::SampleTable) or [`Samples::points`]; the dimensions or the objective; what is
//! integrated or matched; settings. What cannot be measured is refused with a [`MeasureError`].
//!
//! | question | answer |
//! |---|---|
//! | how large is the error that the eye sees? | [`FilteredError`] |
//! | what is the objective worth, with exact distances? | [`Bound`] |
//! | does the table as a whole, a frame, a pixel estimate integrals too high or too low? | [`Bias`] |
//! | are the samples spread evenly over the square? | [`Histogram`], [`Discrepancy`] |
//! | … and every single coordinate, up to its faces? | [`Marginal`] |
//! | what is the error of a prefix, of a class, of a point set? | [`SetError`] |
//! | do points follow a picture? | [`DensityMatch`] |
//! | how far is a point set from its target? | [`SlicedDistance`] |
//! | at which frequencies is the error? | [`Spectra`] |
//! | does the error prefer a direction of the picture? | [`Spectra::anisotropy`] |
//! | what is the error of each pixel, for one integrand? | [`ErrorImage`] |
//!
//! All but the bound measure one *dimension group* `dims`: the list of dimensions that a renderer uses
//! together, such as `[0, 1]` for a point on a light, in the order in which the integrand's coordinates are
//! taken from them.
//!
//! ```
//! use fsot::metrics::{Bias, Integrands, Samples};
//! use fsot::{Extent, SampleTable};
//!
//! let integrands = Integrands::random(2, 16, 0)?;
//! let table = SampleTable::white_noise(Extent { frames: 1, height: 8, width: 8, spp: 4 }, 3, 0)?;
//! let of_table = Bias::measure(&table, &[2, 0], &integrands)?;
//! let of_points = Bias::measure(Samples::points(table.values(), 3)?, &[2, 0], &integrands)?;
//! assert!((of_table.table.mean.mean / of_points.table.mean.mean - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The integrands may be your own: see [`Integrands::with_family`].

mod bias;
mod block_deviation;
mod bound;
mod coordinates;
mod density_match;
mod discrepancy;
mod drawn;
mod error;
mod error_image;
mod errors;
mod filtered_error;
mod histogram;
mod integrand;
mod integrand_kind;
mod integrands;
mod marginal;
mod ratios;
mod samples;
mod set_error;
mod sliced_distance;
mod spectra;
mod volume;

pub use bias::Bias;
pub use block_deviation::BlockDeviation;
pub use bound::Bound;
pub use density_match::DensityMatch;
pub use discrepancy::Discrepancy;
pub use error::MeasureError;
pub use error_image::ErrorImage;
pub use filtered_error::FilteredError;
pub use histogram::Histogram;
pub use integrand::Integrand;
pub use integrands::{Family, Integrands};
pub use marginal::{FaceDensity, Marginal};
pub use ratios::{Estimate, FamilyRatio, Ratios};
pub use samples::{Samples, Values};
pub use set_error::SetError;
pub use sliced_distance::SlicedDistance;
pub use spectra::{AnisotropyRing, RadialBin, Spectra};
