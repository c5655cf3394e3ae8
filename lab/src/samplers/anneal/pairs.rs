//! Energies that depend on the distance of two values, `Σ w(p − q) E(‖v_p − v_q‖)`.
//!
//! The energy of every movable site with its own value is kept, so a proposed swap costs two passes over
//! neighbours, sixteen at a time, and an accepted one four more. Plain arrays; the compiler makes them
//! vectors.

use crate::simd::{LANES, Row, sum};
use pulp::{Arch, NullaryFnOnce};

use super::neighbours::{InFrame, Neighbours, Run};
use super::{Model, Patch, Work, exp};

/// The energy of two values at distance `d`.
#[derive(Clone, Copy, Debug)]
pub(in crate::samplers) enum Law {
    /// `-d`: the energy distance.
    Distance,
    /// `exp(-d^(dims / 2) / sigma²)`.
    Likeness {
        /// `1 / sigma²`.
        steepness: f32,
    },
}

/// Values, and the energy between sites.
pub(in crate::samplers) struct Pairs<'a> {
    arch: Arch,
    /// `[id][dim]`.
    values: &'a [f32],
    dims: usize,
    law: Law,
    reach: [usize; 2],
    runs: Vec<Run>,
    in_frame: InFrame,
}

impl<'a> Pairs<'a> {
    pub fn new(values: &'a [f32], dims: usize, law: Law, neighbours: &Neighbours) -> Self {
        Self {
            arch: Arch::new(),
            values,
            dims,
            law,
            reach: neighbours.reach,
            runs: neighbours.runs(),
            in_frame: neighbours.in_frame(),
        }
    }
}

impl Model for Pairs<'_> {
    fn reach(&self) -> [usize; 2] {
        self.reach
    }

    fn anneal(&self, patch: &mut Patch, work: Work) {
        let Self { arch, dims, .. } = *self;
        match (self.law, dims) {
            (Law::Distance, 2) => arch.dispatch(Swaps::<_, 2> { model: self, law: Away, patch, work }),
            (Law::Distance, _) => arch.dispatch(Swaps::<_, 0> { model: self, law: Away, patch, work }),
            (Law::Likeness { steepness }, 1) => {
                let law = Alike::<1> { dims, steepness };
                arch.dispatch(Swaps::<_, 1> { model: self, law, patch, work });
            }
            (Law::Likeness { steepness }, 2) => {
                let law = Alike::<2> { dims, steepness };
                arch.dispatch(Swaps::<_, 2> { model: self, law, patch, work });
            }
            (Law::Likeness { steepness }, 4) => {
                let law = Alike::<4> { dims, steepness };
                arch.dispatch(Swaps::<_, 4> { model: self, law, patch, work });
            }
            (Law::Likeness { steepness }, _) => {
                let law = Alike::<0> { dims, steepness };
                arch.dispatch(Swaps::<_, 0> { model: self, law, patch, work });
            }
        }
    }
}

/// Energies from squared distances, a vector at a time.
trait Energy: Copy {
    fn of<const L: usize>(self, squares: [f32; L]) -> [f32; L];
}

#[derive(Clone, Copy)]
struct Away;

impl Energy for Away {
    #[inline(always)]
    fn of<const L: usize>(self, mut squares: [f32; L]) -> [f32; L] {
        for square in &mut squares {
            *square = -square.sqrt();
        }
        squares
    }
}

/// `exp(-d^(dims / 2) / sigma²)`; `D` = 0 leaves the number of dimensions to run time.
#[derive(Clone, Copy)]
struct Alike<const D: usize> {
    dims: usize,
    steepness: f32,
}

impl<const D: usize> Energy for Alike<D> {
    #[inline(always)]
    fn of<const L: usize>(self, squares: [f32; L]) -> [f32; L] {
        // d^(dims / 2) is the dims-th power of the square's fourth root.
        let mut powers = [0.0; L];
        for lane in 0..L {
            powers[lane] = match D {
                1 => squares[lane].sqrt().sqrt(),
                2 => squares[lane].sqrt(),
                4 => squares[lane],
                _ => 1.0,
            };
        }
        if !matches!(D, 1 | 2 | 4) {
            let mut roots = squares;
            for root in &mut roots {
                *root = root.sqrt().sqrt();
            }
            for _ in 0..self.dims {
                for lane in 0..L {
                    powers[lane] *= roots[lane];
                }
            }
        }
        for power in &mut powers {
            *power = exp(-*power * self.steepness);
        }
        powers
    }
}

/// A patch being annealed; `D` = 0 leaves the number of dimensions to run time.
struct Swaps<'a, E, const D: usize> {
    model: &'a Pairs<'a>,
    law: E,
    patch: &'a mut Patch,
    work: Work,
}

impl<E: Energy, const D: usize> NullaryFnOnce for Swaps<'_, E, D> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { model, law, patch, mut work } = self;
        let dims = if D == 0 { model.dims } else { D };
        let mut field = Field::<E, D> { law, dims, planes: Vec::new() };
        for dim in 0..dims {
            field.planes.push(patch.ids.iter().map(|&id| model.values[id as usize * dims + dim]).collect());
        }
        let runs: Vec<Vec<(isize, Row)>> = (0..patch.frames)
            .map(|frame| {
                let step = |run: &Run| patch.step(frame, [run.dt, run.dy], run.dx);
                model.runs.iter().map(|run| (step(run), run.weights)).collect()
            })
            .collect();
        let mut own = vec![0.0; patch.ids.len()];
        for (frame, runs) in runs.iter().enumerate() {
            for row in 0..patch.rows {
                for column in 0..patch.columns {
                    let at = patch.at(frame, row, column);
                    own[at] = field.energy(runs, at, at);
                }
            }
        }
        let [alone] = law.of([0.0]);
        for _ in 0..work.proposals {
            let (frame, [a, b]) = work.pair(patch);
            let [p, q] = [a, b].map(|[row, column]| patch.at(frame, row, column));
            if p == q {
                continue;
            }
            let runs = &runs[frame];
            // What the swap does to the energy of ordered pairs; the pair itself keeps its energy.
            let weight = model.in_frame.weight(a, b);
            let mutual = if weight > 0.0 {
                let [apart] = law.of([field.square(p, q)]);
                2.0 * weight * (apart - alone)
            } else {
                0.0
            };
            let crossed = field.energy(runs, p, q) + field.energy(runs, q, p);
            if !work.accepts(2.0 * (crossed - own[p] - own[q] + mutual)) {
                continue;
            }
            field.replace(runs, p, q, &mut own);
            field.replace(runs, q, p, &mut own);
            for plane in &mut field.planes {
                plane.swap(p, q);
            }
            patch.ids.swap(p, q);
            own[p] = field.energy(runs, p, p);
            own[q] = field.energy(runs, q, q);
        }
    }
}

/// The values of a patch, a plane per dimension.
struct Field<E, const D: usize> {
    law: E,
    dims: usize,
    planes: Vec<Vec<f32>>,
}

impl<E: Energy, const D: usize> Field<E, D> {
    #[inline(always)]
    fn dims(&self) -> usize {
        if D == 0 { self.dims } else { D }
    }

    /// Squared distance of the values at two places.
    #[inline(always)]
    fn square(&self, p: usize, q: usize) -> f32 {
        (0..self.dims()).map(|dim| (self.planes[dim][p] - self.planes[dim][q]).powi(2)).sum()
    }

    /// Squared distances of sixteen values in a row to the value at `of`.
    #[inline(always)]
    fn squares(&self, first: usize, of: usize) -> Row {
        let mut squares = [0.0; LANES];
        for plane in &self.planes[..self.dims()] {
            let value = plane[of];
            let row: &[f32] = &plane[first..first + LANES];
            for lane in 0..LANES {
                let difference = row[lane] - value;
                squares[lane] += difference * difference;
            }
        }
        squares
    }

    /// Energy of the value at `of`, put at `at`.
    #[inline(always)]
    fn energy(&self, runs: &[(isize, Row)], at: usize, of: usize) -> f32 {
        let mut total = [0.0; LANES];
        for (offset, weights) in runs {
            let energies = self.law.of(self.squares(at.wrapping_add_signed(*offset), of));
            for lane in 0..LANES {
                total[lane] += weights[lane] * energies[lane];
            }
        }
        sum(total)
    }

    /// Updates the neighbours' own energies for the value at `from` being put at `at`.
    #[inline(always)]
    fn replace(&self, runs: &[(isize, Row)], at: usize, from: usize, own: &mut [f32]) {
        for (offset, weights) in runs {
            let first = at.wrapping_add_signed(*offset);
            let before = self.law.of(self.squares(first, at));
            let after = self.law.of(self.squares(first, from));
            let own = &mut own[first..first + LANES];
            for lane in 0..LANES {
                own[lane] += weights[lane] * (after[lane] - before[lane]);
            }
        }
    }
}
