//! Pictures as densities: what is dark in them, or bright.

use std::path::Path;

use super::density::Density;
use super::picture::{NAME, Picture, PictureOptions, Pixels, Raster, read};
use crate::error::{PictureError, TargetError};

/// Which part of a picture draws points.
///
/// ```
/// use fsot::targets::{Density, Picture, Tone};
///
/// let picture = Picture::new(2, 1, vec![[0.25, 0.25, 0.25, 1.0], [1.0, 1.0, 1.0, 1.0]])?;
/// assert_eq!(Density::from_picture(&picture, Tone::Bright)?.values()[0], 0.25);
/// assert_eq!(Density::from_picture(&picture, Tone::Dark)?.values()[0], 0.75);
/// # Ok::<(), fsot::targets::TargetError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// What is dark, as ink does on paper.
    #[default]
    Dark,
    /// What is bright, as light does: for importance sampling.
    Bright,
}

impl Tone {
    /// Density of a pixel, or the number that can be none.
    fn density(self, [red, green, blue, alpha]: [f32; 4]) -> Result<[f32; 1], f32> {
        let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
        let value = match self {
            // A comparison, so that NaN is not lost.
            Tone::Dark if luminance > alpha => 0.0,
            Tone::Dark => alpha - luminance,
            Tone::Bright => luminance,
        };
        if value.is_finite() && value >= 0.0 { Ok([value]) } else { Err(value) }
    }
}

impl Density {
    /// The density of a picture's luminance (Rec. 709 weights).
    ///
    /// [`Tone::Bright`] counts the light, whatever its alpha; [`Tone::Dark`] what is missing to white where
    /// the picture lies on white paper. Nothing lies where a picture is transparent and gives no light.
    ///
    /// # Errors
    /// A picture without any such density (all white, all black, all transparent), one with values that are
    /// not finite, or with less light than none.
    pub fn from_picture(picture: &Picture, tone: Tone) -> Result<Self, TargetError> {
        Self::of_raster(picture.convert(|pixel| tone.density(pixel))?)
    }

    /// The same of a PNG or EXR file, averaged down to 2²² pixels if there are more.
    ///
    /// The file is read row by row: it takes 4 bytes for each pixel that is kept, twice that to turn them,
    /// and those of a few rows, or of one tile of an EXR file.
    ///
    /// # Errors
    /// Whatever [`Picture::open`] and [`Density::from_picture`] refuse.
    pub fn open(path: impl AsRef<Path>, tone: Tone) -> Result<Self, PictureError> {
        Self::open_with(path, tone, &PictureOptions::default())
    }

    /// The same, read in another way.
    ///
    /// # Errors
    /// Whatever [`Picture::open_with`] and [`Density::from_picture`] refuse.
    pub fn open_with(
        path: impl AsRef<Path>,
        tone: Tone,
        options: &PictureOptions,
    ) -> Result<Self, PictureError> {
        let path = path.as_ref();
        let raster = read(path, options, |pixel| tone.density(pixel))?;
        Self::of_raster(raster).map_err(|problem| PictureError::Density { path: path.into(), problem })
    }

    /// The same of pixels in memory.
    ///
    /// # Errors
    /// Whatever [`Picture::from_pixels`] and [`Density::from_picture`] refuse.
    pub fn from_pixels(
        pixels: Pixels<'_>,
        tone: Tone,
        options: &PictureOptions,
    ) -> Result<Self, PictureError> {
        let raster = pixels.read(options, |pixel| tone.density(pixel))?;
        Self::of_raster(raster).map_err(|problem| PictureError::Density { path: NAME.into(), problem })
    }

    fn of_raster(raster: Raster<1>) -> Result<Self, TargetError> {
        let Raster { size: [width, height], values: [values] } = raster;
        Self::new(width, height, values)
    }
}
