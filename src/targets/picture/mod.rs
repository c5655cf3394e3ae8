//! Pictures in linear light, and the files that they come from.

mod exr;
mod png;
mod transfer;

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use super::density::Density;
use crate::error::{PictureError, TargetError};

/// A picture in linear light: red, green, blue and straight alpha of every pixel, row by row from the top.
///
/// 1 is the light of white paper, and full cover. Light beyond, as of lamps, is kept; so are values that are
/// not finite, which densities refuse.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// A picture of these pixels.
    ///
    /// # Errors
    /// A side of 0 or beyond 65535, a wrong number of pixels.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 4]>) -> Result<Self, TargetError> {
        Density::check_size([width, height])?;
        if pixels.len() != width * height {
            let expected = width * height;
            return Err(TargetError::DensityCount { given: pixels.len(), width, height, expected });
        }
        Ok(Self { width, height, pixels })
    }

    /// The picture of a file: PNG of any depth, grey, in colours or with a palette, or EXR. Its first bytes
    /// say what it is, not its name.
    ///
    /// PNG is taken for sRGB. EXR is linear, and its colours, which are multiplied by alpha, are divided by
    /// it; of several parts the first with channels `R`, `G` and `B` is read.
    ///
    /// # Errors
    /// A file that cannot be read, that is neither PNG nor EXR, or that is damaged; a side beyond 65535, more
    /// than 2²⁷ pixels.
    ///
    /// ```
    /// use fsot::targets::{Density, Picture, Tone};
    ///
    /// let picture = Picture::open("data/lantern.png")?;
    /// assert_eq!([picture.width(), picture.height()], [360, 270]);
    /// let dark = Density::from_picture(&picture, Tone::Dark)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PictureError> {
        let path = path.as_ref();
        let unreadable = |source| PictureError::Read { path: path.into(), source };
        let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
        let mut start = Vec::new();
        file.by_ref().take(8).read_to_end(&mut start).map_err(unreadable)?;
        file.rewind().map_err(unreadable)?;
        if start == png::SIGNATURE {
            png::read(file, path)
        } else if start.starts_with(&exr::SIGNATURE) {
            exr::read(file, path)
        } else {
            Err(PictureError::Format { path: path.into(), start })
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green, blue and alpha, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }
}

/// Refuses what a file says of its size before memory is set aside for it.
fn check_size(path: &Path, [width, height]: [usize; 2]) -> Result<(), PictureError> {
    /// 2 GiB of pixels.
    const MOST: usize = 1 << 27;
    Density::check_size([width, height])
        .map_err(|problem| PictureError::Density { path: path.into(), problem })?;
    if width * height > MOST {
        return Err(PictureError::TooLarge { path: path.into(), width, height, most: MOST });
    }
    Ok(())
}
