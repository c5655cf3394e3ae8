//! One and two threads: time per selected sample, and the same bits.
//!
//! `cargo bench --bench threads`; the throughput is in selected samples.

#[path = "common/selected.rs"]
mod selected;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fsot::{Config, Extent, Optimizer, SampleTable};
use rayon::{ThreadPool, ThreadPoolBuilder};

const THREADS: [usize; 2] = [1, 2];
const CASES: [(&str, Extent); 3] = [
    ("64x64x1", Extent { frames: 1, height: 64, width: 64, spp: 1 }),
    ("64x64x1_4spp", Extent { frames: 1, height: 64, width: 64, spp: 4 }),
    ("64x64x10", Extent { frames: 10, height: 64, width: 64, spp: 1 }),
];

fn threads(criterion: &mut Criterion) {
    let pools = THREADS.map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
    });
    for (name, extent) in CASES {
        let config = Config::new(extent, 2);
        let [one, two] = [&pools[0], &pools[1]].map(|pool| after_some_steps(pool, &config));
        assert!(one == two, "{name}: two threads make another table than one");
        let mut group = criterion.benchmark_group(format!("threads_{name}"));
        for (threads, pool) in THREADS.into_iter().zip(&pools) {
            let mut optimizer = Optimizer::new(config.clone()).expect("the cases are valid");
            group.throughput(Throughput::Elements(selected::per_step(optimizer.objective()) as u64));
            group.bench_function(BenchmarkId::from_parameter(threads), |bencher| {
                pool.install(|| bencher.iter(|| optimizer.step(0.1, 0.1).unwrap()));
            });
        }
        group.finish();
    }
}

fn after_some_steps(pool: &ThreadPool, config: &Config) -> SampleTable {
    pool.install(|| {
        let mut optimizer = Optimizer::new(config.clone()).expect("the cases are valid");
        (0..48).for_each(|_| _ = optimizer.step(0.5, 1.0).unwrap());
        optimizer.into_table()
    })
}

criterion_group!(benches, threads);
criterion_main!(benches);
