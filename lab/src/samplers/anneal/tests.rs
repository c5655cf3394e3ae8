//! The fast local changes against energies written as the papers write them.

use fsot::kernel::{Kernel, SpatialKernel, TemporalKernel};
use rand::SeedableRng;

use super::*;
use crate::samplers::Fast;

const EXTENT: Extent = Extent { frames: 3, height: 18, width: 20, spp: 1 };

/// Weights of ordered pairs of sites, from the kernels' formulas: in space, and in time at the same pixel.
fn weight(p: usize, q: usize) -> f64 {
    let (a, b) = (EXTENT.site(p), EXTENT.site(q));
    let apart = |a: usize, b: usize, len: usize| a.abs_diff(b).min(len - a.abs_diff(b)) as f64;
    let (dt, dy, dx) = (apart(a.frame, b.frame, 3), apart(a.y, b.y, 18), apart(a.x, b.x, 20));
    let in_space = (-(dy * dy + dx * dx) / (2.1 * 2.1)).exp();
    match (dt == 0.0, dy == 0.0 && dx == 0.0) {
        (true, _) if in_space >= 1e-3 => in_space,
        // The Gaussian in time wraps around three frames, images at 1, 2, 4, 5, … frames; relative to its
        // largest weight.
        (false, true) => {
            let image = |k: i32| (-f64::from(k * k) / 2.25).exp();
            let largest: f64 = (0..12).filter(|k| k % 3 == 0).map(image).sum();
            (1..12).filter(|k| k % 3 != 0).map(image).sum::<f64>() / largest
        }
        _ => 0.0,
    }
}

fn neighbours() -> Neighbours {
    let kernels = Kernel::separate(
        SpatialKernel::Gaussian { sigma_px: 2.1 },
        TemporalKernel::Gaussian { sigma_frames: 1.5 },
    );
    Neighbours::of_kernels(&kernels, &EXTENT).unwrap()
}

#[test]
fn weights_are_those_of_the_formula() {
    let neighbours = neighbours();
    let mut found = vec![0.0; EXTENT.sites()];
    let origin = EXTENT.site(0);
    for &(dt, dy, dx, weight) in &neighbours.taps {
        let site = EXTENT.wrapped(origin, (dt.into(), dy.into(), dx.into()));
        found[EXTENT.site_index(site)] += f64::from(weight);
    }
    for (site, found) in found.iter().enumerate().skip(1) {
        assert!((found - weight(0, site)).abs() < 1e-6, "{site}: {found} {}", weight(0, site));
    }
}

/// Tries proposals one at a time and holds each decision of a cold annealing against the energy of the whole.
fn check(model: &impl Model, energy: impl Fn(u32, u32) -> f64) {
    let mut ids = shuffled(&EXTENT, 5);
    let [ry, rx] = model.reach();
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut taken, mut left) = (0, 0);
    for round in 0..300 {
        let origin = [generator.random_range(0..18), generator.random_range(0..20)];
        // Every second patch has room for neighbours only.
        let (rows, columns) = if round % 2 == 0 { (3, 3) } else { (18 - ry, 20 - rx) };
        let mut patch = Patch::empty(3, rows, columns, [ry, rx]);
        let mut sites = vec![0; patch.ids.len()];
        let mut at = 0;
        patch.for_each(&EXTENT, origin, true, |id, site| *id = ids[site]);
        let mut numbers = patch.clone();
        numbers.for_each(&EXTENT, origin, true, |id, site| *id = site as u32);
        sites.iter_mut().zip(&numbers.ids).for_each(|(site, id)| *site = *id as usize);
        let work = |generator| Work { proposals: 1, temperature: 1e-30, generator };
        let (frame, [a, b]) = work(generator.clone()).pair(&patch);
        let [p, q] = [a, b].map(|[row, column]| sites[patch.at(frame, row, column)]);
        let local = |site: usize, ids: &[u32]| -> f64 {
            let others = (0..ids.len()).filter(|&other| other != site && weight(site, other) > 0.0);
            others.map(|other| weight(site, other) * energy(ids[site], ids[other])).sum()
        };
        let mut swapped = ids.clone();
        swapped.swap(p, q);
        let change = 2.0 * (local(p, &swapped) + local(q, &swapped) - local(p, &ids) - local(q, &ids));
        model.anneal(&mut patch, work(generator.clone()));
        patch.for_each(&EXTENT, origin, false, |id, site| {
            at += usize::from(ids[site] != *id);
            ids[site] = *id;
        });
        generator.random::<u64>();
        if p == q || change.abs() < 1e-4 {
            continue; // f32 may see it either way
        }
        assert_eq!(at, if change < 0.0 { 2 } else { 0 }, "round {round}: {p} {q} {change}");
        taken += usize::from(change < 0.0);
        left += usize::from(change > 0.0);
    }
    assert!(taken > 50 && left > 50, "{taken} {left}");
}

#[test]
fn pairs_are_swapped_if_the_whole_energy_falls() {
    let neighbours = neighbours();
    for dims in 1..=5 {
        let values = nets(&EXTENT, dims, 3);
        let distance = |a: u32, b: u32| {
            let of = |id: u32| &values[id as usize * dims..][..dims];
            let squares = of(a).iter().zip(of(b)).map(|(a, b)| f64::from(a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        check(&Pairs::new(&values, dims, Law::Distance, &neighbours), |a, b| -distance(a, b));
        let law = Law::Likeness { steepness: 1.0 };
        let alike = |a, b| (-distance(a, b).powf(dims as f64 / 2.0)).exp();
        check(&Pairs::new(&values, dims, law, &neighbours), alike);
    }
}

#[test]
fn vectors_are_swapped_if_the_sum_of_products_falls() {
    let vectors: Vec<f32> = nets(&EXTENT, 32, 3).iter().map(|value| value - 0.5).collect();
    let product = |a: u32, b: u32| {
        let of = |id: u32| &vectors[id as usize * 32..][..32];
        of(a).iter().zip(of(b)).map(|(a, b)| f64::from(a * b)).sum()
    };
    check(&Dots::new(&vectors, 32, &neighbours()), product);
}

#[test]
fn the_exponential_is_exact_to_a_few_roundings() {
    for i in 0..20_000 {
        let x = -f64::from(i) * 0.004;
        let relative = (f64::from(exp(x as f32)) / f64::from(x as f32).exp() - 1.0).abs();
        // The argument's rounding counts x-fold after the multiplication by log2(e).
        assert!(relative < 4e-7 + 1e-7 * x.abs(), "{x}: {relative}");
    }
    assert_eq!(exp(0.0), 1.0);
    assert!(exp(-1e30) < 1e-37);
}

/// Value stability: a change here changes tables and belongs in the CHANGELOG.
#[test]
fn the_first_numbers_are_pinned() {
    let mut fast = Fast::new(Extent { frames: 1, height: 16, width: 16, spp: 1 }, 2);
    fast.cooling.sweeps = 8;
    let table = fast.table().unwrap();
    assert_eq!(table.values()[..4], [0.108_052_25, 0.481_895_92, 0.354_194_4, 0.696_918_37]);
}
