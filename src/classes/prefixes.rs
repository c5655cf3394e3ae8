//! Prefixes: the first samples of a table or of each of its pixels.

use std::sync::Arc;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::demand::Wanted;
use super::family::Filters;
use crate::error::{ClassError, RangeError};
use crate::table::extent::{Extent, MOST_VALUES};

/// What is cut short by a prefix.
///
/// ```
/// use fsot::classes::{Classes, PrefixLengths, PrefixOf};
///
/// // For renderers that stop early: 1, 2, 4, … samples of each pixel.
/// let classes = Classes::Prefixes { of: PrefixOf::Pixel, lengths: PrefixLengths::PowersOfTwo };
/// # let _ = classes;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PrefixOf {
    /// The table, in its own order: a progressive sequence.
    Table,
    /// The samples of each pixel and frame, for renderers that stop early where they may.
    Pixel,
}

/// Lengths of the prefixes, in samples.
///
/// ```
/// use fsot::classes::PrefixLengths;
/// use fsot::{Config, Until};
///
/// let config = Config::progressive(64, 2, PrefixLengths::PowersOfTwo);
/// let sequence = config.optimize(Until::SlicesPerClass(256))?;
/// assert_eq!(sequence.values().len(), 2 * 64);
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PrefixLengths {
    /// All of them: 1, 2, 3, …. A step visits a random few.
    Every,
    /// 1, 2, 4, … and the whole.
    PowersOfTwo,
    /// These.
    Given(Vec<PrefixLength>),
}

/// A prefix among [`PrefixLengths::Given`].
///
/// ```
/// use fsot::classes::{PrefixLength, PrefixLengths};
///
/// let [some, all] = [24, 100].map(|length| PrefixLength { length, weight: 1.0 / length as f64 });
/// let lengths = PrefixLengths::Given(vec![some, all]);
/// # let _ = lengths;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrefixLength {
    /// Samples, from 1 to all.
    pub length: usize,
    /// Weight of the pull on its samples beside that of the other prefixes; from 1e-12 to 1e6.
    pub weight: f64,
}

/// Prefixes planned for an extent.
#[derive(Clone, Debug)]
pub(crate) struct Prefixes {
    /// Samples of a block, and number of blocks.
    block: usize,
    blocks: usize,
    spp: usize,
    lengths: Vec<PrefixLength>,
    wanted: Wanted,
    mean_size: f64,
    mean_mass: f64,
}

impl Prefixes {
    pub(super) fn new(
        of: PrefixOf,
        lengths: &PrefixLengths,
        extent: Extent,
        wanted: Wanted,
    ) -> Result<Self, ClassError> {
        let block = match of {
            PrefixOf::Table => extent.samples(),
            PrefixOf::Pixel => extent.spp,
        };
        // The first samples are in all prefixes: the short ones decide about them, and the later samples
        // follow.
        let weighed = |length: usize| PrefixLength { length, weight: 1.0 / length as f64 };
        let lengths = match lengths {
            PrefixLengths::Every => (1..=block).map(weighed).collect(),
            PrefixLengths::PowersOfTwo => {
                let powers = std::iter::successors(Some(1_usize), |length| length.checked_mul(2));
                powers.take_while(|&length| length < block).chain([block]).map(weighed).collect()
            }
            PrefixLengths::Given(given) if given.is_empty() => {
                return Err(ClassError::Empty { family: "prefixes" });
            }
            PrefixLengths::Given(given) => given.clone(),
        };
        for &PrefixLength { length, weight } in &lengths {
            if !(1..=block).contains(&length) {
                return Err(ClassError::PrefixLength { length, most: block });
            }
            super::listed::check_weight("the weight of a prefix", weight)?;
        }
        let (spp, blocks) = (extent.spp, extent.samples() / block);
        let all = blocks.saturating_mul(lengths.len());
        let (name, most) = ("the number of prefixes of all pixels", "of at most 2147483647");
        RangeError::check(all <= MOST_VALUES, name, all as f64, most)?;
        let mut prefixes = Self { block, blocks, spp, lengths, wanted, mean_size: 0.0, mean_mass: 0.0 };
        (prefixes.mean_size, prefixes.mean_mass) = prefixes.means();
        Ok(prefixes)
    }

    /// Size of a visited class, and the same times its emphasis, in the mean.
    fn means(&self) -> (f64, f64) {
        let Some(visited) = self.visited() else {
            let count = self.lengths.len() as f64;
            let sizes = self.lengths.iter().map(|prefix| prefix.length as f64);
            let masses = self.lengths.iter().map(|prefix| prefix.weight * prefix.length as f64);
            return (sizes.sum::<f64>() / count, masses.sum::<f64>() / count);
        };
        let (mut sizes, mut masses) = (0, 0.0);
        for &member in &*visited {
            let size = self.demanded(member as usize).count();
            sizes += size;
            masses += self.emphasis(member as usize) * size as f64;
        }
        (sizes as f64 / visited.len().max(1) as f64, masses / visited.len() as f64)
    }

    fn of(&self, member: usize) -> (usize, PrefixLength) {
        (member / self.lengths.len(), self.lengths[member % self.lengths.len()])
    }

    /// Numbers of the samples, demanded or not.
    fn samples(&self, member: usize) -> Range<u32> {
        let (block, prefix) = self.of(member);
        let begin = (block * self.block) as u32;
        begin..begin + prefix.length as u32
    }

    fn demanded(&self, member: usize) -> impl Iterator<Item = u32> {
        self.samples(member).filter(|&sample| self.wanted.site(sample as usize / self.spp))
    }

    /// Marks the classes that hold a sample of the site.
    fn mark(&self, site: usize, holds: &mut [bool]) {
        let first = site * self.spp;
        let (block, within) = (first / self.block, first % self.block);
        let classes = holds[block * self.lengths.len()..].iter_mut().zip(&self.lengths);
        classes.for_each(|(holds, prefix)| *holds |= prefix.length > within);
    }
}

impl Filters for Prefixes {
    fn members(&self) -> usize {
        self.blocks * self.lengths.len()
    }

    fn is_per_site(&self) -> bool {
        self.blocks > 1
    }

    fn emphasis(&self, member: usize) -> f64 {
        self.of(member).1.weight
    }

    fn visited(&self) -> Option<Arc<[u32]>> {
        self.wanted.holding(self.members(), |site, holds| self.mark(site, holds))
    }

    fn mean_size(&self) -> f64 {
        self.mean_size
    }

    fn mean_mass(&self) -> f64 {
        self.mean_mass
    }

    fn sizes(&self) -> Vec<usize> {
        let mut sizes: Vec<usize> = self.lengths.iter().map(|prefix| prefix.length).collect();
        sizes.sort_unstable();
        sizes.dedup();
        sizes
    }

    fn is_partial(&self) -> bool {
        self.wanted.is_partial()
    }

    fn run(&self, member: usize) -> Option<Range<u32>> {
        (!self.is_partial()).then(|| self.samples(member))
    }

    fn select(&self, member: usize, _level: f64, samples: &mut Vec<u32>) {
        samples.clear();
        samples.extend(self.demanded(member));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_of_pixels_start_at_each_pixel() {
        let extent = Extent { frames: 1, height: 1, width: 3, spp: 6 };
        let prefixes =
            Prefixes::new(PrefixOf::Pixel, &PrefixLengths::PowersOfTwo, extent, Wanted::All).unwrap();
        assert_eq!(prefixes.sizes(), [1, 2, 4, 6]);
        assert_eq!(prefixes.members(), 12);
        assert_eq!(prefixes.samples(4), 6..7);
        assert_eq!(prefixes.samples(11), 12..18);
        let prefixes = Prefixes::new(PrefixOf::Table, &PrefixLengths::Every, extent, Wanted::All).unwrap();
        assert_eq!(prefixes.members(), 18);
        assert_eq!(prefixes.samples(16), 0..17);
    }

    #[test]
    fn a_class_is_marked_if_it_reaches_the_site() {
        let extent = Extent::points(8);
        let prefixes =
            Prefixes::new(PrefixOf::Table, &PrefixLengths::PowersOfTwo, extent, Wanted::All).unwrap();
        let mut holds = [false; 4];
        prefixes.mark(3, &mut holds);
        assert_eq!(holds, [false, false, true, true]);
    }
}
