//! Facts about planned families, each against its definition.

use super::*;
use crate::kernel::{Kernel, SpatialKernel, Tap, TemporalKernel};
use crate::table::extent::Extent;
use crate::table::extent::Site;

const EXTENT: Extent = Extent { frames: 4, height: 20, width: 12, spp: 3 };

fn lattice(form: FilterForm) -> Classes {
    let spatial = SpatialKernel::Gaussian { sigma_px: 2.1 };
    Classes::Lattice { kernel: Kernel::product(spatial, TemporalKernel::Ema { alpha: 0.4 }), form }
}

/// The definition: all samples whose filter weight exceeds the level, by a search of the whole table.
fn by_definition(taps: &[Tap], member: usize, level: f64) -> Vec<u32> {
    let centre = EXTENT.site(member);
    let mut samples = Vec::new();
    for site in 0..EXTENT.sites() {
        let lands_here = |tap: &&Tap| {
            EXTENT.site_index(EXTENT.wrapped(centre, (tap.dt.into(), tap.dy.into(), tap.dx.into()))) == site
        };
        if taps.iter().find(lands_here).is_some_and(|tap| tap.weight > level) {
            samples.extend((site * 3) as u32..(site * 3 + 3) as u32);
        }
    }
    samples
}

#[test]
fn level_sets_hold_the_samples_above_the_level() {
    let family = FilterFamily::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::All).unwrap();
    let taps = family.taps().unwrap();
    let mut samples = Vec::new();
    for (member, level) in [(0, 0.0), (17, 0.3), (959, 0.5), (500, 0.999), (240, 0.01)] {
        family.select(member, level, &mut samples);
        let mut sorted = samples.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, by_definition(taps, member, level), "member {member} level {level}");
        assert!(family.sizes().contains(&samples.len()));
    }
}

/// E_z |S_z| is the sum of the relative weights; a fine midpoint rule over z is exact to one step per tap.
#[test]
fn levels_select_each_tap_as_often_as_it_weighs() {
    let family = FilterFamily::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::All).unwrap();
    let taps = family.taps().unwrap();
    let steps = 20_000;
    let mut hits = vec![0.0; EXTENT.samples()];
    let mut samples = Vec::new();
    for step in 0..steps {
        family.select(0, (step as f64 + 0.5) / steps as f64, &mut samples);
        samples.iter().for_each(|&sample| hits[sample as usize] += 1.0 / steps as f64);
    }
    for tap in taps {
        let site =
            EXTENT.wrapped(Site { frame: 0, y: 0, x: 0 }, (tap.dt.into(), tap.dy.into(), tap.dx.into()));
        let frequency = hits[EXTENT.site_index(site) * 3];
        assert!((frequency - tap.weight).abs() <= 1.0 / steps as f64, "{tap:?} {frequency}");
    }
    let mean: f64 = hits.iter().sum();
    assert!((mean - family.mean_size()).abs() < 0.05, "{mean} {}", family.mean_size());
}

#[test]
fn the_weighted_form_lists_the_support_with_its_weights() {
    let family = FilterFamily::new(&lattice(FilterForm::Weighted), EXTENT, Wanted::All).unwrap();
    let (mut samples, mut weights) = (Vec::new(), Vec::new());
    family.select(7, 0.9, &mut samples);
    family.weigh(7, &mut weights);
    assert_eq!(samples.len(), weights.len());
    assert_eq!(samples.len() as f64, family.mean_size());
    assert_eq!(weights[0], 1.0);
    assert!(weights.is_sorted_by(|a, b| a >= b));
}

#[test]
fn blocks_tile_the_table() {
    for (classes, members) in [(Classes::WholeTable, 1), (Classes::PerFrame, 4), (Classes::PerPixel, 960)] {
        let family = FilterFamily::new(&classes, EXTENT, Wanted::All).unwrap();
        assert_eq!(family.members(), members);
        let (mut all, mut samples) = (Vec::new(), Vec::new());
        for member in 0..members {
            family.select(member, 0.5, &mut samples);
            all.extend_from_slice(&samples);
        }
        assert!(all.iter().copied().eq(0..EXTENT.samples() as u32));
    }
}

#[test]
fn a_partial_demand_leaves_out_samples_and_the_classes_without_any() {
    let flags: Vec<bool> =
        (0..EXTENT.sites()).map(|site| EXTENT.site(site).frame == 1 && site % 12 < 3).collect();
    let whole = FilterFamily::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::All).unwrap();
    let part = FilterFamily::new(&lattice(FilterForm::LevelSets), EXTENT, Wanted::new(&flags)).unwrap();
    let (mut all, mut some, mut visited) = (Vec::new(), Vec::new(), Vec::new());
    part.list_visited(&mut visited);
    let mut selected = 0;
    for member in 0..EXTENT.sites() {
        whole.select(member, 0.0, &mut all);
        part.select(member, 0.0, &mut some);
        all.retain(|&sample| flags[sample as usize / 3]);
        assert_eq!(all, some);
        assert_eq!(visited.contains(&(member as u32)), !some.is_empty());
        selected += usize::from(!some.is_empty());
    }
    assert!(selected < EXTENT.sites() && selected == part.visits());
    // Every demanded sample is selected as often as before, by fewer classes.
    let wanted = flags.iter().filter(|&&flag| flag).count() as f64;
    let expected = whole.mean_size() * wanted / part.visits() as f64;
    assert!((part.mean_size() - expected).abs() < 1e-9 * expected);
}
