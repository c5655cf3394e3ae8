//! Images: linear luminance per pixel and frame, and their way into files.

use std::io;
use std::path::Path;

use fsot_cli::draw::raster::Grey;

use super::error::{RenderError, not_empty};
use crate::draw::{srgb, write_exr};

/// Linear luminance `[frame][y][x]` in C order.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    shape: [usize; 3],
    values: Vec<f64>,
}

impl Film {
    /// A film from values in C order.
    ///
    /// # Errors
    /// An empty axis; a number of values that does not fit the shape.
    pub fn new(shape: [usize; 3], values: Vec<f64>) -> Result<Self, RenderError> {
        for (axis, len) in ["frames", "height", "width"].into_iter().zip(shape) {
            not_empty(axis, len)?;
        }
        let expected = shape.iter().product();
        if values.len() != expected {
            return Err(RenderError::Length { given: values.len(), expected });
        }
        Ok(Self { shape, values })
    }

    /// A film of zeros.
    ///
    /// # Errors
    /// An empty axis.
    pub fn black(shape: [usize; 3]) -> Result<Self, RenderError> {
        Self::new(shape, vec![0.0; shape.iter().product()])
    }

    /// Frames, height and width.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// All values in C order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All values in C order, to change.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The pixels of one frame, row by row.
    ///
    /// # Errors
    /// A frame that the film does not have.
    pub fn frame(&self, frame: usize) -> Result<&[f64], RenderError> {
        let [frames, height, width] = self.shape;
        if frame >= frames {
            return Err(RenderError::NoSuchFrame { frame, frames });
        }
        Ok(&self.values[frame * height * width..(frame + 1) * height * width])
    }

    /// The differences of all values from those of another film: the error, if that is the truth.
    ///
    /// # Errors
    /// Different shapes.
    pub fn minus(&self, truth: &Self) -> Result<Self, RenderError> {
        if self.shape != truth.shape {
            let (given, expected) = (self.shape, truth.shape);
            return Err(RenderError::Shape { what: "the rendering", given, expected });
        }
        let pairs = self.values.iter().zip(&truth.values);
        Ok(Self { shape: self.shape, values: pairs.map(|(value, truth)| value - truth).collect() })
    }

    /// One frame as 8-bit grey: times `exposure`, clamped to `[0, 1]`, sRGB curve.
    ///
    /// # Errors
    /// A frame that the film does not have.
    pub fn to_grey(&self, frame: usize, exposure: f64) -> Result<Grey, RenderError> {
        let values = self.frame(frame)?;
        let [_, height, width] = self.shape;
        Ok(Grey::from_fn(width, height, |x, y| [srgb(values[y * width + x] * exposure)]))
    }

    /// Writes [`to_grey`](Self::to_grey) as PNG; the file appears whole or not at all.
    ///
    /// # Errors
    /// A frame that the film does not have; a path that cannot be written.
    pub fn save_png(&self, path: impl AsRef<Path>, frame: usize, exposure: f64) -> Result<(), RenderError> {
        let path = path.as_ref();
        self.to_grey(frame, exposure)?.write_png(path).map_err(|source| unwritten(path, source))
    }

    /// Writes one frame as EXR: linear, 32-bit, the luminance in each of R, G and B, which every viewer
    /// shows. The file appears whole or not at all.
    ///
    /// # Errors
    /// A frame that the film does not have; a path that cannot be written.
    pub fn save_exr(&self, path: impl AsRef<Path>, frame: usize) -> Result<(), RenderError> {
        let path = path.as_ref();
        let values = self.frame(frame)?;
        let [_, height, width] = self.shape;
        write_exr(path, [width, height], |x, y| [values[y * width + x] as f32; 3])
            .map_err(|source| unwritten(path, source))
    }
}

fn unwritten(path: &Path, source: io::Error) -> RenderError {
    RenderError::Io { verb: "write", path: path.into(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back() {
        let directory = tempfile::tempdir().unwrap();
        let film = Film::new([2, 1, 3], vec![0.0, 0.0, 0.0, 0.25, 1.0, 7.5]).unwrap();
        let path = directory.path().join("a.exr");
        film.save_exr(&path, 1).unwrap();
        let read = image::open(&path).unwrap().into_rgb32f();
        assert_eq!(read.pixels().map(|p| p[1]).collect::<Vec<_>>(), [0.25, 1.0, 7.5]);
        let path = directory.path().join("a.png");
        film.save_png(&path, 1, 1.0).unwrap();
        let read = image::open(&path).unwrap().into_luma8();
        // sRGB of 0.25 is 0.5371 (IEC 61966-2-1): 136.96.
        assert_eq!(read.as_raw(), &[137, 255, 255]);
    }

    #[test]
    fn mistakes_are_named() {
        let film = Film::black([1, 2, 2]).unwrap();
        let error = film.save_png("/no/such/place.png", 0, 1.0).unwrap_err();
        assert!(error.to_string().contains("/no/such/place.png"), "{error}");
        assert!(matches!(film.frame(1), Err(RenderError::NoSuchFrame { frame: 1, frames: 1 })));
        assert!(matches!(Film::black([1, 0, 2]), Err(RenderError::Extent(_) | RenderError::Range(_))));
        let error = Film::new([1, 2, 2], vec![0.0; 3]).unwrap_err();
        assert!(matches!(error, RenderError::Length { given: 3, expected: 4 }));
    }
}
