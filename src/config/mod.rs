//! What a caller sets: plain data.
//!
//! [`Config`] holds all of it. Its defaults make a good table; `with_…` changes one thing at a time:
//!
//! ```
//! use fsot::config::{DimensionGroup, Domain};
//! use fsot::kernel::TemporalKernel;
//! use fsot::{Config, Extent, Kernel};
//!
//! let config = Config::new(Extent::animation(8, 32, 32), 4)
//!     .with_kernel(Kernel::gaussian(1.5).with_temporal(TemporalKernel::Ema { alpha: 0.1 }))
//!     .with_groups(&[DimensionGroup::new([0, 1]), DimensionGroup::new([2, 3])])
//!     .with_domain(Domain::Torus)
//!     .with_seed(7);
//! assert_eq!(config.kernels().len(), 1);
//! ```

mod descent;
mod point_sets;
mod sweeps;
mod term;
mod until;

use serde::{Deserialize, Serialize};

pub(crate) use self::descent::check_step;
pub use self::descent::{Descent, Schedule};
pub use self::point_sets::LabelSubsets;
pub use self::sweeps::Sweeps;
pub use self::term::{DimensionGroup, Role, Slicing, Term};
pub use self::until::{EndReason, Until, Work};
use crate::classes::{Classes, FilterForm};
pub use crate::error::{ExtentError, GroupError, RangeError, Short, TermError};
use crate::kernel::{Kernel, TemporalKernel};
pub use crate::table::domain::{BELOW_ONE, Domain};
use crate::table::extent::Extent;
pub use crate::table::extent::MOST_DIMS;

/// Everything that determines a table, but for the length of the run.
///
/// It is written and read by serde, to the last bit; what is not known is refused, since a configuration of
/// which a part is passed over makes another table.
///
/// ```
/// use fsot::{Config, Extent, Kernel, Until};
///
/// let config = Config::new(Extent::still(32, 32), 2).with_kernel(Kernel::gaussian(2.1)).with_seed(7);
/// let table = config.optimize(Until::Sweeps(4))?;
/// assert_eq!(table.shape(), [1, 32, 32, 1, 2]);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Config {
    /// Frames, height, width and samples per pixel.
    pub extent: Extent,
    /// Dimensions of a sample.
    pub dims: usize,
    /// Interval or torus, per dimension.
    pub domains: Vec<Domain>,
    /// What is optimised. [`Config::with_kernels`] and [`Config::with_groups`] write the usual ones.
    pub terms: Vec<Term>,
    /// Whether those include the smaller filters of [`Term::companions`].
    #[serde(default)]
    pub companions: bool,
    /// How slices are drawn.
    #[serde(default)]
    pub slicing: Slicing,
    /// How steps of slices move the samples.
    #[serde(default)]
    pub descent: Descent,
    /// How sweeps move them.
    #[serde(default)]
    pub sweeps: Sweeps,
    /// How far the terms in the role of [`Role::Balance`] move the samples towards their targets, over a run.
    #[serde(default = "all_the_way")]
    pub balance: Schedule,
    /// Names every random number: the same seed gives the same bits.
    pub seed: u64,
}

impl Config {
    /// The defaults for a table of this extent: interval domains, the spatial Gaussian of the papers
    /// (`sigma_px = 2.1`), times the perceptual kernel at 60 frames per second if there are several frames,
    /// consecutive pairs of dimensions and all of them at half their weight, unbiased, barycentric steps of
    /// slices.
    pub fn new(extent: Extent, dims: usize) -> Self {
        let kernel = default_kernel(&extent);
        let groups = DimensionGroup::pairs_and_whole(dims);
        let config = Self {
            extent,
            dims,
            // More dimensions are refused when the configuration is used; a list of them might not fit the
            // memory.
            domains: vec![Domain::Interval; dims.min(MOST_DIMS)],
            terms: Vec::new(),
            companions: true,
            slicing: Slicing::default(),
            descent: Descent::default(),
            sweeps: Sweeps::default(),
            balance: all_the_way(),
            seed: 0,
        };
        config.with_usual_terms(&[kernel], FilterForm::LevelSets, &groups)
    }

    /// Writes the usual terms.
    fn with_usual_terms(mut self, kernels: &[Kernel], form: FilterForm, groups: &[DimensionGroup]) -> Self {
        self.terms = Term::blue_noise(kernels, form, groups, &self.extent);
        if self.companions {
            self.terms.extend(Term::companions(kernels, form, groups, &self.extent));
        }
        self
    }

    /// Filters with this kernel instead: see [`Config::with_kernels`].
    #[must_use]
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        self.with_kernels(&[kernel])
    }

    /// Writes the terms for blue noise under these kernels, which share the work equally. Dimension groups
    /// and the form of the filters stay as they are.
    ///
    /// Terms that were set otherwise are replaced.
    #[must_use]
    pub fn with_kernels(self, kernels: &[Kernel]) -> Self {
        let (form, groups) = (self.form(), self.groups());
        self.with_usual_terms(kernels, form, &groups)
    }

    /// Lets the kernels be accompanied by smaller filters ([`Term::companions`]; the default), or leaves them
    /// alone, as the papers have them.
    ///
    /// Terms that were set otherwise are replaced.
    #[must_use]
    pub fn with_companions(self, companions: bool) -> Self {
        let (kernels, form, groups) = (self.kernels(), self.form(), self.groups());
        Self { companions, ..self }.with_usual_terms(&kernels, form, &groups)
    }

    /// Writes the terms for blue noise in these dimension groups. Kernels and the form of the filters stay as
    /// they are.
    ///
    /// Terms that were set otherwise are replaced.
    #[must_use]
    pub fn with_groups(self, groups: &[DimensionGroup]) -> Self {
        let (kernels, form) = (self.kernels(), self.form());
        self.with_usual_terms(&kernels, form, groups)
    }

    /// Filters in this form; kernels and dimension groups stay as they are.
    ///
    /// Terms that were set otherwise are replaced.
    #[must_use]
    pub fn with_form(self, form: FilterForm) -> Self {
        let (kernels, groups) = (self.kernels(), self.groups());
        self.with_usual_terms(&kernels, form, &groups)
    }

    /// Optimises these terms, and no companions.
    #[must_use]
    pub fn with_terms(self, terms: Vec<Term>) -> Self {
        Self { terms, companions: false, ..self }
    }

    /// Ends every dimension in this way.
    #[must_use]
    pub fn with_domain(mut self, domain: Domain) -> Self {
        self.domains.fill(domain);
        self
    }

    /// Ends each dimension in its own way; one entry per dimension.
    #[must_use]
    pub fn with_domains(self, domains: Vec<Domain>) -> Self {
        Self { domains, ..self }
    }

    /// Draws slices like this.
    #[must_use]
    pub fn with_slicing(self, slicing: Slicing) -> Self {
        Self { slicing, ..self }
    }

    /// Moves the samples like this in steps of slices.
    #[must_use]
    pub fn with_descent(self, descent: Descent) -> Self {
        Self { descent, ..self }
    }

    /// Moves the samples like this in sweeps.
    #[must_use]
    pub fn with_sweeps(self, sweeps: Sweeps) -> Self {
        Self { sweeps, ..self }
    }

    /// Balances so far, over a run.
    #[must_use]
    pub fn with_balance(self, balance: Schedule) -> Self {
        Self { balance, ..self }
    }

    /// Names every random number by this seed.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// The kernels of the terms, each once and without companions; the default one if no term has a kernel.
    pub fn kernels(&self) -> Vec<Kernel> {
        let mut kernels = Vec::new();
        for (kernel, ..) in self.filters() {
            if !kernels.contains(kernel) {
                kernels.push(kernel.clone());
            }
        }
        if kernels.is_empty() {
            kernels.push(default_kernel(&self.extent));
        }
        kernels
    }

    /// The dimension groups of the terms that have a kernel, each once; the default ones if no term has any.
    pub fn groups(&self) -> Vec<DimensionGroup> {
        let mut groups: Vec<DimensionGroup> = Vec::new();
        for (.., term) in self.filters() {
            match groups.iter_mut().find(|group| group.dims == term.dims) {
                // What the kernels share is the group's.
                Some(group) => group.weight += term.weight,
                None => groups.push(DimensionGroup { dims: term.dims.clone(), weight: term.weight }),
            }
        }
        if groups.is_empty() { DimensionGroup::pairs_and_whole(self.dims) } else { groups }
    }

    fn form(&self) -> FilterForm {
        self.filters().next().map_or(FilterForm::default(), |(_, form, _)| form)
    }

    /// Kernels and forms of the terms that have them. Companions come after the balance of what they go with.
    fn filters(&self) -> impl Iterator<Item = (&Kernel, FilterForm, &Term)> {
        let balances = self.terms.iter().rposition(|term| term.role == Role::Balance);
        let own = balances.filter(|_| self.companions).unwrap_or(self.terms.len());
        self.terms[..own].iter().filter_map(|term| match &term.classes {
            Classes::Lattice { kernel, form } => Some((kernel, *form, term)),
            _ => None,
        })
    }
}

fn all_the_way() -> Schedule {
    Schedule::constant(1.0)
}

fn default_kernel(extent: &Extent) -> Kernel {
    let temporal = match extent.frames {
        0 | 1 => TemporalKernel::None,
        _ => TemporalKernel::Perceptual { fps: 60.0 },
    };
    Kernel::gaussian(2.1).with_temporal(temporal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_set_stays_whatever_the_order() {
        let config = || Config::new(Extent::animation(4, 8, 8), 4);
        let kernels = [Kernel::gaussian(1.0), Kernel::gaussian(3.0)];
        let groups = [DimensionGroup::new([0, 1, 3]), DimensionGroup::new([2]).with_weight(0.3)];
        let one = config().with_kernels(&kernels).with_groups(&groups).with_form(FilterForm::Weighted);
        let other = config().with_form(FilterForm::Weighted).with_groups(&groups).with_kernels(&kernels);
        assert_eq!(one, other);
        assert_eq!((one.kernels(), one.groups()), (kernels.to_vec(), groups.to_vec()));
        let mut terms = Term::blue_noise(&kernels, FilterForm::Weighted, &groups, &one.extent);
        assert_eq!(one.clone().with_companions(false).terms, terms);
        terms.extend(Term::companions(&kernels, FilterForm::Weighted, &groups, &one.extent));
        assert_eq!(one.terms, terms);
    }

    #[test]
    fn a_point_set_gets_the_defaults_when_it_is_given_a_kernel() {
        let points = Config::classes(&[4, 4], 2, &LabelSubsets::Every).with_kernel(Kernel::gaussian(1.0));
        assert_eq!(points.groups(), DimensionGroup::pairs_and_whole(2));
    }
}
