//! Stippling: points as dense as a picture is dark.
//!
//! `cargo run --release --example stippling`

use fsot::metrics::{DensityMatch, Samples};
use fsot::targets::{Density, Tone};
use fsot::{Config, Until};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let picture = Density::open(concat!(env!("CARGO_MANIFEST_DIR"), "/data/lantern.png"), Tone::Dark)?;
    let points = Config::stippling(2000, picture.clone()).optimize(Until::SlicesPerClass(2000))?;

    // x to the right and y down, both from 0 to 1 over the picture.
    for point in points.values().chunks_exact(2).take(3) {
        println!("{:.4} {:.4}", point[0], point[1]);
    }
    // Points and picture, both blurred by two distances between neighbours.
    let blur = 2.0 / (2000.0_f64).sqrt();
    let found = DensityMatch::measure(Samples::from(&points), [0, 1], &picture, blur)?;
    println!("correlation {:.4}, points where nothing is: {}", found.correlation, found.strays);
    assert!(found.correlation > 0.99 && found.strays == 0);
    Ok(())
}
