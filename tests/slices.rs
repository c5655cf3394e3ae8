//! The slices that an optimisation draws: every class once an epoch, levels and angles evenly, samples as
//! often as they weigh.

use std::f64::consts::PI;

use fsot::classes::Classes;
use fsot::config::Role;
use fsot::objective::Slice;
use fsot::{Config, Extent, Objective};

const EXTENT: Extent = Extent { frames: 4, height: 16, width: 24, spp: 1 };
/// Steps of an epoch: a batch is a sixteenth of it, less what the balance takes.
const STEPS: u64 = 20;

fn objective() -> Objective {
    Objective::new(&Config::new(EXTENT, 2).with_companions(false)).unwrap()
}

fn draws(role: Role, steps: u64) -> Vec<Slice> {
    let objective = objective();
    (0..steps).flat_map(|step| objective.draw(9, step, role)).collect()
}

#[test]
fn an_epoch_visits_every_class_once_in_random_order() {
    let visits: Vec<usize> = draws(Role::Descend, STEPS).chunks(16).map(|subset| subset[0].member).collect();
    let epoch = &visits[..EXTENT.sites()];
    let mut sorted = epoch.to_vec();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..EXTENT.sites()));
    // Ascents of a random permutation: half of the pairs, with variance (n + 1) / 12; five deviations.
    let ascents = epoch.windows(2).filter(|pair| pair[0] < pair[1]).count() as f64;
    let pairs = EXTENT.sites() as f64;
    assert!((ascents - pairs / 2.0).abs() < 5.0 * (pairs / 12.0).sqrt(), "{ascents} of {pairs}");
}

#[test]
fn levels_fill_their_strata_up_to_the_maximum() {
    let objective = objective();
    for step in 0..8 {
        let slices = objective.draw(9, step, Role::Descend);
        let mut levels: Vec<f64> = slices.chunks(16).map(|subset| subset[0].level).collect();
        levels.sort_unstable_by(f64::total_cmp);
        let strata = levels.len() as f64;
        for (stratum, level) in levels.iter().enumerate() {
            assert_eq!((level * strata) as usize, stratum, "step {step}");
        }
    }
}

#[test]
fn samples_are_selected_as_often_as_they_weigh() {
    let objective = objective();
    let taps = objective.taps(0).unwrap();
    let slices = draws(Role::Descend, 4 * STEPS);
    let subsets = slices.chunks(16).len() as f64;
    // A tap is in the subset where the level is below its weight: a mean over stratified levels.
    for tap in taps {
        let share = slices.chunks(16).filter(|subset| tap.weight > subset[0].level).count() as f64 / subsets;
        // One stratum per step may fall on either side: an error of at most 1 in the 96 or so subsets of a
        // step.
        assert!((share - tap.weight).abs() < 1.5 / 90.0, "{tap:?} {share}");
    }
}

#[test]
fn directions_are_unit_vectors_at_even_angles() {
    let mut bins = [0_u32; 64];
    let slices = draws(Role::Descend, STEPS);
    for subset in slices.chunks(16) {
        let angle = |slice: &Slice| slice.direction[1].atan2(slice.direction[0]).rem_euclid(PI);
        for pair in subset.windows(2) {
            let step = (angle(&pair[1]) - angle(&pair[0])).rem_euclid(PI);
            assert!((step - PI / 16.0).abs() < 1e-5); // f32 components
        }
        for slice in subset {
            let length = slice.direction[0].hypot(slice.direction[1]);
            assert!((length - 1.0).abs() < 1e-6);
            bins[(angle(slice) / PI * 64.0) as usize % 64] += 1;
        }
    }
    // Phases follow a golden-ratio sequence: far more even than the 5 % of independent angles.
    let mean = slices.len() as f64 / 64.0;
    assert!(bins.iter().all(|&count| (f64::from(count) / mean - 1.0).abs() < 0.05), "{bins:?}");
}

#[test]
fn the_whole_table_and_every_frame_are_balanced() {
    let slices = draws(Role::Balance, 400);
    let config = Config::new(EXTENT, 2);
    let count = |wanted: Classes, member: usize| {
        let matches = |slice: &&Slice| (&config.terms[slice.term].classes, slice.member) == (&wanted, member);
        slices.iter().filter(matches).count()
    };
    assert!(count(Classes::WholeTable, 0) > 20);
    for frame in 0..4 {
        assert!(count(Classes::PerFrame, frame) > 20, "{frame}");
    }
}

/// Terms that draw less than one slice a step must not all wait, nor all draw together.
#[test]
fn many_rare_terms_take_turns() {
    let extent = Extent { frames: 1, height: 4, width: 4, spp: 1 };
    let objective = Objective::new(&Config::new(extent, 64)).unwrap();
    let counts: Vec<usize> = (0..64).map(|step| objective.draw(0, step, Role::Descend).len()).collect();
    // One batch is 16 slices, one subset; give or take a few terms that fire early or late.
    let total: usize = counts.iter().sum();
    assert!((900..=1100).contains(&total), "{counts:?}");
    assert!(counts.iter().all(|&count| count <= 5 * 16), "{counts:?}");
}
