//! The closed form against its definition, and the engine's `f32` sweeps against the closed form.

use pulp::NullaryFnOnce;

use super::pairs::Pairs;
use super::*;
use crate::classes::{Classes, Demand, FilterForm};
use crate::config::{Config, DimensionGroup, Sweeps, Term};
use crate::error::ObjectiveError;
use crate::kernel::{Kernel, SpatialKernel, TemporalKernel};
use crate::random;
use crate::table::extent::Extent;

/// A table with a kernel that folds onto itself in time and in one of the axes of space.
const EXTENT: Extent = Extent { frames: 3, height: 4, width: 9, spp: 2 };

fn terms(groups: &[&[usize]]) -> Vec<Term> {
    let spatial = SpatialKernel::Gaussian { sigma_px: 1.3 };
    let kernel = Kernel::product(spatial, TemporalKernel::Ema { alpha: 0.5 });
    let groups: Vec<_> = groups
        .iter()
        .enumerate()
        .map(|(i, dims)| DimensionGroup { dims: dims.to_vec(), weight: 1.0 + i as f64 })
        .collect();
    Term::blue_noise(&[kernel], FilterForm::LevelSets, &groups, &EXTENT)
}

fn objective(dims: usize, groups: &[&[usize]]) -> Objective {
    let domains = vec![Domain::Interval; dims];
    let config = Config::new(EXTENT, dims).with_domains(domains).with_terms(terms(groups));
    Objective::new(&config).unwrap()
}

fn points(dims: usize) -> Vec<f32> {
    random::uniforms(5, EXTENT.samples() * dims)
}

fn widened(points: &[f32]) -> Vec<f64> {
    points.iter().map(|&value| value.into()).collect()
}

/// `∫ (F − G)² ds` of weighted samples and a law given by equally likely numbers, by walking over both.
fn cramer_distance(samples: &[(f64, f64)], law: &[f64]) -> f64 {
    let total: f64 = samples.iter().map(|&(_, weight)| weight).sum();
    let mut steps: Vec<(f64, f64)> = samples.iter().map(|&(at, weight)| (at, weight / total)).collect();
    steps.extend(law.iter().map(|&at| (at, -1.0 / law.len() as f64)));
    steps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut difference, mut integral) = (0.0, 0.0);
    for pair in steps.windows(2) {
        difference += pair[0].1;
        integral += difference * difference * (pair[1].0 - pair[0].0);
    }
    integral
}

/// The definition: every pixel's filtered samples against the cube, along many directions.
#[test]
fn the_closed_form_is_the_mean_over_slices() {
    let objective = objective(2, &[&[1, 0]]);
    let points = widened(&points(2));
    let taps = objective.taps(0).unwrap();
    let (angles, cells) = (96, 2000);
    let mut mean = 0.0;
    for angle in 0..angles {
        let (sin, cos) = (std::f64::consts::PI * (f64::from(angle) + 0.5) / f64::from(angles)).sin_cos();
        let law = Target::UniformCube.project(&[cos, sin]);
        let law: Vec<f64> =
            (0..cells).map(|i| law.quantile((f64::from(i) + 0.5) / f64::from(cells))).collect();
        for site in 0..EXTENT.sites() {
            let mut samples = Vec::new();
            for tap in taps {
                let offset = (tap.dt.into(), tap.dy.into(), tap.dx.into());
                let held = EXTENT.site_index(EXTENT.wrapped(EXTENT.site(site), offset));
                for sample in held * EXTENT.spp..(held + 1) * EXTENT.spp {
                    samples.push((points[2 * sample + 1] * cos + points[2 * sample] * sin, tap.weight));
                }
            }
            mean += cramer_distance(&samples, &law) / (f64::from(angles) * EXTENT.sites() as f64);
        }
    }
    let value = objective.cramer(&points).unwrap().value;
    // 96 angles and 2,000 cells are good for three digits; twice as many of both halve the difference.
    assert!((value / mean - 1.0).abs() < 1e-3, "{value} {mean}");
}

#[test]
fn the_gradient_is_the_slope_of_the_value() {
    for (dims, groups) in [(2, &[&[0, 1][..]][..]), (4, &[&[0][..], &[3, 1, 2], &[0, 1, 2, 3]])] {
        let objective = objective(dims, groups);
        let points = widened(&points(dims));
        let gradient = objective.cramer(&points).unwrap().gradient;
        let largest = gradient.iter().copied().map(f64::abs).fold(0.0, f64::max);
        for coordinate in (0..points.len()).step_by(151) {
            let at = |by: f64| {
                let mut moved = points.clone();
                moved[coordinate] += by;
                objective.cramer(&moved).unwrap().value
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            // 1e-16 / 1e-5 of rounding, and kinks of |x| where samples are as close as the step.
            assert!((gradient[coordinate] - slope).abs() < 1e-6 * largest, "{dims} {coordinate}");
        }
    }
}

fn still() -> Motion {
    Motion { rate: 0.0, softening: 0.0, balance: 0.0 }
}

/// The pulls of a whole sweep without motion.
fn pulls(objective: &Objective, points: &[f32]) -> Vec<f32> {
    let sweeps = Sweeps { truncation: 0.0, ..Sweeps::default() };
    let mut sweeper = Sweeper::new(objective, &sweeps).unwrap();
    let mut all = vec![0.0; points.len()];
    sweeper.load(points);
    sweeper.shuffle(1, 0);
    for step in 0..sweeper.steps() {
        sweeper.step(step, still(), &objective.domains);
        sweeper.each_pull(step, |coordinate, pull| all[coordinate] = pull);
    }
    all
}

/// One term alone: the pull is minus the gradient, times what `Sweeps` calls natural, over the share of one
/// sample.
fn assert_pull_is_gradient(objective: &Objective, natural: f64) {
    let (extent, dims) = (objective.extent(), objective.dims());
    let points = random::uniforms(5, extent.samples() * dims);
    let gradient = objective.cramer(&widened(&points)).unwrap().gradient;
    let found = pulls(objective, &points);
    // gradient = c_d T (∇φ − …) / (P W²), with T = W W_1 and W = spp W_1; pull = −natural (∇φ − …).
    let scale = -natural * extent.samples() as f64 / mean_projection(dims);
    let largest = gradient.iter().map(|slope| (scale * slope).abs()).fold(0.0, f64::max);
    for (coordinate, (slope, &pull)) in gradient.iter().zip(&found).enumerate() {
        let error = (scale * slope - f64::from(pull)).abs();
        // Tables of the field are good for 2e-4 of a unit vector.
        assert!(error < 4e-4 * natural + 1e-5 * largest, "{extent:?} {dims} {coordinate}: {error}");
    }
}

#[test]
fn sweeps_follow_the_gradient() {
    for dims in 1..=6 {
        let group: Vec<usize> = (0..dims).rev().collect();
        let objective = objective(dims, &[&group]);
        let natural = Pairs::new(&[&objective.terms[0]], EXTENT, 0.0).natural_step();
        assert_pull_is_gradient(&objective, natural);
    }
}

/// The default objective, whose kernel and companions share a pass over the pairs.
#[test]
fn companions_are_descended_with_their_kernel() {
    for (frames, height, width, spp, dims) in [(1, 9, 11, 2, 2), (3, 6, 7, 2, 2), (1, 8, 8, 1, 1)] {
        let extent = Extent { frames, height, width, spp };
        let objective = Objective::new(&Config::new(extent, dims)).unwrap();
        let terms: Vec<_> = objective.terms.iter().filter(|term| term.spec.role == Role::Descend).collect();
        assert!(terms.len() > 1);
        assert_pull_is_gradient(&objective, Pairs::new(&terms, extent, 0.0).natural_step());
    }
}

/// Runs that end inside a vector, tiles narrower than the kernel or a vector, single rows and frames.
#[test]
fn any_shape_is_swept() {
    for (frames, height, width) in [
        (1, 1, 1),
        (1, 3, 2),
        (2, 2, 3),
        (1, 4, 15),
        (1, 1, 16),
        (2, 3, 17),
        (1, 5, 20),
        (3, 1, 33),
        (1, 2, 48),
        (5, 1, 1),
    ] {
        let extent = Extent { frames, height, width, spp: 1 };
        let kernel = Kernel::product(
            SpatialKernel::Gaussian { sigma_px: 2.1 },
            TemporalKernel::Gaussian { sigma_frames: 1.0 },
        );
        let groups = [DimensionGroup { dims: vec![0, 1], weight: 1.0 }];
        let terms = Term::blue_noise(&[kernel], FilterForm::LevelSets, &groups, &extent);
        let domains = [Domain::Interval; 2];
        let config = Config::new(extent, 2).with_domains(domains.to_vec()).with_terms(terms);
        let objective = Objective::new(&config).unwrap();
        assert_pull_is_gradient(&objective, Pairs::new(&[&objective.terms[0]], extent, 0.0).natural_step());
    }
}

#[test]
fn terms_share_a_coordinate_by_weight() {
    let whole = objective(3, &[&[0, 1], &[0, 1, 2]]);
    let [pair, three] = [objective(3, &[&[0, 1]]), objective(3, &[&[0, 1, 2]])];
    let points = points(3);
    let [both, of_pair, of_three] = [&whole, &pair, &three].map(|objective| pulls(objective, &points));
    for coordinate in 0..points.len() {
        // Both terms move by their own natural steps.
        let expected = match coordinate % 3 {
            2 => of_three[coordinate],
            _ => (of_pair[coordinate] + 2.0 * of_three[coordinate]) / 3.0,
        };
        assert!((both[coordinate] - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{coordinate}");
    }
}

/// Samples that nobody demands neither move nor push.
#[test]
fn a_demand_leaves_out_samples() {
    let pixels: Vec<bool> = (0..EXTENT.sites()).map(|site| site % 9 < 5 && site % 4 != 1).collect();
    let demand = Demand::new([3, 4, 9], pixels.clone(), vec![vec![0, 1]]).unwrap();
    let domains = [Domain::Interval; 2];
    let objective =
        Objective::for_demand(&Config::new(EXTENT, 2).with_terms(terms(&[&[0, 1]])), &demand).unwrap();
    let start = points(2);
    let mut moved = start.clone();
    let gradient = objective.cramer(&widened(&start)).unwrap().gradient;
    let found = pulls(&objective, &moved);
    for (coordinate, (&slope, &pull)) in gradient.iter().zip(&found).enumerate() {
        let wanted = pixels[coordinate / 4];
        assert_eq!((slope != 0.0, pull != 0.0), (wanted, wanted), "{coordinate}");
        assert!(!wanted || slope * f64::from(pull) < 0.0 || slope.abs() < 1e-5, "{coordinate}");
    }
    let mut sweeper = Sweeper::new(&objective, &Sweeps::default()).unwrap();
    sweeper.load(&moved);
    sweeper.shuffle(1, 0);
    for step in 0..sweeper.steps() {
        sweeper.step(step, Motion { rate: 1.0, ..still() }, &domains);
    }
    sweeper.store(&mut moved);
    for (coordinate, (before, after)) in start.iter().zip(&moved).enumerate() {
        assert_eq!(before != after, pixels[coordinate / 4], "{coordinate}");
    }
}

/// The same bits with and without the processor's vectors.
#[test]
fn instruction_sets_agree() {
    let objective = objective(5, &[&[0, 1], &[2], &[0, 1, 2], &[1, 2, 3, 4], &[0, 1, 2, 3, 4]]);
    let points = points(5);
    let mut sweeper = Sweeper::new(&objective, &Sweeps::default()).unwrap();
    sweeper.load(&points);
    sweeper.shuffle(1, 0);
    let (mut plain, mut vectors) = (vec![[0.0; 16]; 3 * 5], vec![[0.0; 16]; 3 * 5]);
    for run in 0..8 {
        let runs = [3 * run, 3 * run + 1, 3 * run + 2];
        sweeper.pulls_of_runs(&runs, &mut plain).call();
        pulp::Arch::new().dispatch(sweeper.pulls_of_runs(&runs, &mut vectors));
        assert_eq!(plain, vectors, "{runs:?}");
    }
}

#[test]
fn terms_without_a_closed_form_are_named() {
    let torus = [Domain::Interval, Domain::Torus];
    let config = Config::new(EXTENT, 2).with_domains(torus.to_vec()).with_terms(terms(&[&[0], &[0, 1]]));
    let objective = Objective::new(&config).unwrap();
    let error = objective.cramer(&widened(&points(2))).unwrap_err();
    let closed = |error: &_| matches!(error, ConfigError::NotInClosedForm { term: 1, .. });
    assert!(matches!(&error, ObjectiveError::Config(error) if closed(error)), "{error}");
    assert_eq!(
        error.to_string(),
        "term 1 cannot be swept, since it sees a dimension that is a torus: use slices"
    );
    let mut pixels = terms(&[&[0, 1]]);
    pixels[0].classes = Classes::PerFrame;
    let objective = Objective::new(&Config::new(EXTENT, 2).with_terms(pixels)).unwrap();
    assert!(matches!(check(&objective), Err(ConfigError::NotInClosedForm { term: 0, .. })));
}

#[test]
fn mean_projections_are_those_of_random_directions() {
    // Γ(d/2) / (√π Γ((d+1)/2)) by hand.
    let expected = [1.0, 2.0 / std::f64::consts::PI, 0.5, 4.0 / (3.0 * std::f64::consts::PI), 0.375];
    for (dims, expected) in (1..).zip(expected) {
        assert!((mean_projection(dims) - expected).abs() < 1e-15, "{dims}");
    }
}
