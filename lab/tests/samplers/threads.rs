//! The same seed gives the same bits at any number of threads, and another seed others.

use fsot::SampleTable;
use fsot_lab::samplers::{DitherMask, Fast, ScramblingKeys, Stbn, stratified};

use crate::common::tile;

#[test]
fn the_number_of_threads_changes_nothing() {
    type Maker = fn(u64) -> SampleTable;
    let makers: [(&str, Maker); 6] = [
        ("dither", |seed| {
            let mut mask = DitherMask { seed, ..DitherMask::new(tile(1, 48, 1), 3) };
            mask.cooling.sweeps = 20;
            mask.table().unwrap()
        }),
        ("fast", |seed| {
            let mut fast = Fast { seed, ..Fast::new(tile(3, 64, 1), 2) };
            fast.cooling.sweeps = 20;
            fast.table().unwrap()
        }),
        ("stbn", |seed| Stbn { seed, ..Stbn::new(tile(4, 16, 1), 1) }.table().unwrap()),
        ("stbn vectors", |seed| {
            let mut mask = Stbn { seed, ..Stbn::new(tile(4, 40, 1), 2) };
            mask.cooling.sweeps = 20;
            mask.table().unwrap()
        }),
        ("keys", |seed| {
            let mut keys = ScramblingKeys { seed, ..ScramblingKeys::new(tile(1, 48, 4), 2) };
            (keys.cooling.sweeps, keys.integrands) = (20, 16);
            keys.table().unwrap()
        }),
        ("stratified", |seed| stratified(tile(1, 8, 4), 3, seed).unwrap()),
    ];
    for (name, make) in makers {
        let on = |threads: usize, seed| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| make(seed))
        };
        let one = on(1, 7);
        assert_eq!(one, on(3, 7), "{name}");
        assert_ne!(one, on(2, 8), "{name}");
        assert!(one.values().iter().all(|value| (0.0..1.0).contains(value)), "{name}");
    }
}

#[test]
fn tiny_and_odd_tiles_are_arranged() {
    for [frames, height, width] in [[1, 1, 1], [1, 1, 9], [2, 2, 3], [1, 7, 30], [3, 16, 4]] {
        let extent = fsot::Extent { frames, height, width, spp: 1 };
        let mut mask = DitherMask::new(extent, 2);
        mask.cooling.sweeps = 10;
        let mut fast = Fast::new(extent, 1);
        fast.cooling.sweeps = 10;
        let mut keys = ScramblingKeys::new(extent, 2);
        (keys.cooling.sweeps, keys.integrands) = (10, 1);
        let made = [mask.table(), fast.table(), keys.table(), Stbn::new(extent, 1).table()];
        for (i, table) in made.into_iter().enumerate() {
            assert_eq!(table.unwrap().extent(), extent, "{i}");
        }
    }
}
