//! Pictures in linear light, and the files that they come from.

mod canvas;
mod exif;
mod exr;
mod icc;
mod layers;
mod levels;
mod light;
mod options;
mod pixels;
mod png;
mod primaries;
mod transfer;

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

pub(super) use canvas::Raster;
pub use options::{PictureOptions, Transfer};
pub(super) use pixels::NAME;
pub use pixels::Pixels;

use super::density::{Density, with_room};
use crate::error::{PictureError, TargetError};

/// A picture in linear light: red, green, blue, each multiplied by alpha, and alpha of every pixel, row by
/// row from the top.
///
/// Colours are those of Rec. 709; 1 is the light of white paper, and full cover. The product is what comes
/// from a pixel: light without cover, as of a flame, is light. Light beyond 1, as of lamps, is kept; so are
/// values that are not finite, which densities refuse.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// A picture of these pixels: red, green and blue, each multiplied by alpha, and alpha.
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
    /// More than 2²² pixels are averaged down to as many: see [`PictureOptions::most_pixels`], and
    /// [`Transfer`] for what the numbers of a file mean. Pixels that a file calls wider than high (`pHYs` of
    /// PNG, `pixelAspectRatio` of EXR, by more than 0.5 %) become square, by stretching.
    ///
    /// PNG: of an animation, the picture for those who show none; turned as its `eXIf` says; `bKGD` paints
    /// nothing. EXR: what lies within the display window, and around the data nothing, or black where there
    /// is no alpha. The channels are `R`, `G` and `B`, or `Y` alone, of the first part that has them, or
    /// those of a layer: see [`PictureOptions::layer`].
    ///
    /// # Errors
    /// A file that cannot be read, that is neither PNG nor EXR, or that is damaged; a side beyond 65535, more
    /// than 2²⁷ pixels; colours that are not understood; an EXR file without such channels, or with several
    /// layers; no memory.
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
        Self::open_with(path, &PictureOptions::default())
    }

    /// The same, read in another way.
    ///
    /// # Errors
    /// Those of [`Picture::open`], with the limit of the options, and no layer of the name.
    pub fn open_with(path: impl AsRef<Path>, options: &PictureOptions) -> Result<Self, PictureError> {
        let path = path.as_ref();
        Self::of_raster(read(path, options, Ok)?, path)
    }

    /// The same of pixels in memory.
    ///
    /// # Errors
    /// No pixels, a side beyond 65535, more pixels than the limit of the options, no or more than 4 channels,
    /// no memory.
    pub fn from_pixels(pixels: Pixels<'_>, options: &PictureOptions) -> Result<Self, PictureError> {
        Self::of_raster(pixels.read(options, Ok)?, Path::new(NAME))
    }

    fn of_raster(raster: Raster<4>, path: &Path) -> Result<Self, PictureError> {
        let Raster { size: [width, height], values: [red, green, blue, alpha] } = raster;
        let mut pixels = Vec::new();
        canvas::reserve(path, &mut pixels, width * height)?;
        pixels.extend((0..width * height).map(|at| [red[at], green[at], blue[at], alpha[at]]));
        Ok(Self { width, height, pixels })
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue, multiplied by alpha, and alpha, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// `N` numbers of every pixel.
    pub(super) fn convert<const N: usize>(
        &self,
        convert: impl Fn([f32; 4]) -> Result<[f32; N], f32>,
    ) -> Result<Raster<N>, TargetError> {
        let mut values = [(); N].map(|()| Vec::new());
        for values in &mut values {
            *values = with_room(self.pixels.len())?;
        }
        for (index, &pixel) in self.pixels.iter().enumerate() {
            let numbers = convert(pixel).map_err(|value| {
                let [x, y] = [index % self.width, index / self.width];
                TargetError::BadDensity { x, y, value: value.into() }
            })?;
            values.iter_mut().zip(numbers).for_each(|(values, number)| values.push(number));
        }
        Ok(Raster { size: [self.width, self.height], values })
    }
}

/// What `convert` makes of the pixels of a file.
pub(super) fn read<const N: usize>(
    path: &Path,
    options: &PictureOptions,
    convert: impl Fn([f32; 4]) -> Result<[f32; N], f32>,
) -> Result<Raster<N>, PictureError> {
    let unreadable = |source| PictureError::Read { path: path.into(), source };
    let file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut file = BufReader::new(file);
    let mut start = Vec::new();
    file.by_ref().take(8).read_to_end(&mut start).map_err(unreadable)?;
    file.rewind().map_err(unreadable)?;
    if start == png::SIGNATURE {
        png::read(file, path, options, convert)
    } else if start.starts_with(&exr::SIGNATURE) {
        exr::read(file, length, path, options, convert)
    } else {
        Err(PictureError::Format { path: path.into(), start })
    }
}
