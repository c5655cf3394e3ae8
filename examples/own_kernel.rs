//! A kernel of one's own, weight by weight: the 3 × 3 tent of a cheap resolve, with the last two frames.
//!
//! `cargo run --release --example own_kernel`

use fsot::kernel::TemporalKernel;
use fsot::metrics::{FilteredError, Integrands, MeasureError};
use fsot::{Config, Extent, Kernel, Until};
use ndarray::array;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tent = array![[1.0, 2.0, 1.0], [2.0, 4.0, 2.0], [1.0, 2.0, 1.0]];
    // The current frame first.
    let history = TemporalKernel::Taps(vec![0.5, 0.3, 0.2]);
    let kernel = Kernel::from_weights(tent.view())?.with_temporal(history);

    let extent = Extent::animation(8, 32, 32);
    // The tap that weighs most is 1.
    assert_eq!(kernel.taps(&extent)?.len(), 27);
    let integrands = Integrands::random(2, 32, 0)?;
    // A table made for this kernel, and one made for the eye at 60 frames per second, behind it.
    let [own, other] = [Config::new(extent, 2).with_kernel(kernel.clone()), Config::new(extent, 2)]
        .map(|config| config.optimize(Until::Sweeps(40)));
    let error = |table| -> Result<f64, MeasureError> {
        Ok(FilteredError::measure(table, &[0, 1], &integrands, &kernel)?.spatio_temporal.mean.mean)
    };
    let (own, other) = (error(&own?)?, error(&other?)?);
    println!("error after the resolve: {own:.3} of white noise; of a table made for the eye {other:.3}");
    assert!(own < other);
    Ok(())
}
