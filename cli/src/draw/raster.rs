//! Pictures of 8 bits per sample, and the one way in which they become files.

use std::io::{self, Write};
use std::path::Path;

use fsot::files::WholeFile;
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

use crate::Failure;

/// A picture, row by row from the top: grey if pixels have one sample, sRGB if they have three.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster<const SAMPLES: usize> {
    width: usize,
    height: usize,
    pixels: Vec<[u8; SAMPLES]>,
}

/// Of grey pixels.
pub type Grey = Raster<1>;
/// Of pixels in red, green and blue.
pub type Color = Raster<3>;

/// The 8-bit level of a brightness in `[0, 1]`; others are clamped.
pub fn grey(brightness: f64) -> u8 {
    (brightness.clamp(0.0, 1.0) * 255.0).round() as u8
}

impl<const SAMPLES: usize> Raster<SAMPLES> {
    const COLOR: ColorType = match SAMPLES {
        1 => ColorType::Grayscale,
        3 => ColorType::Rgb,
        _ => panic!("a pixel has one sample or three"),
    };

    /// A picture whose pixels are all the same.
    pub fn filled(width: usize, height: usize, pixel: [u8; SAMPLES]) -> Self {
        Self { width, height, pixels: vec![pixel; width * height] }
    }

    /// A picture whose pixel in column `x` and row `y` is `pixel(x, y)`.
    pub fn from_fn(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [u8; SAMPLES]) -> Self {
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self { width, height, pixels: rows.map(|(x, y)| pixel(x, y)).collect() }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All samples, row by row.
    pub fn samples(&self) -> &[u8] {
        self.pixels.as_flattened()
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[[u8; SAMPLES]] {
        &self.pixels
    }

    /// A pixel to change; `None` outside of the picture.
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> Option<&mut [u8; SAMPLES]> {
        if x < self.width { self.pixels.get_mut(y * self.width + x) } else { None }
    }

    /// Writes a PNG file, which appears whole or not at all.
    ///
    /// # Errors
    /// A picture without pixels; a path that cannot be written.
    pub fn write_png(&self, path: &Path) -> io::Result<()> {
        WholeFile::write(path, |out| self.encode(out))?.commit()
    }

    /// The same for a person who has given the path as `--out`.
    ///
    /// # Errors
    /// The same, in one sentence with the path.
    pub fn save(&self, path: &Path) -> Result<(), Failure> {
        self.write_png(path)
            .map_err(|error| format!("cannot write {}: {error}; choose another --out", path.display()).into())
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// A picture without pixels.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.encode(&mut bytes)?;
        Ok(bytes)
    }

    fn encode(&self, out: &mut impl Write) -> io::Result<()> {
        let [width, height] = [self.width, self.height].map(u32::try_from);
        let too_large = |_| io::Error::new(io::ErrorKind::InvalidInput, "a side is beyond 2^32 - 1 pixels");
        let mut encoder = Encoder::new(out, width.map_err(too_large)?, height.map_err(too_large)?);
        encoder.set_color(Self::COLOR);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::High);
        let write = || {
            let mut writer = encoder.write_header()?;
            writer.write_image_data(self.samples())?;
            // Not left to `drop`, which has nobody to tell.
            writer.finish()
        };
        write().map_err(|error| match error {
            EncodingError::IoError(error) => error,
            other => io::Error::other(other),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_decoder_reads_what_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let color = Color::from_fn(31, 17, |x, y| [8 * x as u8, 15 * y as u8, (x * y) as u8]);
        color.save(&path).unwrap();
        let read = image::open(&path).unwrap();
        assert_eq!([read.width(), read.height()], [31, 17]);
        assert_eq!(read.as_rgb8().unwrap().as_raw(), color.samples());
        let mut grey = Grey::filled(3, 2, [7]);
        *grey.pixel_mut(2, 1).unwrap() = [200];
        assert_eq!(grey.pixel_mut(3, 0), None);
        assert_eq!(grey.pixel_mut(0, 2), None);
        grey.save(&path).unwrap();
        assert_eq!(image::open(&path).unwrap().as_luma8().unwrap().as_raw(), &[7, 7, 7, 7, 7, 200]);
    }

    #[test]
    fn failures_name_the_file_and_leave_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        Grey::filled(2, 2, [0]).save(&path).unwrap();
        let before = std::fs::read(&path).unwrap();
        let error = Grey::filled(0, 2, [0]).save(&path).unwrap_err().to_string();
        assert!(error.contains("picture.png") && error.ends_with("choose another --out"), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), before);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        let missing = folder.path().join("missing").join("picture.png");
        let error = Grey::filled(2, 2, [0]).save(&missing).unwrap_err().to_string();
        assert!(error.contains("there is no directory"), "{error}");
    }

    #[test]
    fn a_writer_that_fails_is_heard_of() {
        /// Takes so many bytes and no more.
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                if bytes.len() > self.0 {
                    return Err(io::ErrorKind::StorageFull.into());
                }
                self.0 -= bytes.len();
                Ok(bytes.len())
            }

            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let picture = Color::from_fn(20, 20, |x, y| [x as u8, y as u8, 0]);
        let mut whole = Vec::new();
        picture.encode(&mut whole).unwrap();
        for room in 0..whole.len() {
            let error = picture.encode(&mut Full(room)).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{room} of {}", whole.len());
        }
        picture.encode(&mut Full(whole.len())).unwrap();
    }
}
