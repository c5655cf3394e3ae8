//! Point sets: configurations for a few classes instead of a lattice of pixels.

use std::sync::Arc;

use crate::classes::{Classes, LabelSet, PrefixLengths, PrefixOf};
use crate::config::{Config, Descent, Role, Schedule, Term};
use crate::table::extent::{Extent, MOST_DIMS, MOST_VALUES};
#[cfg(feature = "image")]
use crate::targets::Inks;
use crate::targets::{Density, Target};

/// Which sets of labels are classes of their own.
///
/// ```
/// use fsot::config::LabelSubsets;
/// use fsot::{Config, Until};
///
/// // 32 points labelled 0 and 16 labelled 1; each label and both together are uniform.
/// let config = Config::classes(&[32, 16], 2, &LabelSubsets::EachAndAll);
/// let points = config.optimize(Until::SlicesPerClass(256))?;
/// assert_eq!(points.values().len(), 2 * 48);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LabelSubsets {
    /// Each label, and all of them together.
    EachAndAll,
    /// Every set of labels but the empty one: 3 classes for two labels, 7 for three, 15 for four. Beyond 12
    /// labels that would be thousands: there it is each label, and all of them together.
    Every,
    /// These.
    Given(Vec<Vec<u32>>),
}

impl LabelSubsets {
    /// The sets for labels from 0 to `labels - 1`, each once.
    fn list(&self, labels: usize) -> Vec<Vec<u32>> {
        let all = || (0..labels as u32).collect::<Vec<_>>();
        match self {
            LabelSubsets::Given(given) => given.clone(),
            LabelSubsets::EachAndAll if labels == 1 => vec![all()],
            _ if *self == LabelSubsets::EachAndAll || labels > MOST_LABELS => {
                all().into_iter().map(|label| vec![label]).chain([all()]).collect()
            }
            _ => {
                let held = |set: u64| all().into_iter().filter(move |label| set >> label & 1 == 1).collect();
                (1..1_u64 << labels).map(held).collect()
            }
        }
    }
}

/// Labels all of whose sets are classes.
const MOST_LABELS: usize = 12;

impl Config {
    /// The defaults for a set of `count` points: these terms, interval domains, barycentric steps from 1 to
    /// 0.02.
    ///
    /// Each step draws 16 directions for every class (for 16 of them, if a term has more), and terms are
    /// weighed by what they pull. 1,000 to 4,000 slices per class make a good set.
    pub fn point_set(count: usize, dims: usize, terms: Vec<Term>) -> Self {
        let descent = Descent::Barycentric { rate: Schedule::geometric(1.0, 0.02) };
        Self { terms, descent, ..Self::new(Extent::points(count), dims) }
    }

    /// A set of `counts.len()` classes: `counts[0]` points labelled 0, then `counts[1]` labelled 1, …; each
    /// of the `subsets` of labels is to be uniform by itself.
    ///
    /// Two labels of 512 points: `Config::classes(&[512, 512], 2, &LabelSubsets::EachAndAll)`.
    pub fn classes(counts: &[usize], dims: usize, subsets: &LabelSubsets) -> Self {
        let count = counts.iter().fold(0, |sum: usize, &count| sum.saturating_add(count));
        // More points than a table holds are refused when the configuration is used, and not listed here.
        let labels = if count <= MOST_VALUES { labels(counts) } else { [].into() };
        let size = |set: &Vec<u32>| -> f64 {
            let count = |label: &u32| counts.get(*label as usize).copied().unwrap_or(0) as f64;
            set.iter().map(count).sum()
        };
        let sets = subsets.list(counts.len());
        let weighed = sets.into_iter().map(|set| LabelSet { weight: weight_of(size(&set)), labels: set });
        let classes = Classes::Labelled { labels: labels.clone(), subsets: weighed.collect() };
        Self::point_set(count, dims, vec![whole(classes, Target::UniformCube, dims)])
    }

    /// Stippling: as many points as are denser where the picture is, or importance sampling of a map. Bright
    /// pixels get their share of the points, see [`Density`].
    pub fn stippling(count: usize, picture: impl Into<Arc<Density>>) -> Self {
        Self::point_set(count, 2, vec![whole(Classes::WholeTable, Target::Density(picture.into()), 2)])
    }

    /// Stippling in colour: points labelled 0 to 3 for cyan, magenta, yellow and black, as many of each as
    /// its share of the ink, in this order. Each ink, and each of the up to 15 sets of inks, is to look like
    /// its part of the picture.
    ///
    /// [`Inks::counts`] says how many points each ink has.
    #[cfg(feature = "image")]
    pub fn color_stippling(count: usize, picture: &Inks) -> Self {
        // More points than a table holds are refused when the configuration is used, and not listed here.
        let counts = picture.counts(count.min(MOST_VALUES));
        let labels = if count <= MOST_VALUES { labels(&counts) } else { [].into() };
        let mut terms = Vec::new();
        for set in LabelSubsets::Every.list(counts.len()) {
            let size: usize = set.iter().map(|&ink| counts[ink as usize]).sum();
            // A set that holds an ink without points is the same as the set without it.
            if set.iter().any(|&ink| counts[ink as usize] == 0) {
                continue;
            }
            let Some(densities) = picture.together(&set) else { continue };
            let classes = Classes::labelled(labels.clone(), [set]);
            // Terms share touches by weight, classes of different sizes unequally.
            let weight = size as f64 * weight_of(size as f64);
            terms.push(Term { weight, ..whole(classes, Target::Densities(densities), 2) });
        }
        Self::point_set(count, 2, terms)
    }

    /// A progressive sequence: the first 1, 2, 4, … points are uniform, and so are as many as `lengths` says.
    ///
    /// In two and more dimensions each coordinate alone is uniform as well, with a smaller weight.
    pub fn progressive(count: usize, dims: usize, lengths: PrefixLengths) -> Self {
        let classes = Classes::Prefixes { of: PrefixOf::Table, lengths };
        let mut terms = vec![whole(classes.clone(), Target::UniformCube, dims)];
        if dims > 1 {
            terms.extend((0..dims.min(MOST_DIMS)).map(|dim| Term {
                dims: vec![dim],
                weight: MARGINAL,
                ..whole(classes.clone(), Target::UniformCube, dims)
            }));
        }
        Self::point_set(count, dims, terms)
    }
}

/// Weight of a single coordinate in a progressive sequence.
const MARGINAL: f64 = 0.15;

/// `counts[0]` times 0, `counts[1]` times 1, and so on.
pub(crate) fn labels(counts: &[usize]) -> Arc<[u32]> {
    let runs = counts.iter().enumerate().map(|(label, &count)| std::iter::repeat_n(label as u32, count));
    runs.flatten().collect()
}

/// A class of this size is as far from its best as one of another size relative to what that is.
pub(crate) fn weight_of(size: f64) -> f64 {
    size.max(1.0).sqrt()
}

/// A term over all dimensions.
pub(crate) fn whole(classes: Classes, target: Target, dims: usize) -> Term {
    // More dimensions are refused when the configuration is used, and not listed here.
    let dims = (0..dims.min(MOST_DIMS)).collect();
    Term { classes, target, dims, weight: 1.0, role: Role::Descend }
}
