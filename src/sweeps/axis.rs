//! One axis of the lattice, cut into tiles: where a site is stored, and where its copies are.

use std::ops::Range;

use crate::simd::LANES;

/// An axis of the lattice, cut into tiles of nearly equal length, one per lane along it.
///
/// A tile is stored as its *cells* and as many sites to either side of them as neighbours reach, so that a
/// neighbour in one tile is the same number of cells away as in all others. An axis of one tile may wrap
/// onto itself instead, and stores no site twice.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    len: usize,
    /// Sites that are stored to either side of the cells; 0 if the axis wraps onto itself.
    margin: usize,
    /// First site of each tile; tiles follow each other, and may be shorter than `cells`.
    starts: Vec<usize>,
    /// Sites of the part that is cut.
    window: Range<usize>,
    /// Cells of the longest tile.
    cells: usize,
}

/// Where the tiles store what they own at some cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Copies {
    pub place: usize,
    /// For each lane the part along this axis of the lane that it has a copy of, or [`NO_LANE`].
    pub of: [u8; LANES],
}

/// Added to others it remains more than any lane.
pub(super) const NO_LANE: u8 = 64;

impl Axis {
    /// Cuts the sites of `window` (which may run over the end of the axis) into `tiles`, with a margin for
    /// neighbours. Without one the axis wraps, and there may be one tile alone, of the whole axis.
    pub(super) fn new(len: usize, window: Range<usize>, tiles: usize, margin: usize) -> Self {
        let start = |tile: usize| window.start + window.len() * tile / tiles;
        let starts: Vec<usize> = (0..tiles).map(start).collect();
        let cells = (0..tiles).map(|tile| start(tile + 1) - start(tile)).max().unwrap_or(1).max(1);
        Self { len, margin, starts, window, cells }
    }

    pub(super) fn tiles(&self) -> usize {
        self.starts.len()
    }

    pub(super) fn cells(&self) -> usize {
        self.cells
    }

    /// Places of a tile.
    pub(super) fn stored(&self) -> usize {
        self.cells + 2 * self.margin
    }

    /// Places of the cells.
    pub(super) fn own_places(&self) -> Range<usize> {
        self.margin..self.margin + self.cells
    }

    /// Place of what is `offset` sites after a cell.
    #[inline(always)]
    pub(super) fn place(&self, cell: usize, offset: i32) -> usize {
        if self.margin == 0 {
            (cell as i64 + i64::from(offset)).rem_euclid(self.len as i64) as usize
        } else {
            (cell + self.margin).wrapping_add_signed(offset as isize)
        }
    }

    /// The site that a tile stores at a place.
    pub(super) fn site(&self, tile: usize, place: usize) -> usize {
        let before = self.margin.next_multiple_of(self.len) - self.margin;
        (self.starts[tile] + before + place) % self.len
    }

    /// Whether a cell belongs to the tile, and not to the next one.
    pub(super) fn owns(&self, tile: usize, cell: usize) -> bool {
        let next = self.starts.get(tile + 1).copied().unwrap_or(self.window.end);
        self.starts[tile] + cell < next
    }

    /// The tile that owns a site, and its cell there; `None` outside the window.
    pub(super) fn owner(&self, site: usize) -> Option<[usize; 2]> {
        let at = if site < self.window.start { site + self.len } else { site };
        let tile = self.starts.partition_point(|&start| start <= at).checked_sub(1)?;
        let cell = at - self.starts[tile];
        self.owns(tile, cell).then_some([tile, cell])
    }

    /// The copies of every cell, its own place first. `tile` tells that of a lane, and the next lane along
    /// the axis is `stride` lanes away.
    pub(super) fn copies(&self, tile: impl Fn(usize) -> usize, stride: usize) -> Vec<Vec<Copies>> {
        let mut copies: Vec<Vec<Copies>> = vec![Vec::new(); self.cells];
        for place in (self.margin..self.stored()).chain(0..self.margin) {
            for lane in 0..LANES {
                let Some([tile, cell]) = self.owner(self.site(tile(lane), place)) else { continue };
                if copies[cell].last().is_none_or(|last| last.place != place) {
                    copies[cell].push(Copies { place, of: [NO_LANE; LANES] });
                }
                if let Some(last) = copies[cell].last_mut() {
                    last.of[lane] = (tile * stride) as u8;
                }
            }
        }
        copies
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length, window, tiles, margin.
    const CASES: [(usize, (usize, usize), usize, usize); 8] = [
        (64, (0, 64), 4, 6),
        (50, (0, 50), 4, 6),
        (3, (0, 3), 4, 1),
        (1, (0, 1), 16, 0),
        (10, (0, 10), 1, 0),
        (17, (0, 17), 2, 8),
        // Over the end.
        (20, (14, 27), 4, 5),
        (20, (3, 4), 1, 7),
    ];

    fn axes() -> impl Iterator<Item = (Axis, usize, Range<usize>, usize)> {
        CASES.into_iter().map(|(len, (from, to), tiles, margin)| {
            (Axis::new(len, from..to, tiles, margin), len, from..to, margin)
        })
    }

    #[test]
    fn every_site_of_the_window_has_one_owner() {
        for (axis, len, window, _) in axes() {
            let mut owned = vec![0; len];
            for (tile, cell) in
                (0..axis.tiles()).flat_map(|tile| (0..axis.cells()).map(move |cell| (tile, cell)))
            {
                if axis.owns(tile, cell) {
                    let site = axis.site(tile, axis.place(cell, 0));
                    assert_eq!(axis.owner(site), Some([tile, cell]));
                    owned[site] += 1;
                }
            }
            let expected =
                (0..len).map(|site| usize::from(window.contains(&site) || window.contains(&(site + len))));
            assert!(owned.into_iter().eq(expected), "{axis:?}");
        }
    }

    #[test]
    fn neighbours_are_as_far_away_in_every_tile() {
        for (axis, len, _, margin) in axes() {
            let reach = if margin == 0 { len as i32 / 2 } else { margin as i32 };
            for (tile, cell) in
                (0..axis.tiles()).flat_map(|tile| (0..axis.cells()).map(move |cell| (tile, cell)))
            {
                for offset in (-reach..=reach).filter(|_| margin > 0 || axis.tiles() == 1) {
                    let own = axis.site(tile, axis.place(cell, 0)) as i32;
                    let site = axis.site(tile, axis.place(cell, offset)) as i32;
                    assert_eq!(
                        site,
                        (own + offset).rem_euclid(len as i32),
                        "{axis:?} {tile} {cell} {offset}"
                    );
                }
            }
        }
    }
}
