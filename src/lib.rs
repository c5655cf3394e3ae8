//! Tables of random numbers whose Monte Carlo error is blue noise in space and time, by filtered sliced
//! optimal transport.
//!
//! A renderer that takes its random numbers from such a table makes the errors of neighbouring pixels and
//! frames cancel under the low-pass filter that follows: the eye, a denoiser, temporal antialiasing. The
//! method is that of Salaün et al. 2022[^salaun] and its spatio-temporal extension by Korać et al.
//! 2023[^korac], written from the mathematics.
//!
//! ```
//! use fsot::{Config, Extent, Kernel, Site, Until};
//!
//! let table = Config::new(Extent::still(64, 64), 2)
//!     .with_kernel(Kernel::gaussian(2.1))
//!     .with_seed(7)
//!     .optimize(Until::Sweeps(20))?;
//! let random_numbers = table.sample(Site { frame: 0, y: 5, x: 7 }, 0);
//! assert!(random_numbers.iter().all(|number| (0.0..1.0).contains(number)));
//! # Ok::<(), fsot::ConfigError>(())
//! ```
//!
//! `table.save("table.npy")` writes it for everybody else. You can stop here.
//!
//! # Three types
//!
//! * [`Config`] is plain data: everything that determines a table but for the length of the run. Its `with_…`
//!   methods change one thing at a time; [`config`], [`kernel`], [`classes`] and [`targets`] hold what it is
//!   made of.
//! * [`Optimizer`] is a table on its way: [`run`](Optimizer::run) or, with a closure that watches,
//!   [`run_observed`](Optimizer::run_observed); single steps; the [metadata](Optimizer::metadata) of what
//!   came of it.
//! * [`SampleTable`] is what renderers read: samples by [`Site`], views, files.
//!
//! [`metrics`] says what a table or a list of points is worth; [`Objective`] hands value and gradient to
//! optimisers of your own; [`method`] has the mathematics.
//!
//! # Which run
//!
//! | [`Until`] | for |
//! |---|---|
//! | [`Usual`](Until::Usual) | a good table, the same on every machine |
//! | [`Seconds`](Until::Seconds) | the best table in a given time; [`RunReport::work`] makes it again |
//! | [`Sweeps`](Until::Sweeps) | tables on intervals: soonest at any error; 20 to 100 make a good one |
//! | [`SlicesPerClass`](Until::SlicesPerClass) | point sets, toruses, and whatever has no closed form |
//! | [`Epochs`](Until::Epochs) | the same, by visits of every pixel |
//! | [`Work`](Until::Work) | slices, then sweeps: the lowest bound |
//! | [`Converged`](Until::Converged) | slices, until they bring little more |
//!
//! # Point sets
//!
//! Pixels are one family of classes among others, and the cube one target. [`Config::classes`] makes sets
//! whose labelled parts and their unions are all uniform, [`Config::progressive`] sequences whose prefixes
//! are,
//! [`Config::stippling`] points as dense as a picture; [`Classes`] and [`Target`] hold the rest, and
//! [`ClassFamily`] and [`Measure`] whatever is yours.
//!
//! # Features
//!
//! * `image` (default): densities from PNG and EXR files, and tables to and from them. Without it
//!   `targets::Picture` is absent, the formats `Atlas`, `Slices`, `Exr` and `ExrLayers` of [`files::Format`],
//!   and the crates `png`, `exr` and `moxcms`.
//!
//! # What it promises
//!
//! * The same seed gives the same bits at any thread count, on the AVX-512, AVX2 and baseline paths alike.
//!   Across platforms sines, cosines and powers of the standard library may round differently in the last
//!   bit, and a run amplifies that; tables then differ, their quality doesn't.
//! * A run that is resumed from a [`Checkpoint`](optimizer::Checkpoint), wherever it was killed, ends with
//!   the same bits as one that was left alone.
//! * Values lie in `[0, 1)`; 1.0 never appears.
//! * Steps allocate nothing once their buffers have grown; memory stays below eleven times the table (twelve
//!   with SGD, thirteen with Adam; nine in sweeps), plus a few MiB per thread. Slices keep 4 bytes per pixel
//!   and descended term besides, and 64 bytes per pixel where a table has one dimension. Sweeps work on a
//!   copy that has margins as wide as filters reach, which counts in small tiles: 1.2 times a table of
//!   512×512 pixels, 3 times one of 64×64, 9 times one of 24×24, 30 times one of 4×4. Where a demand is
//!   scattered, sweeps list its pairs, in up to sixteen times the table. A target other than the cube is
//!   tabulated once, in up to 17 MiB, or 50 where thousands of a picture's pixels stand out by a part of a
//!   point. Planning a picture takes less than the picture itself, and some 50 MiB.
//! * Bad input is refused with a typed error ([`ConfigError`], [`TableError`], [`MeasureError`]) before
//!   anything is computed or written. The library prints nothing.
//!
//! # Limits
//!
//! It is no renderer, no denoiser, no GPU library, and no source of random numbers for anything that needs
//! statistical independence between pixels. A finished run of sweeps is even in every coordinate
//! up to the faces of the cube; one of slices alone, as on a torus or for targets of one's own, holds some
//! tenths fewer samples within a hundredth of a face, and may hold 0 itself.
//!
//! [`ClassFamily`]: classes::ClassFamily
//! [`Classes`]: classes::Classes
//! [`MeasureError`]: metrics::MeasureError
//! [`Measure`]: targets::Measure
//! [`TableError`]: files::TableError
//! [`Target`]: targets::Target
//!
//! [^salaun]: Salaün, Georgiev, Seidel, Singh 2022, "Scalable multi-class sampling via filtered sliced
//!     optimal transport", ACM TOG 41(6), <https://doi.org/10.1145/3550454.3555484>.
//! [^korac]: Korać, Salaün, Georgiev, Grittmann, Slusallek, Myszkowski, Singh 2023, "Perceptual error
//!     optimization for Monte Carlo animation rendering", SIGGRAPH Asia,
//!     <https://doi.org/10.1145/3610548.3618146>.

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
mod simd;
mod slices;
mod sweeps;
mod table;
pub mod targets;
mod transport;

#[doc(inline)]
pub use config::{Config, Until};
pub use error::ConfigError;
#[doc(inline)]
pub use kernel::Kernel;
#[doc(inline)]
pub use objective::Objective;
#[doc(inline)]
pub use optimizer::{Optimizer, RunReport};
pub use table::SampleTable;
pub use table::extent::{Extent, Site};

/// The README's Rust compiles as it is pasted.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
