//! How a lattice is cut into tiles: what samples of a vector have to do with each other.

use std::ops::Range;

use super::axis::Axis;
use crate::classes::Wanted;
use crate::kernel::Tap;
use crate::simd::LANES;
use crate::table::extent::Extent;

/// Cuts what is demanded of a lattice into [`LANES`] tiles along time, y and x, so that little is stored or
/// computed in vain, and the samples of a vector see as little of each other as they can.
pub(super) fn cut(extent: &Extent, taps: &[Tap], wanted: &Wanted) -> [Axis; 3] {
    let lens = [extent.frames, extent.height, extent.width];
    let windows = windows(extent, wanted);
    let offset = |tap: &Tap| [tap.dt, tap.dy, tap.dx];
    let reach =
        |axis: usize| taps.iter().map(|tap| offset(tap)[axis].unsigned_abs() as usize).max().unwrap_or(0);
    let axes = |tiles: [usize; 3]| -> [Axis; 3] {
        std::array::from_fn(|axis| {
            // Rows are read without asking where they wrap.
            let wraps = tiles[axis] == 1 && windows[axis].len() == lens[axis] && axis < 2;
            Axis::new(lens[axis], windows[axis].clone(), tiles[axis], if wraps { 0 } else { reach(axis) })
        })
    };
    let strongest = taps.iter().map(|tap| tap.weight).fold(f64::MIN_POSITIVE, f64::max);
    let cost = |axes: &[Axis; 3]| {
        // Whether some lane is as far from the first one as a tap reaches.
        let is_lane = |tap: &&Tap| {
            (0..3).all(|axis| {
                let cells = axes[axis].cells();
                let (by, len) = (offset(tap)[axis].rem_euclid(lens[axis] as i32) as usize, lens[axis]);
                let tile = by / cells;
                by.is_multiple_of(cells) && tile < axes[axis].tiles() || by == len
            })
        };
        let seen: f64 = taps.iter().filter(is_lane).map(|tap| tap.weight / strongest).sum();
        let cells: usize = axes.iter().map(Axis::cells).product();
        let stored: usize = axes.iter().map(Axis::stored).product();
        cells as f64 * (1.0 + seen) + MARGIN_COST * stored as f64
    };
    let splits = (0..=4).flat_map(|a: u32| (0..=4 - a).map(move |b| [1 << a, 1 << b, LANES >> (a + b)]));
    let best = splits.map(axes).min_by(|a, b| cost(a).total_cmp(&cost(b)));
    best.expect("there is more than one way")
}

/// What storing and loading a vector costs, next to its pull.
const MARGIN_COST: f64 = 0.02;

/// The shortest part of each axis that holds all demanded sites; it may run over the end.
fn windows(extent: &Extent, wanted: &Wanted) -> [Range<usize>; 3] {
    let lens = [extent.frames, extent.height, extent.width];
    if !wanted.is_partial() {
        return lens.map(|len| 0..len);
    }
    let mut holds = lens.map(|len| vec![false; len]);
    for site in (0..extent.sites()).filter(|&site| wanted.site(site)) {
        let site = extent.site(site);
        for (holds, at) in holds.iter_mut().zip([site.frame, site.y, site.x]) {
            holds[at] = true;
        }
    }
    holds.map(|holds| {
        // All but the longest gap, as on a circle.
        let len = holds.len();
        let at: Vec<usize> = (0..len).filter(|&at| holds[at]).collect();
        let gaps = at.iter().enumerate().map(|(i, &at_i)| {
            let next = at.get(i + 1).copied().unwrap_or(at[0] + len);
            (next - at_i, next % len)
        });
        let (gap, first) = gaps.max_by_key(|&(gap, _)| gap).unwrap_or((1, 0));
        first..first + len + 1 - gap
    })
}
