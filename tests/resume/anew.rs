//! What is lost where a run is cut in two instead of resumed: schedules begin anew.

use fsot::metrics::{FilteredError, Integrands};
use fsot::{Config, Extent, Kernel, Optimizer, SampleTable};

use super::slices;

/// As a ratio to white noise.
fn filtered_error(table: &SampleTable) -> f64 {
    let integrands = Integrands::random(2, 512, 9).unwrap();
    let errors = FilteredError::measure(table, &[0, 1], &integrands, &Kernel::gaussian(2.1)).unwrap();
    errors.spatial.mean.mean
}

/// The same integrands for all, so that their noise is common: tables of other seeds differ by less than .004
/// in each column, and a whole run from the others by .005 or more.
#[test]
fn two_halves_are_less_than_a_run() {
    for seed in 0..3 {
        let config = Config::new(Extent::still(64, 64), 2).with_seed(seed);
        let run = |mut optimizer: Optimizer, slices_per_class| {
            let report = optimizer.run(slices(slices_per_class)).unwrap();
            (optimizer.table(), optimizer.metadata(&report))
        };
        let (whole, _) = run(Optimizer::new(config.clone()).unwrap(), 2000);
        let (half, metadata) = run(Optimizer::new(config.clone()).unwrap(), 1000);
        let next = Optimizer::from_table_with(config.clone(), half.clone(), &metadata).unwrap();
        let again = Optimizer::from_table(config, half.clone()).unwrap();
        let tables = [&whole, &half, &run(next, 1000).0, &run(again, 1000).0];
        let [whole, half, next, again] = tables.map(filtered_error);
        println!("2000 {whole:.3}, 1000 {half:.3}, others {next:.3}, the same {again:.3}");
        assert!(whole < next.min(again), "seed {seed}: {whole}, {next}, {again}");
    }
}
