//! A slice: time per selected sample by the size of the subset and the dimensions, on one thread.
//!
//! `cargo bench --bench slice`; the throughput is in selected samples: 100 Melem/s are 10 ns each. The
//! kernels are the nearest `n` pixels with equal weights, so that every slice selects exactly `n` samples.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fsot::classes::{Classes, FilterForm};
use fsot::config::{Role, Term};
use fsot::kernel::{SpatialKernel, SpatialTap, TemporalKernel};
use fsot::optimizer::SliceStep;
use fsot::targets::Target;
use fsot::{Config, Extent, Kernel, Optimizer};

const SIDE: usize = 64;
const SIZES: [usize; 11] = [1, 2, 4, 8, 14, 36, 64, 155, 256, 1024, SIDE * SIDE];
const DIMS: [usize; 4] = [1, 2, 4, 8];
/// Samples that a step selects, about.
const SELECTED: usize = 1 << 16;

fn slice(criterion: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    for dims in DIMS {
        let mut group = criterion.benchmark_group(format!("slice_{dims}d"));
        for size in SIZES {
            let mut optimizer = Optimizer::new(config(size, dims)).expect("the cases are valid");
            let SliceStep { displacement: before, slices, .. } =
                one_thread.install(|| optimizer.step(0.5, 1.0).unwrap());
            assert_eq!(slices as usize, slices_per_step(size));
            group.throughput(Throughput::Elements(slices * size as u64));
            group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
                one_thread.install(|| bencher.iter(|| optimizer.step(0.5, 1.0).unwrap()));
            });
            let after = one_thread.install(|| {
                (0..8).map(|_| optimizer.step(0.5, 1.0).unwrap().displacement).sum::<f64>() / 8.0
            });
            assert!(after < before, "{size} samples in {dims} dimensions: displacement {before} to {after}");
            let table = optimizer.into_table();
            assert!(table.values().iter().all(|value| (0.0..1.0).contains(value)), "values left the cube");
        }
        group.finish();
    }
}

fn slices_per_step(size: usize) -> usize {
    (SELECTED / size).next_multiple_of(16)
}

/// One term, whose subsets hold `size` samples at every level.
fn config(size: usize, dims: usize) -> Config {
    let kernel = Kernel::product(SpatialKernel::Taps(nearest(size)), TemporalKernel::None);
    let term = Term {
        classes: Classes::Lattice { kernel, form: FilterForm::LevelSets },
        target: Target::UniformCube,
        dims: (0..dims).collect(),
        weight: 1.0,
        role: Role::Descend,
    };
    let mut config = Config::new(Extent { frames: 1, height: SIDE, width: SIDE, spp: 1 }, dims);
    config.terms = vec![term];
    config.slicing.batch_slices = Some(slices_per_step(size));
    config
}

/// The offsets of the `size` pixels next to a pixel, itself included.
fn nearest(size: usize) -> Vec<SpatialTap> {
    let half = SIDE as i32 / 2;
    let offsets = (1 - half..=half).flat_map(|dy| (1 - half..=half).map(move |dx| (dy, dx)));
    let mut taps: Vec<SpatialTap> = offsets.map(|(dy, dx)| SpatialTap { dy, dx, weight: 1.0 }).collect();
    taps.sort_by_key(|tap| tap.dy * tap.dy + tap.dx * tap.dx);
    taps.truncate(size);
    taps
}

criterion_group!(benches, slice);
criterion_main!(benches);
