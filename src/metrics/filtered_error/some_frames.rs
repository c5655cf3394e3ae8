//! The same figures from some frames of an animation, for tables of which all would take too long.

use std::collections::BTreeMap;

use rustfft::num_complex::Complex64;

use super::{FilteredError, sums_of_squares};
use crate::error::RangeError;
use crate::kernel::fft::Transform;
use crate::kernel::{Kernel, Tap, TemporalKernel};
use crate::metrics::errors::Errors;
use crate::metrics::{Integrands, MeasureError, Ratios, Samples};
use crate::table::extent::Extent;

impl FilteredError {
    /// The same as [`measure`](Self::measure), averaged over `frames` frames at equal distances instead of
    /// all of them, each filtered in space and time as in the whole animation.
    ///
    /// A long animation has more frames than an average needs: integrands count, of which more can be
    /// afforded. Cost per integrand: O(samples · dims) to evaluate the frames that the filter sees, and
    /// O(pixels log pixels) for each of them.
    ///
    /// # Errors
    /// As `measure`; no frames, or more than there are.
    ///
    /// ```
    /// use fsot::kernel::TemporalKernel;
    /// use fsot::metrics::{FilteredError, Integrands};
    /// use fsot::{Extent, Kernel, SampleTable};
    ///
    /// let table = SampleTable::white_noise(Extent::animation(16, 16, 16), 2, 0)?;
    /// let eye = Kernel::gaussian(2.1).with_temporal(TemporalKernel::Box { frames: 2 });
    /// let integrands = Integrands::random(2, 16, 0)?;
    /// let error = FilteredError::measure_frames(&table, &[0, 1], &integrands, &eye, 4)?;
    /// assert!((0.5..1.5).contains(&error.spatio_temporal.mean.mean));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn measure_frames<'a>(
        samples: impl Into<Samples<'a>>,
        dims: &[usize],
        integrands: &Integrands,
        kernel: &Kernel,
        frames: usize,
    ) -> Result<Self, MeasureError> {
        let errors = Errors::of(samples, dims, "an integrand", integrands.dims())?;
        let extent = errors.extent;
        let is_good = (1..=extent.frames).contains(&frames);
        RangeError::check(is_good, "the number of frames", frames as f64, "from 1 to those of the table")?;
        let filter = Filter::new(&extent, kernel)?;
        let plane = filter.plane.len();
        let [unfiltered, spatial, spatio_temporal] = Ratios::over(
            integrands,
            || (filter.plane.scratch(), vec![Complex64::default(); plane]),
            |(scratch, filtered), pair, ratios| {
                let mut squares = [[0.0; 3]; 2];
                for frame in (0..frames).map(|k| k * extent.frames / frames) {
                    filtered.fill(Complex64::default());
                    for (&dt, spectrum) in &filter.planes {
                        let seen = (frame as i64 + i64::from(dt)).rem_euclid(extent.frames as i64) as usize;
                        let sites = seen * plane..(seen + 1) * plane;
                        scratch.data.fill(Complex64::default());
                        for (site, error) in
                            scratch.data.iter_mut().zip(errors.within(sites.clone(), &pair[0]))
                        {
                            site.re = error;
                        }
                        if let Some(second) = pair.get(1) {
                            for (site, error) in scratch.data.iter_mut().zip(errors.within(sites, second)) {
                                site.im = error;
                            }
                        }
                        filter.plane.forward(scratch);
                        for ((sum, value), weight) in filtered.iter_mut().zip(&scratch.data).zip(spectrum) {
                            *sum += value * weight;
                        }
                        if dt == 0 {
                            let of_frame = sums_of_squares(&scratch.data, &filter.mirrors, |site| {
                                [1.0, filter.spatial[site]]
                            });
                            for (squares, [plain, spatial]) in squares.iter_mut().zip(of_frame) {
                                squares[0] += plain;
                                squares[1] += spatial;
                            }
                        }
                    }
                    let of_frame = sums_of_squares(filtered, &filter.mirrors, |_| [1.0]);
                    for (squares, [filtered]) in squares.iter_mut().zip(of_frame) {
                        squares[2] += filtered;
                    }
                }
                for ((ratio, integrand), squares) in ratios.iter_mut().zip(pair).zip(squares) {
                    let white = integrand.variance() / extent.spp as f64 * frames as f64;
                    let sites = plane as f64;
                    let mean = squares.map(|sum| 0.5 * sum / (sites * sites));
                    *ratio = std::array::from_fn(|k| mean[k] / (white * filter.white[k]));
                }
            },
        );
        Ok(Self { unfiltered, spatial, spatio_temporal })
    }
}

/// A kernel as one spectrum for each frame that it sees.
struct Filter {
    plane: Transform,
    mirrors: Vec<u32>,
    /// By what each frequency of the frame `dt` is multiplied; the frame itself is always there.
    planes: BTreeMap<i32, Vec<Complex64>>,
    /// `|W(k)|²` of the spatial kernel.
    spatial: Vec<f64>,
    /// `Σw² / (Σw)²` of no kernel, of the spatial and of the whole one.
    white: [f64; 3],
}

impl Filter {
    fn new(extent: &Extent, kernel: &Kernel) -> Result<Self, MeasureError> {
        let plane = Transform::new(1, extent.height, extent.width);
        let spatial = Kernel { temporal: TemporalKernel::None, ..kernel.clone() }.taps(extent)?;
        let whole = kernel.taps(extent)?;
        let sum = |taps: &[Tap]| taps.iter().map(|tap| tap.weight).sum::<f64>();
        let white = |taps: &[Tap]| {
            let sum = sum(taps);
            taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum::<f64>()
        };
        let mut scratch = plane.scratch();
        let mut spectrum = |taps: &mut dyn Iterator<Item = &Tap>, sum: f64| -> Vec<Complex64> {
            scratch.data.fill(Complex64::default());
            for tap in taps {
                let site = extent.wrapped(extent.site(0), (0, tap.dy.into(), tap.dx.into()));
                scratch.data[extent.site_index(site)].re += tap.weight / sum;
            }
            plane.forward(&mut scratch);
            // A tap looks at the site beside: a correlation, not a convolution.
            scratch.data.iter().map(Complex64::conj).collect()
        };
        let of_space = spectrum(&mut spatial.iter(), sum(&spatial));
        let mut planes = BTreeMap::from([(0, Vec::new())]);
        planes.extend(whole.iter().map(|tap| (tap.dt, Vec::new())));
        for (dt, plane) in &mut planes {
            *plane = spectrum(&mut whole.iter().filter(|tap| tap.dt == *dt), sum(&whole));
        }
        Ok(Self {
            mirrors: plane.mirrors(),
            planes,
            spatial: of_space.iter().map(Complex64::norm_sqr).collect(),
            white: [1.0, white(&spatial), white(&whole)],
            plane,
        })
    }
}
