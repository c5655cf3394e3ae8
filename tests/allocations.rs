//! Steps work in buffers that the first ones have made, and those are few.

use allocation_counter::measure;
use fsot::config::Work;
use fsot::{Config, Extent, Optimizer, Until};

/// Allocations of 64 steps and 4 sweeps, after 64 times as many have grown the buffers to the largest
/// subsets.
fn allocations(extent: Extent) -> u64 {
    let mut optimizer = Optimizer::new(Config::new(extent, 2)).unwrap();
    let mut work = || {
        (0..64).for_each(|_| {
            _ = optimizer.step(0.1, 1.0).unwrap();
        });
        (0..4).for_each(|_| _ = optimizer.sweep(0.1, 1.0).unwrap());
    };
    one_thread().install(|| {
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

/// The counter is that of its thread: all work happens on this one.
fn one_thread() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap()
}

#[test]
fn the_peak_of_a_run_is_a_small_multiple_of_the_table() {
    let extent = Extent { frames: 64, height: 64, width: 64, spp: 1 };
    let table = (extent.samples() * 2 * size_of::<f32>()) as f64;
    for (slices_per_class, sweeps, most) in [(2, 0, 10.5), (0, 1, 6.5), (2, 1, 10.5)] {
        let peak = one_thread().install(|| {
            measure(|| {
                let mut optimizer = Optimizer::new(Config::new(extent, 2)).unwrap();
                let work = Until::Work(Work { slices_per_class, sweeps, ..Work::default() });
                optimizer.run(work).unwrap();
            })
            .bytes_max
        });
        // The table, and either the sweep's copy (3) and ranks, or the pulls (2), the buffers of the
        // whole-table slice (2), the orders of visits (0.5 for each of four filters), the draws of a step and
        // what is in flight (2, less of a larger table).
        let multiple = peak as f64 / table;
        assert!(multiple < most, "{slices_per_class} slices, {sweeps} sweeps: {multiple:.2} times the table");
    }
}
