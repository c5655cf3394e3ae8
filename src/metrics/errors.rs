//! The errors of estimates by a dimension group of samples.

use std::ops::Range;

use super::error::MeasureError;
use super::integrand::Integrand;
use super::samples::{Samples, Values};
use crate::error::GroupError;
use crate::table::extent::Extent;

/// Samples whose dimensions of one group estimate integrals. Read where they lie: a copy in `f64` would be
/// larger than the table.
pub(super) struct Errors<'a> {
    pub extent: Extent,
    samples: Samples<'a>,
    group: Vec<usize>,
}

impl<'a> Errors<'a> {
    /// Refuses a bad group, and one of another number of dimensions than `what` has.
    pub fn of(
        samples: impl Into<Samples<'a>>,
        group: &[usize],
        what: &'static str,
        expected: usize,
    ) -> Result<Self, MeasureError> {
        let samples = samples.into();
        GroupError::check(group, samples.dims())?;
        if group.len() != expected {
            return Err(MeasureError::GroupSize { what, given: group.len(), expected });
        }
        Ok(Self { extent: samples.extent(), samples, group: group.to_vec() })
    }

    /// Error of every site, in the order of sites.
    pub fn all(&self, integrand: &Integrand) -> impl Iterator<Item = f64> {
        self.within(0..self.extent.sites(), integrand)
    }

    /// Error of the sites of a range, in the order of sites.
    pub fn within(&self, sites: Range<usize>, integrand: &Integrand) -> impl Iterator<Item = f64> {
        let spp = self.extent.spp;
        let share = 1.0 / spp as f64;
        let mut x = vec![0.0; self.group.len()];
        sites.map(move |site| {
            let values = (site * spp..(site + 1) * spp).map(|sample| {
                self.read(sample, &mut x);
                integrand.value(&x)
            });
            values.sum::<f64>() * share - integrand.integral()
        })
    }

    fn read(&self, sample: usize, x: &mut [f64]) {
        let first = sample * self.samples.dims();
        match self.samples.values() {
            Values::F32(values) => gather(&values[first..], &self.group, x),
            Values::F64(values) => gather(&values[first..], &self.group, x),
        }
    }
}

fn gather<T: Copy + Into<f64>>(sample: &[T], group: &[usize], x: &mut [f64]) {
    x.iter_mut().zip(group).for_each(|(x, &dim)| *x = sample[dim].into());
}
