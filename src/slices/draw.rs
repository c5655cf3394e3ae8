//! The random slices of a step, named by seed, step and place, never by thread.

use rand::RngExt;
use rand::seq::SliceRandom;

use crate::classes::FilterFamily;
use crate::config::Role;
use crate::directions::Directions;
use crate::objective::{Objective, Slice};
use crate::random::{self, GOLDEN_RATIO, Purpose};
use crate::table::domain::Domain;
use crate::table::extent::bytes_of;

/// One subset of a step, before its samples and directions are looked up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SubsetDraw {
    pub term: u32,
    pub member: u32,
    pub level: f64,
    pub phase: f64,
    /// Term, and number within its step: names the subset's generator.
    pub name: u64,
}

/// The order in which a term visits its classes: a new random permutation each epoch.
#[derive(Clone, Debug, Default)]
pub(crate) struct VisitOrder {
    epoch: Option<u64>,
    members: Vec<u32>,
}

/// Which subsets are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Picked {
    /// As many of this role as a batch holds.
    Batch(Role),
    /// One of every class in this role; the step is a sweep.
    Each(Role),
}

impl Picked {
    pub(crate) fn role(self) -> Role {
        match self {
            Picked::Batch(role) | Picked::Each(role) => role,
        }
    }

    /// Keeps the names of both apart.
    fn mark(self) -> u64 {
        match self {
            Picked::Batch(_) => 0,
            Picked::Each(_) => 1 << 63,
        }
    }
}

/// Visits of a term's classes that `f64` tells apart, with some room for fractions.
const MOST_VISITS: f64 = (1_u64 << 50) as f64;

impl Objective {
    /// The subsets that are drawn in a step. `orders` keeps the permutations between steps.
    pub(crate) fn draw_subsets(
        &self,
        seed: u64,
        step: u64,
        pick: Picked,
        orders: &mut Vec<VisitOrder>,
        draws: &mut Vec<SubsetDraw>,
    ) {
        orders.resize_with(self.terms.len(), VisitOrder::default);
        draws.clear();
        // Room for all at once: in one dimension a step draws as many subsets as there are classes.
        draws.reserve_exact(self.subsets_per_step(pick));
        for (index, (term, order)) in self.terms.iter().zip(orders).enumerate() {
            let is_swept = matches!(pick, Picked::Each(_)) && self.is_balanced_in_sweeps(term);
            if term.spec.role != pick.role() || is_swept {
                continue;
            }
            let members = term.family.visits() as u64;
            let (rate, phase) = match pick {
                // Terms that draw less than once a step take turns.
                Picked::Batch(_) => (term.rate, ((index + 1) as f64 * GOLDEN_RATIO).fract()),
                Picked::Each(_) => (members as f64, 0.0),
            };
            let steady = term.steady && pick == Picked::Batch(pick.role());
            // A steady term draws a whole number of subsets, each step the same.
            let phase = if steady { 0.0 } else { phase };
            // Visits begin anew before they are too many to be counted one by one.
            let place = step % (MOST_VISITS / rate.max(1.0)) as u64;
            let begin = (place as f64 * rate + phase) as u64;
            let end = ((place + 1) as f64 * rate + phase) as u64;
            let mut generator = random::generator(seed, Purpose::Strata, step, index as u64 | pick.mark());
            let turn = match pick {
                Picked::Batch(_) => generator.random(),
                // A class that comes once a sweep has its directions spread over the sweeps.
                Picked::Each(_) => (step as f64 * GOLDEN_RATIO).fract(),
            };
            for visit in begin..end {
                let epoch = visit / members;
                order.turn_to(seed, index as u64, epoch, &term.family);
                let (i, strata) = ((visit - begin) as f64, (end - begin) as f64);
                let member = order.members[(visit % members) as usize];
                let phase = match steady {
                    // Of all its visits, and apart from those of other classes.
                    true => epoch as f64 * GOLDEN_RATIO + f64::from(member) * std::f64::consts::SQRT_2,
                    false => turn + i * GOLDEN_RATIO,
                };
                // Jittered strata of the level against a rotated golden-ratio sequence of the phase.
                let level = ((i + generator.random::<f64>()) / strata).min(1.0 - f64::EPSILON);
                if term.family.is_empty_at(member as usize, level) {
                    continue;
                }
                draws.push(SubsetDraw {
                    term: index as u32,
                    member,
                    level,
                    phase: phase.fract(),
                    name: (index as u64) << 32 | (visit - begin) | pick.mark(),
                });
            }
        }
    }

    /// Subsets that a step draws at most.
    fn subsets_per_step(&self, pick: Picked) -> usize {
        let terms = self.terms.iter().filter(|term| term.spec.role == pick.role());
        let subsets = terms.map(|term| match pick {
            Picked::Batch(_) => term.rate as usize + 1,
            Picked::Each(_) => term.family.visits(),
        });
        subsets.sum()
    }

    /// Directions and torus cuts of a subset.
    pub(crate) fn draw_directions(
        &self,
        seed: u64,
        step: u64,
        draw: &SubsetDraw,
        directions: &mut Directions,
        cut: &mut Vec<Option<f32>>,
    ) {
        let term = &self.terms[draw.term as usize];
        cut.clear();
        cut.resize(term.spec.dims.len(), None);
        let is_cut = |dim: &usize| self.domains[*dim] == Domain::Torus;
        let is_random = term.slicer.is_random() || term.spec.dims.iter().any(is_cut);
        let mut generator = match is_random {
            true => random::generator(seed, Purpose::Subset, step, draw.name),
            // Nobody asks it; naming one takes as long as transporting a sample.
            false => random::unnamed(),
        };
        term.slicer.draw(draw.phase, &mut generator, directions);
        for (cut, dim) in cut.iter_mut().zip(&term.spec.dims) {
            *cut = is_cut(dim).then(|| generator.random());
        }
    }

    /// The slices that the terms of a role draw in step `step` of an optimisation with this seed, one by one.
    pub fn draw(&self, seed: u64, step: u64, role: Role) -> Vec<Slice> {
        let (mut orders, mut draws) = (Vec::new(), Vec::new());
        let (mut directions, mut cut) = (Directions::default(), Vec::new());
        self.draw_subsets(seed, step, Picked::Batch(role), &mut orders, &mut draws);
        let mut slices = Vec::new();
        for draw in &draws {
            self.draw_directions(seed, step, draw, &mut directions, &mut cut);
            slices.extend((0..directions.count).map(|lane| Slice {
                term: draw.term as usize,
                member: draw.member as usize,
                level: draw.level,
                direction: directions.theta.iter().map(|row| f64::from(row[lane])).collect(),
                cut: cut.iter().map(|cut| f64::from(cut.unwrap_or(0.0))).collect(),
            }));
        }
        slices
    }
}

impl VisitOrder {
    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        bytes_of(&self.members)
    }

    fn turn_to(&mut self, seed: u64, term: u64, epoch: u64, family: &FilterFamily) {
        if self.epoch != Some(epoch) {
            self.epoch = Some(epoch);
            family.list_visited(&mut self.members);
            self.members.shuffle(&mut random::generator(seed, Purpose::Order, epoch, term));
        }
    }
}
