//! How points resemble a picture, and what to make of the figure.

use fsot::metrics::{BlockDeviation, DensityMatch, MeasureError, Samples};
use fsot::targets::Density;
use serde::Serialize;

/// Correlation with a picture after both are blurred by two distances between neighbours.
#[derive(Debug, Serialize)]
pub struct Likeness {
    /// Points that were compared.
    pub points: usize,
    /// `null` where it is not a number.
    pub correlation: f64,
    /// Points where the blurred picture has nothing.
    pub strays: usize,
    /// Standard deviation of the blur, in units of the picture's longer side.
    pub blur: f64,
    /// The block of pixels whose number of points is the least likely for its mass.
    pub worst: BlockDeviation,
    /// A word about a poor figure.
    pub advice: Option<&'static str>,
}

/// Deviation beyond which mass was lost, where random points have 4 to 5.
const LOST: f64 = 6.0;

/// Correlation below which points are expected to look poor, if there are enough of them.
const POOR: f64 = 0.9;
const ENOUGH: usize = 1000;

/// Relative deviation of a picture's values below which there is hardly anything to correlate with.
const EVEN: f64 = 0.1;

impl Likeness {
    /// Compares at least one point with a picture.
    pub fn measure(points: &[f32], density: &Density) -> Result<Self, MeasureError> {
        let count = points.len() / 2;
        let blur = blur(count, density);
        let found = DensityMatch::measure(Samples::points(points, 2)?, [0, 1], density, blur)?;
        let good = found.correlation >= POOR || count < ENOUGH;
        let advice = match good {
            true if found.worst.deviation.abs() > LOST => Some(
                "a part of the picture has too few or too many points (see the largest deviation): \
                 give more --slices",
            ),
            true => None,
            false if is_even(density) => {
                Some("the picture is almost even, so that its correlation says nothing")
            }
            false => Some("the points follow the picture poorly: give more --slices"),
        };
        let DensityMatch { correlation, strays, worst, .. } = found;
        Ok(Self { points: count, correlation, strays, blur, worst, advice })
    }
}

/// Two distances between neighbours, if all of the picture were equally dark.
pub fn blur(count: usize, density: &Density) -> f64 {
    let [width, height] = density.size();
    let shape = width.min(height) as f64 / width.max(height) as f64;
    // A handful of points are told apart by no blur at all.
    (2.0 * (shape / count as f64).sqrt()).min(1.0)
}

fn is_even(density: &Density) -> bool {
    let values = density.values();
    let mean = density.mass() / values.len() as f64;
    let squares: f64 = values.iter().map(|&value| (f64::from(value) - mean).powi(2)).sum();
    (squares / values.len() as f64).sqrt() < EVEN * mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_poor_figure_has_a_word_that_fits() {
        let points: Vec<f32> =
            (0..2000).flat_map(|i| [(i as f32 * 0.618).fract(), i as f32 / 2000.0]).collect();
        let advice = |density: &Density, points: &[f32]| Likeness::measure(points, density).unwrap().advice;
        let even = Density::new(8, 8, vec![0.5; 64]).unwrap();
        let left: Vec<f32> = points.chunks(2).flat_map(|point| [0.3 * point[0], point[1]]).collect();
        assert!(advice(&even, &left).unwrap().contains("almost even"));
        let right = Density::new(8, 1, vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]).unwrap();
        assert!(advice(&right, &left).unwrap().contains("more --slices"));
        // A few points resemble nothing, wherever they are; but not as few may be where they should not.
        assert_eq!(advice(&even, &left[..10]), None);
        assert!(advice(&right, &left[..200]).unwrap().contains("too few or too many"));
        assert_eq!(blur(1, &even), 1.0);
    }
}
