//! A family of classes and a target of one's own: every window of consecutive points is uniform on a disc.
//!
//! `cargo run --release --example own_class_and_target`

use fsot::classes::{ClassFamily, ClassSamples, Classes};
use fsot::config::{Role, Term};
use fsot::targets::{Measure, Projected, Target};
use fsot::{Config, Extent, Optimizer, Until};

/// Windows of 128 points, half overlapping; the sequence wraps.
#[derive(Debug)]
struct Windows;
impl ClassFamily for Windows {
    fn name(&self) -> &str {
        "windows"
    }
    fn members(&self, extent: &Extent) -> usize {
        extent.samples() / 64
    }
    fn member(&self, extent: &Extent, member: usize) -> ClassSamples {
        let samples = (64 * member..64 * member + 128).map(|i| ((i % extent.samples()) as u32, 1.0));
        ClassSamples { samples: samples.collect(), weight: 1.0 }
    }
}

/// The disc inside the unit square: along any direction its density is a half circle.
#[derive(Debug)]
struct Disc;
impl Measure for Disc {
    fn name(&self) -> &str {
        "disc"
    }
    fn dims(&self) -> usize {
        2
    }
    fn project(&self, theta: &[f64]) -> Projected {
        let (centre, radius) = (0.5 * (theta[0] + theta[1]), 0.5 * theta[0].hypot(theta[1]));
        let angles = (0..=256).map(|i| f64::from(i) / 256.0 * std::f64::consts::PI);
        let places: Vec<f64> = angles.clone().map(|angle| centre - radius * angle.cos()).collect();
        Projected::from_density(&places, &angles.map(f64::sin).collect::<Vec<_>>())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (target, dims, role) = (Target::custom(Disc), vec![0, 1], Role::Descend);
    let whole = Term { classes: Classes::WholeTable, target, dims, weight: 1.0, role };
    let windows = Term { classes: Classes::custom(Windows), ..whole.clone() };
    let mut optimizer = Optimizer::new(Config::point_set(1024, 2, vec![windows, whole]))?;
    optimizer.run(Until::SlicesPerClass(2000))?;
    let table = optimizer.into_table();
    let inside = |dot: &&[f32]| (dot[0] - 0.5).hypot(dot[1] - 0.5) < 0.505;
    assert!(table.values().chunks_exact(2).filter(inside).count() == 1024, "points left the disc");
    Ok(())
}
