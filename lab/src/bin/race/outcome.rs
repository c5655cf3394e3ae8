//! What a race leaves: curves of error over time.

use std::path::Path;

use fsot_lab::figures::write_csv;
use fsot_lab::judge::Quality;
use fsot_lab::program;
pub use fsot_lab::program::Failure;

use crate::cases::Case;

/// A table on its way, or one of a row of tables of growing effort.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub seconds: f64,
    pub slices: u64,
    pub quality: Quality,
}

/// Quality of a method over time, in the order of time.
#[derive(Clone, Debug)]
pub struct Curve {
    pub method: &'static str,
    pub points: Vec<Point>,
}

/// What was measured of a case.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub case: Case,
    pub ours: Vec<Curve>,
    pub published: Curve,
}

impl Outcome {
    /// Ours, then the published loop.
    pub fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.ours.iter().chain([&self.published])
    }

    /// What must hold on any machine.
    pub fn check(&self) -> Result<(), Failure> {
        for Curve { method, points } in self.curves() {
            let context = format!("{}, {method}", self.case.name);
            let [Some(first), Some(last)] = [points.first(), points.last()] else {
                return Err(format!("{context}: no table was made").into());
            };
            let [first, last] = [first, last].map(|point| point.quality);
            let finite = |quality: Quality| (quality.filtered + quality.bound + quality.bias).is_finite();
            // Not the bound: with several samples per pixel, long sweeps trade it for a smaller filtered
            // error.
            let better = last.filtered <= first.filtered && last.bound < 1.0;
            if !(finite(first) && finite(last) && better) {
                return Err(format!("{context}: it went from {first:?} to {last:?}").into());
            }
        }
        Ok(())
    }
}

/// Writes all points of all curves.
pub fn save_csv(path: &Path, outcomes: &[Outcome]) -> Result<(), Failure> {
    let heading = ["case", "method", "seconds", "slices", "filtered", "bound", "bias"];
    let rows = outcomes.iter().flat_map(|outcome| {
        outcome.curves().flat_map(|curve| curve.points.iter().map(|point| row(&outcome.case, curve, point)))
    });
    let mut text = Vec::new();
    write_csv(&mut text, heading, rows)?;
    program::save(path, &text)
}

fn row(case: &Case, curve: &Curve, Point { seconds, slices, quality }: &Point) -> [String; 7] {
    let Quality { filtered, bound, bias } = quality;
    [
        case.name.into(),
        curve.method.into(),
        format!("{seconds:.6}"),
        format!("{slices}"),
        format!("{filtered:.5}"),
        format!("{bound:.5}"),
        format!("{bias:.5}"),
    ]
}
