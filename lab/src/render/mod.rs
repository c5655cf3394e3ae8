//! A minimal renderer that tells whether a table makes pictures better.
//!
//! It sees samplers only, never how a table was made. A [`Scene`] is a plain value; [`render`] asks a
//! [`Sampler`](crate::samplers::Sampler) for the numbers and gives a [`Film`]; a [`Reference`] holds the
//! truth with its own error; [`compare`] gives the errors as ratios to white noise.
//!
//! One ray a pixel goes through the pixel's centre (a thin lens spreads it), so the only noise is the
//! integrand's; edges are aliased, on purpose. Luminance only, no textures, no acceleration structure.

mod bsdf;
mod camera;
mod denoise;
mod error;
mod film;
mod gallery;
mod guides;
mod image_metrics;
mod integrate;
#[cfg(test)]
mod known_answers;
mod light;
mod needs;
mod reference;
mod scales;
mod scene;
mod shape;

pub use bsdf::Material;
pub use camera::{Camera, Lens};
pub use denoise::Denoiser;
pub use error::RenderError;
pub use film::Film;
pub use guides::{Guide, Guides};
pub use image_metrics::{Comparison, Figure, ImageFilter, compare, relative_mean};
pub use integrate::{render, render_frame};
pub use light::Light;
pub use needs::demand;
pub use reference::Reference;
pub use scales::{Scales, error_spectrum};
pub use scene::{Integrator, Object, Scene};
pub use shape::{Ray, Rectangle, Shape};
