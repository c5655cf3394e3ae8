//! A table for one still picture: 64 × 64 pixels, two numbers each, whose error the eye blurs away.
//!
//! `cargo run --release --example still_table`

use fsot::metrics::{FilteredError, Integrands};
use fsot::{Config, Extent, Kernel, SampleTable, Site, Until};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The eye as a Gaussian exp(-r²/2.1²), which is also the default.
    let eye = Kernel::gaussian(2.1);
    let config = Config::new(Extent::still(64, 64), 2).with_kernel(eye.clone()).with_seed(7);
    let table = config.optimize(Until::Sweeps(100))?;

    // What a renderer reads in pixel (12, 5); the table tiles the picture.
    let [u, v] = table.sample(Site { frame: 0, y: 5, x: 12 }, 0) else { unreachable!("two dimensions") };
    println!("pixel (12, 5): {u:.4}, {v:.4}");

    // The error that is left after the blur, as a share of that of independent numbers.
    let integrands = Integrands::random(2, 64, 0)?;
    let white = SampleTable::white_noise(table.extent(), 2, 7)?;
    let filtered = |table: &SampleTable| -> Result<f64, fsot::metrics::MeasureError> {
        Ok(FilteredError::measure(table, &[0, 1], &integrands, &eye)?.spatial.mean.mean)
    };
    let (ours, noise) = (filtered(&table)?, filtered(&white)?);
    println!("filtered error {ours:.3}, of independent numbers {noise:.3}");
    assert!(ours < 0.25 && noise > 0.8);

    let folder = tempfile::tempdir()?;
    table.save(folder.path().join("table.npy"))?;
    Ok(())
}
