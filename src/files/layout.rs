//! Which axis of somebody else's array is which of a table's.

use std::fmt;
use std::str::FromStr;

use super::import::ImportOptions;
use crate::error::ImportError;
use crate::table::extent::Extent;

/// An axis of a table.
///
/// ```
/// use fsot::files::Axis;
///
/// assert_eq!("sample".parse(), Ok(Axis::Sample));
/// assert_eq!(Axis::Y.to_string(), "y");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Frames of an animation.
    Frame,
    /// Rows of a frame.
    Y,
    /// Columns of a frame.
    X,
    /// Samples of a pixel.
    Sample,
    /// Dimensions of a sample.
    Dim,
}

impl Axis {
    /// All five, slowest first, as they lie in a table.
    pub const ALL: [Self; 5] = [Self::Frame, Self::Y, Self::X, Self::Sample, Self::Dim];

    /// `frame`, `y`, `x`, `sample` or `dim`.
    pub fn name(self) -> &'static str {
        ["frame", "y", "x", "sample", "dim"][self as usize]
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(self.name())
    }
}

impl FromStr for Axis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|axis| axis.name() == text);
        named.ok_or_else(|| format!("'{text}' is no axis: write frame, y, x, sample or dim"))
    }
}

/// Longest last axis that is taken for the dimensions of a sample; a longer one is a row of pixels.
const MOST_COLUMNS: usize = 16;

/// The last axes of pictures.
pub(super) const PICTURE: [Axis; 3] = [Axis::Y, Axis::X, Axis::Dim];

/// Where the axes of an array go.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Its axes, slowest first; empty where it is a list of samples, in the order of a table.
    pub(super) axes: Vec<Axis>,
    pub(super) extent: Extent,
    pub(super) dims: usize,
}

impl Layout {
    /// The layout of an array of this shape, whose axes are `known` if the file names them itself.
    pub(super) fn of(shape: &[usize], known: &[Axis], options: &ImportOptions) -> Result<Self, ImportError> {
        let layout = match options.lengths() {
            Some(lengths) if options.axes.is_empty() && known.ends_with(&PICTURE) => {
                Self::list(shape, of_picture(shape, lengths))?
            }
            None if options.axes.is_empty() && !known.is_empty() => Self::named(shape, known)?,
            None if !options.axes.is_empty() => Self::named(shape, &options.axes)?,
            Some(_) if !options.axes.is_empty() => return Err(ImportError::AxesAndLengths),
            // Five axes are those of a table, unless they have other lengths than are given.
            Some(lengths)
                if shape.len() == 5
                    && lengths
                        .iter()
                        .zip(shape)
                        .all(|(given, found)| given.is_none_or(|given| given == *found)) =>
            {
                Self::named(shape, &Axis::ALL)?
            }
            Some(lengths) => Self::list(shape, lengths)?,
            None => match usual(shape)? {
                axes if axes.is_empty() => Self::list(shape, [None; 5])?,
                axes => Self::named(&shape[shape.len() - axes.len()..], &axes)?,
            },
        };
        let Extent { frames, height, width, spp } = layout.extent;
        let shape = [frames, height, width, spp, layout.dims];
        layout.extent.validate(layout.dims).map_err(|problem| ImportError::Extent { shape, problem })?;
        Ok(layout)
    }

    fn named(shape: &[usize], axes: &[Axis]) -> Result<Self, ImportError> {
        if axes.len() != shape.len() {
            return Err(ImportError::AxesCount { shape: shape.to_vec(), named: axes.len() });
        }
        let mut lengths = [None; 5];
        for (&axis, &length) in axes.iter().zip(shape) {
            if lengths[axis as usize].replace(length).is_some() {
                return Err(ImportError::AxisTwice { axis: axis.name() });
            }
        }
        let [frames, height, width, spp, dims] = lengths.map(|length| length.unwrap_or(1));
        Ok(Self { axes: axes.to_vec(), extent: Extent { frames, height, width, spp }, dims })
    }

    /// Samples in the order of a table, of which some lengths are known.
    fn list(shape: &[usize], lengths: [Option<usize>; 5]) -> Result<Self, ImportError> {
        let [frames, height, width, spp, dims] = lengths;
        let columns = shape.last().copied().filter(|&last| shape.len() > 1 && last <= MOST_COLUMNS);
        let dims = dims.or(columns).unwrap_or(1);
        let values: usize = shape.iter().product();
        let known = [frames, height, width, spp, Some(dims)].into_iter().flatten();
        let given = known.fold(1_usize, usize::saturating_mul);
        if given == 0 || !values.is_multiple_of(given) {
            return Err(ImportError::Lengths { values, given });
        }
        let rest = values / given;
        let extent = |frames: Option<usize>, height, width, spp: Option<usize>| Extent {
            frames: frames.unwrap_or(1),
            height,
            width,
            spp: spp.unwrap_or(1),
        };
        let extent = match (height, width, frames, spp) {
            (None, None, ..) => {
                let side = rest.isqrt();
                if side * side != rest {
                    return Err(no_square(rest, frames, spp));
                }
                extent(frames, side, side, spp)
            }
            (Some(height), None, ..) => extent(frames, height, rest, spp),
            (None, Some(width), ..) => extent(frames, rest, width, spp),
            (Some(height), Some(width), None, Some(_)) => extent(Some(rest), height, width, spp),
            (Some(height), Some(width), Some(_), None) => extent(frames, height, width, Some(rest)),
            (Some(height), Some(width), ..) if rest == 1 => extent(frames, height, width, spp),
            (Some(_), Some(_), None, None) => return Err(ImportError::FramesOrSamples { times: rest }),
            (Some(_), Some(_), Some(_), Some(_)) => return Err(ImportError::Lengths { values, given }),
        };
        Ok(Self { axes: Vec::new(), extent, dims })
    }
}

/// Lengths of a picture, whose columns and channels are known.
fn of_picture(shape: &[usize], lengths: [Option<usize>; 5]) -> [Option<usize>; 5] {
    let [frames, height, width, spp, dims] = lengths;
    let &[.., columns, channels] = shape else { return lengths };
    let rest = |known: Option<usize>| match known {
        Some(known) if known > 0 && channels.is_multiple_of(known) => Some(channels / known),
        _ => None,
    };
    // Channels are samples and dimensions: all that are not said to be the one are the other.
    let dims = dims.or_else(|| rest(spp)).or(Some(channels));
    let spp = spp.or_else(|| rest(dims).filter(|&spp| spp > 1));
    [frames, height, width.or(Some(columns)), spp, dims]
}

/// The axes that an array of this shape usually has; none for a list of samples.
///
/// Pictures are as wide as high, and the axis before or behind them is that of frames.
fn usual(shape: &[usize]) -> Result<Vec<Axis>, ImportError> {
    use Axis::{Dim, Frame, Sample, X, Y};
    Ok(match *shape {
        [] | [_] => vec![],
        // A mask, however small.
        [rows, columns] if rows == columns => vec![Y, X],
        [_, columns] if columns <= MOST_COLUMNS => vec![],
        [_, _] => vec![Y, X],
        [first, second, last] if first == second && second == last => vec![Frame, Y, X],
        [_, _, last] if last <= MOST_COLUMNS => vec![Y, X, Dim],
        [first, second, last] if first == second && second != last => vec![Y, X, Frame],
        [_, _, _] => vec![Frame, Y, X],
        [first, second, third, _] if first == second && second != third => vec![Y, X, Sample, Dim],
        [_, _, _, _] => vec![Frame, Y, X, Dim],
        [ref empty @ .., _, _, _, _, _] if empty.iter().all(|&length| length == 1) => Axis::ALL.to_vec(),
        _ => return Err(ImportError::TooManyAxes { shape: shape.to_vec() }),
    })
}

/// Suggests as few frames, or samples per pixel, as leave a square; or a single row.
fn no_square(samples: usize, frames: Option<usize>, spp: Option<usize>) -> ImportError {
    /// Smaller pictures are a coincidence.
    const SMALLEST_SIDE: usize = 8;
    let sides = (SMALLEST_SIDE..=samples.isqrt()).rev();
    let side = sides.into_iter().find(|&side| samples.is_multiple_of(side * side));
    let (axis, length) = match (side, frames, spp) {
        (Some(side), None, _) => ("frames", samples / (side * side)),
        (Some(side), _, None) => ("spp", samples / (side * side)),
        _ => ("height", 1),
    };
    ImportError::NoSquare { samples, axis, length }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(shape: &[usize], options: &ImportOptions) -> Result<[usize; 5], ImportError> {
        Layout::of(shape, &[], options).map(
            |Layout { extent: Extent { frames, height, width, spp }, dims, .. }| {
                [frames, height, width, spp, dims]
            },
        )
    }

    #[test]
    fn usual_arrays_are_recognised() {
        for (array, expected) in [
            (&[][..], [1, 1, 1, 1, 1]),
            (&[4096], [1, 64, 64, 1, 1]),
            (&[4096, 2], [1, 64, 64, 1, 2]),
            (&[64, 32], [1, 64, 32, 1, 1]),
            (&[64, 32, 2], [1, 64, 32, 1, 2]),
            (&[32, 64, 64], [32, 64, 64, 1, 1]),
            (&[64, 64, 32], [32, 64, 64, 1, 1]),
            (&[64, 64, 64], [64, 64, 64, 1, 1]),
            (&[16, 64, 64, 2], [16, 64, 64, 1, 2]),
            (&[64, 64, 4, 2], [1, 64, 64, 4, 2]),
            (&[2, 3, 4, 5, 6], [2, 3, 4, 5, 6]),
            (&[1, 1, 2, 3, 4, 5, 6], [2, 3, 4, 5, 6]),
        ] {
            assert_eq!(shape(array, &ImportOptions::default()), Ok(expected), "{array:?}");
        }
        assert_eq!(
            shape(&[2; 6], &ImportOptions::default()),
            Err(ImportError::TooManyAxes { shape: vec![2; 6] })
        );
    }

    #[test]
    fn lengths_complete_each_other() {
        let options = |[frames, height, width, spp, dims]: [usize; 5]| {
            let given = |length| (length > 0).then_some(length);
            ImportOptions {
                frames: given(frames),
                height: given(height),
                width: given(width),
                spp: given(spp),
                dims: given(dims),
                ..ImportOptions::default()
            }
        };
        let list = |lengths| shape(&[40960, 2], &options(lengths));
        assert_eq!(list([10, 0, 0, 0, 0]), Ok([10, 64, 64, 1, 2]));
        assert_eq!(list([0, 0, 0, 10, 0]), Ok([1, 64, 64, 10, 2]));
        assert_eq!(list([0, 0, 320, 0, 0]), Ok([1, 128, 320, 1, 2]));
        assert_eq!(list([0, 64, 64, 1, 0]), Ok([10, 64, 64, 1, 2]));
        assert_eq!(list([5, 64, 64, 0, 0]), Ok([5, 64, 64, 2, 2]));
        assert_eq!(list([0, 1, 0, 0, 4]), Ok([1, 1, 20480, 1, 4]));
        assert_eq!(list([0, 64, 64, 0, 0]), Err(ImportError::FramesOrSamples { times: 10 }));
        assert_eq!(list([3, 0, 0, 0, 0]), Err(ImportError::Lengths { values: 81920, given: 6 }));
        assert_eq!(list([5, 64, 64, 1, 2]), Err(ImportError::Lengths { values: 81920, given: 40960 }));
        let no_square = |samples, axis, length| Err(ImportError::NoSquare { samples, axis, length });
        assert_eq!(list([0; 5]), no_square(40960, "frames", 10));
        assert_eq!(list([1, 0, 0, 0, 0]), no_square(40960, "spp", 10));
        assert_eq!(shape(&[4099], &options([0; 5])), no_square(4099, "height", 1));
        // Not a list, but as long as is given all the same.
        assert_eq!(shape(&[8, 8, 64], &options([0, 64, 64, 0, 0])), Ok([1, 64, 64, 1, 1]));
        // A table, as far as is given.
        assert_eq!(shape(&[3, 8, 9, 2, 1], &options([0, 0, 0, 2, 1])), Ok([3, 8, 9, 2, 1]));
    }

    #[test]
    fn names_are_checked() {
        let named = |array: &[usize], axes: &[Axis]| {
            shape(array, &ImportOptions { axes: axes.to_vec(), ..ImportOptions::default() })
        };
        assert_eq!(named(&[3, 4, 5], &[Axis::X, Axis::Y, Axis::Dim]), Ok([1, 4, 3, 1, 5]));
        assert_eq!(named(&[3, 4], &[Axis::X]), Err(ImportError::AxesCount { shape: vec![3, 4], named: 1 }));
        assert_eq!(named(&[3, 4], &[Axis::X; 2]), Err(ImportError::AxisTwice { axis: "x" }));
        let both = ImportOptions { axes: vec![Axis::X], spp: Some(1), ..ImportOptions::default() };
        assert_eq!(shape(&[3], &both), Err(ImportError::AxesAndLengths));
        assert!(matches!(named(&[3, 128], &[Axis::X, Axis::Dim]), Err(ImportError::Extent { .. })));
        assert!(matches!(named(&[3, 0], &[Axis::X, Axis::Y]), Err(ImportError::Extent { .. })));
    }
}
