//! Power spectra of error images: where in frequency the error of a table is.

use ndarray::{Array2, ArrayView3};
use rayon::prelude::*;
use rustfft::num_complex::Complex64;

use super::error_image::Points;
use super::families::Integrands;
use super::fft::{Scratch, Transform};
use crate::error::ConfigError;
use crate::table::SampleTable;

/// Power spectra of an error image, normalised so that white noise is 1 at every frequency.
///
/// Both arrays are centred: frequency `(k_row, k_column)` stands at `[k_row + rows/2, k_column + columns/2]`
/// (integer division), zero frequency in the middle. Frequencies are in cycles per picture; cycles per pixel
/// (or frame) are `k / len`, up to 0.5.
///
/// The zero frequency is kept in the arrays: the mean of the error is not subtracted, so the central value of `xy`
/// is the bias of a frame as ratio to random. Radial average and low-frequency share leave it out.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Power over `[ky, kx]` (height × width), averaged over frames.
    pub xy: Array2<f64>,
    /// Power over `[kt, kx]` (frames × width), averaged over rows `y`.
    pub xt: Array2<f64>,
}

/// A ring of frequencies of the xy spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialBin {
    /// Mean radius of the ring's frequencies, in cycles per pixel.
    pub frequency: f64,
    /// Mean power; white noise is 1.
    pub power: f64,
    /// Frequencies in the ring.
    pub count: usize,
}

/// Integrands are summed in this many parts, whatever the number of threads; each holds its own sums.
const PARTS: usize = 8;

impl Spectra {
    /// Spectra of one error image `[frame, y, x]` (of a renderer, say) whose pixels have this variance in white
    /// noise; pass the image's own mean square to look at the shape alone.
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

    /// Spectra of a table's error in the dimension group `dims`, averaged over all integrands, each relative to
    /// its own white noise.
    ///
    /// O(sites log sites) per integrand; parallel, and independent of the number of threads.
    ///
    /// # Errors
    /// A bad dimension group (as in [`super::error_image()`]).
    pub fn of_table(
        table: &SampleTable,
        dims: &[usize],
        integrands: &Integrands,
    ) -> Result<Self, ConfigError> {
        let points = Points::new(table, dims, integrands.dims())?;
        let extent = points.extent;
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
                        for (pixel, error) in image.iter_mut().zip(points.errors(integrand)) {
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

    /// Error energy of `xy` at radii above 0 up to `cutoff` cycles per pixel, relative to white noise there: 1
    /// for white noise, near 0 for blue noise. NaN if no frequency is that low.
    ///
    /// The spatial Gaussian with `sigma_px = 2.1` halves the power at 0.09 cycles per pixel; 0.1 is a good cutoff.
    pub fn low_frequency_share(&self, cutoff: f64) -> f64 {
        let low = self.frequencies().filter(|&(radius, _)| radius <= cutoff);
        let (sum, count) = low.fold((0.0, 0.0), |(sum, count), (_, power)| (sum + power, count + 1.0));
        sum / count
    }

    /// Radius in cycles per pixel and power of every frequency of `xy` but zero.
    fn frequencies(&self) -> impl Iterator<Item = (f64, f64)> {
        let (height, width) = self.xy.dim();
        let cycles = |at: usize, len: usize| (at as f64 - (len / 2) as f64) / len as f64;
        self.xy
            .indexed_iter()
            .map(move |((row, column), &power)| (cycles(row, height).hypot(cycles(column, width)), power))
            .filter(|&(radius, _)| radius > 0.0)
    }
}

/// Sums of powers over images and slices of them, in the order of the transforms.
struct Sums {
    shape: [usize; 3],
    plane: [Transform; 2],
    scratch: [Scratch; 2],
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

fn accumulate(plane: &Transform, scratch: &mut Scratch, power: &mut [f64]) {
    plane.forward(scratch);
    for (power, value) in power.iter_mut().zip(&scratch.data) {
        *power += value.norm_sqr();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{Estimate, Family, error_image};
    use crate::table::extent::Extent;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use ndarray::Array3;

    fn image(shape: (usize, usize, usize), f: impl Fn(usize, usize, usize) -> f64) -> Spectra {
        Spectra::of_image(Array3::from_shape_fn(shape, |(t, y, x)| f(t, y, x)).view(), 1.0)
    }

    /// All power at one frequency: N times white noise there, nothing elsewhere.
    fn assert_peaks(spectrum: &Array2<f64>, peaks: &[([usize; 2], f64)]) {
        for ((row, column), &power) in spectrum.indexed_iter() {
            let peak = peaks.iter().find(|(at, _)| *at == [row, column]);
            assert_abs_diff_eq!(power, peak.map_or(0.0, |(_, power)| *power), epsilon = 1e-10);
        }
    }

    #[test]
    fn patterns_peak_where_they_should() {
        let sign = |n: usize| if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        // A checkerboard that stands still: the Nyquist frequency, which is row and column 0 of a centred array.
        let checkerboard = image((4, 6, 8), |_, y, x| sign(x + y));
        assert_peaks(&checkerboard.xy, &[([0, 0], 48.0)]);
        assert_peaks(&checkerboard.xt, &[([2, 0], 32.0)]);
        // Flicker of whole frames; a constant.
        let flicker = image((4, 6, 8), |t, _, _| sign(t));
        assert_peaks(&flicker.xy, &[([3, 4], 48.0)]);
        assert_peaks(&flicker.xt, &[([0, 4], 32.0)]);
        // One cycle down 5 rows, two cycles across 7 columns: a wave and its mirror share the power ½ · 35.
        let wave = image((1, 5, 7), |_, y, x| {
            (std::f64::consts::TAU * (y as f64 / 5.0 + 2.0 * x as f64 / 7.0)).cos()
        });
        assert_peaks(&wave.xy, &[([3, 5], 8.75), ([1, 1], 8.75)]);
        let radial = wave.radial();
        let peak = radial.iter().max_by(|a, b| a.power.total_cmp(&b.power)).unwrap();
        // Two frequencies of the ring around 0.35 · 7 ≈ 2: radius (1/5, 2/7).
        assert!((peak.frequency - 0.2_f64.hypot(2.0 / 7.0)).abs() < 0.5 / 7.0);
        assert_abs_diff_eq!(wave.low_frequency_share(0.2), 0.0, epsilon = 1e-12);
        assert!(wave.low_frequency_share(0.36) > 1.0);
        assert!(wave.low_frequency_share(0.01).is_nan());
    }

    /// Mean power over 64 tables of every frequency within 5 standard errors of 1 (192 checks, p = 1e-4).
    #[test]
    fn white_noise_is_flat() {
        let extent = Extent { frames: 3, height: 6, width: 8, spp: 2 };
        let integrands = Integrands::random(2, 16, 1).unwrap();
        let spectra: Vec<Spectra> = (0..64)
            .map(|seed| {
                let table = SampleTable::white_noise(extent, 2, seed).unwrap();
                Spectra::of_table(&table, &[1, 0], &integrands).unwrap()
            })
            .collect();
        let check = |pick: &dyn Fn(&Spectra) -> f64| {
            let over = Estimate::of(spectra.iter().map(pick));
            assert!((over.mean - 1.0).abs() < 5.0 * over.standard_error, "{over:?}");
            assert!(over.standard_error < 0.2, "{over:?}");
        };
        for x in 0..8 {
            for y in 0..6 {
                check(&|spectra| spectra.xy[[y, x]]);
            }
            for t in 0..3 {
                check(&|spectra| spectra.xt[[t, x]]);
            }
        }
        check(&|spectra| spectra.radial()[1].power);
        check(&|spectra| spectra.low_frequency_share(0.25));
    }

    #[test]
    fn a_table_is_the_mean_of_its_images() {
        let extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };
        let table = SampleTable::white_noise(extent, 3, 7).unwrap();
        let integrands = Integrands::random(2, 3, 1).unwrap();
        let spectra = Spectra::of_table(&table, &[2, 1], &integrands).unwrap();
        let (mut xy, mut xt) = (Array2::zeros((3, 4)), Array2::zeros((2, 4)));
        for integrand in Family::ALL.iter().flat_map(|&family| integrands.family(family)) {
            let errors = error_image(&table, &[2, 1], integrand).unwrap();
            let one = Spectra::of_image(errors.view(), integrand.variance() / 2.0);
            xy += &(one.xy / 12.0);
            xt += &(one.xt / 12.0);
        }
        for (mean, expected) in spectra.xy.iter().chain(&spectra.xt).zip(xy.iter().chain(&xt)) {
            assert_relative_eq!(mean, expected, max_relative = 1e-10);
        }
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Spectra::of_table(&table, &[2, 1], &integrands).unwrap())
        };
        assert_eq!(on(1), on(2));
    }
}
