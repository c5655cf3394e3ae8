//! Autocorrelation of a kernel over the lattice: how strongly the filters of all sites hold two sites
//! together.

use crate::kernel::Tap;
use crate::table::extent::Extent;

/// `F(c) = Σ_p w(p) w(p + c)` at the offsets where it exceeds `truncation` times its largest value, row by
/// row.
///
/// Offsets are folded to at most half the extent either way. O(taps²), and memory for one number per site.
///
/// ```
/// use fsot::kernel::autocorrelation;
/// use fsot::{Extent, Kernel};
///
/// let extent = Extent::still(32, 32);
/// let pairs = autocorrelation(&Kernel::gaussian(2.1).taps(&extent)?, &extent, 0.01);
/// // A Gaussian's is wider by √2: the neighbour is held together as much as exp(-1 / (2 · 2.1²)) of itself.
/// let of = |dx| pairs.iter().find(|tap| (tap.dy, tap.dx) == (0, dx)).map_or(0.0, |tap| tap.weight);
/// assert!((of(1) / of(0) - (-1.0_f64 / (2.0 * 2.1 * 2.1)).exp()).abs() < 1e-3);
/// # Ok::<(), fsot::kernel::KernelError>(())
/// ```
pub fn autocorrelation(taps: &[Tap], extent: &Extent, truncation: f64) -> Vec<Tap> {
    let [frames, height, width] = [extent.frames, extent.height, extent.width].map(|len| len as i32);
    let mut sums = vec![0.0; extent.sites()];
    for a in taps {
        for b in taps {
            let wrap = |at: i32, len: i32| if at < 0 { at + len } else { at };
            let [dt, dy, dx] = [
                wrap((b.dt - a.dt) % frames, frames),
                wrap((b.dy - a.dy) % height, height),
                wrap((b.dx - a.dx) % width, width),
            ];
            sums[((dt * height + dy) * width + dx) as usize] += a.weight * b.weight;
        }
    }
    let fold = |at: usize, len: i32| if at as i32 > len / 2 { at as i32 - len } else { at as i32 };
    let least = truncation * sums[0];
    let kept = sums.iter().enumerate().filter(|&(_, &weight)| weight > least).map(|(index, &weight)| {
        let site = extent.site(index);
        Tap { dt: fold(site.frame, frames), dy: fold(site.y, height), dx: fold(site.x, width), weight }
    });
    let mut kept: Vec<Tap> = kept.collect();
    kept.sort_by_key(|tap| (tap.dt, tap.dy, tap.dx));
    kept
}
