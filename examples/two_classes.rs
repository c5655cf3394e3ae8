//! Two classes of points: each is uniform, and so are both together.
//!
//! `cargo run --release --example two_classes`

use fsot::config::LabelSubsets;
use fsot::metrics::{MeasureError, Samples, SlicedDistance};
use fsot::targets::Target;
use fsot::{Config, SampleTable, Until};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let config = Config::classes(&[256, 256], 2, &LabelSubsets::EachAndAll);
    let points = config.optimize(Until::SlicesPerClass(2000))?;

    // 256 points labelled 0 come first, then those labelled 1.
    let distance = |samples: Samples| -> Result<f64, MeasureError> {
        Ok(SlicedDistance::measure(samples, &[0, 1], &Target::UniformCube, 128)?.w2)
    };
    let first = distance(Samples::from(&points).select(..256)?)?;
    let second = distance(Samples::from(&points).select(256..)?)?;
    let both = distance(Samples::from(&points))?;
    // One class of the same size, which has only itself to care for.
    let alone =
        Config::classes(&[256], 2, &LabelSubsets::EachAndAll).optimize(Until::SlicesPerClass(2000))?;
    let alone = distance(Samples::from(&alone))?;
    let white = distance(Samples::from(&SampleTable::white_noise(points.extent(), 2, 1)?))?;
    println!(
        "to uniform: {first:.5}, {second:.5}; both {both:.5}; alone {alone:.5}; 512 at random {white:.5}"
    );
    assert!(first < 1.2 * alone && second < 1.2 * alone && both < alone && both < 0.3 * white);
    Ok(())
}
