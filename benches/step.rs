//! One step of the optimiser: time per sample that a slice selects, for subsets of a few to a thousand
//! samples.
//!
//! `cargo bench --bench step`; the throughput is in selected samples, the sum of subset sizes over all
//! slices.

#[path = "common/selected.rs"]
mod selected;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fsot::classes::{Classes, Demand};
use fsot::config::EndReason;
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Config, Extent, Optimizer, Until};

/// A table's configuration and its name.
fn cases() -> Vec<(&'static str, Config)> {
    let still = |size, spp, dims| Config::new(Extent { frames: 1, height: size, width: size, spp }, dims);
    vec![
        ("64x64x1_2d", still(64, 1, 2)),
        ("64x64x10_2d", Config::new(Extent { frames: 10, height: 64, width: 64, spp: 1 }, 2)),
        ("64x64x1_2d_4spp", still(64, 4, 2)),
        ("32x32x1_2d_16spp", still(32, 16, 2)),
        ("64x64x1_4d", still(64, 1, 4)),
        ("64x64x1_8d", still(64, 1, 8)),
        ("256x256x1_2d", still(256, 1, 2)),
    ]
}

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for (name, config) in cases() {
        let mut optimizer = Optimizer::new(config).expect("the cases are valid");
        group.throughput(Throughput::Elements(selected::per_step(optimizer.objective()) as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| optimizer.step(0.1, 0.1).unwrap());
        });
        let table = optimizer.into_table();
        assert!(table.values().iter().all(|value| (0.0..1.0).contains(value)), "{name} left the unit cube");
    }
    group.finish();
}

/// What the kernel's form and size cost: the mean subset grows with the square of sigma.
fn sigma(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sigma");
    for sigma_px in [0.5, 1.0, 2.1, 4.0, 8.0] {
        let mut config = Config::new(Extent { frames: 1, height: 64, width: 64, spp: 1 }, 2);
        for term in &mut config.terms {
            if let Classes::Lattice { kernel, .. } = &mut term.classes {
                kernel.spatial = SpatialKernel::Gaussian { sigma_px };
                kernel.temporal = TemporalKernel::None;
            }
        }
        let mut optimizer = Optimizer::new(config).expect("the cases are valid");
        group.throughput(Throughput::Elements(selected::per_step(optimizer.objective()) as u64));
        group.bench_function(BenchmarkId::from_parameter(sigma_px), |bencher| {
            bencher.iter(|| optimizer.step(0.1, 0.1).unwrap());
        });
        let displacement = optimizer.step(0.1, 0.1).unwrap().displacement;
        assert!(displacement.is_finite() && displacement > 0.0);
    }
    group.finish();
}

/// An optimisation where all of the pixels, a disc of a tenth of them, or every tenth of them are demanded.
fn demand(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("demand");
    let extent = Extent { frames: 1, height: 64, width: 64, spp: 1 };
    let disc = |site: usize| {
        let (y, x) = (site as f64 / 64.0 - 32.0, site as f64 % 64.0 - 32.0);
        y * y + x * x < 409.6 / std::f64::consts::PI
    };
    let shapes: [(&str, &dyn Fn(usize) -> bool); 3] =
        [("all", &|_| true), ("disc", &disc), ("every_tenth", &|site| site % 10 == 0)];
    for (name, wanted) in shapes {
        let pixels = (0..extent.sites()).map(wanted).collect();
        let demand = Demand::new([1, 64, 64], pixels, vec![vec![0, 1]]).expect("the demand fits");
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut optimizer =
                    Optimizer::for_demand(Config::new(extent, 2), &demand).expect("the cases are valid");
                let report = optimizer.run(Until::SlicesPerClass(128));
                assert_eq!(report.expect("the run is valid").ended, EndReason::Finished);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, step, sigma, demand);
criterion_main!(benches);
