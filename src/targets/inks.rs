//! Pictures as inks: cyan, magenta, yellow and black.

use std::path::Path;

use super::density::Density;
use super::density_sum::DensitySum;
use super::picture::{NAME, Picture, PictureOptions, Pixels, Raster, read};
use crate::error::{PictureError, TargetError};

/// Density of each ink of a picture: cyan, magenta, yellow and black, 0 to 1 per pixel.
///
/// ```
/// use fsot::targets::{Inks, Picture};
///
/// // Cyan and black, side by side.
/// let picture = Picture::new(2, 1, vec![[0.0, 1.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]])?;
/// assert_eq!(Inks::from_picture(&picture)?.counts(100), [50, 0, 0, 50]);
/// # Ok::<(), fsot::targets::TargetError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Inks {
    /// None of an ink that covers nothing.
    coverage: [Option<Density>; 4],
}

impl Inks {
    /// The inks of a picture on white paper: black replaces what the colours have in common. Transparency
    /// shows the paper.
    ///
    /// # Errors
    /// A picture without any ink, or with values that are not finite.
    pub fn from_picture(picture: &Picture) -> Result<Self, TargetError> {
        Self::of_raster(picture.convert(separated)?)
    }

    /// The same of a PNG or EXR file, averaged down to 2²² pixels if there are more, ink by ink.
    ///
    /// The file is read row by row: it takes 16 bytes for each pixel that is kept, twice that to turn them,
    /// and those of a few rows, or of one tile of an EXR file.
    ///
    /// # Errors
    /// Whatever [`Picture::open`] and [`Inks::from_picture`] refuse.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PictureError> {
        Self::open_with(path, &PictureOptions::default())
    }

    /// The same, read in another way.
    ///
    /// # Errors
    /// Whatever [`Picture::open_with`] and [`Inks::from_picture`] refuse.
    pub fn open_with(path: impl AsRef<Path>, options: &PictureOptions) -> Result<Self, PictureError> {
        let path = path.as_ref();
        Self::of_raster(read(path, options, separated)?)
            .map_err(|problem| PictureError::Density { path: path.into(), problem })
    }

    /// The same of pixels in memory.
    ///
    /// # Errors
    /// Whatever [`Picture::from_pixels`] and [`Inks::from_picture`] refuse.
    pub fn from_pixels(pixels: Pixels<'_>, options: &PictureOptions) -> Result<Self, PictureError> {
        Self::of_raster(pixels.read(options, separated)?)
            .map_err(|problem| PictureError::Density { path: NAME.into(), problem })
    }

    fn of_raster(raster: Raster<4>) -> Result<Self, TargetError> {
        let Raster { size: [width, height], values } = raster;
        let coverage = values.map(|values| Density::new(width, height, values).ok());
        match coverage.iter().all(Option::is_none) {
            true => Err(TargetError::NoDensity { width, height }),
            false => Ok(Self { coverage }),
        }
    }

    /// Density of an ink (0 cyan, 1 magenta, 2 yellow, 3 black); `None` if there is none of it.
    pub fn density(&self, ink: usize) -> Option<Density> {
        self.coverage.get(ink)?.clone()
    }

    /// Points of each ink if there are `count` in all, in proportion to what it covers.
    pub fn counts(&self, count: usize) -> [usize; 4] {
        let masses: [f64; 4] =
            std::array::from_fn(|ink| self.coverage[ink].as_ref().map_or(0.0, Density::mass));
        let total: f64 = masses.iter().sum();
        let (mut before, mut below) = (0, 0.0);
        masses.map(|mass| {
            below += mass;
            // Rounded sums, so that they add up.
            let upto = (count as f64 * (below / total)).round() as usize;
            std::mem::replace(&mut before, upto).abs_diff(upto)
        })
    }

    /// Some inks together; `None` if there is none of any.
    pub(crate) fn together(&self, inks: &[u32]) -> Option<DensitySum> {
        let parts = inks.iter().filter_map(|&ink| self.density(ink as usize)).collect();
        DensitySum::new(parts).ok()
    }
}

/// Inks of a pixel on white paper, or the number that stands against them.
fn separated([red, green, blue, alpha]: [f32; 4]) -> Result<[f32; 4], f32> {
    if let Some(value) = [red, green, blue, alpha].into_iter().find(|value| !value.is_finite()) {
        return Err(value);
    }
    let [red, green, blue] = [red, green, blue].map(|light| (light + 1.0 - alpha).clamp(0.0, 1.0));
    let lightest = red.max(green).max(blue);
    let ink = |light: f32| if lightest > 0.0 { 1.0 - light / lightest } else { 0.0 };
    Ok([ink(red), ink(green), ink(blue), 1.0 - lightest])
}
