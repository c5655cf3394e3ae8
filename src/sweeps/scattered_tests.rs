//! Listed neighbours against the closed form's definition, and against tiles.

use super::*;
use crate::classes::Demand;
use crate::config::{Config, DimensionGroup, Sweeps};
use crate::objective::plan::PlannedTerm;
use crate::random;
use crate::sweeps::{Motion, Sweeper, mean_projection};

/// Two samples per pixel, and a kernel that goes around in time and in x.
const EXTENT: Extent = Extent { frames: 3, height: 40, width: 12, spp: 2 };

/// A twentieth of the pixels, here and there, and none of the second frame.
fn flags() -> Vec<bool> {
    let numbers = random::uniforms(8, EXTENT.sites()).into_iter().enumerate();
    numbers.map(|(site, number)| number < 0.05 && site / (40 * 12) != 1).collect()
}

fn objective(dims: usize, group: &[usize]) -> Objective {
    let demand = Demand::new([3, 40, 12], flags(), vec![group.to_vec()]).unwrap();
    let groups = [DimensionGroup::new(group.to_vec())];
    let config = Config::new(EXTENT, dims).with_companions(false).with_groups(&groups);
    Objective::for_demand(&config, &demand).unwrap()
}

/// The pulls of all samples, in the order of the table.
fn pulls(objective: &Objective, points: &[f32], arch: Option<Arch>) -> Vec<f32> {
    let terms: Vec<&PlannedTerm> =
        objective.terms.iter().filter(|term| term.family.taps().is_some()).collect();
    let terms = vec![Pairs::new(&terms, EXTENT, 0.0)];
    let mut scattered = Scattered::new(objective, &terms, f64::INFINITY).unwrap();
    scattered.load(points);
    let samples: Vec<u32> = scattered.samples().collect();
    let shares = vec![vec![1.0; terms[0].dims.len()]];
    let mut rows = vec![[0.0; LANES]; samples.len().div_ceil(LANES) * objective.dims];
    match arch {
        Some(arch) => scattered.pull(arch, &terms, &shares, &samples, &mut rows),
        None => {
            for (samples, pulls) in samples.chunks(LANES).zip(rows.chunks_exact_mut(objective.dims)) {
                let scattered = &scattered;
                PullsOfSamples { scattered, terms: &terms, shares: &shares, samples, pulls }.call();
            }
        }
    }
    // Moved by their pulls from 0, samples hold them.
    scattered.points_mut().fill(0.0);
    for (samples, rows) in samples.chunks(LANES).zip(rows.chunks_exact(objective.dims)) {
        for (lane, &sample) in samples.iter().enumerate() {
            let values = &mut scattered.points_mut()[sample as usize * objective.dims..];
            values.iter_mut().zip(rows).for_each(|(value, row)| *value = row[lane]);
        }
    }
    let mut all = vec![0.0; points.len()];
    scattered.store(&mut all);
    all
}

/// `gradient_i = c_d Σ_j F_ij (∇φ − mean_i) / Σ_ij F_ij`; what moves is `-(∇φ − mean_i)` times the natural
/// step for the neighbours that there are.
#[test]
fn pulls_are_the_gradient_of_the_closed_form() {
    for (dims, group) in [(2, vec![0, 1]), (3, vec![2]), (4, vec![3, 0, 1]), (5, vec![0, 1, 2, 3, 4])] {
        let objective = objective(dims, &group);
        let points = random::uniforms(5, EXTENT.samples() * dims);
        let widened: Vec<f64> = points.iter().map(|&value| value.into()).collect();
        let gradient = objective.cramer(&widened).unwrap().gradient;
        let terms: Vec<&PlannedTerm> =
            objective.terms.iter().filter(|term| term.family.taps().is_some()).collect();
        let pairs = Pairs::new(&terms, EXTENT, 0.0);
        let flags = flags();
        let found = pulls(&objective, &points, None);
        let mut compared = 0;
        let total_of = |sample: usize| -> f64 {
            let site = EXTENT.site(sample / 2);
            let held = |tap: &crate::kernel::Tap| {
                let offset = (tap.dt.into(), tap.dy.into(), tap.dx.into());
                flags[EXTENT.site_index(EXTENT.wrapped(site, offset))]
            };
            2.0 * pairs.taps().filter(held).map(|tap| tap.weight).sum::<f64>()
        };
        let demanded = (0..EXTENT.samples()).filter(|sample| flags[sample / 2]);
        let sum: f64 = demanded.map(total_of).sum();
        for sample in 0..EXTENT.samples() {
            let total = total_of(sample);
            let natural = pairs.natural_step_of(total);
            let scale = natural * sum / (total * mean_projection(group.len()));
            for dim in 0..dims {
                let (slope, pull) = (gradient[sample * dims + dim], found[sample * dims + dim]);
                let is_seen = flags[sample / 2] && group.contains(&dim);
                assert_eq!(pull != 0.0, is_seen, "{group:?} {sample} {dim}");
                // The field is tabulated to 1e-3, weights and roots are f32.
                let error = (f64::from(pull) + scale * slope).abs();
                assert!(error < 4e-3 * natural, "{group:?} {sample} {dim}: {pull} {}", -scale * slope);
                compared += usize::from(is_seen);
            }
        }
        assert!(compared > 50, "{compared}");
        assert_eq!(pulls(&objective, &points, Some(Arch::new())), found, "instruction sets differ");
    }
}

/// Whole sweeps lower the closed form, and leave what is not demanded as it is, also in dimensions that
/// nobody asked for.
#[test]
fn sweeps_move_what_is_demanded() {
    let objective = objective(3, &[0, 2]);
    let start = random::uniforms(5, EXTENT.samples() * 3);
    let value = |points: &[f32]| {
        let points: Vec<f64> = points.iter().map(|&value| value.into()).collect();
        objective.cramer(&points).unwrap().value
    };
    let mut sweeper = Sweeper::new(&objective, &Sweeps::default()).unwrap();
    let mut points = start.clone();
    sweeper.load(&points);
    for sweep in 0..20 {
        sweeper.shuffle(1, sweep);
        for step in 0..sweeper.steps() {
            let how = Motion { rate: 0.3, softening: 0.0, balance: 0.0 };
            sweeper.step(step, how, &[Domain::Interval; 3]);
        }
    }
    sweeper.store(&mut points);
    assert!(value(&points) < 0.7 * value(&start), "{} {}", value(&start), value(&points));
    let flags = flags();
    for (index, (before, after)) in start.iter().zip(&points).enumerate() {
        let is_swept = flags[index / 6] && index % 3 != 1;
        assert_eq!(before.to_bits() != after.to_bits(), is_swept, "{index}");
    }
}
