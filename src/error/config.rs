//! What is wrong with a configuration.

use thiserror::Error;

use super::{ExtentError, GroupError, KernelError, RangeError, Short, TargetError};

/// A configuration that cannot be optimised.
///
/// ```
/// use fsot::{Config, ConfigError, Extent, Objective};
///
/// let mut config = Config::new(Extent::still(16, 16), 2);
/// config.terms[0].weight = -1.0;
/// let error = Objective::new(&config).unwrap_err();
/// assert!(matches!(error, ConfigError::Term { term: 0, .. }));
/// assert_eq!(error.to_string(), "term 0: the weight of a term is -1: give a value from 1e-15 to 1e15");
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The extent or the number of dimensions is not admissible.
    #[error(transparent)]
    Extent(#[from] ExtentError),
    /// A number lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The list of domains does not fit the table.
    #[error("{given} domains for {dims} dimensions: give one domain per dimension")]
    DomainCount {
        /// Domains given.
        given: usize,
        /// Dimensions of the table.
        dims: usize,
    },
    /// Nothing to optimise.
    #[error("the objective has no term with a positive weight: give at least one")]
    NoTerms,
    /// A term cannot be planned.
    #[error("term {term}: {problem}")]
    Term {
        /// Position of the term, from 0.
        term: usize,
        /// What is wrong with it.
        problem: TermError,
    },
    /// Flags of a demand that are not one per site.
    #[error("{given} flags for a demand of {expected} sites: give frames * height * width flags")]
    DemandCount {
        /// Flags given.
        given: usize,
        /// Flags expected.
        expected: usize,
    },
    /// A demanded group that is none.
    #[error("group {group} of the demand: {problem}")]
    DemandGroup {
        /// Position of the group, from 0.
        group: usize,
        /// What is wrong with it.
        problem: GroupError,
    },
    /// A demand that no term of the objective serves.
    #[error("nothing is demanded: demand at least one pixel and a dimension that a term sees")]
    NoDemand,
    /// More slices in a step than anybody waits for.
    #[error("a step of {slices} slices would take too long: give a batch of at most {most}")]
    Batch {
        /// Slices asked for.
        slices: usize,
        /// Most slices of a step.
        most: usize,
    },
    /// A run would be counted by terms that do next to nothing of its work, and hardly ever end.
    #[error(
        "the terms by which slices are counted do {} of the work, less than 1e-3: \
         bring the weights of the terms nearer to each other",
        Short::from(share)
    )]
    Uneven {
        /// Their share of the slices, or of the samples that these hold.
        share: f64,
    },
    /// A time in which nothing can be done.
    #[error(
        "{} s are too short, since one sweep or step takes {} s at the least, and maybe many times as long: \
         ask for a number of sweeps or slices",
        Short::from(seconds),
        Short::from(least)
    )]
    TooShort {
        /// Seconds asked for.
        seconds: f64,
        /// Seconds that one step or sweep takes, rounded up to two digits.
        least: f64,
    },
    /// Sweeps were asked for, but a term has no closed form over all slices.
    #[error("term {term} cannot be swept, since {why}: use slices")]
    NotInClosedForm {
        /// Position of the term, from 0.
        term: usize,
        /// What stands against it.
        why: &'static str,
    },
    /// Whoever watched the planning broke off.
    #[error("planning was stopped: let it continue to its end")]
    Stopped,
    /// A table of another shape than the configuration's.
    #[error(
        "the table has shape {given:?} instead of {expected:?}: bring one of that [frame, y, x, sample, dim]"
    )]
    OtherShape {
        /// Shape of the table.
        given: Box<[usize; 5]>,
        /// Shape that is configured.
        expected: Box<[usize; 5]>,
    },
}

impl ConfigError {
    /// Whether slices can optimise what sweeps cannot: the configuration itself is good.
    pub fn is_about_sweeps_only(&self) -> bool {
        matches!(self, Self::NotInClosedForm { .. })
    }
}

/// A term that cannot be planned.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TermError {
    /// A number lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Its dimensions are no group.
    #[error(transparent)]
    Group(#[from] GroupError),
    /// Its kernel cannot filter.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// Its classes are none.
    #[error(transparent)]
    Classes(#[from] ClassError),
    /// Its target is none.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// The target cannot be projected on the dimensions of the term.
    #[error("the target has {target} dimensions, but the term sees {dims}: name as many dimensions")]
    TargetDims {
        /// Dimensions of the target.
        target: usize,
        /// Dimensions of the term.
        dims: usize,
    },
    /// A target that is not uniform in a dimension that wraps.
    #[error("it sees dimension {dimension}, a torus, but its target is not uniform: make it an interval")]
    TargetOnTorus {
        /// The dimension.
        dimension: usize,
    },
}

impl TermError {
    /// Says which term it is about.
    pub(crate) fn of(self, term: usize) -> ConfigError {
        ConfigError::Term { term, problem: self }
    }
}

/// A family of classes that cannot serve as one.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ClassError {
    /// A number lies outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// None of the classes holds a sample.
    #[error("no class of {family} holds a sample: give at least one that does")]
    Empty {
        /// Which family.
        family: &'static str,
    },
    /// A list does not have one entry per sample.
    #[error("{what} holds {given} entries, but the table has {expected} samples: give one per sample")]
    SampleCount {
        /// Which list.
        what: &'static str,
        /// Entries given.
        given: usize,
        /// Samples of the table.
        expected: usize,
    },
    /// A prefix that is empty or longer than what it is a part of.
    #[error("a prefix has length {length}: give a length from 1 to {most}")]
    PrefixLength {
        /// The length given.
        length: usize,
        /// Samples of the whole.
        most: usize,
    },
    /// A class of the caller's own cannot serve as one.
    #[error("class {member} of \"{name}\" gives sample {sample} weight {}: {problem}", Short::from(weight))]
    Custom {
        /// Name of the family.
        name: Box<str>,
        /// Number of the class.
        member: u32,
        /// The sample.
        sample: u32,
        /// Its weight.
        weight: f64,
        /// What to do.
        problem: &'static str,
    },
}
