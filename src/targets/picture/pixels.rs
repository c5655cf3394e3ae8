//! Pictures in memory.

use std::path::Path;

use ndarray::{ArrayView1, ArrayView2, ArrayView3, Axis};

use super::canvas::{Canvas, Raster, check_size, reserve};
use super::exif::Orientation;
use super::levels::{Levels, covered};
use super::light::Light;
use super::options::{PictureOptions, Transfer};
use super::transfer::srgb;
use crate::error::PictureError;

/// A picture in memory: numbers `[row, column, channel]`, rows from the top, of 1 (grey), 2 (grey and alpha),
/// 3 (red, green and blue) or 4 channels (the same and alpha), in the colours of Rec. 709. Colours are as
/// they are before alpha multiplies them.
///
/// Points that follow it are those that follow a PNG file of the same numbers. Of the options `layer` says
/// nothing here.
///
/// ```
/// use fsot::targets::{Density, PictureOptions, Pixels, Tone};
/// use ndarray::array;
///
/// let grey = array![[[0_u8], [255]]];
/// let options = PictureOptions::default();
/// let density = Density::from_pixels(Pixels::U8(grey.view()), Tone::Dark, &options)?;
/// assert_eq!((density.size(), density.values()), ([2, 1], &[1.0, 0.0][..]));
/// # Ok::<(), fsot::targets::PictureError>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Pixels<'a> {
    /// Levels from 0 to 255: sRGB, unless [`Transfer::Linear`] says otherwise.
    U8(ArrayView3<'a, u8>),
    /// Levels from 0 to 65535: sRGB, unless [`Transfer::Linear`] says otherwise.
    U16(ArrayView3<'a, u16>),
    /// Light, of which white paper gives 1; sRGB values from 0 to 1 if [`Transfer::Srgb`] says so.
    F32(ArrayView3<'a, f32>),
}

/// What stands where a file has a name.
pub(in crate::targets) const NAME: &str = "the picture";

impl Pixels<'_> {
    /// What `convert` makes of the pixels.
    pub(in crate::targets) fn read<const N: usize>(
        self,
        options: &PictureOptions,
        convert: impl Fn([f32; 4]) -> Result<[f32; N], f32>,
    ) -> Result<Raster<N>, PictureError> {
        let (height, width, channels) = match self {
            Self::U8(array) => array.dim(),
            Self::U16(array) => array.dim(),
            Self::F32(array) => array.dim(),
        };
        if !(1..=4).contains(&channels) {
            return Err(PictureError::ChannelCount { given: channels });
        }
        let path = Path::new(NAME);
        check_size(path, [width, height], options)?;
        let mut canvas = Canvas::new(path, [width, height], 1.0, options, convert)?;
        let mut pixels = Vec::new();
        reserve(path, &mut pixels, width)?;
        let light = Light::of_levels(options.transfer);
        match self {
            Self::U8(array) => {
                let levels = Levels::new(&light, channels, u8::MAX.into());
                let pixel = |at: ArrayView1<'_, u8>| levels.pixel(|channel| at[channel].into());
                each_row(array, &mut pixels, pixel, |row, pixels| canvas.put(row, [0, 1], pixels))?;
            }
            Self::U16(array) => {
                let levels = Levels::new(&light, channels, u16::MAX);
                let pixel = |at: ArrayView1<'_, u16>| levels.pixel(|channel| at[channel].into());
                each_row(array, &mut pixels, pixel, |row, pixels| canvas.put(row, [0, 1], pixels))?;
            }
            Self::F32(array) => {
                let linear = options.transfer != Transfer::Srgb;
                let light = |value: f32| if linear { value } else { srgb(value) };
                let pixel = |at: ArrayView1<'_, f32>| {
                    let colors = [0, 1, 2].map(|color| light(at[if channels < 3 { 0 } else { color }]));
                    covered(colors, if channels % 2 == 0 { at[channels - 1] } else { 1.0 })
                };
                each_row(array, &mut pixels, pixel, |row, pixels| canvas.put(row, [0, 1], pixels))?;
            }
        }
        canvas.finish(Orientation::default())
    }
}

fn each_row<T>(
    array: ArrayView3<'_, T>,
    pixels: &mut Vec<[f32; 4]>,
    pixel: impl Fn(ArrayView1<'_, T>) -> [f32; 4],
    mut put: impl FnMut(usize, &[[f32; 4]]) -> Result<(), PictureError>,
) -> Result<(), PictureError> {
    for (row, line) in array.axis_iter(Axis(0)).enumerate() {
        let line: ArrayView2<'_, T> = line;
        pixels.clear();
        pixels.extend(line.axis_iter(Axis(0)).map(&pixel));
        put(row, pixels)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use ndarray::Array3;
    use png::{BitDepth, ColorType, Encoder};

    use super::*;
    use crate::random;
    use crate::targets::{Density, Inks, Picture, Tone};

    /// Random levels; every fourth is the lowest or the highest.
    fn levels(shape: [usize; 3]) -> Array3<u16> {
        let values = random::uniforms(9, shape.iter().product());
        let level = |(at, value): (usize, f32)| match at % 8 {
            0 => 0,
            4 => u16::MAX,
            _ => (value * 65536.0) as u16,
        };
        Array3::from_shape_vec(shape, values.into_iter().enumerate().map(level).collect()).unwrap()
    }

    fn write(path: &Path, levels: &Array3<u16>, depth: BitDepth) {
        let (height, width, channels) = levels.dim();
        let mut encoder = Encoder::new(File::create(path).unwrap(), width as u32, height as u32);
        encoder.set_color(
            [ColorType::Grayscale, ColorType::GrayscaleAlpha, ColorType::Rgb, ColorType::Rgba][channels - 1],
        );
        encoder.set_depth(depth);
        let bytes: Vec<u8> = match depth {
            BitDepth::Eight => levels.iter().map(|level| (level >> 8) as u8).collect(),
            _ => levels.iter().flat_map(|level| level.to_be_bytes()).collect(),
        };
        encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    }

    /// The very same numbers, also where they are averaged.
    #[test]
    fn an_array_is_the_picture_of_its_file() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("picture.png");
        for channels in 1..=4 {
            let deep = levels([13, 17, channels]);
            let shallow = deep.mapv(|level| (level >> 8) as u8);
            for transfer in [Transfer::FromFile, Transfer::Srgb, Transfer::Linear] {
                for most_pixels in [None, Some(60)] {
                    let options = PictureOptions { transfer, most_pixels, ..PictureOptions::default() };
                    for depth in [BitDepth::Eight, BitDepth::Sixteen] {
                        write(&path, &deep, depth);
                        let pixels = match depth {
                            BitDepth::Eight => Pixels::U8(shallow.view()),
                            _ => Pixels::U16(deep.view()),
                        };
                        let says = format!("{channels} {transfer:?} {most_pixels:?} {depth:?}");
                        for tone in [Tone::Dark, Tone::Bright] {
                            let file = Density::open_with(&path, tone, &options).unwrap();
                            assert_eq!(Density::from_pixels(pixels, tone, &options).unwrap(), file, "{says}");
                        }
                        let file = Inks::open_with(&path, &options).unwrap();
                        assert_eq!(Inks::from_pixels(pixels, &options).unwrap(), file, "{says}");
                        let file = Picture::open_with(&path, &options).unwrap();
                        assert_eq!(Picture::from_pixels(pixels, &options).unwrap(), file, "{says}");
                    }
                }
            }
        }
    }

    #[test]
    fn floats_are_light_unless_said_otherwise() {
        let of = |channels: usize, values: &[f32], transfer| {
            let array = Array3::from_shape_vec([1, 1, channels], values.to_vec()).unwrap();
            let options = PictureOptions { transfer, ..PictureOptions::default() };
            Picture::from_pixels(Pixels::F32(array.view()), &options).unwrap().pixels()[0]
        };
        assert_eq!(of(1, &[0.5], Transfer::FromFile), [0.5, 0.5, 0.5, 1.0]);
        assert_eq!(of(2, &[4.0, 0.25], Transfer::Linear), [1.0, 1.0, 1.0, 0.25]);
        assert_eq!(of(3, &[0.1, 0.2, 0.3], Transfer::FromFile), [0.1, 0.2, 0.3, 1.0]);
        assert_eq!(of(4, &[1.0, 0.5, 0.0, 0.5], Transfer::Linear), [0.5, 0.25, 0.0, 0.5]);
        let [red, ..] = of(1, &[0.5], Transfer::Srgb);
        assert!((red - 0.214_041).abs() < 1e-5, "{red}"); // IEC 61966-2-1
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let refused = |array: ArrayView3<'_, f32>| {
            let options = PictureOptions { limit_pixels: 1000, ..PictureOptions::default() };
            Density::from_pixels(Pixels::F32(array), Tone::Dark, &options).unwrap_err().to_string()
        };
        assert!(refused(Array3::zeros([2, 2, 0]).view()).contains("0 channels"));
        assert!(refused(Array3::zeros([2, 2, 5]).view()).contains("5 channels"));
        assert!(refused(Array3::zeros([0, 2, 4]).view()).contains("height"));
        assert!(refused(Array3::zeros([40, 40, 1]).view()).starts_with("the picture has 40 x 40 pixels"));
        assert!(refused(Array3::from_elem([2, 2, 1], f32::NAN).view()).starts_with("the picture: "));
        assert!(refused(Array3::ones([2, 2, 1]).view()).contains("above 0"));
    }
}
