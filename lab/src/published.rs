//! The published way to optimise a table, written plainly, to compare with.
//!
//! This is the loop of Salaün et al. 2022[^salaun] and Korać et al. 2023[^korac], written from a description
//! of its mathematics, without sight of their programs. Every slice looks at every sample, and that is what
//! it costs:
//!
//! 1. draw a pixel, a level and a direction (70 % of them anywhere, 15 % along each axis);
//! 2. evaluate the filter, with its exponential, at every sample of the table and keep those above the level;
//! 3. draw three target points per kept sample from the square, project and sort both;
//! 4. the sample of rank `i` moves towards the mean of the target points `3i`, `3i + 1`, `3i + 2`: the exact
//!    transport between the two sets of points, and the least noisy use of three points per sample;
//! 5. write the displacements into a table that is cleared and added up in full.
//!
//! A batch of slices makes a step of Adam with constant parameters. Its `epsilon` exceeds the gradient by
//! orders of magnitude, so that it is gradient descent with momentum in effect. Samples that leave the square
//! are put back on its border.
//!
//! Slices run in parallel, on plain arrays, compiled like the library.
//!
//! [^salaun]: <https://doi.org/10.1145/3550454.3555484>
//! [^korac]: <https://doi.org/10.1145/3610548.3618146>

use fsot::config::BELOW_ONE;
use fsot::files::TableError;
use fsot::{Extent, SampleTable, Site};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::random::GOLDEN;

/// Up to which filter weight levels are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Levels {
    /// The weight of the filtered pixel in the current frame. A kernel that peaks in the past is clipped
    /// there: it becomes almost a box in time. The published spatio-temporal loop does so.
    CurrentFrame,
    /// The greatest weight.
    Peak,
}

/// What the published loop optimises, and how.
#[derive(Clone, Debug)]
pub struct Parameters {
    /// Shape of the table.
    pub extent: Extent,
    /// The spatial filter is `exp(-r² / sigma_px²)`.
    pub sigma_px: f32,
    /// Weights in time, current frame first.
    pub temporal: Vec<f32>,
    /// Up to where levels are drawn.
    pub levels: Levels,
    /// Slices per iteration.
    pub batch: usize,
    /// Step of gradient descent that Adam amounts to: the mean displacement over the slices of a batch, most
    /// of which hold a given sample not at all, times `gain` is what the sample moves, once its momentum has
    /// built up.
    pub gain: f32,
    /// Names every random number.
    pub seed: u64,
}

const LEARNING_RATE: f32 = 0.5;
const BETA: [f32; 2] = [0.9, 0.99];
const EPSILON: f32 = 1e-4;
const AXIS_SHARE_EACH: f32 = 0.15;
const TARGETS_PER_SAMPLE: usize = 3;
/// Below -87 `exp` underflows in `f32`, which takes twice as long.
const LEAST_EXPONENT: f32 = -80.0;
/// Slices that share an accumulator.
const CHUNK: usize = 64;

/// A table of two dimensions on its way.
#[derive(Debug)]
pub struct Published {
    parameters: Parameters,
    points: Vec<f32>,
    first: Vec<f32>,
    second: Vec<f32>,
    iterations: u64,
}

/// Buffers of one slice.
#[derive(Debug)]
struct Workspace {
    kept: Vec<usize>,
    projections: Vec<(f32, usize)>,
    targets: Vec<f32>,
    /// Displacement of every coordinate along this slice.
    shift: Vec<f32>,
    /// Sum over the slices so far.
    total: Vec<f32>,
}

impl Published {
    /// Starts from white noise in the square.
    pub fn new(parameters: Parameters) -> Result<Self, TableError> {
        let points = SampleTable::white_noise(parameters.extent, 2, parameters.seed)?.into_values();
        let zeros = vec![0.0; points.len()];
        Ok(Self { parameters, first: zeros.clone(), second: zeros, points, iterations: 0 })
    }

    /// The table as it is now; a copy.
    pub fn table(&self) -> SampleTable {
        SampleTable::new(self.parameters.extent, 2, self.points.clone()).expect("points are kept inside")
    }

    /// Slices drawn so far.
    pub fn slices(&self) -> u64 {
        self.iterations * self.parameters.batch as u64
    }

    /// One batch of slices and one step of Adam.
    pub fn iterate(&mut self) {
        let displacements = self.mean_displacements();
        self.iterations += 1;
        let unbias = BETA.map(|beta| 1.0 / (1.0 - beta.powi(self.iterations.min(10_000) as i32)));
        // Scaled so that epsilon alone is left of Adam's denominator.
        let scale = self.parameters.gain * EPSILON / LEARNING_RATE;
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((point, (first, second)), displacement) in self.points.iter_mut().zip(moments).zip(displacements)
        {
            let gradient = -scale * displacement;
            *first = BETA[0] * *first + (1.0 - BETA[0]) * gradient;
            *second = BETA[1] * *second + (1.0 - BETA[1]) * gradient * gradient;
            *point -= LEARNING_RATE * (unbias[0] * *first) / ((unbias[1] * *second).sqrt() + EPSILON);
            *point = point.clamp(0.0, BELOW_ONE);
        }
    }

    /// Displacements of all coordinates, averaged over the slices of a batch.
    fn mean_displacements(&self) -> Vec<f32> {
        let Parameters { batch, .. } = self.parameters;
        let chunks: Vec<usize> = (0..batch).step_by(CHUNK).collect();
        // Collected in order, so that the sum does not depend on the threads.
        let totals: Vec<Vec<f32>> = chunks
            .into_par_iter()
            .map(|begin| {
                let mut workspace = Workspace::new(self.points.len());
                (begin..(begin + CHUNK).min(batch)).for_each(|slice| self.transport(slice, &mut workspace));
                workspace.total
            })
            .collect();
        let mut mean = vec![0.0; self.points.len()];
        for total in totals {
            mean.iter_mut().zip(total).for_each(|(mean, total)| *mean += total / batch as f32);
        }
        mean
    }

    /// Draws a slice and adds the displacements along it.
    fn transport(&self, slice: usize, workspace: &mut Workspace) {
        let Parameters { batch, seed, ref extent, .. } = self.parameters;
        let name = self.iterations * batch as u64 + slice as u64;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.wrapping_add(name.wrapping_mul(GOLDEN)));
        let centre = extent.site(random.random_range(0..extent.sites()));
        let level = random.random::<f32>() * self.greatest_level();
        let theta = direction(&mut random);

        self.select(centre, level, &mut workspace.kept);
        let Workspace { kept, projections, targets, shift, total } = workspace;
        let project = |point: &[f32]| point[0] * theta[0] + point[1] * theta[1];
        projections.clear();
        projections.extend(kept.iter().map(|&sample| (project(&self.points[2 * sample..]), sample)));
        projections.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        targets.clear();
        targets.extend((0..TARGETS_PER_SAMPLE * kept.len()).map(|_| project(&random.random::<[f32; 2]>())));
        targets.sort_unstable_by(f32::total_cmp);

        shift.fill(0.0);
        for (&(projection, sample), targets) in
            projections.iter().zip(targets.chunks_exact(TARGETS_PER_SAMPLE))
        {
            let target = targets.iter().sum::<f32>() / TARGETS_PER_SAMPLE as f32;
            for (shift, component) in shift[2 * sample..].iter_mut().zip(theta) {
                *shift = (target - projection) * component;
            }
        }
        total.iter_mut().zip(shift).for_each(|(total, shift)| *total += *shift);
    }

    fn greatest_level(&self) -> f32 {
        let Parameters { temporal, levels, .. } = &self.parameters;
        match levels {
            Levels::CurrentFrame => temporal[0],
            Levels::Peak => temporal.iter().copied().fold(0.0, f32::max),
        }
    }

    /// The samples whose filter weight exceeds the level, by evaluating the filter at every sample.
    fn select(&self, centre: Site, level: f32, kept: &mut Vec<usize>) {
        let Parameters { extent, sigma_px, temporal, .. } = &self.parameters;
        let distance = |a: usize, b: usize, len: usize| a.abs_diff(b).min(len - a.abs_diff(b)) as f32;
        kept.clear();
        let mut sample = 0;
        for frame in 0..extent.frames {
            let back = (centre.frame + extent.frames - frame) % extent.frames;
            let in_time: f32 = temporal.iter().skip(back).step_by(extent.frames).sum();
            for y in 0..extent.height {
                let dy = distance(y, centre.y, extent.height);
                for x in 0..extent.width {
                    let dx = distance(x, centre.x, extent.width);
                    for _ in 0..extent.spp {
                        let exponent = -(dx * dx + dy * dy) / (sigma_px * sigma_px);
                        if in_time * exponent.max(LEAST_EXPONENT).exp() > level {
                            kept.push(sample);
                        }
                        sample += 1;
                    }
                }
            }
        }
    }
}

impl Workspace {
    fn new(coordinates: usize) -> Self {
        let zeros = vec![0.0; coordinates];
        Self {
            kept: Vec::new(),
            projections: Vec::new(),
            targets: Vec::new(),
            shift: zeros.clone(),
            total: zeros,
        }
    }
}

/// A unit vector of the plane: one of the axes, or any.
fn direction(random: &mut Xoshiro256PlusPlus) -> [f32; 2] {
    let kind: f32 = random.random();
    if kind < AXIS_SHARE_EACH {
        [1.0, 0.0]
    } else if kind < 2.0 * AXIS_SHARE_EACH {
        [0.0, 1.0]
    } else {
        let angle = std::f32::consts::PI * random.random::<f32>();
        [angle.cos(), angle.sin()]
    }
}
