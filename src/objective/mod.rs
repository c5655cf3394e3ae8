//! What is optimised: weighted terms, and the value and gradient of their slices.
//!
//! [`Objective`] is for optimisers of your own; [`Optimizer`](crate::Optimizer) plans its own.

pub(crate) mod plan;
mod slice;
mod start;

use std::ops::ControlFlow;

use self::plan::{PlannedTerm, classes, share_work};
pub use self::slice::{Slice, ValueAndGradient};
use crate::classes::{Classes, Demand, FilterFamily, Wanted};
use crate::config::{Config, Role, Term};
use crate::directions::banks::Banks;
use crate::directions::target_bank::BankError;
use crate::error::{ConfigError, GroupError, TermError};
pub use crate::error::{ObjectiveError, SliceError};
use crate::kernel::Tap;
use crate::table::SampleTable;
use crate::table::domain::Domain;
use crate::table::extent::Extent;
use crate::targets::Target;
use crate::targets::watch::Watch;

/// An objective planned for one extent.
///
/// Its value is the mean over slices of `(n / N) · W2²(X_S · theta, mu · theta)`: the level-set objective of
/// Salaün et al. 2022 with the squared 2-Wasserstein distance as the one-dimensional cost, whose gradient
/// exists.
///
/// ```
/// use fsot::{Config, Extent, Objective};
///
/// let objective = Objective::new(&Config::new(Extent::still(8, 8), 2))?;
/// let points = vec![0.5; 128];
/// let found = objective.cramer(&points)?;
/// assert!(found.value > 0.0 && found.gradient.iter().all(|slope| slope.is_finite()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Objective {
    pub(crate) extent: Extent,
    pub(crate) dims: usize,
    pub(crate) domains: Vec<Domain>,
    pub(crate) terms: Vec<PlannedTerm>,
    /// Slices that a step draws of those that it would draw for the whole table, as far as dimensions go.
    share: f64,
    pub(crate) wanted: Wanted,
}

/// What a step of slices does of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// Slices per visited pixel and frame, in the mean; per class where none of the terms has classes per
    /// pixel.
    pub per_class: f64,
    /// Steps until one of these has surely been drawn.
    pub steps: f64,
    /// Their share of all slices, or of all samples that slices hold, whichever is less.
    pub share: f64,
}

impl Pace {
    /// Steps that draw so many slices per class.
    pub(crate) fn steps_of(&self, slices_per_class: u64) -> u64 {
        match slices_per_class {
            0 => 0,
            slices => (slices as f64 / self.per_class).ceil().max(self.steps) as u64,
        }
    }
}

impl Objective {
    /// Checks and plans the terms of a configuration.
    ///
    /// # Errors
    /// An empty or oversized extent, a wrong number of domains, slicing parameters outside their ranges, no
    /// terms, and what is wrong with one of them: a weight that is not positive and finite, a dimension group
    /// that is empty, repeats or exceeds the table's dimensions, a kernel without a positive weight.
    ///
    /// ```
    /// use fsot::config::Role;
    /// use fsot::{Config, Extent, Objective};
    ///
    /// let objective = Objective::new(&Config::new(Extent::still(16, 16), 2))?;
    /// let points: Vec<f64> = (0..512).map(|i| f64::from(i) / 512.0).collect();
    /// let slices = objective.draw(7, 0, Role::Descend);
    /// let found = objective.value_and_gradient(&points, &slices)?;
    /// assert!(found.value > 0.0 && found.gradient.len() == points.len());
    /// # Ok::<(), fsot::objective::ObjectiveError>(())
    /// ```
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        Self::new_observed(config, |_| ControlFlow::Continue(()))
    }

    /// The same, for whoever waits: the laws of large pictures and of targets of one's own take their time.
    ///
    /// `observe` is called from time to time with the share that is planned, from 0 to 1, and may break off.
    ///
    /// # Errors
    /// As [`Objective::new`]; [`ConfigError::Stopped`] if `observe` breaks off.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use fsot::targets::Density;
    /// use fsot::{Config, ConfigError, Objective};
    ///
    /// let config = Config::stippling(100, Density::new(8, 8, vec![1.0; 64])?);
    /// let stopped = Objective::new_observed(&config, |share| {
    ///     println!("{:.0} %", 100.0 * share);
    ///     ControlFlow::Break(())
    /// });
    /// assert_eq!(stopped.unwrap_err(), ConfigError::Stopped);
    /// # Ok::<(), fsot::targets::TargetError>(())
    /// ```
    pub fn new_observed(
        config: &Config,
        mut observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ConfigError> {
        let terms = config.terms.iter().cloned().enumerate().collect();
        Self::planned(config, terms, Wanted::All, &mut observe)
    }

    /// The same for the part of a table that a renderer will really consume.
    ///
    /// A demand of other width, height or frames is folded onto the table first, which tiles it. Samples of
    /// other sites and dimensions outside the demanded groups belong to no class any more: a subset holds its
    /// demanded samples alone, whose errors are the only ones that a filter sees; terms lose the dimensions
    /// that are not demanded, and classes without a demanded sample are never drawn. Those that are left are
    /// drawn as often as in a run for the whole table; where one dimension is left of a group, a draw has one
    /// slice, since all its directions are the same. What is left out costs nothing; visiting the classes of
    /// samples that lie here and there costs somewhat more than their share.
    ///
    /// # Errors
    /// As [`Objective::new`]; a demand for dimensions that the table does not have; a demand for nothing.
    pub fn for_demand(config: &Config, demand: &Demand) -> Result<Self, ConfigError> {
        Self::for_demand_observed(config, demand, |_| ControlFlow::Continue(()))
    }

    /// The same, for whoever waits: see [`Objective::new_observed`].
    ///
    /// # Errors
    /// As [`Objective::for_demand`]; [`ConfigError::Stopped`] if `observe` breaks off.
    pub fn for_demand_observed(
        config: &Config,
        demand: &Demand,
        mut observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ConfigError> {
        let Config { extent, dims, .. } = *config;
        extent.validate(dims)?;
        for (group, dimensions) in demand.groups().iter().enumerate() {
            GroupError::check(dimensions, dims)
                .map_err(|problem| ConfigError::DemandGroup { group, problem })?;
        }
        let folded = demand.folded(&extent)?;
        let is_demanded = |dim: &usize| demand.groups().iter().flatten().any(|demanded| demanded == dim);
        let mut terms = Vec::new();
        for (index, mut term) in config.terms.iter().cloned().enumerate() {
            // A group that is none stays, so that it is refused.
            if GroupError::check(&term.dims, dims).is_ok() {
                term.dims.retain(is_demanded);
                if term.dims.is_empty() {
                    continue;
                }
            }
            terms.push((index, term));
        }
        if terms.is_empty() || folded.count() == 0 {
            return Err(ConfigError::NoDemand);
        }
        Self::planned(config, terms, Wanted::new(folded.pixels()), &mut observe)
    }

    /// Plans terms, given with their positions in the configuration, which may have others.
    fn planned(
        config: &Config,
        terms: Vec<(usize, Term)>,
        wanted: Wanted,
        observe: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ConfigError> {
        let Config { extent, dims, ref domains, ref slicing, .. } = *config;
        extent.validate(dims)?;
        if domains.len() != dims {
            return Err(ConfigError::DomainCount { given: domains.len(), dims });
        }
        if terms.is_empty() {
            return Err(ConfigError::NoTerms);
        }
        slicing.validate()?;
        // Where a demand leaves terms out, or all but one dimension of them, a step has as many visits fewer.
        let slices = |term: &Term| term.weight * slicing.per_subset(term.dims.len()) as f64;
        let descended = |term: &&Term| term.role == Role::Descend;
        let [given, all] = [
            terms.iter().map(|(_, term)| term).filter(descended).map(slices).sum::<f64>(),
            config.terms.iter().filter(descended).map(slices).sum(),
        ];
        let share = if given < all { given / all } else { 1.0 };
        let mut checked: Vec<(usize, Term, FilterFamily)> = Vec::new();
        for (index, term) in terms {
            // Terms of several groups share what they say of the lattice.
            let same = |(_, other, _): &&(usize, Term, FilterFamily)| other.classes == term.classes;
            let shared = checked.iter().rfind(same).map(|(_, _, family)| family.clone());
            let family = PlannedTerm::family(&term, extent, domains, wanted.clone(), shared);
            checked.extend(family.map_err(|problem| problem.of(index))?.map(|family| (index, term, family)));
        }
        if checked.is_empty() {
            return Err(ConfigError::NoDemand);
        }
        let largest = |family: &FilterFamily| family.sizes().last().copied().unwrap_or(1);
        let targets: Vec<_> = checked
            .iter()
            .map(|(_, term, family)| (term.dims.len(), &term.target, largest(family)))
            .collect();
        let mut banks = Banks::default();
        banks.plan(&targets, &mut Watch::new(observe)).map_err(|(at, problem)| match problem {
            BankError::Target(problem) => TermError::from(problem).of(checked[at].0),
            BankError::Stopped => ConfigError::Stopped,
        })?;
        let plan = |(_, term, family)| PlannedTerm::new(term, family, slicing, &mut banks);
        let mut planned: Vec<PlannedTerm> = checked.into_iter().map(plan).collect();
        share_work(&mut planned, extent, slicing, share)?;
        Ok(Self { extent, dims, domains: domains.clone(), terms: planned, share, wanted })
    }

    /// Frames, height, width and samples per pixel of the tables that this objective is planned for.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Dimensions of a sample.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The terms as they were given.
    pub fn terms(&self) -> impl Iterator<Item = &Term> {
        self.terms.iter().map(|term| &term.spec)
    }

    /// The folded taps of a term's kernel, by falling weight; `None` for families without one.
    pub fn taps(&self, term: usize) -> Option<&[Tap]> {
        self.terms.get(term)?.family.taps()
    }

    /// Whether this is for all of a configuration's samples and dimensions, and not for a part of them.
    pub(crate) fn is_whole(&self, config: &Config) -> bool {
        let given = config.terms.iter().map(|term| &term.dims);
        !self.wanted.is_partial() && given.eq(self.terms().map(|term| &term.dims))
    }

    /// The sites that are demanded, unless all are, and the dimensions of the terms, for a hash.
    pub(crate) fn demanded(&self) -> Vec<u8> {
        let sites = if self.wanted.is_partial() { self.extent.sites() } else { 0 };
        let mut bytes: Vec<u8> = (0..sites).map(|site| u8::from(self.wanted.site(site))).collect();
        for term in self.terms() {
            bytes.push(u8::MAX);
            // At most MOST_DIMS.
            bytes.extend(term.dims.iter().map(|&dim| dim as u8));
        }
        bytes
    }

    /// Whether a balance takes slices beside sweeps.
    pub(crate) fn has_balances_beside_sweeps(&self) -> bool {
        let mut balances = self.terms.iter().filter(|term| term.spec.role == Role::Balance);
        balances.any(|term| !self.is_balanced_in_sweeps(term))
    }

    /// Whether sweeps balance a term by themselves, without slices.
    pub(crate) fn is_balanced_in_sweeps(&self, term: &PlannedTerm) -> bool {
        term.spec.role == Role::Balance
            && matches!(term.spec.classes, Classes::WholeTable | Classes::PerFrame)
            && term.spec.target == Target::UniformCube
            && term.spec.dims.iter().all(|&dim| self.domains[dim] == Domain::Interval)
    }

    /// How steps are counted: by the descended terms that draw the same in every step; else by those of a
    /// lattice; else by all that descend, or by all.
    pub(crate) fn pace(&self) -> Pace {
        let descended = |term: &&PlannedTerm| term.spec.role == Role::Descend;
        let is_lattice = |term: &&PlannedTerm| matches!(term.spec.classes, Classes::Lattice { .. });
        let steady: Vec<_> = self.terms.iter().filter(|term| term.steady && descended(term)).collect();
        let lattice: Vec<_> = self.terms.iter().filter(is_lattice).collect();
        let any = self.terms.iter().any(|term| descended(&term));
        let visits = |terms: &[&PlannedTerm]| terms.iter().map(|term| term.family.visits()).sum();
        let (counted, classes): (Vec<&PlannedTerm>, f64) = if !steady.is_empty() {
            let visits: usize = visits(&steady);
            (steady, visits as f64)
        } else if !lattice.is_empty() {
            // As many steps as for a whole table, of whose dimensions these may be a part.
            (lattice, classes(&self.terms, self.extent) as f64 * self.share)
        } else {
            let counted: Vec<_> = self.terms.iter().filter(|term| !any || descended(term)).collect();
            let visits: usize = visits(&counted);
            (counted, visits as f64)
        };
        let sum = |of: fn(&PlannedTerm) -> f64| {
            let counted: f64 = counted.iter().map(|term| of(term)).sum();
            (counted, counted / self.terms.iter().map(of).sum::<f64>())
        };
        let (slices, of_slices) = sum(PlannedTerm::slices);
        let (_, of_touches) = sum(|term| term.slices() * term.family.mean_size());
        let rate = counted.iter().map(|term| term.rate).fold(0.0, f64::max);
        Pace { per_class: slices / classes, steps: (1.0 / rate).ceil(), share: of_slices.min(of_touches) }
    }

    /// Samples that the subsets of a step hold, in the mean.
    pub(crate) fn touches_per_step(&self) -> f64 {
        self.terms.iter().map(|term| term.slices() * term.family.mean_size()).sum()
    }

    /// Factor on what the slices of a class pull.
    #[inline(always)]
    pub(crate) fn emphasis(&self, term: usize, member: usize) -> f64 {
        let term = &self.terms[term];
        term.pull * term.family.emphasis(member)
    }

    /// Refuses a table of another shape, also one that holds as many values.
    pub(crate) fn check_table(&self, table: &SampleTable) -> Result<(), ConfigError> {
        let Extent { frames, height, width, spp } = self.extent;
        let [given, expected] = [table.shape(), [frames, height, width, spp, self.dims]].map(Box::new);
        if given == expected { Ok(()) } else { Err(ConfigError::OtherShape { given, expected }) }
    }
}
