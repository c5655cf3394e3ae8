//! Where an optimisation starts, if not from white noise, and what is done at its end.

use super::Objective;
use super::plan::PlannedTerm;
use crate::config::Role;
use crate::random::kronecker_steps;
use crate::table::domain::Domain;

/// Jitter of a start, in distances between neighbours: with less, the order of the sequence stays visible.
const JITTER: f64 = 3.0;

impl Objective {
    /// Places samples by their targets: each by that of the smallest classes that hold it, whose samples
    /// become a Kronecker sequence at a random place, jittered by some distances between neighbours and
    /// warped into the target. Parts of a target then hold as many samples as they should, up to a few: no
    /// slice brings one from one part to another without leaving others on the way.
    pub(crate) fn place(&self, points: &mut [f32]) {
        let mut terms: Vec<&PlannedTerm> =
            self.terms.iter().filter(|term| term.spec.role == Role::Descend).collect();
        terms.retain(|term| term.spec.target.has_warp());
        if terms.is_empty() {
            return;
        }
        terms.sort_by(|a, b| b.family.mean_size().total_cmp(&a.family.mean_size()));
        let noise = points.to_vec();
        // From the smallest classes on, each coordinate once.
        let mut is_placed = vec![false; points.len()];
        let (mut samples, mut place) = (Vec::new(), Vec::new());
        for term in terms.into_iter().rev() {
            let mut warp = None;
            let steps = kronecker_steps(term.spec.dims.len());
            for index in (0..term.family.visits()).rev() {
                term.family.select(term.family.visited_member(index), 0.0, &mut samples);
                let Some(&origin) = samples.first() else { continue };
                let shift = |dim: &usize| f64::from(noise[origin as usize * self.dims + dim]);
                let apart = JITTER * (samples.len() as f64).powf(-1.0 / steps.len() as f64);
                for (rank, &sample) in samples.iter().enumerate() {
                    let first = sample as usize * self.dims;
                    if term.spec.dims.iter().all(|dim| is_placed[first + dim]) {
                        continue;
                    }
                    let Some(warp) = warp.get_or_insert_with(|| term.spec.target.warp()) else { continue };
                    let jitter = |dim: &usize| apart * f64::from(noise[first + dim]);
                    let along = term.spec.dims.iter().map(|dim| shift(dim) + jitter(dim)).zip(&steps);
                    place.clear();
                    place.extend(along.map(|(start, step)| (start + rank as f64 * step).fract()));
                    warp.place(&mut place);
                    for (dim, place) in term.spec.dims.iter().zip(&place) {
                        if !std::mem::replace(&mut is_placed[first + dim], true) {
                            points[first + dim] = Domain::Interval.admit(*place as f32);
                        }
                    }
                }
            }
        }
    }

    /// Brings points that an optimisation has left beside or between bright pixels of their density into
    /// those that lack some: each by the smallest of its classes that have one.
    pub(crate) fn settle(&self, points: &mut [f32]) {
        let has_pixels =
            |term: &&PlannedTerm| term.spec.role == Role::Descend && !term.spec.target.densities().is_empty();
        let mut terms: Vec<&PlannedTerm> = self.terms.iter().filter(has_pixels).collect();
        // Where pixels have classes of their own, a sample has too many to follow one.
        terms.retain(|term| !term.family.is_per_site() && !term.family.has_levels());
        terms.sort_by(|a, b| a.family.mean_size().total_cmp(&b.family.mean_size()));
        let mut is_settled = vec![false; if terms.is_empty() { 0 } else { points.len() }];
        let mut samples = Vec::new();
        for term in terms {
            let &[x, y] = term.spec.dims.as_slice() else { continue };
            for index in 0..term.family.visits() {
                term.family.select(term.family.visited_member(index), 0.0, &mut samples);
                let places = |sample: &u32| [x, y].map(|dim| *sample as usize * self.dims + dim);
                if samples.iter().flat_map(places).any(|place| is_settled[place]) {
                    continue;
                }
                let mut class: Vec<[f32; 2]> =
                    samples.iter().map(|sample| places(sample).map(|place| points[place])).collect();
                term.spec.target.settle(&mut class);
                for (place, value) in samples.iter().flat_map(places).zip(class.into_iter().flatten()) {
                    (points[place], is_settled[place]) = (value, true);
                }
            }
        }
    }
}
