//! Which classes of a kernel hold demanded sites: row by row, for all pixels at once.

use std::collections::BTreeMap;

use crate::kernel::Tap;
use crate::table::extent::{Extent, Site};

/// What [`first_taps`] says of a class whose first demanded tap lies beyond so many.
pub(super) const FARTHEST: u8 = u8::MAX;

/// Weight down to which [`first_taps`] looks: a random level lies below with this probability.
const LIGHTEST: f64 = 1.0 / 64.0;

/// One flag a class: whether any of its taps lies on a flagged site.
///
/// Time grows with the rows that hold such a site and with the rows of the kernel, not with its taps.
pub(super) fn holders(taps: &[Tap], extent: &Extent, flags: &[bool]) -> Vec<bool> {
    let &Extent { height, width, .. } = extent;
    let mut holds = vec![false; flags.len()];
    let runs = runs(taps);
    // Flags up to each place of a row that is written twice, because runs go over its end.
    let mut counts = vec![0_u32; 2 * width + 1];
    for (line, row) in flags.chunks_exact(width).enumerate().filter(|(_, row)| row.contains(&true)) {
        for (place, flag) in row.iter().chain(row).enumerate() {
            counts[place + 1] = counts[place] + u32::from(*flag);
        }
        let site = Site { frame: line / height, y: line % height, x: 0 };
        for &([dt, dy], [first, last]) in &runs {
            // The class lies where the tap comes from.
            let class = extent.wrapped(site, (-i64::from(dt), -i64::from(dy), 0));
            let begin = extent.site_index(class);
            let len = ((last - first) as usize + 1).min(width);
            let shift = first.rem_euclid(width as i32) as usize;
            let (direct, wrapped) = holds[begin..begin + width].split_at_mut(width - shift);
            // Two loops, each of which the compiler turns into vectors.
            for (holds, start) in [(direct, shift), (wrapped, 0)] {
                let ends = counts[start..].iter().zip(&counts[start + len..]);
                holds.iter_mut().zip(ends).for_each(|(holds, (before, after))| *holds |= after > before);
            }
        }
    }
    holds
}

/// Per class, the place of the first tap on a flagged site, as far as taps are heavy and [`FARTHEST`] allows:
/// beyond, the place of the first tap that was not looked at.
pub(super) fn first_taps(taps: &[Tap], extent: &Extent, flags: &[bool]) -> Vec<u8> {
    let &Extent { height, width, .. } = extent;
    let heavy = taps.partition_point(|tap| tap.weight >= LIGHTEST).min(FARTHEST.into());
    let mut firsts = vec![heavy as u8; flags.len()];
    for (place, tap) in taps[..heavy].iter().enumerate() {
        let shift = tap.dx.rem_euclid(width as i32) as usize;
        for (line, firsts) in firsts.chunks_exact_mut(width).enumerate() {
            let site = Site { frame: line / height, y: line % height, x: 0 };
            let tapped = extent.site_index(extent.wrapped(site, (tap.dt.into(), tap.dy.into(), 0)));
            let (wrapped, direct) = flags[tapped..tapped + width].split_at(shift);
            let (firsts, firsts_wrapped) = firsts.split_at_mut(direct.len());
            // Two loops, each of which the compiler turns into vectors.
            for (firsts, flags) in [(firsts, direct), (firsts_wrapped, wrapped)] {
                for (first, flag) in firsts.iter_mut().zip(flags) {
                    let here = if *flag { place as u8 } else { FARTHEST };
                    *first = here.min(*first);
                }
            }
        }
    }
    firsts
}

/// Taps next to each other in a row of the kernel: its `[dt, dy]`, the first and the last `dx`.
fn runs(taps: &[Tap]) -> Vec<([i32; 2], [i32; 2])> {
    let mut rows: BTreeMap<[i32; 2], Vec<i32>> = BTreeMap::new();
    taps.iter().for_each(|tap| rows.entry([tap.dt, tap.dy]).or_default().push(tap.dx));
    let mut runs = Vec::new();
    for (row, mut columns) in rows {
        columns.sort_unstable();
        let together = columns.chunk_by(|a, b| *b - *a <= 1);
        runs.extend(together.map(|run| (row, [run[0], run[run.len() - 1]])));
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Kernel, TemporalKernel};
    use crate::random;

    /// Both against the definition, tap by tap, on extents that kernels go around.
    #[test]
    fn classes_hold_what_their_taps_lie_on() {
        for (extent, seed) in [
            (Extent { frames: 3, height: 5, width: 7, spp: 1 }, 1),
            (Extent { frames: 1, height: 1, width: 40, spp: 2 }, 2),
            (Extent { frames: 6, height: 32, width: 30, spp: 1 }, 3),
        ] {
            let kernel = Kernel::gaussian(2.1).with_temporal(TemporalKernel::Ema { alpha: 0.3 });
            let mut taps = kernel.taps(&extent).unwrap();
            // With a gap, as a caller's kernel may have.
            taps.retain(|tap| tap.dx != 1);
            for share in [0.005, 0.05, 0.6] {
                let numbers = random::uniforms(seed, extent.sites());
                let flags: Vec<bool> = numbers.into_iter().map(|number| f64::from(number) < share).collect();
                let (holders, firsts) = (holders(&taps, &extent, &flags), first_taps(&taps, &extent, &flags));
                for class in 0..extent.sites() {
                    let on = |tap: &Tap| {
                        let offset = (tap.dt.into(), tap.dy.into(), tap.dx.into());
                        flags[extent.site_index(extent.wrapped(extent.site(class), offset))]
                    };
                    let first = taps.iter().position(on);
                    assert_eq!(holders[class], first.is_some(), "{extent:?} {share} {class}");
                    let looked_at = taps.iter().filter(|tap| tap.weight >= LIGHTEST).count().min(255);
                    let expected = first.unwrap_or(usize::MAX).min(looked_at);
                    assert_eq!(usize::from(firsts[class]), expected, "{extent:?} {share} {class}");
                }
            }
        }
    }
}
