//! What a table is worth, measured: filtered error, bias, uniformity and spectra.
//!
//! Every figure that can be one is a *ratio to white noise*: 1 means as good as independent random numbers in a
//! table of the same shape, 0 means no error. The denominator is the analytic expectation, never a draw, so a
//! ratio has no noise but that of the test integrands, which [`Estimate`] states.
//!
//! | question | answer |
//! |---|---|
//! | how large is the error that the eye sees? | [`FilteredError`] |
//! | what is the objective worth, with exact distances? | [`bound()`] |
//! | does the table as a whole, a frame, a pixel estimate integrals too high or too low? | [`Bias`] |
//! | are the samples spread evenly over the square? | [`Histogram`], [`l2_star_discrepancy`] |
//! | what is the error of a prefix, of a class, of a point set? | [`set_error`] |
//! | do points follow a picture? | [`density_match`] |
//! | how far is a point set from its target? | [`sliced_w2`] |
//! | at which frequencies is the error? | [`Spectra`] |
//!
//! All but the histogram of a table measure one *dimension group* `dims`: the list of table dimensions that a
//! renderer uses together, such as `[0, 1]` for a point on a light, in the order in which the integrand's
//! coordinates are taken from them.

mod bias;
mod bound;
mod density_match;
mod discrepancy;
mod error_image;
mod fft;
mod filtered_error;
mod histogram;
mod integrand;
mod integrands;
mod ratios;
mod set_error;
mod sliced_distance;
mod spectra;
mod volume;

pub use bias::Bias;
pub use bound::{Bound, bound};
pub use density_match::{DensityMatch, density_match};
pub use discrepancy::l2_star_discrepancy;
pub use error_image::error_image;
pub use filtered_error::{FilteredError, filtered_error};
pub use histogram::Histogram;
pub use integrand::Integrand;
pub use integrands::{Family, Integrands};
pub use ratios::{Estimate, Ratios};
pub use set_error::set_error;
pub use sliced_distance::sliced_w2;
pub use spectra::{RadialBin, Spectra};
