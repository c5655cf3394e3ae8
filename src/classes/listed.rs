//! Families whose classes are written out, sample by sample: labels, ramps, and the caller's own.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::CustomClasses;
use super::demand::Wanted;
use super::family::Filters;
use crate::error::{ClassError, RangeError};
use crate::table::extent::Extent;

/// A class of [`super::Classes::Labelled`].
///
/// ```
/// use fsot::classes::{Classes, LabelSet};
///
/// let both = LabelSet { labels: vec![0, 1], weight: 1.0 };
/// let classes = Classes::Labelled { labels: vec![0, 0, 1].into(), subsets: vec![both] };
/// # let _ = classes;
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LabelSet {
    /// The labels whose samples it holds.
    pub labels: Vec<u32>,
    /// Weight of the pull on its samples beside that of the other classes; from 1e-12 to 1e6.
    pub weight: f64,
}

/// A class of [`super::Classes::Ramps`].
///
/// ```
/// use fsot::classes::{Classes, Ramp};
///
/// let coordinates: Vec<f64> = (0..9).map(|sample| f64::from(sample) / 8.0).collect();
/// let ramps = vec![Ramp::Rising, Ramp::Falling];
/// let classes = Classes::Ramps { coordinates: coordinates.into(), ramps };
/// # let _ = classes;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ramp {
    /// The weight is the coordinate.
    Rising,
    /// The weight is 1 less the coordinate.
    Falling,
}

/// Classes as lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct Listed {
    /// Where each class begins among `samples`, and the end of the last.
    starts: Vec<usize>,
    /// Class by class, by falling weight and then by number.
    samples: Vec<u32>,
    /// Weights of the samples, by the largest of their class; empty if all are 1.
    weights: Vec<f32>,
    emphases: Vec<f64>,
}

/// Classes that a caller may list.
const MOST_CLASSES: usize = 1 << 24;

pub(super) fn check_weight(name: &'static str, value: f64) -> Result<(), ClassError> {
    Ok(RangeError::check((1e-12..=1e6).contains(&value), name, value, "from 1e-12 to 1e6")?)
}

impl Listed {
    pub(super) fn labelled(
        labels: &[u32],
        subsets: &[LabelSet],
        extent: Extent,
        wanted: &Wanted,
    ) -> Result<Self, ClassError> {
        check_count("the list of labels", labels.len(), extent)?;
        let mut listed = Self::default();
        for subset in subsets {
            check_weight("the weight of a set of labels", subset.weight)?;
            let mut sought = subset.labels.clone();
            sought.sort_unstable();
            let carries = |&sample: &u32| sought.binary_search(&labels[sample as usize]).is_ok();
            let samples = demanded(extent, wanted).filter(carries);
            listed.begin(subset.weight);
            listed.samples.extend(samples);
        }
        listed.finish("sets of labels", wanted)
    }

    pub(super) fn ramps(
        coordinates: &[f64],
        ramps: &[Ramp],
        extent: Extent,
        wanted: &Wanted,
    ) -> Result<Self, ClassError> {
        check_count("the list of class coordinates", coordinates.len(), extent)?;
        if let Some(&value) = coordinates.iter().find(|value| !(0.0..=1.0).contains(*value)) {
            return Err(RangeError::new("a class coordinate", value, "in [0, 1]").into());
        }
        let mut listed = Self::default();
        for ramp in ramps {
            let weight = |sample: u32| match ramp {
                Ramp::Rising => coordinates[sample as usize],
                Ramp::Falling => 1.0 - coordinates[sample as usize],
            };
            listed.add(demanded(extent, wanted).map(|sample| (sample, weight(sample))).collect(), 1.0);
        }
        listed.finish("ramps", wanted)
    }

    pub(super) fn custom(
        classes: &CustomClasses,
        extent: Extent,
        wanted: &Wanted,
    ) -> Result<Self, ClassError> {
        let family = classes.get();
        let mut listed = Self::default();
        let members = family.members(&extent);
        let (name, most) = ("the number of the caller's classes", "of at most 16777216");
        RangeError::check(members <= MOST_CLASSES, name, members as f64, most)?;
        let mut seen = vec![usize::MAX; extent.samples()];
        for index in 0..members {
            let mut member = family.member(&extent, index);
            check_weight("the weight of a class", member.weight)?;
            for &(sample, weight) in &member.samples {
                let refused = |problem| {
                    let (name, member) = (family.name().into(), index as u32);
                    Err(ClassError::Custom { name, member, sample, weight, problem })
                };
                match seen.get_mut(sample as usize) {
                    None => return refused("name samples of the table only"),
                    Some(seen) if *seen == index => return refused("name each sample once"),
                    Some(seen) => *seen = index,
                }
                if !(0.0..=1.0).contains(&weight) {
                    return refused("give weights in [0, 1]");
                }
            }
            member.samples.retain(|&(sample, _)| wanted.site(sample as usize / extent.spp));
            listed.add(member.samples, member.weight);
        }
        listed.finish("the caller's classes", wanted)
    }

    fn begin(&mut self, emphasis: f64) {
        self.starts.push(self.samples.len());
        self.emphases.push(emphasis);
    }

    /// Adds a class; samples without weight don't belong to it.
    fn add(&mut self, mut weighed: Vec<(u32, f64)>, emphasis: f64) {
        weighed.retain(|&(_, weight)| weight > 0.0);
        weighed.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let largest = weighed.first().map_or(1.0, |&(_, weight)| weight);
        self.begin(emphasis);
        self.samples.extend(weighed.iter().map(|&(sample, _)| sample));
        self.weights.extend(weighed.iter().map(|&(_, weight)| (weight / largest) as f32));
    }

    /// Classes that no demand touches are no mistake, but classes without any sample.
    fn finish(mut self, family: &'static str, wanted: &Wanted) -> Result<Self, ClassError> {
        self.starts.push(self.samples.len());
        if self.samples.is_empty() && matches!(wanted, Wanted::All) {
            return Err(ClassError::Empty { family });
        }
        if self.weights.iter().all(|&weight| weight == 1.0) {
            self.weights = Vec::new();
        }
        self.samples.shrink_to_fit();
        Ok(self)
    }

    fn list(&self, member: usize) -> std::ops::Range<usize> {
        self.starts[member]..self.starts[member + 1]
    }

    /// The samples of a class whose weight exceeds the level.
    fn above(&self, member: usize, level: f64) -> &[u32] {
        let list = self.list(member);
        let count = match self.weights.get(list.clone()) {
            Some(weights) if self.has_levels() => {
                weights.partition_point(|&weight| f64::from(weight) > level)
            }
            _ => list.len(),
        };
        &self.samples[list][..count]
    }

    /// Weight that a random level of a class selects, times a factor, in the mean over classes that hold any
    /// sample.
    fn mean(&self, factor: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut holding) = (0.0, 0);
        for member in 0..self.members() {
            let list = self.list(member);
            holding += usize::from(!list.is_empty());
            let mass = match self.has_levels() {
                true => self.weights[list].iter().map(|&weight| f64::from(weight)).sum(),
                false => list.len() as f64,
            };
            sum += factor(member) * mass;
        }
        sum / holding.max(1) as f64
    }
}

/// What is not demanded is left out of the lists already.
impl Filters for Listed {
    fn members(&self) -> usize {
        self.emphases.len()
    }

    fn is_per_site(&self) -> bool {
        false
    }

    fn has_levels(&self) -> bool {
        !self.weights.is_empty()
    }

    fn emphasis(&self, member: usize) -> f64 {
        self.emphases[member]
    }

    fn visited(&self) -> Option<Arc<[u32]>> {
        let holding = |&member: &u32| !self.list(member as usize).is_empty();
        let visited: Vec<u32> = (0..self.members() as u32).filter(holding).collect();
        (visited.len() < self.members()).then(|| visited.into())
    }

    fn mean_size(&self) -> f64 {
        self.mean(|_| 1.0)
    }

    fn mean_mass(&self) -> f64 {
        self.mean(|member| self.emphases[member])
    }

    fn sizes(&self) -> Vec<usize> {
        let mut sizes = Vec::new();
        for list in (0..self.members()).map(|member| self.list(member)).filter(|list| !list.is_empty()) {
            let len = list.len();
            if self.has_levels() {
                let weights = &self.weights[list];
                sizes.extend((1..len).filter(|&n| weights[n] < weights[n - 1]));
            }
            sizes.push(len);
        }
        sizes.sort_unstable();
        sizes.dedup();
        sizes
    }

    fn is_partial(&self) -> bool {
        false
    }

    fn select(&self, member: usize, level: f64, samples: &mut Vec<u32>) {
        samples.clear();
        samples.extend_from_slice(self.above(member, level));
    }
}

fn demanded(extent: Extent, wanted: &Wanted) -> impl Iterator<Item = u32> {
    (0..extent.samples() as u32).filter(move |&sample| wanted.site(sample as usize / extent.spp))
}

fn check_count(what: &'static str, given: usize, extent: Extent) -> Result<(), ClassError> {
    let expected = extent.samples();
    if given == expected { Ok(()) } else { Err(ClassError::SampleCount { what, given, expected }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Extent = Extent::points(6);

    fn set(labels: &[u32]) -> LabelSet {
        LabelSet { labels: labels.to_vec(), weight: 1.0 }
    }

    #[test]
    fn a_class_holds_the_samples_of_its_labels() {
        let labels = [7, 0, 7, 3, 0, 7];
        let subsets = [set(&[7]), set(&[3, 0]), set(&[5])];
        let listed = Listed::labelled(&labels, &subsets, EXTENT, &Wanted::All).unwrap();
        assert_eq!(listed.above(0, 0.9), [0, 2, 5]);
        assert_eq!(listed.above(1, 0.0), [1, 3, 4]);
        assert_eq!(listed.visited(), Some([0, 1].into()));
        assert_eq!((listed.sizes(), listed.mean_size()), (vec![3], 3.0));
    }

    #[test]
    fn level_sets_of_a_ramp_are_its_upper_parts() {
        let coordinates = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
        let ramps = [Ramp::Rising, Ramp::Falling];
        let listed = Listed::ramps(&coordinates, &ramps, EXTENT, &Wanted::All).unwrap();
        assert_eq!(listed.above(0, 0.5), [5, 4, 3]);
        assert_eq!(listed.above(1, 0.5), [0, 1, 2]);
        assert_eq!(listed.above(0, 0.0).len(), 5);
        assert_eq!(listed.sizes(), [1, 2, 3, 4, 5]);
    }

    #[test]
    fn what_is_not_demanded_is_left_out() {
        let flags = Wanted::new(&[true, false, false, true, false, false]);
        let listed = Listed::labelled(&[0, 0, 1, 1, 2, 2], &[set(&[0]), set(&[2])], EXTENT, &flags).unwrap();
        assert_eq!(listed.above(0, 0.0), [0]);
        assert_eq!(listed.visited(), Some([0].into()));
    }
}
