//! What a scene will really consume: pixels and frames with any variance, and groups of dimensions.

use std::ops::Range;
use std::sync::Arc;

use crate::error::{ConfigError, ExtentError, GroupError};
use crate::table::extent::{Extent, Site};

/// The part of a table that a renderer reads in earnest.
///
/// A pixel that is *not* demanded has the same value whatever random numbers it is given: background, a
/// visible light, full shadow. Its samples need no optimisation.
///
/// ```
/// use fsot::classes::Demand;
/// use fsot::{Config, Extent, Optimizer, Until};
///
/// // The left half of a picture needs dimensions 0 and 1 only.
/// let pixels = (0..32 * 32).map(|pixel| pixel % 32 < 16).collect();
/// let demand = Demand::new([1, 32, 32], pixels, vec![vec![0, 1]])?;
/// assert_eq!((demand.share(), demand.dims()), (0.5, 2));
/// Optimizer::for_demand(Config::new(Extent::still(32, 32), 4), &demand)?.run(Until::Sweeps(2))?;
/// # Ok::<(), fsot::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Demand {
    frames: usize,
    height: usize,
    width: usize,
    pixels: Vec<bool>,
    groups: Vec<Vec<usize>>,
}

impl Demand {
    /// A demand over `frames × height × width` pixels, in C order, for these groups of dimensions.
    ///
    /// # Errors
    /// An empty axis, a number of pixels that does not fit, an empty group, a dimension twice in a group.
    pub fn new(
        [frames, height, width]: [usize; 3],
        pixels: Vec<bool>,
        groups: Vec<Vec<usize>>,
    ) -> Result<Self, ConfigError> {
        Extent { frames, height, width, spp: 1 }.validate(1)?;
        let expected = frames * height * width;
        if pixels.len() != expected {
            return Err(ConfigError::DemandCount { given: pixels.len(), expected });
        }
        for (group, dimensions) in groups.iter().enumerate() {
            // Whether the table has them is found out when there is one.
            GroupError::check(dimensions, usize::MAX)
                .map_err(|problem| ConfigError::DemandGroup { group, problem })?;
        }
        Ok(Self { frames, height, width, pixels, groups })
    }

    /// Frames, height and width.
    pub fn shape(&self) -> [usize; 3] {
        [self.frames, self.height, self.width]
    }

    /// One flag a site, in C order.
    pub fn pixels(&self) -> &[bool] {
        &self.pixels
    }

    /// Groups of dimensions that are consumed together, such as a light's `[0, 1]`.
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }

    /// Dimensions a table must have: one more than the largest named.
    pub fn dims(&self) -> usize {
        self.groups.iter().flatten().max().map_or(0, |largest| largest.saturating_add(1))
    }

    /// Whether the site is demanded; it must lie inside the shape.
    pub fn wants(&self, site: Site) -> bool {
        self.pixels[(site.frame * self.height + site.y) * self.width + site.x]
    }

    /// Number of demanded sites.
    pub fn count(&self) -> usize {
        self.pixels.iter().filter(|&&wanted| wanted).count()
    }

    /// Demanded share of all sites, in `[0, 1]`.
    pub fn share(&self) -> f64 {
        self.count() as f64 / self.pixels.len() as f64
    }

    /// The demand on a smaller table that tiles the image and the animation: a site of the tile is demanded
    /// if any site that reads it is.
    ///
    /// # Errors
    /// An empty or oversized tile.
    pub fn folded(&self, tile: &Extent) -> Result<Self, ExtentError> {
        tile.validate(1)?;
        let mut pixels = vec![false; tile.sites()];
        let image = Extent { frames: self.frames, height: self.height, width: self.width, spp: 1 };
        for index in (0..self.pixels.len()).filter(|&index| self.pixels[index]) {
            pixels[tile.site_index(tile.wrapped(image.site(index), (0, 0, 0)))] = true;
        }
        let Extent { frames, height, width, .. } = *tile;
        Ok(Self { frames, height, width, pixels, groups: self.groups.clone() })
    }
}

/// Demanded sites of a table, or all of them.
#[derive(Clone, Debug)]
pub(crate) enum Wanted {
    /// Every site.
    All,
    /// Some of them.
    Some(Arc<WantedSites>),
}

/// Demanded sites, as flags and as a list.
#[derive(Debug)]
pub(crate) struct WantedSites {
    flags: Box<[bool]>,
    sites: Box<[u32]>,
}

impl Wanted {
    /// The sites with a flag.
    pub(crate) fn new(flags: &[bool]) -> Self {
        let sites: Box<[u32]> = (0..flags.len() as u32).filter(|&site| flags[site as usize]).collect();
        match sites.len() == flags.len() {
            true => Wanted::All,
            false => Wanted::Some(Arc::new(WantedSites { flags: flags.into(), sites })),
        }
    }

    pub(crate) fn site(&self, site: usize) -> bool {
        match self {
            Wanted::All => true,
            Wanted::Some(wanted) => wanted.flags[site],
        }
    }

    pub(crate) fn is_partial(&self) -> bool {
        matches!(self, Wanted::Some(_))
    }

    /// One flag a site, unless all are demanded.
    pub(super) fn flags(&self) -> Option<&[bool]> {
        match self {
            Wanted::All => None,
            Wanted::Some(wanted) => Some(&wanted.flags),
        }
    }

    /// Visits the demanded sites of a range, in order.
    pub(crate) fn for_each(&self, range: Range<usize>, visit: impl FnMut(u32)) {
        match self {
            Wanted::All => (range.start as u32..range.end as u32).for_each(visit),
            Wanted::Some(wanted) => {
                let sites = &wanted.sites;
                let before = |end: usize| sites.partition_point(|&site| (site as usize) < end);
                sites[before(range.start)..before(range.end)].iter().copied().for_each(visit);
            }
        }
    }

    /// The classes among `members` that hold a demanded site, unless all sites are; `mark(site, holds)` flags
    /// those that hold the site.
    pub(super) fn holding(&self, members: usize, mark: impl Fn(usize, &mut [bool])) -> Option<Arc<[u32]>> {
        let Wanted::Some(wanted) = self else { return None };
        let mut holds = vec![false; members];
        wanted.sites.iter().for_each(|&site| mark(site as usize, &mut holds));
        Some(marked(&holds).into())
    }

    /// Mean size of the visited classes, if it is `mean_size` over all `members` where all is demanded: every
    /// wanted site is held as often as before, but by fewer classes.
    pub(super) fn mean_size(&self, mean_size: f64, members: usize, visited: usize) -> f64 {
        let Wanted::Some(wanted) = self else { return mean_size };
        let share = wanted.sites.len() as f64 / wanted.flags.len() as f64;
        mean_size * share * members as f64 / visited.max(1) as f64
    }
}

/// The positions of the flags that are set.
pub(super) fn marked(flags: &[bool]) -> Vec<u32> {
    (0..flags.len() as u32).filter(|&index| flags[index as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_demand_counts_and_folds() {
        let mut pixels = vec![false; 2 * 4 * 6];
        pixels[0] = true;
        pixels[4 * 6 + 3 * 6 + 5] = true; // frame 1, y 3, x 5
        let demand = Demand::new([2, 4, 6], pixels, vec![vec![0, 1], vec![3, 2]]).unwrap();
        assert_eq!((demand.count(), demand.dims()), (2, 4));
        assert!((demand.share() - 2.0 / 48.0).abs() < 1e-15);
        assert!(demand.wants(Site { frame: 1, y: 3, x: 5 }));
        let tile = demand.folded(&Extent { frames: 1, height: 2, width: 4, spp: 1 }).unwrap();
        let wanted: Vec<usize> = (0..8).filter(|&i| tile.pixels()[i]).collect();
        assert_eq!(wanted, [0, 5]); // (0, 0) and (3 mod 2, 5 mod 4) = (1, 1)
    }

    #[test]
    fn a_bad_demand_is_named() {
        let error = Demand::new([1, 2, 2], vec![true; 3], vec![]).unwrap_err();
        assert!(matches!(error, ConfigError::DemandCount { given: 3, expected: 4 }));
        let error = Demand::new([1, 0, 2], vec![], vec![]).unwrap_err();
        assert_eq!(error, ExtentError::EmptyAxis { axis: "height" }.into());
        let error = Demand::new([1, 1, 1], vec![true], vec![vec![0], vec![]]).unwrap_err();
        assert_eq!(error, ConfigError::DemandGroup { group: 1, problem: GroupError::Empty });
        let error = Demand::new([1, 1, 1], vec![true], vec![vec![2, 2]]).unwrap_err();
        let problem = GroupError::Repeated { dimension: 2 };
        assert_eq!(error, ConfigError::DemandGroup { group: 0, problem });
    }
}
