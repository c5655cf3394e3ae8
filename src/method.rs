//! The mathematics: what is minimised, in which symbols, and where it deviates from the papers: Salaün et al.
//! 2022[^salaun] for the objective, Korać et al. 2023[^korac] for filters in time.
//!
//! # What it minimises
//!
//! Each pixel's *filter* (or class) `w_p` gives the samples around it weights. A level `z` turns the weights
//! into a plain subset of samples; a direction `theta` turns the subset into numbers; their distance to the
//! projected target is a problem of sorting. The mean over pixels, levels and directions,
//!
//! ```text
//! L(X) = E_p ∫₀^{w_max} (|S_z(p)| / N) · E_theta W(X_{S_z(p)}·theta, mu·theta) dz,
//! ```
//!
//! bounds the filtered error of every Lipschitz integrand from above. [`Optimizer`] descends it with a batch
//! of random slices `(p, z, theta)` per step; [`metrics::Bound`] measures it with exact distances;
//! [`Objective::value_and_gradient`] hands it to an optimiser of your own.
//!
//! # All slices at once
//!
//! With Cramér's distance in place of Wasserstein's, and weights in place of levels, the mean over *all*
//! directions has a closed form, the energy distance: see [`Objective::cramer`]. It is the squared filtered
//! error of random half-spaces, and its exact gradient needs no sorting and no random numbers. A *sweep*
//! ([`Optimizer::sweep`]) moves every sample along it once. Sweeps are the sooner at any filtered error;
//! slices reach the lower bound, and hold where there is no closed form (on a torus). [`Until::Usual`] and
//! [`Until::Seconds`] choose sweeps, after those of a single frame in an animation, and slices where sweeps
//! are impossible.
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
//! # Where it deviates from the papers
//!
//! * A sample moves towards the exact *mean of its quantile cell*, not towards a random point of the target:
//!   the gradient has no noise but that of the slices.
//! * Tables are *unbiased* by default. The published objective pulls samples to the middle of the square,
//!   since a filter often holds a single one; a balance of the whole table, of whole frames and of single
//!   coordinates after each step or sweep ([`Role::Balance`]) removes this.
//! * Smaller filters accompany a kernel with small weights ([`Term::companions`]), since a scene changes
//!   within a filter, and is seen without it.
//! * Levels reach the true maximum of the filter, also where a temporal kernel peaks in the past.
//! * Domains end like intervals by default, since integrands do; [`Domain::Torus`] per dimension on request.
//!
//! [`Classes`]: crate::classes::Classes
//! [`Domain::Torus`]: crate::config::Domain::Torus
//! [`Kernel`]: crate::Kernel
//! [`Objective::cramer`]: crate::Objective::cramer
//! [`Objective::value_and_gradient`]: crate::Objective::value_and_gradient
//! [`Optimizer::sweep`]: crate::Optimizer::sweep
//! [`Optimizer`]: crate::Optimizer
//! [`Projected`]: crate::targets::Projected
//! [`Role::Balance`]: crate::config::Role::Balance
//! [`SampleTable`]: crate::SampleTable
//! [`Site`]: crate::Site
//! [`Slice::direction`]: crate::objective::Slice::direction
//! [`Slice::level`]: crate::objective::Slice::level
//! [`Target`]: crate::targets::Target
//! [`Term::companions`]: crate::config::Term::companions
//! [`Term`]: crate::config::Term
//! [`Until::Usual`]: crate::Until::Usual
//! [`Until::Seconds`]: crate::Until::Seconds
//! [`metrics::Bound`]: crate::metrics::Bound
//!
//! [^salaun]: Salaün, Georgiev, Seidel, Singh 2022, "Scalable multi-class sampling via filtered sliced
//!     optimal transport", ACM TOG 41(6), <https://doi.org/10.1145/3550454.3555484>.
//! [^korac]: Korać, Salaün, Georgiev, Grittmann, Slusallek, Myszkowski, Singh 2023, "Perceptual error
//!     optimization for Monte Carlo animation rendering", SIGGRAPH Asia,
//!     <https://doi.org/10.1145/3610548.3618146>.
