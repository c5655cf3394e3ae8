//! Pictures as densities: what is dark in them, or bright.

use std::path::Path;

use super::density::Density;
use super::picture::Picture;
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

impl Density {
    /// The density of a picture's luminance (Rec. 709 weights).
    ///
    /// [`Tone::Dark`] counts what is missing to white, [`Tone::Bright`] the light; both times alpha, so that
    /// nothing lies where a picture is transparent.
    ///
    /// # Errors
    /// A picture without any such density (all white, all black, all transparent), one with values that are
    /// not finite.
    pub fn from_picture(picture: &Picture, tone: Tone) -> Result<Self, TargetError> {
        let values = picture.pixels().iter().map(|&[red, green, blue, alpha]| {
            let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
            alpha
                * match tone {
                    // A comparison, so that NaN is not lost.
                    Tone::Dark if luminance > 1.0 => 0.0,
                    Tone::Dark => 1.0 - luminance,
                    Tone::Bright => luminance,
                }
        });
        Self::new(picture.width(), picture.height(), values.collect())
    }

    /// The same of a PNG or EXR file.
    ///
    /// # Errors
    /// Whatever [`Picture::open`] and [`Density::from_picture`] refuse.
    pub fn open(path: impl AsRef<Path>, tone: Tone) -> Result<Self, PictureError> {
        let path = path.as_ref();
        Self::from_picture(&Picture::open(path)?, tone)
            .map_err(|problem| PictureError::Density { path: path.to_owned(), problem })
    }
}
