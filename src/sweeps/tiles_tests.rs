use super::*;
use crate::kernel::{Kernel, SpatialKernel, TemporalKernel, autocorrelation};
use crate::random;

fn taps(extent: &Extent) -> Vec<Tap> {
    let kernel = Kernel::product(
        SpatialKernel::Gaussian { sigma_px: 1.5 },
        TemporalKernel::Gaussian { sigma_frames: 1.0 },
    );
    autocorrelation(&kernel.taps(extent).unwrap(), extent, 0.007).unwrap()
}

/// Shapes that are cut evenly, unevenly, in time, and hardly; demanded whole, and in a part that runs over
/// the edge.
fn cases() -> Vec<Tiles> {
    let mut cases = Vec::new();
    for (frames, height, width, spp) in [
        (1, 32, 32, 1),
        (16, 16, 16, 1),
        (1, 18, 23, 2),
        (32, 3, 2, 1),
        (5, 1, 1, 3),
        (2, 7, 40, 1),
        (4, 16, 16, 1),
    ] {
        let extent = Extent { frames, height, width, spp };
        let flags = (0..extent.sites()).map(|site| site % 5 != 1 && (site % width) * 2 / width.max(2) != 1);
        // Two frames, which lie at both ends where there are more.
        let frames = (0..extent.sites()).map(|site| (site / (height * width) + 1) % frames < 2);
        let [flags, frames] =
            [flags.collect::<Vec<bool>>(), frames.collect()].map(|wanted| Wanted::new(&wanted));
        for wanted in [Wanted::All, flags, frames] {
            cases.push(Tiles::new(extent, 2, &taps(&extent), &wanted));
        }
    }
    cases
}

fn points(tiles: &Tiles, seed: u64) -> Vec<f32> {
    random::uniforms(seed, tiles.extent.samples() * tiles.dims)
}

/// Whether every copy of a demanded sample is what a table has.
fn assert_copies(tiles: &Tiles, points: &[f32]) {
    let mut fresh = tiles.clone();
    fresh.load(points);
    let stride = tiles.planes();
    for (index, (Cell(found), Cell(expected))) in tiles.values.iter().zip(&fresh.values).enumerate() {
        for lane in 0..LANES {
            // What nobody demands may move unseen.
            let flag =
                stride > tiles.dims && tiles.values[index / stride * stride + tiles.dims].0[lane] == 0.0;
            assert!(flag || found[lane] == expected[lane], "{:?} {index} {lane}", tiles.extent);
        }
    }
}

#[test]
fn what_is_loaded_is_stored() {
    for mut tiles in cases() {
        let (given, mut found) = (points(&tiles, 1), points(&tiles, 2));
        let before = found.clone();
        tiles.load(&given);
        tiles.store(&mut found);
        for (index, value) in found.iter().enumerate() {
            let wanted = tiles.wanted.site(index / 2 / tiles.extent.spp);
            assert_eq!(*value, if wanted { given[index] } else { before[index] }, "{:?}", tiles.extent);
        }
    }
}

#[test]
fn every_demanded_sample_is_in_one_run() {
    for tiles in cases() {
        let mut held = vec![0; tiles.extent.samples()];
        for run in (0..tiles.runs()).map(|index| tiles.run(index)) {
            run.lanes().for_each(|lane| held[tiles.sample(run, lane)] += 1);
        }
        let wanted = |sample: usize| usize::from(tiles.wanted.site(sample / tiles.extent.spp));
        assert!(held.into_iter().eq((0..tiles.extent.samples()).map(wanted)), "{:?}", tiles.extent);
    }
}

#[test]
fn copies_follow_what_moves() {
    for mut tiles in cases() {
        let mut table = points(&tiles, 3);
        tiles.load(&table);
        for index in 0..tiles.runs() {
            let run = tiles.run(index);
            let motion = std::array::from_fn(|lane| 0.01 * (lane as f32 - 7.0) + 1e-4 * index as f32);
            tiles.shift(run, index % 2, &motion, Domain::Interval);
        }
        tiles.store(&mut table);
        assert_copies(&tiles, &table);
        // All at once.
        tiles.for_each_row(|CellRow { cells, stride, .. }| {
            for cell in cells.chunks_exact_mut(stride) {
                cell[1].0 = cell[1].0.map(|value| value * value);
            }
        });
        let squares: Vec<f32> =
            table.iter().enumerate().map(|(i, x)| if i % 2 == 1 { x * x } else { *x }).collect();
        tiles.store(&mut table);
        let wanted = |index: usize| tiles.wanted.site(index / 2 / tiles.extent.spp);
        assert!((0..table.len()).all(|index| !wanted(index) || table[index] == squares[index]));
        assert_copies(&tiles, &table);
    }
}

/// A part of a picture costs a part: sixteen tiles of the part, not of the whole.
#[test]
fn a_compact_demand_is_cut_by_itself() {
    let extent = Extent::still(64, 64);
    // Sixteen rows and columns around the corner.
    let wanted = |site: usize| [site / 64, site % 64].iter().all(|&at| !(8..56).contains(&at));
    let wanted = Wanted::new(&(0..extent.sites()).map(wanted).collect::<Vec<bool>>());
    let tiles = Tiles::new(extent, 2, &taps(&extent), &wanted);
    assert_eq!(tiles.runs(), 16);
    assert!((0..16).all(|index| tiles.run(index).lanes().count() == LANES));
}

#[test]
fn lanes_are_far_apart() {
    let extent = Extent::still(64, 64);
    let tiles = Tiles::new(extent, 2, &taps(&extent), &Wanted::All);
    assert_eq!(tiles.axes.each_ref().map(Axis::tiles), [1, 4, 4]);
}
