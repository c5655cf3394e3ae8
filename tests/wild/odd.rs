//! Classes and measures of a caller's own.

use fsot::Extent;
use fsot::classes::{ClassFamily, ClassSamples};
use fsot::targets::{Measure, Projected};

/// The same list for every member.
#[derive(Debug)]
pub struct Windows {
    pub members: usize,
    pub samples: Vec<(u32, f64)>,
    pub weight: f64,
}

impl ClassFamily for Windows {
    fn name(&self) -> &str {
        "windows"
    }

    fn members(&self, _: &Extent) -> usize {
        self.members
    }

    fn member(&self, _: &Extent, member: usize) -> ClassSamples {
        let mut samples = self.samples.clone();
        samples.truncate(8 - member.min(8));
        ClassSamples { samples, weight: self.weight }
    }
}

/// A measure that may be one.
#[derive(Debug)]
pub struct Odd {
    pub dims: usize,
    pub kind: usize,
    pub numbers: [f64; 2],
}

impl Measure for Odd {
    fn name(&self) -> &str {
        "odd"
    }

    fn dims(&self) -> usize {
        self.dims
    }

    fn project(&self, direction: &[f64]) -> Projected {
        let ([a, b], length): ([f64; 2], f64) = (self.numbers, direction.iter().sum());
        match self.kind {
            0 => Projected::from_samples(vec![a * length, b * length]),
            1 => Projected::from_samples(Vec::new()),
            2 => Projected::from_density(&[0.2 * length, b * length], &[a, b]),
            3 => Projected::from_quantile(move |u| length * (b - (b - 0.1) * u)),
            _ => Projected::from_quantile(move |u| {
                let (low, high) = (a * length, b * length);
                low.min(high) + u * (high - low).abs()
            }),
        }
    }
}
