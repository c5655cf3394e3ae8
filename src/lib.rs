//! Filtered sliced optimal transport: tables of random numbers whose Monte Carlo error is blue noise in space and time.
//!
//! A renderer that takes its random numbers from such a table makes the errors of neighbouring pixels and frames cancel
//! under the low-pass filter that follows: the eye, a denoiser, temporal antialiasing. The method is that of Salaün et
//! al. 2022[^salaun] and its spatio-temporal extension by Korać et al. 2023[^korac], written from the mathematics.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use fsot::{Config, Extent, Optimizer, Site, Until, metrics};
//!
//! let extent = Extent { frames: 1, height: 32, width: 32, spp: 1 };
//! let mut optimizer = Optimizer::new(Config::new(extent, 2))?;
//! optimizer.run(Until::Seconds(0.05), |_progress| ControlFlow::Continue(()))?;
//! let bound = metrics::bound(optimizer.objective(), &optimizer.table(), 0, 4096)?;
//! assert!(bound.total.ratio_to_white_noise < 0.75);
//!
//! let table = optimizer.into_table();
//! let random_numbers = table.sample(Site { frame: 0, y: 5, x: 7 }, 0);
//! assert!(random_numbers.iter().all(|number| (0.0..1.0).contains(number)));
//! # Ok::<(), fsot::ConfigError>(())
//! ```
//!
//! `table.save("table.npy")` writes it for everybody else. You can stop here; the rest is what happens inside.
//!
//! # What it minimises
//!
//! Each pixel's *filter* (or class) `w_p` gives the samples around it weights. A level `z` turns the weights into a plain
//! subset of samples; a direction `theta` turns the subset into numbers; their distance to the projected target is a
//! problem of sorting. The mean over pixels, levels and directions,
//!
//! ```text
//! L(X) = E_p ∫₀^{w_max} (|S_z(p)| / N) · E_theta W(X_{S_z(p)}·theta, mu·theta) dz,
//! ```
//!
//! bounds the filtered error of every Lipschitz integrand from above. [`Optimizer`] descends it with a batch of random
//! slices `(p, z, theta)` per step; [`metrics::bound()`] measures it with exact distances;
//! [`Objective::value_and_gradient`] hands it to an optimiser of your own.
//!
//! # All slices at once
//!
//! With Cramér's distance in place of Wasserstein's, and weights in place of levels, the mean over *all* directions has a
//! closed form, the energy distance: see [`Objective::cramer`]. It is the squared filtered error of random half-spaces,
//! and its exact gradient needs no sorting and no random numbers. A *sweep* ([`Optimizer::sweep`]) moves every sample along
//! it once. Sweeps are the sooner at any filtered error; slices reach the lower bound, and hold where there is no closed
//! form (on a torus). [`Until::Seconds`] chooses: sweeps alone if time is short, slices and then sweeps if there is more,
//! slices alone where sweeps are impossible.
//!
//! | symbol | here | shape, unit |
//! |---|---|---|
//! | x | [`SampleTable`] | `[frame, y, x, sample, dim]`, `f32` in `[0, 1)`, C order |
//! | c | [`Site`] and sample | lattice position of a sample |
//! | w_p(c) | [`Kernel`], [`Classes`] | weight relative to the largest, in `[0, 1]` |
//! | z | [`Slice::level`] | `[0, 1)` |
//! | S_z(p) | subset | `{j : w_p(c_j) > z}` |
//! | theta | [`Slice::direction`] | unit vector over the dimensions of a [`Term`] |
//! | mu | [`Target`] | measure on `[0, 1]^D`; its law along theta is [`Projected`] |
//! | N, n | samples of the table, of a subset | |
//!
//! # Point sets
//!
//! Pixels are one family of classes among others, and the cube one target. [`Config::classes`] makes sets whose labelled
//! parts and their unions are all uniform, [`Config::progressive`] sequences whose prefixes are, [`Config::stippling`] points as
//! dense as a picture; [`Classes`] and [`Target`] hold the rest, and [`ClassFamily`] and [`Measure`] whatever is yours.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use fsot::{Config, Optimizer, Subsets, Target, Until, metrics};
//!
//! let mut optimizer = Optimizer::new(Config::classes(&[64, 64], 2, &Subsets::EachAndAll))?;
//! optimizer.run(Until::SlicesPerClass(1000), |_progress| ControlFlow::Continue(()))?;
//! let points: Vec<f64> = optimizer.into_table().values().iter().map(|&value| value.into()).collect();
//! let of_the_first_label = metrics::sliced_w2(&points[..2 * 64], 2, &Target::UniformCube, 64)?;
//! assert!(of_the_first_label < 0.02);
//! # Ok::<(), fsot::ConfigError>(())
//! ```
//!
//! # Where it deviates from the papers
//!
//! * A sample moves towards the exact *mean of its quantile cell*, not towards a random point of the target: the
//!   gradient has no noise but that of the slices.
//! * Tables are *unbiased* by default. The published objective pulls samples to the middle of the square, since a filter
//!   often holds a single one; a few slices of the whole table and of whole frames after each step
//!   ([`Role::Balance`]) remove this.
//! * Levels reach the true maximum of the filter, also where a temporal kernel peaks in the past.
//! * Domains end like intervals by default, since integrands do; [`Domain::Torus`] per dimension on request.
//!
//! # What it promises
//!
//! * The same seed gives the same bits at any thread count, on the AVX-512, AVX2 and baseline paths alike. Across
//!   platforms sines, cosines and powers of the standard library may round differently in the last bit, and a run
//!   amplifies that; tables then differ, their quality doesn't.
//! * Values lie in `[0, 1)`; 1.0 never appears.
//! * Steps allocate nothing once their buffers have grown; memory stays below nine times the table (ten with SGD, eleven
//!   with Adam), plus a few MiB per thread. (Sweeps of tiles narrower than 16 pixels take up to 16 times the table instead:
//!   their rows are filled up.) A target other than the cube is tabulated once, in up to 17 MiB.
//! * Bad input is refused with a typed error ([`ConfigError`], [`TableError`]) before anything is computed or written.
//!   The library prints nothing.
//!
//! What it is not: a renderer, a denoiser, a GPU library, or a source of random numbers for anything that needs
//! statistical independence between pixels.
//!
//! [^salaun]: Salaün, Georgiev, Seidel, Singh 2022, "Scalable multi-class sampling via filtered sliced optimal transport",
//!     ACM TOG 41(6), <https://doi.org/10.1145/3550454.3555484>.
//! [^korac]: Korać, Salaün, Georgiev, Grittmann, Slusallek, Myszkowski, Singh 2023, "Perceptual error optimization for Monte
//!     Carlo animation rendering", SIGGRAPH Asia, <https://doi.org/10.1145/3610548.3618146>.

mod classes;
mod config;
mod directions;
mod error;
mod files;
mod kernel;
mod laws;
pub mod metrics;
mod objective;
mod optimizer;
mod random;
#[cfg(feature = "render")]
pub mod render;
#[cfg(feature = "render")]
pub mod sampler;
mod simd;
mod slices;
mod sweeps;
mod table;
mod targets;
mod transport;

pub use classes::demand::Demand;
pub use classes::{
    ClassFamily, Classes, CustomClasses, Form, LabelSet, Lengths, Member, PrefixLength, PrefixOf, Ramp,
};
pub use config::point_sets::Subsets;
pub use config::term::{DimensionGroup, Role, Slicing, Term};
#[cfg(feature = "render")]
pub use error::PictureError;
pub use error::{ConfigError, FormatError, TableError};
pub use files::metadata::{BoundEstimate, BoundRecord, KernelTaps, Metadata, RunRecord};
pub use kernel::{Kernel, SpatialKernel, SpatialTap, Tap, TemporalKernel};
pub use laws::Projected;
pub use objective::{Objective, Slice};
pub use optimizer::report::{Ended, RunReport, StepReport, Until, Work};
pub use optimizer::{Config, Optimizer};
pub use slices::walk::{Descent, Schedule, Shape};
pub use sweeps::Sweeps;
pub use table::SampleTable;
pub use table::domain::{BELOW_ONE, Domain};
pub use table::extent::{Extent, Site};
pub use table::vectors::Mapping;
pub use targets::{CustomTarget, Density, Measure, PointCloud, Target};
#[cfg(feature = "render")]
pub use targets::{Inks, Tone};
