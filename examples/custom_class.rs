//! A family of classes and a target of one's own: every window of consecutive points is uniform on a disc.
//!
//! `cargo run --release --example custom_class -- custom_class.png`

#[path = "common/page.rs"]
mod page;

use fsot::{
    ClassFamily, Classes, Config, Extent, Measure, Member, Optimizer, Projected, Role, Target, Term, Until,
};

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
    fn member(&self, extent: &Extent, member: usize) -> Member {
        let samples = (64 * member..64 * member + 128).map(|i| ((i % extent.samples()) as u32, 1.0));
        Member { samples: samples.collect(), weight: 1.0 }
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
    optimizer.run(Until::SlicesPerClass(2000), |_| std::ops::ControlFlow::Continue(()))?;
    let (table, mut page) = (optimizer.into_table(), page::Page::new(1280, 440));
    for (left, first, count) in [(20, 0, 128), (440, 320, 128), (860, 0, 1024)] {
        let dots = table.values().chunks_exact(2).skip(first).take(count);
        page.scatter([left, 20], [400, 400], 3.0, dots.map(|dot| (dot, [20; 3])));
    }
    Ok(page.image.save(std::env::args().nth(1).unwrap_or("custom_class.png".into()))?)
}
