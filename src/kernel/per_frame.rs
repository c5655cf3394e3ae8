//! Filters whose taps in space change from frame to frame.

use std::collections::BTreeMap;

use super::spatial::{SpatialTap, folded_taps};
use super::taps::{Tap, drop_below, maximum, to_unit};
use super::temporal::TemporalKernel;
use crate::error::KernelError;
use crate::table::extent::Extent;

/// The taps in the order of their offsets; those below a share of the largest are left out.
pub(super) fn taps(
    frames: &[Vec<SpatialTap>],
    temporal: &TemporalKernel,
    truncation: f64,
    extent: &Extent,
) -> Result<Vec<Tap>, KernelError> {
    let mut in_space = frames.iter().map(|taps| folded_taps(taps, extent)).collect::<Result<Vec<_>, _>>()?;
    let Some(last) = in_space.len().checked_sub(1) else {
        return Err(KernelError::Empty { kernel: "the spatial kernel" });
    };
    // Products of large or small weights would leave the range of numbers: one scale for all frames.
    let largest = in_space.iter().map(maximum).fold(0.0, f64::max);
    let (_, exponent) = libm::frexp(largest);
    for weight in in_space.iter_mut().flat_map(BTreeMap::values_mut) {
        *weight = libm::scalbn(*weight, -exponent);
    }
    // What each list weighs at each offset in time, once around the animation or more often.
    let mut in_time = vec![BTreeMap::new(); in_space.len()];
    for (back, weight) in temporal.taps()?.into_iter().enumerate() {
        let offset = -((back % extent.frames) as i32);
        *in_time[back.min(last)].entry(offset).or_insert(0.0) += weight;
    }
    let (_, exponent) = libm::frexp(in_time.iter().map(maximum).fold(0.0, f64::max));
    let mut folded = BTreeMap::new();
    for (in_space, in_time) in in_space.iter().zip(&in_time) {
        for (&dt, &of_frame) in in_time {
            for (&(dy, dx), &weight) in in_space {
                let weight = libm::scalbn(of_frame, -exponent) * weight;
                *folded.entry((dt, dy, dx)).or_insert(0.0) += weight;
            }
        }
    }
    if maximum(&folded) <= 0.0 {
        return Err(KernelError::Empty { kernel: "the product of the kernels in space and in time" });
    }
    to_unit(&mut folded);
    drop_below(&mut folded, truncation);
    let largest = maximum(&folded);
    let taps = folded.into_iter().filter(|(_, weight)| *weight > 0.0);
    Ok(taps.map(|((dt, dy, dx), weight)| Tap { dt, dy, dx, weight: weight / largest }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Kernel, SpatialKernel};

    const TILE: Extent = Extent { frames: 6, height: 16, width: 16, spp: 1 };

    fn stencil(weights: &[[f64; 3]; 3]) -> Vec<SpatialTap> {
        let at = |row: usize, column: usize| SpatialTap {
            dy: row as i32 - 1,
            dx: column as i32 - 1,
            weight: weights[row][column],
        };
        (0..9).map(|tap| at(tap / 3, tap % 3)).collect()
    }

    #[test]
    fn equal_lists_are_a_product() {
        let binomial = stencil(&[[1.0, 2.0, 1.0], [2.0, 4.0, 2.0], [1.0, 2.0, 1.0]]);
        for temporal in [
            TemporalKernel::None,
            TemporalKernel::Box { frames: 4 },
            TemporalKernel::Ema { alpha: 0.2 },
            TemporalKernel::Taps(vec![1e-200, 3e-200]),
        ] {
            for lists in 1..4 {
                let kernel = |spatial| Kernel::product(spatial, temporal.clone()).taps(&TILE).unwrap();
                let expected = kernel(SpatialKernel::Taps(binomial.clone()));
                let found = kernel(SpatialKernel::PerFrame(vec![binomial.clone(); lists]));
                assert_eq!(found.len(), expected.len(), "{temporal:?}");
                for (found, expected) in found.iter().zip(&expected) {
                    assert_eq!((found.dt, found.dy, found.dx), (expected.dt, expected.dy, expected.dx));
                    // Rounded in another order.
                    assert!((found.weight - expected.weight).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn lists_are_taken_frame_by_frame_and_the_last_goes_on() {
        let point = |dx, weight| vec![SpatialTap { dy: 0, dx, weight }];
        let spatial = SpatialKernel::PerFrame(vec![point(0, 4.0), point(1, 2.0), point(2, 1.0)]);
        let taps = |temporal| Kernel::product(spatial.clone(), temporal).taps(&TILE).unwrap();
        let seen = |temporal| -> Vec<(i32, i32, f64)> {
            taps(temporal).iter().map(|tap| (tap.dt, tap.dx, tap.weight)).collect()
        };
        assert_eq!(seen(TemporalKernel::None), [(0, 0, 1.0)]);
        let four = TemporalKernel::Box { frames: 4 };
        assert_eq!(seen(four), [(0, 0, 1.0), (-1, 1, 0.5), (-3, 2, 0.25), (-2, 2, 0.25)]);
        // Once around and one frame further: the current frame has taps of the first and of the last list.
        let around = seen(TemporalKernel::Box { frames: 7 });
        assert!(around.contains(&(0, 2, 0.25)) && around.contains(&(0, 0, 1.0)), "{around:?}");
    }

    #[test]
    fn a_frame_without_weight_is_refused() {
        let some = stencil(&[[1.0; 3]; 3]);
        for lists in [vec![], vec![vec![], some.clone()], vec![some, stencil(&[[0.0; 3]; 3])]] {
            let kernel = Kernel::product(SpatialKernel::PerFrame(lists), TemporalKernel::Box { frames: 2 });
            assert_eq!(kernel.taps(&TILE), Err(KernelError::Empty { kernel: "the spatial kernel" }));
        }
    }
}
