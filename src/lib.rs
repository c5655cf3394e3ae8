//! Filtered sliced optimal transport: tables of random numbers whose Monte Carlo error is blue noise in space and time.
//!
//! A renderer that takes its random numbers from such a table makes the errors of neighbouring pixels and frames cancel
//! under the low-pass filter that follows: the eye, a denoiser, temporal antialiasing. The method is that of Salaün et
//! al. 2022[^salaun] and its spatio-temporal extension by Korać et al. 2023[^korac], written from the mathematics.
//!
//! ```
//! use fsot::{Config, Extent, Optimizer, Site, Until, metrics};
//!
//! let extent = Extent { frames: 1, height: 32, width: 32, spp: 1 };
//! let mut optimizer = Optimizer::new(Config::new(extent, 2))?;
//! optimizer.run(Until::Seconds(0.05))?;
//! let bound = metrics::Bound::measure(&optimizer.table(), optimizer.objective(), 0, 4096)?;
//! assert!(bound.total.ratio_to_white_noise < 0.75);
//!
//! let table = optimizer.into_table();
//! let random_numbers = table.sample(Site { frame: 0, y: 5, x: 7 }, 0);
//! assert!(random_numbers.iter().all(|number| (0.0..1.0).contains(number)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `table.save("table.npy")` writes it for everybody else. You can stop here; the rest is what happens inside.
//!
//! # Point sets
//!
//! Pixels are one family of classes among others, and the cube one target. [`Config::classes`] makes sets whose labelled
//! parts and their unions are all uniform, [`Config::progressive`] sequences whose prefixes are, [`Config::stippling`] points as
//! dense as a picture; [`Classes`] and [`Target`] hold the rest, and [`ClassFamily`] and [`Measure`] whatever is yours.
//!
//! ```
//! use fsot::config::LabelSubsets;
//! use fsot::metrics::{Samples, SlicedDistance};
//! use fsot::targets::Target;
//! use fsot::{Config, Optimizer, Until};
//!
//! let mut optimizer = Optimizer::new(Config::classes(&[64, 64], 2, &LabelSubsets::EachAndAll))?;
//! optimizer.run(Until::SlicesPerClass(1000))?;
//! let table = optimizer.into_table();
//! let first_label = Samples::from(&table).select(..64)?;
//! let distance = SlicedDistance::measure(first_label, &[0, 1], &Target::UniformCube, 64)?;
//! assert!(distance.w2 < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
//! * Bad input is refused with a typed error ([`ConfigError`], [`TableError`], [`MeasureError`]) before anything is
//!   computed or written. The library prints nothing.
//!
//! What it is not: a renderer, a denoiser, a GPU library, or a source of random numbers for anything that needs
//! statistical independence between pixels.
//!
//! [`ClassFamily`]: classes::ClassFamily
//! [`Classes`]: classes::Classes
//! [`MeasureError`]: metrics::MeasureError
//! [`Measure`]: targets::Measure
//! [`TableError`]: files::TableError
//! [`Target`]: targets::Target
//!
//! [^salaun]: Salaün, Georgiev, Seidel, Singh 2022, "Scalable multi-class sampling via filtered sliced optimal transport",
//!     ACM TOG 41(6), <https://doi.org/10.1145/3550454.3555484>.
//! [^korac]: Korać, Salaün, Georgiev, Grittmann, Slusallek, Myszkowski, Singh 2023, "Perceptual error optimization for Monte
//!     Carlo animation rendering", SIGGRAPH Asia, <https://doi.org/10.1145/3610548.3618146>.

pub mod classes;
pub mod config;
mod directions;
mod error;
pub mod files;
pub mod kernel;
mod laws;
pub mod method;
pub mod metrics;
mod named;
pub mod objective;
pub mod optimizer;
pub mod random;
#[doc(hidden)]
pub mod simd;
mod slices;
mod sweeps;
mod table;
pub mod targets;
mod transport;

pub use config::{Config, Until};
pub use error::ConfigError;
pub use kernel::Kernel;
pub use objective::Objective;
pub use optimizer::{Optimizer, RunReport};
pub use table::SampleTable;
pub use table::extent::{Extent, Site};
