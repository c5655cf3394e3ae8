//! Pictures as densities: linear light, luminance, alpha, and inks.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::{DynamicImage, ImageFormat, ImageReader, Rgba};

use super::density::Density;
use crate::error::{PictureError, TargetError};

/// Which part of a picture draws points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// What is dark, as ink does on paper.
    #[default]
    Dark,
    /// What is bright, as light does: for importance sampling.
    Bright,
}

/// Density of each ink of a picture: cyan, magenta, yellow and black, 0 to 1 per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Inks {
    /// Columns and rows.
    size: [usize; 2],
    coverage: [Vec<f32>; 4],
}

impl Density {
    /// The density of a picture's luminance (Rec. 709 weights) in linear light, with straight alpha. Integers are taken for sRGB; floating point
    /// numbers, as of an EXR, for linear.
    ///
    /// [`Tone::Dark`] counts what is missing to white, [`Tone::Bright`] the light; both times alpha, so that nothing lies where
    /// a picture is transparent.
    ///
    /// # Errors
    /// A picture without any such density (all white, all black, all transparent), one with values that are not finite or
    /// sides beyond 65535.
    pub fn from_picture(picture: &DynamicImage, tone: Tone) -> Result<Self, TargetError> {
        let values = linear(picture).map(|[red, green, blue, alpha]| {
            let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
            alpha
                * match tone {
                    // A comparison, so that NaN is not lost.
                    Tone::Dark if luminance > 1.0 => 0.0,
                    Tone::Dark => 1.0 - luminance,
                    Tone::Bright => luminance,
                }
        });
        Self::new(picture.width() as usize, picture.height() as usize, values.collect())
    }

    /// The same of a PNG or EXR file.
    ///
    /// # Errors
    /// A file that cannot be read as a picture; whatever [`Density::from_picture`] refuses.
    pub fn open(path: impl AsRef<Path>, tone: Tone) -> Result<Self, PictureError> {
        let path = path.as_ref();
        Self::from_picture(&read(path)?, tone)
            .map_err(|problem| PictureError::Density { path: path.to_owned(), problem })
    }
}

impl Inks {
    /// The inks of a picture on white paper: black replaces what the colours have in common. Transparency shows the paper;
    /// alpha is straight.
    ///
    /// # Errors
    /// A picture without any ink, with values that are not finite, or with sides beyond 65535.
    pub fn from_picture(picture: &DynamicImage) -> Result<Self, TargetError> {
        let size = [picture.width() as usize, picture.height() as usize];
        Density::check_size(size)?;
        let mut coverage = [(); 4].map(|()| Vec::with_capacity(size[0] * size[1]));
        for (index, [red, green, blue, alpha]) in linear(picture).enumerate() {
            let [x, y] = [index % size[0], index / size[0]];
            let bad = [red, green, blue, alpha].into_iter().find(|value| !value.is_finite());
            if let Some(value) = bad {
                return Err(TargetError::BadDensity { x, y, value: value.into() });
            }
            let [red, green, blue] =
                [red, green, blue].map(|light| (alpha * light + 1.0 - alpha).clamp(0.0, 1.0));
            let lightest = red.max(green).max(blue);
            let ink = |light: f32| if lightest > 0.0 { 1.0 - light / lightest } else { 0.0 };
            let inks = [ink(red), ink(green), ink(blue), 1.0 - lightest];
            coverage.iter_mut().zip(inks).for_each(|(coverage, ink)| coverage.push(ink));
        }
        if coverage.iter().flatten().all(|&ink| ink == 0.0) {
            return Err(TargetError::NoDensity { width: size[0], height: size[1] });
        }
        Ok(Self { size, coverage })
    }

    /// The same of a PNG or EXR file.
    ///
    /// # Errors
    /// A file that cannot be read as a picture; whatever [`Inks::from_picture`] refuses.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PictureError> {
        let path = path.as_ref();
        Self::from_picture(&read(path)?)
            .map_err(|problem| PictureError::Density { path: path.to_owned(), problem })
    }

    /// Density of an ink (0 cyan, 1 magenta, 2 yellow, 3 black); `None` if there is none of it.
    pub fn density(&self, ink: usize) -> Option<Density> {
        Density::new(self.size[0], self.size[1], self.coverage.get(ink)?.clone()).ok()
    }

    /// Points of each ink if there are `count` in all, in proportion to what it covers.
    pub fn counts(&self, count: usize) -> [usize; 4] {
        let masses: [f64; 4] =
            std::array::from_fn(|ink| self.coverage[ink].iter().map(|&value| f64::from(value)).sum());
        let total: f64 = masses.iter().sum();
        let (mut before, mut below) = (0, 0.0);
        masses.map(|mass| {
            below += mass;
            // Rounded sums, so that they add up.
            let upto = (count as f64 * (below / total)).round() as usize;
            std::mem::replace(&mut before, upto).abs_diff(upto)
        })
    }

    /// The density of some inks together, each with its mass; `None` if there is none of any.
    pub(crate) fn mixture(&self, inks: &[u32]) -> Option<Arc<Density>> {
        let mut values = vec![0.0; self.size[0] * self.size[1]];
        for coverage in inks.iter().filter_map(|&ink| self.coverage.get(ink as usize)) {
            values.iter_mut().zip(coverage).for_each(|(sum, ink)| *sum += ink);
        }
        Density::new(self.size[0], self.size[1], values).ok().map(Arc::new)
    }
}

fn read(path: &Path) -> Result<DynamicImage, PictureError> {
    let refused = |source| PictureError::Read { path: PathBuf::from(path), source };
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let reader = reader.map_err(|error| refused(error.into()))?;
    let is_exr = reader.format() == Some(ImageFormat::OpenExr);
    let mut picture = reader.decode().map_err(refused)?;
    if let (true, DynamicImage::ImageRgba32F(pixels)) = (is_exr, &mut picture) {
        // An EXR file holds colours that are multiplied by alpha already.
        for Rgba([red, green, blue, alpha]) in pixels.pixels_mut() {
            let share = if *alpha > 0.0 { alpha.recip() } else { 0.0 };
            [red, green, blue].into_iter().for_each(|light| *light *= share);
        }
    }
    Ok(picture)
}

/// Red, green, blue and alpha in linear light.
fn linear(picture: &DynamicImage) -> impl Iterator<Item = [f32; 4]> {
    let is_linear = matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let decode = move |value: f32| match value {
        _ if is_linear => value,
        // IEC 61966-2-1.
        ..=0.04045 => value / 12.92,
        _ => ((value + 0.055) / 1.055).powf(2.4),
    };
    let pixels: Vec<[f32; 4]> = picture.to_rgba32f().pixels().map(|pixel| pixel.0).collect();
    pixels.into_iter().map(move |[red, green, blue, alpha]| [decode(red), decode(green), decode(blue), alpha])
}
