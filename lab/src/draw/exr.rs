//! EXR files, for measuring.

use std::io;
use std::path::Path;

use exr::error::Error;
use exr::image::{Image, SpecificChannels};
use exr::math::Vec2;
use exr::prelude::WritableImage;
use fsot::files::WholeFile;

/// Writes a picture of so many columns and rows, linear and in 32 bits; the file appears whole or not at all.
///
/// # Errors
/// A picture without pixels; a path that cannot be written.
pub fn write_exr(
    path: &Path,
    [width, height]: [usize; 2],
    pixel: impl Fn(usize, usize) -> [f32; 3] + Sync,
) -> io::Result<()> {
    let channels = SpecificChannels::rgb(|Vec2(x, y): Vec2<usize>| <(f32, f32, f32)>::from(pixel(x, y)));
    let image = Image::from_channels((width, height), channels);
    WholeFile::write(path, |out| {
        image.write().non_parallel().to_buffered(out).map_err(|error| match error {
            Error::Io(error) => error,
            other => io::Error::other(other),
        })
    })?
    .commit()
}
