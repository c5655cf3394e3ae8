//! Error of the mean over many samples: what no filter takes away.

use super::error::MeasureError;
use super::errors::Errors;
use super::integrands::Integrands;
use super::ratios::Ratios;
use super::samples::Samples;

/// Squared error of the mean over groups of samples, as ratio to as many independent random samples.
///
/// 1 is random, 0 is exact. Filters reach a few pixels only, so a small filtered error says nothing about
/// these: a table whose samples avoid the corners of the square is biased, and a renderer shows the bias
/// everywhere.
///
/// ```
/// use fsot::metrics::{Bias, Integrands};
/// use fsot::{Extent, SampleTable};
///
/// let extent = Extent { frames: 1, height: 16, width: 16, spp: 1 };
/// let table = SampleTable::white_noise(extent, 2, 0)?;
/// let bias = Bias::measure(&table, &[0, 1], &Integrands::random(2, 16, 0)?)?;
/// assert!(bias.pixel.mean.mean > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bias {
    /// All samples of the table together.
    pub table: Ratios,
    /// The samples of a frame, averaged over frames. Equal to `table` for a single frame.
    pub frame: Ratios,
    /// The samples of a pixel, averaged over pixels and frames; with one sample per pixel it is 1 unless the
    /// samples are not uniformly distributed.
    pub pixel: Ratios,
}

impl Bias {
    /// Measures the dimension group `dims` of samples over test integrands of as many coordinates.
    ///
    /// O(samples · dims) per integrand; parallel, and independent of the number of threads.
    ///
    /// # Errors
    /// A dimension group that is empty, repeats a dimension, exceeds those of the samples, or has another
    /// length than integrands have coordinates.
    pub fn measure<'a>(
        samples: impl Into<Samples<'a>>,
        dims: &[usize],
        integrands: &Integrands,
    ) -> Result<Self, MeasureError> {
        let errors = Errors::of(samples, dims, "an integrand", integrands.dims())?;
        let extent = errors.extent;
        let mean_sq = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let [table, frame, pixel] = Ratios::over(
            integrands,
            || (),
            |(), pair, ratios| {
                for (integrand, ratio) in pair.iter().zip(ratios) {
                    let plane = extent.height * extent.width;
                    let mut of_pixels = 0.0;
                    let mean_of = |frame: usize| {
                        let pixels = errors.within(frame * plane..(frame + 1) * plane, integrand);
                        pixels.inspect(|error| of_pixels += error * error).sum::<f64>() / plane as f64
                    };
                    let frames: Vec<f64> = (0..extent.frames).map(mean_of).collect();
                    let samples = [1, extent.frames, extent.sites()].map(|parts| extent.samples() / parts);
                    let squares =
                        [mean(&frames).powi(2), mean_sq(&frames), of_pixels / extent.sites() as f64];
                    *ratio = std::array::from_fn(|k| squares[k] * samples[k] as f64 / integrand.variance());
                }
            },
        );
        Ok(Self { table, frame, pixel })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{Estimate, Family, Integrand, integrand_kind::IntegrandKind};
    use crate::table::SampleTable;
    use crate::table::extent::Extent;
    use approx::assert_relative_eq;

    const EXTENT: Extent = Extent { frames: 3, height: 6, width: 8, spp: 2 };

    /// Mean over 400 tables, within 4 standard errors of 1.
    #[test]
    fn white_noise_is_one() {
        let integrands = Integrands::random(3, 16, 2).unwrap();
        let tables: Vec<Bias> = (0..400)
            .map(|seed| {
                let table = SampleTable::white_noise(EXTENT, 3, seed).unwrap();
                Bias::measure(&table, &[0, 2, 1], &integrands).unwrap()
            })
            .collect();
        for pick in
            [|bias: &Bias| bias.table.mean, |bias: &Bias| bias.frame.mean, |bias: &Bias| bias.pixel.mean]
        {
            let over = Estimate::of(tables.iter().map(|table| pick(table).mean));
            assert!((over.mean - 1.0).abs() < 4.0 * over.standard_error, "{over:?}");
            assert!(over.standard_error < 0.1, "{over:?}");
        }
    }

    #[test]
    fn equal_points_are_as_biased_as_they_are_many() {
        let table = SampleTable::new(EXTENT, 2, vec![0.25; EXTENT.samples() * 2]).unwrap();
        let integrands = Integrands::random(2, 4, 2).unwrap();
        let bias = Bias::measure(&table, &[0, 1], &integrands).unwrap();
        for family in integrands.families() {
            let of = family.integrands().iter();
            let single = of.map(|f| (f.value(&[0.25, 0.25]) - f.integral()).powi(2) / f.variance());
            let single = single.sum::<f64>() / 4.0;
            let mean = |ratios: &Ratios| ratios.family(family.name()).unwrap().mean;
            let measured = [mean(&bias.table), mean(&bias.frame), mean(&bias.pixel)];
            for (measured, samples) in measured.into_iter().zip([288.0, 96.0, 2.0]) {
                assert_relative_eq!(measured, single * samples, max_relative = 1e-10);
            }
        }
    }

    /// A regular grid of n × n cell centres: linear functions are exact, and a vertical edge is off by a
    /// known share of one column.
    #[test]
    fn a_regular_grid_has_a_small_known_bias() {
        let extent = Extent { frames: 1, height: 16, width: 16, spp: 1 };
        let centre = |i: usize| (i as f32 + 0.5) / 16.0;
        let values = (0..256).flat_map(|i| [centre(i % 16), centre(i / 16)]).collect();
        let table = SampleTable::new(extent, 2, values).unwrap();
        let linear = Integrand::known(IntegrandKind::Linear { gradient: vec![0.6, 0.8] }, 2);
        // 5 of 16 columns have x < 0.3: 0.3125 instead of 0.3.
        let edge = Integrand::known(IntegrandKind::HalfSpace { normal: vec![1.0, 0.0], offset: 0.3 }, 2);
        let integrands = Integrands::own(2, "edge", vec![edge]).unwrap();
        let integrands = integrands.with_family("linear", vec![linear]).unwrap();
        let bias = Bias::measure(&table, &[0, 1], &integrands).unwrap();
        assert!(bias.table.family("linear").unwrap().mean < 1e-28);
        let expected = 256.0 * 0.0125_f64.powi(2) / (0.3 * 0.7);
        assert_relative_eq!(bias.table.family("edge").unwrap().mean, expected, max_relative = 1e-12);
        // Random ones: edges that cut cells at all angles average out, faster still where nothing jumps.
        // Edges along the grid do not: boxes are off by whole rows, which at any n is as bad as random.
        let random = Integrands::random(2, 64, 1).unwrap();
        let bias = Bias::measure(&table, &[0, 1], &random).unwrap();
        for (family, limit) in [(Family::HALF_SPACE, 0.1), (Family::SMOOTH, 0.001), (Family::BALL, 0.1)] {
            assert!(bias.table.family(family).unwrap().mean < limit, "{family}: {:?}", bias.table);
        }
        assert!(bias.table.family(Family::BOX).unwrap().mean > 0.5, "{:?}", bias.table);
    }
}
