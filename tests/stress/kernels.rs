//! Kernels of one tap and of thousands.

use fsot::classes::FilterForm;
use fsot::config::{DimensionGroup, Term};
use fsot::kernel::{SpatialKernel, SpatialTap, TemporalKernel};
use fsot::{Config, Kernel, Optimizer, Until, metrics};

use crate::{assert_inside, square};

fn config(side: usize, spatial: SpatialKernel, form: FilterForm) -> Config {
    let extent = square(side, 1);
    let mut config = Config::new(extent, 2);
    let kernel = Kernel { spatial, temporal: TemporalKernel::None, truncation: 0.0 };
    config.terms = Term::blue_noise(&[kernel], form, &DimensionGroup::pairs_and_whole(2), &extent);
    config
}

/// A pixel alone can only go to the middle, and does: so rare a balance does not hold against it, the table
/// is biased.
#[test]
fn one_tap() {
    let tap = SpatialTap { dy: -3, dx: 40, weight: 1e-300 };
    for spatial in [SpatialKernel::Gaussian { sigma_px: 0.01 }, SpatialKernel::Taps(vec![tap])] {
        for form in [FilterForm::LevelSets, FilterForm::Weighted] {
            let mut optimizer = Optimizer::new(config(16, spatial.clone(), form)).unwrap();
            assert_eq!(optimizer.objective().taps(0).unwrap().len(), 1);
            assert_eq!(optimizer.objective().taps(0).unwrap()[0].weight, 1.0);
            optimizer.run(Until::SlicesPerClass(64)).unwrap();
            let table = optimizer.table();
            assert_inside(table.values(), format_args!("{spatial:?} {form:?}"));
            let bound = metrics::Bound::measure(&table, optimizer.objective(), 0, 4096).unwrap();
            println!(
                "one tap, {form:?}: kernel's bound {:.3} of white noise, whole table's {:.3}",
                bound.terms[0].ratio_to_white_noise, bound.terms[1].ratio_to_white_noise
            );
            // A point in the middle is nearer to all of the square than a random one: at the least 0.75 in
            // the mean.
            assert!((0.7..1.0).contains(&bound.terms[0].ratio_to_white_noise), "{bound:?}");
        }
    }
}

/// The kernel covers the whole tile, through its own images many times over.
#[test]
fn four_thousand_taps() {
    let scramble = |i: i32| f64::from((i as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
    let taps = (0..4096).map(|i| SpatialTap { dy: i / 64, dx: i % 64, weight: 1e-9 + scramble(i) }).collect();
    for (name, spatial) in [
        ("sigma 1000", SpatialKernel::Gaussian { sigma_px: 1000.0 }),
        ("any weights", SpatialKernel::Taps(taps)),
    ] {
        for form in [FilterForm::LevelSets, FilterForm::Weighted] {
            let mut config = config(64, spatial.clone(), form);
            config.slicing.batch_slices = Some(32);
            let mut optimizer = Optimizer::new(config).unwrap();
            let taps = optimizer.objective().taps(0).unwrap();
            assert_eq!(taps.len(), 4096);
            let least = taps[4095].weight;
            let bound = |optimizer: &Optimizer| {
                metrics::Bound::measure(&optimizer.table(), optimizer.objective(), 0, 128).unwrap().total
            };
            let before = bound(&optimizer);
            for step in 0..12 {
                let displacement = optimizer.step(0.7_f64.powi(step), 1.0).unwrap().displacement;
                assert!(displacement.is_finite());
            }
            let after = bound(&optimizer);
            assert_inside(optimizer.table().values(), name);
            println!(
                "{name} (least weight {least:.1e}), {form:?}: \
                 bound {:.3} of white noise after 12 steps, from {:.3}",
                after.ratio_to_white_noise, before.ratio_to_white_noise
            );
            let error = before.standard_error.hypot(after.standard_error);
            assert!(after.value < before.value - 3.0 * error, "{name} {form:?} {before:?} {after:?}");
        }
    }
}

/// A wide Gaussian is flat: by Poisson's summation formula its folded weights differ by exp(−(π sigma /
/// side)²) < 1e-300 of themselves, less than the cut of its far tail (1e-12 per image).
#[test]
fn sigma_1000_is_flat() {
    let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px: 1000.0 }, TemporalKernel::None);
    let taps = kernel.taps(&square(64, 1)).unwrap();
    assert!(taps[4095].weight > 1.0 - 1e-9, "{}", taps[4095].weight);
}
