//! Steps work in buffers that the first ones have made.

use allocation_counter::measure;
use fsot::{Config, Extent, Optimizer};

/// Allocations of 64 steps and 4 sweeps, after 64 times as many have grown the buffers to the largest subsets.
fn allocations(extent: Extent) -> u64 {
    let mut optimizer = Optimizer::new(Config::new(extent, 2)).unwrap();
    let mut work = || {
        (0..64).for_each(|_| {
            let _ = optimizer.step(0.1, 1.0);
        });
        (0..4).for_each(|_| drop(optimizer.sweep(0.1, 1.0).unwrap()));
    };
    // The counter is that of its thread: all work happens on this one.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        (0..64).for_each(|_| work());
        measure(work).count_total
    })
}

#[test]
fn nothing_is_allocated() {
    for extent in [
        Extent { frames: 1, height: 32, width: 32, spp: 1 },
        Extent { frames: 1, height: 16, width: 16, spp: 4 },
        Extent { frames: 6, height: 16, width: 16, spp: 1 },
    ] {
        assert_eq!(allocations(extent), 0, "{extent:?}");
    }
}
