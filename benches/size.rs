//! Tables of 16² to 256² pixels and 1 to 64 frames: time per selected sample, which should not grow with the
//! table.
//!
//! `cargo bench --bench size`; the throughput is in selected samples.

#[path = "common/selected.rs"]
mod selected;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fsot::{Config, Extent, Optimizer};

/// Side in pixels, frames, samples per pixel.
const SIZES: [(usize, usize, usize); 12] = [
    (16, 1, 1),
    (32, 1, 1),
    (64, 1, 1),
    (128, 1, 1),
    (256, 1, 1),
    (64, 1, 16),
    (256, 1, 16),
    (16, 8, 1),
    (64, 4, 1),
    (64, 16, 1),
    (64, 64, 1),
    (128, 64, 1),
];

fn size(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("size");
    group.sample_size(20);
    for (side, frames, spp) in SIZES {
        let name = format!("{side}x{side}x{frames}_{spp}spp");
        let extent = Extent { frames, height: side, width: side, spp };
        let mut optimizer = Optimizer::new(Config::new(extent, 2)).expect("the cases are valid");
        group.throughput(Throughput::Elements(selected::per_step(optimizer.objective()) as u64));
        let before = optimizer.step(0.5, 1.0).unwrap().displacement;
        group.bench_function(BenchmarkId::from_parameter(&name), |bencher| {
            bencher.iter(|| optimizer.step(0.5, 1.0).unwrap());
        });
        // An epoch, so that every sample has moved.
        let after = (0..16).map(|_| optimizer.step(0.5, 1.0).unwrap().displacement).sum::<f64>() / 16.0;
        assert!(after < before, "{name}: displacement {before} to {after}");
        let table = optimizer.into_table();
        assert!(table.values().iter().all(|value| (0.0..1.0).contains(value)), "{name} left the square");
    }
    group.finish();
}

criterion_group!(benches, size);
criterion_main!(benches);
