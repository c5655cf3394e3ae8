//! Energies that are inner products of vectors, `Σ w(p − q) v_p · v_q`: the least is where neighbours cancel.
//!
//! The weighted sum of the neighbours' vectors is kept for every movable site, so a proposed swap costs one
//! pass over the vectors and an accepted one updates the sums around.

use crate::simd::{LANES, sum};
use pulp::{Arch, NullaryFnOnce};

use super::neighbours::{InFrame, Neighbours};
use super::{Model, Patch, Work};

/// Vectors, and the weights between sites.
pub(in crate::samplers) struct Dots<'a> {
    arch: Arch,
    /// `[id][component]`, the components a multiple of [`LANES`].
    vectors: &'a [f32],
    components: usize,
    neighbours: &'a Neighbours,
    in_frame: InFrame,
}

impl<'a> Dots<'a> {
    pub fn new(vectors: &'a [f32], components: usize, neighbours: &'a Neighbours) -> Self {
        assert_eq!(components % LANES, 0, "vectors fill their lanes");
        Self { arch: Arch::new(), vectors, components, neighbours, in_frame: neighbours.in_frame() }
    }
}

impl Model for Dots<'_> {
    fn reach(&self) -> [usize; 2] {
        self.neighbours.reach
    }

    fn anneal(&self, patch: &mut Patch, work: Work) {
        self.arch.dispatch(Swaps { model: self, patch, work });
    }
}

struct Swaps<'a> {
    model: &'a Dots<'a>,
    patch: &'a mut Patch,
    work: Work,
}

impl NullaryFnOnce for Swaps<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { model, patch, mut work } = self;
        let Dots { vectors, components, .. } = *model;
        let vector = |id: u32| &vectors[id as usize * components..][..components];
        let offsets: Vec<Vec<(isize, f32)>> = (0..patch.frames)
            .map(|frame| {
                let offset = |&(dt, dy, dx, weight): &(i32, i32, i32, f32)| {
                    (patch.step(frame, [dt, dy], dx as isize), weight)
                };
                model.neighbours.taps.iter().map(offset).collect()
            })
            .collect();
        let mut around = vec![0.0; patch.ids.len() * components];
        for (frame, offsets) in offsets.iter().enumerate() {
            for row in 0..patch.rows {
                for column in 0..patch.columns {
                    let at = patch.at(frame, row, column);
                    let sums = &mut around[at * components..][..components];
                    for &(offset, weight) in offsets {
                        add(sums, weight, vector(patch.ids[at.wrapping_add_signed(offset)]));
                    }
                }
            }
        }
        for _ in 0..work.proposals {
            let (frame, [a, b]) = work.pair(patch);
            let [p, q] = [a, b].map(|[row, column]| patch.at(frame, row, column));
            if p == q {
                continue;
            }
            let weight = model.in_frame.weight(a, b);
            let [at_p, at_q] = [p, q].map(|at| vector(patch.ids[at]));
            let [around_p, around_q] = [p, q].map(|at| &around[at * components..][..components]);
            // (v_q − v_p) · (B_p − B_q) − w ‖v_q − v_p‖², over ordered pairs.
            let mut change = [0.0; LANES];
            for first in (0..components).step_by(LANES) {
                let here = first..first + LANES;
                let (p, q) = (&at_p[here.clone()], &at_q[here.clone()]);
                let (around_p, around_q) = (&around_p[here.clone()], &around_q[here]);
                for lane in 0..LANES {
                    let difference = q[lane] - p[lane];
                    change[lane] += difference * (around_p[lane] - around_q[lane] - weight * difference);
                }
            }
            if !work.accepts(2.0 * sum(change)) {
                continue;
            }
            for (at, new, old) in [(p, at_q, at_p), (q, at_p, at_q)] {
                for &(offset, weight) in &offsets[frame] {
                    let sums = &mut around[at.wrapping_add_signed(offset) * components..][..components];
                    add(sums, weight, new);
                    add(sums, -weight, old);
                }
            }
            patch.ids.swap(p, q);
        }
    }
}

#[inline(always)]
fn add(sums: &mut [f32], weight: f32, vector: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(vector) {
        *sum += weight * value;
    }
}
