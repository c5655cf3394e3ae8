//! Pictures: arrays, files, and what other packages make of them.

use std::path::PathBuf;

use fsot::targets::{Density, Inks, PictureError, PictureOptions, Pixels, Tone, Transfer};
use ndarray::ArrayView3;
use numpy::Element;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, refuse_masked};
use crate::counts::Count;
use crate::errors::refused;

/// A picture as it was given.
#[derive(Debug)]
pub enum Picture {
    File(PathBuf),
    U8(Array<u8>),
    U16(Array<u16>),
    F32(Array<f32>),
}

/// Numbers `[y, x, channel]`.
#[derive(Debug)]
pub struct Array<T> {
    shape: [usize; 3],
    values: Vec<T>,
}

/// How it is read.
#[derive(Debug)]
pub struct Reading {
    pub tone: Tone,
    pub options: PictureOptions,
}

impl Reading {
    /// Of the arguments of a function.
    pub fn of(
        tone: &str,
        transfer: Option<&str>,
        layer: Option<String>,
        most_pixels: Option<Count>,
        limit_pixels: Count,
    ) -> PyResult<Self> {
        let tone = match tone {
            "dark" => Tone::Dark,
            "bright" => Tone::Bright,
            other => return Err(refused(format!("'{other}' is no tone: write dark or bright"))),
        };
        let transfer = match transfer {
            None => Transfer::FromFile,
            Some("srgb") => Transfer::Srgb,
            Some("linear") => Transfer::Linear,
            Some(other) => {
                return Err(refused(format!("'{other}' is no transfer: write srgb or linear, or give None")));
            }
        };
        if let Some(Count(0)) = most_pixels {
            return Err(refused("most_pixels is 0: give at least 1, or None to leave every pixel as it is"));
        }
        let most_pixels = most_pixels.map(|Count(most)| most);
        let options = PictureOptions { transfer, layer, most_pixels, limit_pixels: limit_pixels.0 };
        Ok(Self { tone, options })
    }
}

impl Picture {
    /// The name of a file, or an array `[y, x]` or `[y, x, channel]`.
    ///
    /// # Errors
    /// Anything else, and numbers whose range says nothing.
    pub fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(path) = object.extract::<PathBuf>() {
            return Ok(Self::File(path));
        }
        refuse_palettes(object)?;
        refuse_masked(object)?;
        let array = object.py().import("numpy")?.call_method1("asarray", (object,)).map_err(|error| {
            let word = error.value(object.py());
            PyTypeError::new_err(format!("no picture: {word}; give an array or the name of a file"))
        })?;
        let dtype = array.getattr("dtype")?;
        let kind: String = dtype.getattr("kind")?.extract()?;
        let bytes: usize = dtype.getattr("itemsize")?.extract()?;
        match (kind.as_str(), bytes) {
            ("b", _) => {
                let mut array = Array::<u8>::of(&array)?;
                array.values.iter_mut().for_each(|value| *value *= u8::MAX);
                Ok(Self::U8(array))
            }
            ("u", 1) => Ok(Self::U8(Array::of(&array)?)),
            ("u", 2) => Ok(Self::U16(Array::of(&array)?)),
            ("f", _) => Ok(Self::F32(Array::of(&array)?)),
            _ => Err(PyTypeError::new_err(format!(
                "a picture of dtype {dtype}: give uint8 (white is 255), uint16 (white is 65535), floats \
                 (white is 1), or the name of a file"
            ))),
        }
    }

    /// What draws points.
    pub fn density(&self, Reading { tone, options }: &Reading) -> Result<Density, PictureError> {
        match self {
            Self::File(path) => Density::open_with(path, *tone, options),
            Self::U8(array) => Density::from_pixels(Pixels::U8(array.view()), *tone, options),
            Self::U16(array) => Density::from_pixels(Pixels::U16(array.view()), *tone, options),
            Self::F32(array) => Density::from_pixels(Pixels::F32(array.view()), *tone, options),
        }
    }

    /// What draws points of four inks.
    pub fn inks(&self, Reading { options, .. }: &Reading) -> Result<Inks, PictureError> {
        match self {
            Self::File(path) => Inks::open_with(path, options),
            Self::U8(array) => Inks::from_pixels(Pixels::U8(array.view()), options),
            Self::U16(array) => Inks::from_pixels(Pixels::U16(array.view()), options),
            Self::F32(array) => Inks::from_pixels(Pixels::F32(array.view()), options),
        }
    }
}

impl<T: Element + Copy> Array<T> {
    fn of(array: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::of(array)?;
        let shape = match *shape.as_slice() {
            [height, width] => [height, width, 1],
            [height, width, channels] => [height, width, channels],
            _ => {
                return Err(refused(format!(
                    "a picture of shape {shape:?}: give two axes [y, x] or three [y, x, channel]"
                )));
            }
        };
        Ok(Self { shape, values })
    }

    fn view(&self) -> ArrayView3<'_, T> {
        ArrayView3::from_shape(self.shape, &self.values).expect("it fits its shape")
    }
}

/// Pillow gives the numbers of a palette, and of inks, for those of colours.
fn refuse_palettes(object: &Bound<'_, PyAny>) -> PyResult<()> {
    let Some(mode) = object.getattr_opt("mode")?.and_then(|mode| mode.extract::<String>().ok()) else {
        return Ok(());
    };
    match mode.as_str() {
        "1" | "L" | "LA" | "RGB" | "RGBA" | "I;16" | "F" => Ok(()),
        _ => Err(refused(format!(
            "a picture of mode {mode}: give picture.convert('RGB'), or 'RGBA' if it is transparent"
        ))),
    }
}
