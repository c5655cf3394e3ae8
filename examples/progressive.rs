//! A sequence whose first 16, 64, 256, … points are each as good as a set of that size.
//!
//! `cargo run --release --example progressive`

use fsot::classes::PrefixLengths;
use fsot::metrics::{Integrands, Samples, SetError};
use fsot::{Config, Until};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sequence =
        Config::progressive(1024, 2, PrefixLengths::PowersOfTwo).optimize(Until::SlicesPerClass(2000))?;
    let integrands = Integrands::random(2, 64, 0)?;
    let mut last = 1.0;
    for length in [16, 64, 256, 1024] {
        let prefix = Samples::from(&sequence).select(..length)?;
        let ratio = SetError::measure(prefix, &[0, 1], &integrands)?.ratios.mean.mean;
        println!("first {length:4}: squared error {ratio:.4} of as many random points");
        assert!(ratio < last, "the longer the better");
        last = ratio;
    }
    Ok(())
}
