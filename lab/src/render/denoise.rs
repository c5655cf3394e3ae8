//! An edge-avoiding filter guided by normals and depth: the denoiser after the sampler[^dammertz].
//!
//! [^dammertz]: Dammertz, Sewtz, Hanika, Lensch 2010, "Edge-avoiding À-trous wavelet transform for fast
//!     global illumination filtering", HPG. Weights of normals as in Schied et al. 2017, "Spatiotemporal
//!     variance-guided filtering", HPG; of depth, by the distance from the tangent plane.

use fsot::config::RangeError;
use rayon::prelude::*;

use super::error::RenderError;
use super::film::Film;
use super::guides::{Guide, Guides};

/// An à-trous filter: `levels` passes of a 5 × 5 B-spline whose taps lie 1, 2, 4, … pixels apart, each tap
/// weighted by how alike the surfaces are. One level alone is a bilateral filter of 5 × 5 pixels.
///
/// The radiance takes no part in the weights, so the filter is linear: what it makes of an error does not
/// depend on the truth, and the expectation for white noise is exact ([`Denoiser::apply_to_variance`]).
/// Weights inside the picture sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Denoiser {
    /// Passes, from 1 to 5; 3 reach 14 pixels.
    pub levels: u32,
    /// Exponent of the cosine between normals, at least 0; 128 in Schied et al. 2017. 0 ignores normals.
    pub normal_power: f64,
    /// Distance from the tangent plane, as a share of the depth, at which a weight falls to 1/e; positive.
    /// Infinite ignores depth.
    pub plane_share: f64,
}

impl Default for Denoiser {
    fn default() -> Self {
        Self { levels: 3, normal_power: 128.0, plane_share: 0.01 }
    }
}

/// The B-spline's taps `0, ±1, ±2`.
const SPLINE: [f64; 3] = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];

/// Taps of a pass and their weights, per pixel; taps outside the picture weigh 0.
type Pass = Vec<[(u32, f64); 25]>;

impl Denoiser {
    /// Filters every frame of a film by the guides of that frame.
    ///
    /// O(pixels · levels · 25).
    ///
    /// # Errors
    /// A parameter outside its range; not one guide per frame; guides of another resolution.
    pub fn apply(&self, film: &Film, guides: &[Guides]) -> Result<Film, RenderError> {
        self.check(film, guides)?;
        let [_, height, width] = film.shape();
        let mut out = film.clone();
        out.values_mut().par_chunks_exact_mut(height * width).zip(guides).for_each(|(image, guides)| {
            for pass in self.passes(guides) {
                let filtered =
                    pass.iter().map(|taps| taps.iter().map(|tap| tap.1 * image[tap.0 as usize]).sum());
                let filtered: Vec<f64> = filtered.collect();
                image.copy_from_slice(&filtered);
            }
        });
        Ok(out)
    }

    /// Variances after the filter, from those of independent pixels: the weights of all passes together,
    /// squared.
    ///
    /// O(pixels · 25 · 4^levels).
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub fn apply_to_variance(&self, variance: &Film, guides: &[Guides]) -> Result<Film, RenderError> {
        self.check(variance, guides)?;
        let [_, height, width] = variance.shape();
        let mut out = variance.clone();
        out.values_mut().par_chunks_exact_mut(height * width).zip(guides).for_each(|(image, guides)| {
            let passes = self.passes(guides);
            // The row of the product of passes that belongs to one pixel, from the last pass to the first.
            let (mut row, mut next) = (vec![0.0; image.len()], vec![0.0; image.len()]);
            let mut touched: Vec<u32> = Vec::new();
            let filtered = (0..image.len() as u32).map(|pixel| {
                let mut active = vec![pixel];
                row[pixel as usize] = 1.0;
                for pass in passes.iter().rev() {
                    for &at in &active {
                        let weight = std::mem::take(&mut row[at as usize]);
                        for &(tap, share) in pass[at as usize].iter().filter(|tap| tap.1 > 0.0) {
                            if next[tap as usize] == 0.0 {
                                touched.push(tap);
                            }
                            next[tap as usize] += weight * share;
                        }
                    }
                    std::mem::swap(&mut row, &mut next);
                    std::mem::swap(&mut active, &mut touched);
                    touched.clear();
                }
                let take = |&at: &u32| std::mem::take(&mut row[at as usize]).powi(2) * image[at as usize];
                active.iter().map(take).sum()
            });
            let filtered: Vec<f64> = filtered.collect();
            image.copy_from_slice(&filtered);
        });
        Ok(out)
    }

    fn check(&self, film: &Film, guides: &[Guides]) -> Result<(), RenderError> {
        let bad = |name, value, expected| Err(RangeError::new(name, value, expected).into());
        if !(1..=5).contains(&self.levels) {
            return bad("levels", self.levels.into(), "from 1 to 5");
        }
        if !(self.normal_power >= 0.0 && self.normal_power.is_finite()) {
            return bad("normal_power", self.normal_power, "of at least 0, finite");
        }
        if self.plane_share.is_nan() || self.plane_share <= 0.0 {
            return bad("plane_share", self.plane_share, "above 0");
        }
        let expected = film.shape();
        let [height, width] = guides.first().map_or([0; 2], Guides::resolution);
        let same = guides.iter().all(|guides| guides.resolution() == [height, width]);
        let given = [guides.len(), height, width];
        if given != expected || !same {
            return Err(RenderError::Shape { what: "the list of guides", given, expected });
        }
        Ok(())
    }

    /// The passes for these guides, first to last.
    fn passes(&self, guides: &Guides) -> Vec<Pass> {
        let [height, width] = guides.resolution();
        let pixels = guides.pixels();
        let pass = |level: u32| {
            let taps = |pixel: usize| {
                let (y, x) = ((pixel / width) as i64, (pixel % width) as i64);
                let mut taps = [(pixel as u32, 0.0); 25];
                let mut sum = 0.0;
                for (i, tap) in taps.iter_mut().enumerate() {
                    let (dy, dx) = (i as i64 / 5 - 2, i as i64 % 5 - 2);
                    let (y, x) = (y + (dy << level), x + (dx << level));
                    if y < 0 || x < 0 || y >= height as i64 || x >= width as i64 {
                        continue;
                    }
                    let other = y as usize * width + x as usize;
                    let spline = SPLINE[dy.unsigned_abs() as usize] * SPLINE[dx.unsigned_abs() as usize];
                    *tap = (other as u32, spline * self.likeness(&pixels[pixel], &pixels[other]));
                    sum += tap.1;
                }
                // A pixel is always like itself, so the sum is positive.
                taps.iter_mut().for_each(|tap| tap.1 /= sum);
                taps
            };
            (0..height * width).map(taps).collect()
        };
        (0..self.levels).map(pass).collect()
    }

    /// How alike two surfaces are, from 0 to 1.
    fn likeness(&self, here: &Option<Guide>, there: &Option<Guide>) -> f64 {
        match (here, there) {
            (None, None) => 1.0,
            (Some(here), Some(there)) => {
                let turned = here.normal.dot(&there.normal).clamp(0.0, 1.0).powf(self.normal_power);
                let off = (there.point - here.point).dot(&here.normal).abs();
                turned * (-off / (self.plane_share * here.depth)).exp()
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::*;
    use crate::render::{Reference, Scene, render};
    use crate::samplers::WhiteNoise;

    const RESOLUTION: [usize; 2] = [24, 24];

    fn guides(scene: &Scene) -> Vec<Guides> {
        vec![Guides::render(scene, 0, RESOLUTION).unwrap()]
    }

    #[test]
    fn a_constant_passes_and_nothing_crosses_an_edge() {
        let scene = Scene::by_name("soft_shadow").unwrap();
        let guides = guides(&scene);
        let denoiser = Denoiser::default();
        let grey = Film::new([1, 24, 24], vec![0.25; 576]).unwrap();
        for value in denoiser.apply(&grey, &guides).unwrap().values() {
            assert!((value - 0.25).abs() < 1e-12);
        }
        // 1 on the background, 0 on surfaces: it stays so.
        let mask: Vec<f64> =
            guides[0].pixels().iter().map(|guide| f64::from(u8::from(guide.is_none()))).collect();
        let share = mask.iter().sum::<f64>() / 576.0;
        assert!(share > 0.1 && share < 0.9, "{share}");
        let film = Film::new([1, 24, 24], mask.clone()).unwrap();
        for (after, before) in denoiser.apply(&film, &guides).unwrap().values().iter().zip(&mask) {
            assert!((after - before).abs() < 1e-12);
        }
    }

    #[test]
    fn the_variance_of_white_noise_is_predicted() {
        // Impulses at all pixels one after the other give the weights; their squares are the prediction.
        let scene = Scene::by_name("soft_shadow").unwrap();
        let guides = guides(&scene);
        let denoiser = Denoiser { levels: 2, ..Denoiser::default() };
        let ones = Film::new([1, 24, 24], vec![1.0; 576]).unwrap();
        let predicted = denoiser.apply_to_variance(&ones, &guides).unwrap();
        let mut squares = vec![0.0; 576];
        for pixel in 0..576 {
            let mut impulse = Film::black([1, 24, 24]).unwrap();
            impulse.values_mut()[pixel] = 1.0;
            let spread = denoiser.apply(&impulse, &guides).unwrap();
            squares.iter_mut().zip(spread.values()).for_each(|(sum, value)| *sum += value * value);
        }
        for (square, predicted) in squares.iter().zip(predicted.values()) {
            approx::assert_relative_eq!(square, predicted, max_relative = 1e-9);
        }
    }

    /// What of 1 on the left half crosses a step in the middle, of the normal or of the plane.
    fn leak(denoiser: Denoiser, turned: bool, off: f64) -> f64 {
        let guide = |pixel: usize| {
            let right = pixel % 24 >= 12;
            let normal = if right && turned { Vector3::x() } else { Vector3::z() };
            Some(Guide { point: Point3::new(0.0, 0.0, if right { off } else { 0.0 }), normal, depth: 1.0 })
        };
        let guides = [Guides::new(RESOLUTION, (0..576).map(guide).collect()).unwrap()];
        let left = (0..576).map(|pixel| if pixel % 24 < 12 { 1.0 } else { 0.0 }).collect();
        let after = denoiser.apply(&Film::new([1, 24, 24], left).unwrap(), &guides).unwrap();
        after.values().iter().enumerate().filter(|(pixel, _)| pixel % 24 >= 12).map(|(_, value)| value).sum()
    }

    #[test]
    fn nothing_crosses_a_step_of_the_normal_or_of_the_plane() {
        let denoiser = Denoiser::default();
        let free = leak(denoiser, false, 0.0);
        assert!(free > 10.0, "{free}");
        assert!(leak(denoiser, true, 0.0).abs() < 1e-12);
        // 100 planes apart: e^-100.
        assert!(leak(denoiser, false, 1.0).abs() < 1e-12);
        assert!((leak(Denoiser { normal_power: 0.0, ..denoiser }, true, 0.0) - free).abs() < 1e-9);
        assert!((leak(Denoiser { plane_share: f64::INFINITY, ..denoiser }, false, 1.0) - free).abs() < 1e-9);
        // A third of a share apart: some of it.
        let some = leak(denoiser, false, 0.01 / 3.0);
        assert!(some > 0.2 * free && some < 0.95 * free, "{some} of {free}");
    }

    #[test]
    fn guides_that_guide_nowhere_are_named() {
        let good = Guide { point: Point3::origin(), normal: Vector3::z(), depth: 1.0 };
        for (bad, text) in [
            (Guide { depth: 0.0, ..good }, "depth of a guide is 0"),
            (Guide { normal: Vector3::zeros(), ..good }, "normal is 0"),
            (Guide { point: Point3::new(f64::NAN, 0.0, 0.0), ..good }, "point is NaN"),
        ] {
            let error = Guides::new([1, 1], vec![Some(bad)]).unwrap_err().to_string();
            assert!(error.contains(text), "{error}");
        }
    }

    #[test]
    fn noise_is_reduced_and_mistakes_are_named() {
        let scene = Scene::by_name("soft_shadow").unwrap();
        let guides = guides(&scene);
        let film = render(&scene, &WhiteNoise::new(1), RESOLUTION, 1).unwrap();
        let truth = Reference::render(&scene, RESOLUTION, 256).unwrap().mean;
        // The filter is linear: what it makes of the noise alone.
        let noise = film.values().iter().zip(truth.values()).map(|(value, truth)| value - truth);
        let noise = Film::new(film.shape(), noise.collect()).unwrap();
        let power = |film: &Film| film.values().iter().map(|value| value * value).sum::<f64>();
        let after = Denoiser::default().apply(&noise, &guides).unwrap();
        assert!(power(&after) < 0.5 * power(&noise), "{} {}", power(&after), power(&noise));
        let error = Denoiser::default().apply(&film, &[]).unwrap_err();
        assert!(matches!(error, RenderError::Shape { given: [0, 0, 0], expected: [1, 24, 24], .. }));
        for bad in [
            Denoiser { levels: 0, ..Denoiser::default() },
            Denoiser { normal_power: -1.0, ..Denoiser::default() },
            Denoiser { plane_share: 0.0, ..Denoiser::default() },
        ] {
            assert!(
                matches!(bad.apply(&film, &guides), Err(RenderError::Extent(_) | RenderError::Range(_))),
                "{bad:?}"
            );
        }
    }
}
