//! Filters of given weights: arrays, centred on the pixel that is filtered.

use std::collections::BTreeMap;

use ndarray::{ArrayView2, ArrayView3, Axis};

use super::{Kernel, SpatialKernel, SpatialTap, TemporalKernel};
use crate::error::{KernelError, RangeError};
use crate::table::extent::Extent;

impl Kernel {
    /// Weights `[y, x]` in space, rows from the top, and the current frame alone.
    ///
    /// An odd side is centred on the pixel that is filtered, an even one reaches one pixel further right and
    /// down, as that of [`SpatialKernel::Box`]: row `r` of `h` lies `r - (h - 1) / 2` rows below. Weights are
    /// relative; those of 0 are left out.
    ///
    /// Whoever wants to be sure that a tile is not smaller asks [`check_fit`].
    ///
    /// # Errors
    /// No weights; one that is negative or not finite; a sum that is 0 or not finite; a side beyond
    /// 2147483647.
    ///
    /// ```
    /// use fsot::{Extent, Kernel};
    /// use ndarray::array;
    ///
    /// let cross = array![[0.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 0.0]];
    /// let taps = Kernel::from_weights(cross.view())?.taps(&Extent::still(16, 16))?;
    /// assert_eq!(taps.len(), 5);
    /// assert_eq!((taps[0].dy, taps[0].dx, taps[0].weight), (0, 0, 1.0));
    /// # Ok::<(), fsot::kernel::KernelError>(())
    /// ```
    pub fn from_weights(weights: ArrayView2<'_, f64>) -> Result<Self, KernelError> {
        let weights = weights.insert_axis(Axis(0));
        check(&weights, false)?;
        let taps = taps(&weights, &mut weights.iter().copied());
        Ok(Self::product(SpatialKernel::Taps(taps), TemporalKernel::None))
    }

    /// Weights `[frame, y, x]` in space and time, the current frame first and then one frame further back
    /// each; any filter over pixels and frames. In space as [`Kernel::from_weights`].
    ///
    /// Frames may be more than an animation has, which wraps.
    ///
    /// # Errors
    /// As of [`Kernel::from_weights`]. Single frames may weigh nothing.
    ///
    /// ```
    /// use fsot::{Extent, Kernel};
    /// use ndarray::array;
    ///
    /// // What is seen of a pixel, and of the pair of pixels that begins there a frame before.
    /// let kernel = Kernel::from_frame_weights(array![[[1.0, 0.0]], [[0.5, 0.5]]].view())?;
    /// let taps = kernel.taps(&Extent::animation(4, 8, 8))?;
    /// let seen: Vec<_> = taps.iter().map(|tap| (tap.dt, tap.dx, tap.weight)).collect();
    /// assert_eq!(seen, [(0, 0, 1.0), (-1, 0, 0.5), (-1, 1, 0.5)]);
    /// # Ok::<(), fsot::kernel::KernelError>(())
    /// ```
    pub fn from_frame_weights(weights: ArrayView3<'_, f64>) -> Result<Self, KernelError> {
        check(&weights, true)?;
        let sums: Vec<f64> = weights.outer_iter().map(|frame| frame.iter().sum()).collect();
        // What stands for a frame that weighs nothing, where it is looked at alone.
        let mut together = BTreeMap::new();
        for (at, weight) in weights.outer_iter().flat_map(|frame| frame.into_iter().enumerate()) {
            *together.entry(at).or_insert(0.0) += weight;
        }
        let in_space = weights.outer_iter().zip(&sums).map(|(frame, &sum)| match sum {
            0.0 => taps(&weights, &mut together.values().copied()),
            _ => taps(&weights, &mut frame.iter().map(|weight| weight / sum)),
        });
        Ok(Self::product(SpatialKernel::PerFrame(in_space.collect()), TemporalKernel::Taps(sums)))
    }
}

impl SpatialKernel {
    /// Rows and columns from the first to the last tap of a list; `None` where taps follow a formula, which
    /// may fold.
    ///
    /// ```
    /// use fsot::Kernel;
    /// use ndarray::Array2;
    ///
    /// let kernel = Kernel::from_weights(Array2::ones((5, 4)).view())?;
    /// assert_eq!(kernel.spatial.span(), Some([5, 4]));
    /// # Ok::<(), fsot::kernel::KernelError>(())
    /// ```
    pub fn span(&self) -> Option<[usize; 2]> {
        let lists: &[Vec<SpatialTap>] = match self {
            Self::Taps(taps) => std::slice::from_ref(taps),
            Self::PerFrame(frames) => frames,
            _ => return None,
        };
        let span = |offset: fn(&SpatialTap) -> i32| {
            let offsets = || lists.iter().flatten().map(offset);
            let (first, last) = (offsets().min().unwrap_or(0), offsets().max().unwrap_or(0));
            (i64::from(last) - i64::from(first) + 1) as usize
        };
        Some([span(|tap| tap.dy), span(|tap| tap.dx)])
    }
}

/// Refuses more rows or columns of weights than a frame has, where a list of weights is meant as it stands:
/// [`Kernel::taps`] folds what lies beyond the edges of a tile, so that it comes in again from the other
/// side.
///
/// # Errors
/// [`KernelError::Oversized`].
///
/// ```
/// use fsot::Extent;
/// use fsot::kernel::check_fit;
///
/// assert!(check_fit([5, 5], &Extent::still(8, 8)).is_ok());
/// assert!(check_fit([5, 9], &Extent::still(8, 8)).is_err());
/// ```
pub fn check_fit([rows, columns]: [usize; 2], extent: &Extent) -> Result<(), KernelError> {
    let Extent { height, width, .. } = *extent;
    if rows <= height && columns <= width {
        return Ok(());
    }
    Err(KernelError::Oversized { rows, columns, height, width })
}

fn check(weights: &ArrayView3<'_, f64>, over_time: bool) -> Result<(), KernelError> {
    if weights.is_empty() {
        return Err(KernelError::NoWeights);
    }
    for &side in weights.shape() {
        let name = "the number of weights along an axis of the kernel";
        RangeError::check(i32::try_from(side).is_ok(), name, side as f64, "of at most 2147483647")?;
    }
    let bad = weights.indexed_iter().find(|(_, weight)| !(weight.is_finite() && **weight >= 0.0));
    if let Some(((frame, y, x), &weight)) = bad {
        return Err(KernelError::BadWeight { frame: over_time.then_some(frame), y, x, weight });
    }
    let sum: f64 = weights.iter().sum();
    if sum > 0.0 && sum.is_finite() { Ok(()) } else { Err(KernelError::BadSum { sum }) }
}

/// Taps of one frame's weights, row by row.
fn taps(weights: &ArrayView3<'_, f64>, of_frame: &mut dyn Iterator<Item = f64>) -> Vec<SpatialTap> {
    let (_, rows, columns) = weights.dim();
    let offset = |at: usize, len: usize| at as i32 - (len as i32 - 1) / 2;
    let placed = of_frame.enumerate().filter(|(_, weight)| *weight > 0.0);
    let tap = |(at, weight): (usize, f64)| {
        let (dy, dx) = (offset(at / columns, rows), offset(at % columns, columns));
        SpatialTap { dy, dx, weight }
    };
    placed.map(tap).collect()
}

#[cfg(test)]
mod tests {
    use ndarray::{Array2, Array3, array};

    use super::*;
    use crate::kernel::Tap;
    use crate::random;

    /// The array that taps stand for, with the filtered pixel at `centre`.
    fn as_array(taps: &[Tap], shape: [usize; 3], centre: [i32; 2]) -> Array3<f64> {
        let mut array = Array3::zeros(shape);
        for tap in taps {
            let at = [-tap.dt, tap.dy + centre[0], tap.dx + centre[1]].map(|at| at as usize);
            array[at] += tap.weight;
        }
        array
    }

    fn noise(shape: [usize; 3]) -> Array3<f64> {
        let values = random::uniforms(5, shape.iter().product());
        Array3::from_shape_vec(shape, values.into_iter().map(|value| 0.1 + f64::from(value)).collect())
            .unwrap()
    }

    /// Whatever the sides and the strides, `taps` gives the array back, up to its largest weight.
    #[test]
    fn arrays_come_back_from_their_taps() {
        for (rows, columns) in [(1, 1), (3, 3), (2, 2), (4, 3), (3, 6), (1, 8), (7, 2)] {
            let centre = [(rows as i32 - 1) / 2, (columns as i32 - 1) / 2];
            let extent = Extent::animation(6, 9, 10);
            for frames in [1, 2, 5] {
                let weights = noise([frames, rows, columns]);
                let largest = weights.iter().copied().fold(0.0, f64::max);
                let kernel = Kernel::from_frame_weights(weights.view()).unwrap();
                let taps = kernel.taps(&extent).unwrap();
                let found = as_array(&taps, [frames, rows, columns], centre) * largest;
                for (found, given) in found.iter().zip(&weights) {
                    assert!((found - given).abs() < 1e-12, "{frames} {rows} {columns}: {found} {given}");
                }
                assert_eq!(kernel.spatial.span(), Some([rows, columns]));
                let current = weights.index_axis(Axis(0), 0);
                let still = Kernel::from_weights(current).unwrap().taps(&extent).unwrap();
                let largest = current.iter().copied().fold(0.0, f64::max);
                let found = as_array(&still, [1, rows, columns], centre) * largest;
                assert!(found.iter().zip(current).all(|(found, given)| (found - given).abs() < 1e-12));
            }
        }
    }

    #[test]
    fn strides_do_not_matter() {
        let weights = noise([4, 6, 5]);
        let turned = weights.view().permuted_axes([0, 2, 1]);
        let mut mirrored = weights.view();
        for axis in [0, 2] {
            mirrored.invert_axis(Axis(axis));
        }
        let thinned = weights.view().split_at(Axis(2), 3).0;
        let views = [turned, mirrored, thinned];
        for view in views {
            let plain = Array3::from_shape_vec(view.dim(), view.iter().copied().collect()).unwrap();
            assert_eq!(Kernel::from_frame_weights(view), Kernel::from_frame_weights(plain.view()));
        }
    }

    /// A frame without weight is left out of the filter, but has taps where it is looked at alone.
    #[test]
    fn frames_may_weigh_nothing() {
        let weights = array![[[0.0, 0.0]], [[1.0, 3.0]]];
        let kernel = Kernel::from_frame_weights(weights.view()).unwrap();
        let taps = kernel.taps(&Extent::animation(4, 4, 4)).unwrap();
        assert!(taps.iter().all(|tap| tap.dt == -1) && taps.len() == 2);
        let SpatialKernel::PerFrame(frames) = kernel.spatial else { panic!() };
        assert!(frames.iter().all(|taps| taps.len() == 2), "{frames:?}");
    }

    #[test]
    fn what_is_no_kernel_is_refused() {
        let refused = |weights: Array2<f64>| Kernel::from_weights(weights.view()).unwrap_err();
        let words = |weights: Array2<f64>| refused(weights).to_string();
        assert_eq!(refused(Array2::zeros((0, 3))), KernelError::NoWeights);
        assert_eq!(refused(Array2::zeros((2, 3))), KernelError::BadSum { sum: 0.0 });
        assert_eq!(refused(array![[f64::MAX, f64::MAX]]), KernelError::BadSum { sum: f64::INFINITY });
        assert_eq!(
            words(array![[1.0, 2.0], [-3.0, 4.0]]),
            "the kernel has weight -3 at [y 1, x 0]: weights must be finite and at least 0"
        );
        assert!(words(array![[1.0, f64::NAN]]).contains("weight NaN at [y 0, x 1]"));
        assert!(words(array![[f64::INFINITY]]).contains("weight inf at [y 0, x 0]"));
        let minus = Kernel::from_frame_weights(array![[[1.0, 2.0]], [[1.0, -2.0]]].view()).unwrap_err();
        assert_eq!(minus, KernelError::BadWeight { frame: Some(1), y: 0, x: 1, weight: -2.0 });
        assert!(minus.to_string().contains("weight -2 at [frame 1, y 0, x 1]"));
        let far = Array2::from_elem((1, 1), 1.0);
        let far = far.broadcast((1, 1 << 31)).unwrap();
        assert!(matches!(Kernel::from_weights(far), Err(KernelError::Range(_))));
        let large = check_fit([1, 9], &Extent::still(7, 8)).unwrap_err();
        assert_eq!(large, KernelError::Oversized { rows: 1, columns: 9, height: 7, width: 8 });
        assert_eq!(Kernel::gaussian(50.0).spatial.span(), None);
    }
}
