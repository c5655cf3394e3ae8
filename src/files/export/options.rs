//! What a table is exported as: the format, the numbers in it, and how they are rounded.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::files::dtype::Dtype;

/// A format that engines read, and that [`SampleTable::import`](crate::SampleTable::import) reads back.
///
/// ```
/// use fsot::files::Format;
///
/// assert_eq!("ktx2".parse(), Ok(Format::Ktx2));
/// assert_eq!(Format::Ktx2.to_string(), "ktx2");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Format {
    /// One PNG picture, frames one below the other.
    #[cfg(feature = "image")]
    Atlas,
    /// One PNG picture per frame.
    #[cfg(feature = "image")]
    Slices,
    /// A KTX 2.0 file: a 2-D texture, or an array of them, one layer per frame.
    Ktx2,
    /// One OpenEXR picture per frame.
    #[cfg(feature = "image")]
    Exr,
    /// One OpenEXR file, with a layer per frame.
    #[cfg(feature = "image")]
    #[serde(rename = "exr-layers")]
    ExrLayers,
    /// Bare little-endian numbers in the order of the table, and a text file that says which.
    Raw,
    /// Four `f32` a texel without a header, what FAST reads as `-init`.
    Fast,
    /// C++ source text with the blue-noise textures of pbrt-v4, `[texture][x][y]`.
    Pbrt,
    /// A header for C99 and C++ with an array and functions that read it.
    C,
    /// Text, one sample a line, numbers between commas below the names of columns.
    Csv,
    /// Text, one sample a line, numbers between blanks.
    Dat,
}

/// The numbers that a file holds.
///
/// ```
/// use fsot::files::Depth;
///
/// assert_eq!("half".parse(), Ok(Depth::Half));
/// assert_eq!(Depth::U16.levels(), Some(65536));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Depth {
    /// Levels of 8 bits: `k` stands for `(k + 1/2) / 256`.
    #[serde(rename = "8")]
    U8,
    /// Levels of 16 bits: `k` stands for `(k + 1/2) / 65536`.
    #[serde(rename = "16")]
    U16,
    /// IEEE floating point of 16 bits, the nearest below 1.
    #[serde(rename = "half")]
    Half,
    /// IEEE floating point of 32 bits: the values themselves.
    #[serde(rename = "32")]
    F32,
}

/// Which of the two nearest levels a value becomes.
///
/// ```
/// use fsot::files::Rounding;
///
/// assert_eq!("floor".parse(), Ok(Rounding::Floor));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Rounding {
    /// The level in whose interval it lies: `floor(v 2^b)`. What a level stands for is the nearest that
    /// there is.
    #[default]
    Floor,
    /// As many of each level as by `Floor`, in each frame and dimension, but some of the values that lie
    /// nearest to the border of two levels are exchanged across it, so that rounding errors cancel in the
    /// neighbourhood instead of being independent. Matters where the filtered error of smooth integrands is
    /// tiny, and levels are of 8 bits; errors of single values grow to three quarters of a level. Takes two
    /// bytes a value.
    ///
    /// No rounding helps integrands that compare a number with a threshold: whether a random number is below
    /// it has a probability that is a multiple of 1/256 where there are 256 levels.
    Diffuse,
}

/// What a table is exported as.
///
/// ```
/// use fsot::files::{Depth, ExportOptions, Format};
///
/// let options = ExportOptions { depth: Some(Depth::U16), ..ExportOptions::new(Format::Ktx2) };
/// assert_eq!(options.depth(), Depth::U16);
/// assert_eq!(ExportOptions::new(Format::Ktx2).depth(), Depth::U8);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ExportOptions {
    /// The format.
    pub format: Format,
    /// The numbers in it; those that are usual in the format if they are not given.
    pub depth: Option<Depth>,
    /// How values become levels.
    pub rounding: Rounding,
    /// Names of the files, without folder and extension. `{name}` stands for the name of the path that is
    /// given, `{kind}` for `scalar`, `vec2`, `vec3` or `vec4`, `{width}`, `{height}` and `{frames}` for
    /// lengths, `{sample}`, `{dims}` and `{frame}` for what of the table is in a file: 3, 0-3, 17.
    ///
    /// If it is not given: `{name}`, followed by `_s{sample}` where files differ in samples and `_d{dims}`
    /// where they differ in dimensions. Where each frame has a file,
    /// `_{kind}_2Dx1D_{width}x{height}x{frames}` stands before these and `_{frame}` behind them.
    pub name: Option<String>,
}

impl ExportOptions {
    /// The format with all that is usual in it.
    pub fn new(format: Format) -> Self {
        Self { format, depth: None, rounding: Rounding::default(), name: None }
    }

    /// The numbers in the files.
    pub fn depth(&self) -> Depth {
        self.depth.unwrap_or(self.format.rule().depths[0])
    }
}

/// What a file of a format can hold.
pub(super) struct Rule {
    /// The extension of its name.
    pub(super) extension: &'static str,
    /// Numbers that it can hold, the usual ones first.
    pub(super) depths: &'static [Depth],
    /// Consecutive dimensions of one file at most: its channels.
    pub(super) most_dims: usize,
    /// Whether one file holds all samples of a pixel, or each has a file.
    pub(super) all_samples: bool,
    /// Whether one file holds all frames, or each has a file.
    pub(super) all_frames: bool,
}

impl Format {
    /// All formats.
    pub const ALL: &[Self] = &[
        #[cfg(feature = "image")]
        Self::Atlas,
        #[cfg(feature = "image")]
        Self::Slices,
        Self::Ktx2,
        #[cfg(feature = "image")]
        Self::Exr,
        #[cfg(feature = "image")]
        Self::ExrLayers,
        Self::Raw,
        Self::Fast,
        Self::Pbrt,
        Self::C,
        Self::Csv,
        Self::Dat,
    ];

    /// `atlas`, `slices`, `ktx2`, `exr`, `exr-layers`, `raw`, `fast`, `pbrt`, `c`, `csv`, `dat`.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(feature = "image")]
            Self::Atlas => "atlas",
            #[cfg(feature = "image")]
            Self::Slices => "slices",
            Self::Ktx2 => "ktx2",
            #[cfg(feature = "image")]
            Self::Exr => "exr",
            #[cfg(feature = "image")]
            Self::ExrLayers => "exr-layers",
            Self::Raw => "raw",
            Self::Fast => "fast",
            Self::Pbrt => "pbrt",
            Self::C => "c",
            Self::Csv => "csv",
            Self::Dat => "dat",
        }
    }

    /// What a file of it can hold. A texture has one sample of a pixel, and up to four dimensions; what is no
    /// texture holds a whole table.
    pub(super) fn rule(self) -> Rule {
        use Depth::{F32, Half, U8, U16};
        let texture = |extension, depths, all_frames| Rule {
            extension,
            depths,
            most_dims: 4,
            all_samples: false,
            all_frames,
        };
        let whole = |extension, depths| Rule {
            extension,
            depths,
            most_dims: usize::MAX,
            all_samples: true,
            all_frames: true,
        };
        match self {
            #[cfg(feature = "image")]
            Self::Atlas => texture("png", &[U8, U16], true),
            #[cfg(feature = "image")]
            Self::Slices => texture("png", &[U8, U16], false),
            Self::Ktx2 => texture("ktx2", &[U8, U16, Half, F32], true),
            #[cfg(feature = "image")]
            Self::Exr => texture("exr", &[F32, Half], false),
            #[cfg(feature = "image")]
            Self::ExrLayers => texture("exr", &[F32, Half], true),
            Self::Raw => whole("raw", &[F32, U16, U8, Half]),
            Self::Fast => texture("bin", &[F32], true),
            Self::Pbrt => whole("cpp", &[U16]),
            Self::C => whole("h", &[F32, U16, U8]),
            Self::Csv => whole("csv", &[F32]),
            Self::Dat => whole("dat", &[F32]),
        }
    }
}

impl Depth {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::U8, Self::U16, Self::Half, Self::F32];

    /// `8`, `16`, `half` or `32`.
    pub fn name(self) -> &'static str {
        ["8", "16", "half", "32"][self as usize]
    }

    /// How many levels there are; `None` for floating point.
    pub fn levels(self) -> Option<u32> {
        match self {
            Self::U8 => Some(1 << 8),
            Self::U16 => Some(1 << 16),
            Self::Half | Self::F32 => None,
        }
    }

    /// The type of the numbers, little-endian.
    pub(in crate::files) fn dtype(self) -> Dtype {
        [Dtype::U8, Dtype::U16, Dtype::HALF, Dtype::TABLE][self as usize]
    }

    /// Bytes of a number.
    pub fn bytes(self) -> usize {
        [1, 2, 2, 4][self as usize]
    }

    /// What a number of a file stands for, as it is written into the metadata.
    pub fn decode_rule(self) -> &'static str {
        match self {
            Self::U8 => "(k + 0.5) / 256",
            Self::U16 => "(k + 0.5) / 65536",
            Self::Half | Self::F32 => "v",
        }
    }
}

impl Rounding {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Floor, Self::Diffuse];

    /// `floor` or `diffuse`.
    pub fn name(self) -> &'static str {
        ["floor", "diffuse"][self as usize]
    }
}

/// By its name, or the list of names.
fn named<T: Copy>(text: &str, all: &[T], name: fn(T) -> &'static str) -> Result<T, String> {
    let found = all.iter().find(|&&one| name(one) == text);
    let names = || all.iter().map(|&one| name(one)).collect::<Vec<_>>().join(", ");
    found.copied().ok_or_else(|| format!("give one of {}", names()))
}

macro_rules! by_name {
    ($($type:ty),*) => {$(
        impl fmt::Display for $type {
            fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
                out.write_str(self.name())
            }
        }

        impl $type {
            /// All names, for help texts.
            pub fn names() -> String {
                Self::ALL.iter().map(|one| one.name()).collect::<Vec<_>>().join(", ")
            }
        }

        impl FromStr for $type {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                named(text, <$type>::ALL.as_ref(), Self::name)
            }
        }
    )*};
}

by_name!(Format, Depth, Rounding);
