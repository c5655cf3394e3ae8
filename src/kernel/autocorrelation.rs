//! Autocorrelation of a kernel over the lattice: how strongly the filters of all sites hold two sites
//! together.

use super::fft::Transform;
use super::taps::{check_taps, range};
use crate::error::KernelError;
use crate::kernel::Tap;
use crate::table::extent::Extent;

/// `F(c) = Σ_p w(p) w(p + c)` at the offsets where it exceeds `truncation` times its largest value, row by
/// row.
///
/// Offsets are folded to at most half the extent either way. O(taps²) for up to 8,192 taps, O(sites · log
/// sites) for more, to 1e-13 of the largest value then; memory for one number per site, or some.
///
/// # Errors
/// An empty or oversized extent; a weight that is negative or not finite, or none above 0; weights whose
/// squares have no finite sum; a truncation outside of `[0, 1)`.
///
/// ```
/// use fsot::kernel::autocorrelation;
/// use fsot::{Extent, Kernel};
///
/// let extent = Extent::still(32, 32);
/// let pairs = autocorrelation(&Kernel::gaussian(2.1).taps(&extent)?, &extent, 0.01)?;
/// // A Gaussian's is wider by √2: the neighbour is held together as much as exp(-1 / (2 · 2.1²)) of itself.
/// let of = |dx| pairs.iter().find(|tap| (tap.dy, tap.dx) == (0, dx)).map_or(0.0, |tap| tap.weight);
/// assert!((of(1) / of(0) - (-1.0_f64 / (2.0 * 2.1 * 2.1)).exp()).abs() < 1e-3);
/// # Ok::<(), fsot::kernel::KernelError>(())
/// ```
pub fn autocorrelation(taps: &[Tap], extent: &Extent, truncation: f64) -> Result<Vec<Tap>, KernelError> {
    extent.validate(1)?;
    if !(0.0..1.0).contains(&truncation) {
        return Err(range("truncation", truncation, "in [0, 1)"));
    }
    check_taps("the list of taps", taps.iter().map(|tap| tap.weight))?;
    // The square of the sum is the sum of all values, and the largest of what is added up.
    let square = taps.iter().map(|tap| tap.weight).sum::<f64>().powi(2);
    if !square.is_normal() {
        return Err(range("the squared sum of a kernel's weights", square, "from 1e-307 to 1e308"));
    }
    let (sums, noise) = match taps.len() {
        ..=FEW => (pair_by_pair(taps, extent), 0.0),
        _ => (by_transform(taps, extent), NOISE),
    };
    let [frames, height, width] = [extent.frames, extent.height, extent.width].map(|len| len as i32);
    let fold = |at: usize, len: i32| if at as i32 > len / 2 { at as i32 - len } else { at as i32 };
    let least = truncation.max(noise) * sums[0];
    let kept = sums.iter().enumerate().filter(|&(_, &weight)| weight > least).map(|(index, &weight)| {
        let site = extent.site(index);
        Tap { dt: fold(site.frame, frames), dy: fold(site.y, height), dx: fold(site.x, width), weight }
    });
    let mut kept: Vec<Tap> = kept.collect();
    kept.sort_by_key(|tap| (tap.dt, tap.dy, tap.dx));
    Ok(kept)
}

/// Taps whose pairs are looked at one by one.
const FEW: usize = 8192;

/// What rounding leaves of a transform where there is nothing, relative to the largest value.
const NOISE: f64 = 1e-13;

/// By its definition.
fn pair_by_pair(taps: &[Tap], extent: &Extent) -> Vec<f64> {
    let lens = [extent.frames, extent.height, extent.width].map(|len| len as i32);
    let [_, height, width] = lens;
    let places: Vec<([i32; 3], f64)> = taps
        .iter()
        .map(|tap| {
            let [dt, dy, dx] = [tap.dt, tap.dy, tap.dx];
            let place = [dt.rem_euclid(lens[0]), dy.rem_euclid(lens[1]), dx.rem_euclid(lens[2])];
            (place, tap.weight)
        })
        .collect();
    let mut sums = vec![0.0; extent.sites()];
    for (a, weight) in &places {
        for (b, other) in &places {
            let wrap = |at: i32, len: i32| if at < 0 { at + len } else { at };
            let [dt, dy, dx] = std::array::from_fn(|axis| wrap(b[axis] - a[axis], lens[axis]));
            sums[((dt * height + dy) * width + dx) as usize] += weight * other;
        }
    }
    sums
}

/// By the theorem of Wiener and Khinchin.
fn by_transform(taps: &[Tap], extent: &Extent) -> Vec<f64> {
    let Extent { frames, height, width, .. } = *extent;
    let there = Transform::new(frames, height, width);
    let mut scratch = there.scratch();
    for tap in taps {
        let at = [(tap.dt, frames), (tap.dy, height), (tap.dx, width)];
        let [t, y, x] = at.map(|(by, len)| by.rem_euclid(len as i32) as usize);
        scratch.data[(t * height + y) * width + x] += tap.weight;
    }
    there.forward(&mut scratch);
    // Its axes come out reversed; and what is symmetric is its own mirror image.
    let back = Transform::new(width, height, frames);
    let scale = 1.0 / extent.sites() as f64;
    let mut again = back.scratch();
    for (power, value) in again.data.iter_mut().zip(&scratch.data) {
        *power = (scale * value.norm_sqr()).into();
    }
    drop(scratch);
    back.forward(&mut again);
    again.data.iter().map(|value| value.re).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Kernel, TemporalKernel};

    #[test]
    fn both_ways_agree() {
        let extent = Extent::animation(5, 12, 21);
        let kernel = Kernel::gaussian(2.1).with_temporal(TemporalKernel::Ema { alpha: 0.3 });
        let taps = kernel.taps(&extent).unwrap();
        let [pairs, transformed] = [pair_by_pair(&taps, &extent), by_transform(&taps, &extent)];
        for (pair, transformed) in pairs.iter().zip(&transformed) {
            assert!((pair - transformed).abs() < NOISE * pairs[0], "{pair} {transformed}");
        }
    }
}
