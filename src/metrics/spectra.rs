//! Power spectra of error images: where in frequency the error of a table is.

use ndarray::{Array2, ArrayView3};
use rayon::prelude::*;
use rustfft::num_complex::Complex64;

use super::error::MeasureError;
use super::errors::Errors;
use super::integrands::Integrands;
use super::samples::Samples;
use crate::kernel::fft::{Transform, TransformBuffers};

/// Power spectra of an error image, normalised so that white noise is 1 at every frequency.
///
/// Both arrays are centred: frequency `(k_row, k_column)` stands at `[k_row + rows/2, k_column + columns/2]`
/// (integer division), zero frequency in the middle. Frequencies are in cycles per picture; cycles per pixel
/// (or frame) are `k / len`, up to 0.5.
///
/// The zero frequency is kept in the arrays: the mean of the error is not subtracted, so the central value of
/// `xy` is the bias of a frame as ratio to random. Radial average and low-frequency share leave it out.
///
/// ```
/// use fsot::metrics::{Integrands, Spectra};
/// use fsot::{Extent, SampleTable};
///
/// let extent = Extent { frames: 1, height: 16, width: 16, spp: 1 };
/// let table = SampleTable::white_noise(extent, 2, 0)?;
/// let spectra = Spectra::measure(&table, &[0, 1], &Integrands::random(2, 16, 0)?)?;
/// assert!((0.5..1.5).contains(&spectra.low_frequency_share(0.25)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spectra {
    /// Power over `[ky, kx]` (height × width), averaged over frames.
    pub xy: Array2<f64>,
    /// Power over `[kt, kx]` (frames × width), averaged over rows `y`.
    pub xt: Array2<f64>,
}

/// A ring of frequencies of the xy spectrum.
///
/// ```
/// use fsot::metrics::Spectra;
///
/// // A checkerboard has a single frequency, half a cycle per pixel along both axes.
/// let sign = |(_, y, x): (usize, usize, usize)| if (x + y) % 2 == 0 { 0.5 } else { -0.5 };
/// let checkerboard = ndarray::Array3::from_shape_fn((1, 8, 8), sign);
/// let rings = Spectra::of_image(checkerboard.view(), 0.25).radial();
/// let last = rings.last().unwrap();
/// assert_eq!((last.frequency, last.count), (0.5_f64.sqrt(), 1));
/// assert!(last.power > 63.9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RadialBin {
    /// Mean radius of the ring's frequencies, in cycles per pixel.
    pub frequency: f64,
    /// Mean power; white noise is 1.
    pub power: f64,
    /// Frequencies in the ring.
    pub count: usize,
}

/// How much more power a ring of frequencies has along y than along x.
///
/// ```
/// use fsot::metrics::Spectra;
///
/// // Rows that differ: all power is along y.
/// let rows = ndarray::Array3::from_shape_fn((1, 16, 16), |(_, y, _)| if y % 4 < 2 { 0.5 } else { -0.5 });
/// let ring = Spectra::of_image(rows.view(), 0.25).anisotropy()[1];
/// assert_eq!((ring.from, ring.to), (0.25, 0.35));
/// assert!(ring.along_y_over_along_x > 1e6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AnisotropyRing {
    /// Least radius of the ring, in cycles per pixel.
    pub from: f64,
    /// Greatest radius, exclusive.
    pub to: f64,
    /// Mean power of frequencies within 15° of the y axis over that within 15° of the x axis: 1 where no
    /// direction is preferred. NaN where the tile has no such frequencies.
    pub along_y_over_along_x: f64,
}

/// Integrands are summed in this many parts, whatever the number of threads; each holds its own sums.
const PARTS: usize = 8;

impl Spectra {
    /// Spectra of one error image `[frame, y, x]` (of a renderer, say) whose pixels have this variance in
    /// white noise; pass the image's own mean square to look at the shape alone.
    ///
    /// O(sites log sites).
    ///
    /// # Panics
    /// If an axis of the image is empty.
    pub fn of_image(errors: ArrayView3<'_, f64>, variance: f64) -> Self {
        let (frames, height, width) = errors.dim();
        assert!(!errors.is_empty(), "an error image of {frames} x {height} x {width} has no spectrum");
        let mut sums = Sums::new([frames, height, width]);
        let scale = variance.sqrt().recip();
        let image: Vec<Complex64> = errors.iter().map(|error| (error * scale).into()).collect();
        sums.add(&image);
        sums.finish(1)
    }

    /// Spectra of the samples' error in the dimension group `dims`, averaged over all integrands, each
    /// relative to its own white noise.
    ///
    /// O(sites log sites) per integrand; parallel, and independent of the number of threads.
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
        let shape = [extent.frames, extent.height, extent.width];
        let all: Vec<_> = integrands.iter().collect();
        let parts: Vec<Sums> = all
            .par_chunks(all.len().div_ceil(PARTS))
            .map(|part| {
                let mut sums = Sums::new(shape);
                let mut image = vec![Complex64::default(); extent.sites()];
                // Two real images ride in one complex transform: their powers are summed anyway.
                for pair in part.chunks(2) {
                    image.fill(Complex64::default());
                    for (k, integrand) in pair.iter().enumerate() {
                        let scale = (extent.spp as f64 / integrand.variance()).sqrt();
                        for (pixel, error) in image.iter_mut().zip(errors.all(integrand)) {
                            let value = scale * error;
                            if k == 0 { pixel.re = value } else { pixel.im = value }
                        }
                    }
                    sums.add(&image);
                }
                sums
            })
            .collect();
        let total = parts.into_iter().reduce(Sums::plus).expect("there is at least one integrand");
        Ok(total.finish(all.len()))
    }

    /// Radial average of `xy`: rings of width `1 / max(height, width)` cycles per pixel around zero, which is
    /// left out. Rings beyond 0.5 lie in the corners of the spectrum only. Empty rings are skipped.
    pub fn radial(&self) -> Vec<RadialBin> {
        let (height, width) = self.xy.dim();
        let rings = height.max(width) as f64;
        // The farthest frequency is √½ cycles per pixel.
        let mut bins = vec![RadialBin { frequency: 0.0, power: 0.0, count: 0 }; rings as usize + 1];
        for (radius, power) in self.frequencies() {
            let bin = &mut bins[(radius * rings).round() as usize];
            bin.frequency += radius;
            bin.power += power;
            bin.count += 1;
        }
        let mean = |bin: RadialBin| {
            let count = bin.count as f64;
            RadialBin { frequency: bin.frequency / count, power: bin.power / count, ..bin }
        };
        bins.into_iter().filter(|bin| bin.count > 0).map(mean).collect()
    }

    /// Error energy of `xy` at radii above 0 up to `cutoff` cycles per pixel, relative to white noise there:
    /// 1 for white noise, near 0 for blue noise. NaN if no frequency is that low.
    ///
    /// The spatial Gaussian with `sigma_px = 2.1` halves the power at 0.09 cycles per pixel; 0.1 is a good
    /// cutoff.
    pub fn low_frequency_share(&self, cutoff: f64) -> f64 {
        let low = self.frequencies().filter(|&(radius, _)| radius <= cutoff);
        let (sum, count) = low.fold((0.0, 0.0), |(sum, count), (_, power)| (sum + power, count + 1.0));
        sum / count
    }

    /// Power along y over power along x, in three rings of `xy` from 0.15 to 0.5 cycles per pixel.
    ///
    /// A radial average cannot see a direction, and the error of a whole table neither.
    pub fn anisotropy(&self) -> [AnisotropyRing; 3] {
        let slope = (std::f64::consts::PI / 12.0).tan();
        [(0.15, 0.25), (0.25, 0.35), (0.35, 0.5)].map(|(from, to)| {
            let mean = |is_along: &dyn Fn(f64, f64) -> bool| {
                let ring = self
                    .plane_frequencies()
                    .filter(|&([y, x], _)| (from..to).contains(&y.hypot(x)) && is_along(y.abs(), x.abs()));
                let (sum, count) =
                    ring.fold((0.0, 0.0), |(sum, count), (_, power)| (sum + power, count + 1.0));
                sum / count
            };
            let along_y_over_along_x = mean(&|y, x| x <= slope * y) / mean(&|y, x| y <= slope * x);
            AnisotropyRing { from, to, along_y_over_along_x }
        })
    }

    /// Radius in cycles per pixel and power of every frequency of `xy` but zero.
    fn frequencies(&self) -> impl Iterator<Item = (f64, f64)> {
        let radii = self.plane_frequencies().map(|([y, x], power)| (y.hypot(x), power));
        radii.filter(|&(radius, _)| radius > 0.0)
    }

    /// `[y, x]` in cycles per pixel and power of every frequency of `xy`.
    fn plane_frequencies(&self) -> impl Iterator<Item = ([f64; 2], f64)> {
        let (height, width) = self.xy.dim();
        let cycles = |at: usize, len: usize| (at as f64 - (len / 2) as f64) / len as f64;
        let place = move |row, column| [cycles(row, height), cycles(column, width)];
        self.xy.indexed_iter().map(move |((row, column), &power)| (place(row, column), power))
    }
}

/// Sums of powers over images and slices of them, in the order of the transforms.
struct Sums {
    shape: [usize; 3],
    plane: [Transform; 2],
    scratch: [TransformBuffers; 2],
    power: [Vec<f64>; 2],
}

impl Sums {
    fn new(shape: [usize; 3]) -> Self {
        let [frames, height, width] = shape;
        let plane = [Transform::new(1, height, width), Transform::new(1, frames, width)];
        let scratch = plane.each_ref().map(Transform::scratch);
        let power = plane.each_ref().map(|plane| vec![0.0; plane.len()]);
        Self { shape, plane, scratch, power }
    }

    /// Adds an image `[frame][y][x]` whose real and imaginary parts are one error image each.
    fn add(&mut self, image: &[Complex64]) {
        let [frames, height, width] = self.shape;
        let [frame_buffer, row_buffer] = self.scratch.each_mut();
        for frame in image.chunks_exact(height * width) {
            frame_buffer.data.copy_from_slice(frame);
            accumulate(&self.plane[0], frame_buffer, &mut self.power[0]);
        }
        for y in 0..height {
            for frame in 0..frames {
                let row = &image[(frame * height + y) * width..][..width];
                row_buffer.data[frame * width..][..width].copy_from_slice(row);
            }
            accumulate(&self.plane[1], row_buffer, &mut self.power[1]);
        }
    }

    fn plus(mut self, other: Self) -> Self {
        for (power, other) in self.power.iter_mut().flatten().zip(other.power.iter().flatten()) {
            *power += other;
        }
        self
    }

    /// Mean over `images` real images and over the slices of each.
    fn finish(self, images: usize) -> Spectra {
        let [frames, height, width] = self.shape;
        let spectrum = |which: usize, rows: usize, slices: usize| {
            let (plane, power) = (&self.plane[which], &self.power[which]);
            let mirrors = plane.mirrors();
            let scale = 0.5 / (rows * width * slices * images) as f64;
            Array2::from_shape_fn((rows, width), |(row, column)| {
                let k = |at: usize, len: usize| (at + len - len / 2) % len;
                let at = plane.index([0, k(row, rows), k(column, width)]);
                // |A(k)|² + |B(k)|² = (|Z(k)|² + |Z(−k)|²) / 2 for the real images A and B in Z = A + iB.
                scale * (power[at] + power[mirrors[at] as usize])
            })
        };
        Spectra { xy: spectrum(0, height, frames), xt: spectrum(1, frames, height) }
    }
}

fn accumulate(plane: &Transform, scratch: &mut TransformBuffers, power: &mut [f64]) {
    plane.forward(scratch);
    for (power, value) in power.iter_mut().zip(&scratch.data) {
        *power += value.norm_sqr();
    }
}

#[cfg(test)]
mod tests;
