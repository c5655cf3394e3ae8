//! How densely the values of a dimension lie, finely next to the faces of the cube.

use fsot::SampleTable;
use fsot::metrics::{Marginal, MeasureError};

/// Thickness of the slab at each face that is widened.
const SLAB: f64 = 0.02;

/// Density next to 0, between, and next to 1; 1 is even.
pub struct Profile {
    pub parts: [Bins; 3],
    pub marginal: Marginal,
}

/// Bins of one width.
pub struct Bins {
    pub densities: Vec<f64>,
    /// Standard deviation of each for independent random values.
    pub deviation: f64,
}

impl Profile {
    /// Bins are as fine as leaves four random values in each at the faces, and eight between them.
    pub fn measure(table: &SampleTable, dim: usize) -> Result<Self, MeasureError> {
        let samples = table.extent().samples() as f64;
        let most = |counts: &[usize], width: f64, values: f64| {
            let is_good = |count: &&usize| samples * width / **count as f64 >= values;
            counts.iter().find(is_good).copied().unwrap_or(1)
        };
        let at_face = most(&[20, 10, 5, 4, 2, 1], SLAB, 4.0);
        let between = most(&[24, 12, 8, 4, 2, 1], 1.0 - 2.0 * SLAB, 8.0);
        // A fiftieth, in so many parts; 48 of them lie between the faces.
        let bins = 50 * at_face;
        let marginal = Marginal::measure(table, dim, bins)?;
        let part = |from: usize, to: usize, count: usize| {
            let bins_each = (to - from) / count;
            let width = bins_each as f64 / bins as f64;
            let counts = marginal.counts[from..to].chunks(bins_each);
            let sums = counts.map(|counts| counts.iter().sum::<u64>() as f64);
            let densities = sums.map(|sum| sum / (width * samples)).collect();
            Bins { densities, deviation: ((1.0 - width) / (width * samples)).sqrt() }
        };
        let parts = [
            part(0, at_face, at_face),
            part(at_face, bins - at_face, between),
            part(bins - at_face, bins, at_face),
        ];
        Ok(Self { parts, marginal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fsot::Extent;

    /// 48 slabs lie between the faces: every number of bins divides what it gets.
    #[test]
    fn bins_have_one_width_and_hold_every_value() {
        for samples in [1, 7, 49, 100, 200, 201, 1000, 4096, 16384, 100_000] {
            let extent = Extent { frames: 1, height: 1, width: samples, spp: 1 };
            let table = SampleTable::white_noise(extent, 1, 3).unwrap();
            let profile = Profile::measure(&table, 0).unwrap();
            let widths = [SLAB, 1.0 - 2.0 * SLAB, SLAB];
            let shares = profile.parts.iter().zip(widths).map(|(bins, width)| {
                let count = bins.densities.len() as f64;
                bins.densities.iter().sum::<f64>() * width / count
            });
            let all: f64 = shares.sum();
            assert!((all - 1.0).abs() < 1e-9, "{samples}: {all}");
        }
    }

    /// Nothing lies within 0.004 of a face: a histogram of 16 cells would say 0.94 there.
    #[test]
    fn empty_faces_are_empty_bins() {
        let values = (0..10_000_u16).map(|i| 0.004 + 0.992 * f32::from(i) / 10_000.0).collect();
        let extent = Extent { frames: 1, height: 100, width: 100, spp: 1 };
        let table = SampleTable::new(extent, 1, values).unwrap();
        let [first, middle, last] = Profile::measure(&table, 0).unwrap().parts;
        assert_eq!(first.densities.len(), 20);
        assert_eq!((&first.densities[..4], &last.densities[16..]), (&[0.0; 4][..], &[0.0; 4][..]));
        let even = middle.densities.iter().chain(&first.densities[5..]).chain(&last.densities[..15]);
        // Evenly spaced values: a bin of a thousandth holds 10 or 11.
        assert!(even.clone().all(|density| (0.9..1.2).contains(density)), "{:?}", even.collect::<Vec<_>>());
    }
}
