//! Tables out of other people's files: arrays of any plain type, order and number of axes, bare numbers,
//! text, C and C++; and out of what an export has written.

#[cfg(feature = "image")]
mod exr;
mod ktx2;
#[cfg(feature = "image")]
mod png;
mod raw;
mod recorded;
mod set;
mod source;
mod written;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use ndarray::{ArrayD, IxDyn, ShapeBuilder};

use self::set::Pattern;
use self::source::Source;
use super::dtype::Dtype;
use super::header::{Fault, GIVE_NPY};
use super::layout::{Axis, Layout};
use super::levels::Scale;
use super::shell;
use super::text::Unread;
use crate::error::{ImportError, TableError};
use crate::table::SampleTable;

/// Larger files are not read for the sake of a message.
const MOST_BYTES: u64 = 256 << 20;

/// What a file of numbers does not say itself. All may be left out: then it is deduced, and
/// [`Imported`] tells how.
///
/// ```
/// use fsot::files::{Axis, ImportOptions};
///
/// // Ten bits in an array of bytes or more, [dim, y, x].
/// let options = ImportOptions {
///     axes: vec![Axis::Dim, Axis::Y, Axis::X],
///     levels: Some(1024),
///     ..ImportOptions::default()
/// };
/// assert_eq!(options.to_string(), "--axes dim,y,x --levels 1024");
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// The axes of the file, slowest first; those that are not named have length 1. Excludes lengths.
    ///
    /// If neither they nor lengths are given: five axes are those of a table, in front of which axes of
    /// length 1 are dropped; four are `frame, y, x, dim`, or `y, x, sample, dim` if only the first two are
    /// equal; three are `y, x, dim` if the last is at most 16 long and not all are equal, else `frame, y, x`,
    /// or `y, x, frame` if only the first two are equal; two are `y, x` if they are equal or the last is
    /// longer than 16, else a list of samples; one is a list of scalars. Lists are square pictures, row by
    /// row.
    pub axes: Vec<Axis>,
    /// Of how many levels the values are, `0..levels`; a value `v` becomes `(v + ½) / levels`.
    ///
    /// If they are not given: fractions in `[0, 1]` are taken as they are. Whole numbers of which each from 0
    /// (or from 1) to the greatest is there equally often are ranks, and there are as many levels. Unsigned
    /// types of 8, 16 and 32 bits have 2⁸, 2¹⁶ and 2³² levels if a value is in their upper half. Everything
    /// else is refused.
    pub levels: Option<u64>,
    /// Frames of a list of samples in the order of a table, `[frame][y][x][sample][dim]`. One of the lengths
    /// may be missing, or width and height of a square picture; frames and samples are 1 otherwise.
    pub frames: Option<usize>,
    /// Rows of a frame of a list.
    pub height: Option<usize>,
    /// Columns of a frame of a list.
    pub width: Option<usize>,
    /// Samples per pixel of a list.
    pub spp: Option<usize>,
    /// Dimensions of a sample of a list; the length of the last axis or of a line of text, up to 16, if it is
    /// not given.
    pub dims: Option<usize>,
    /// Numbers that a sample takes in a list, of which the first `dims` are read, such as 4 in a texture of
    /// RGBA; only what is read if it is not given.
    pub channels: Option<usize>,
    /// The type of the numbers of a file that has no header. If it is not given, a text beside the file says
    /// it, whose name is the file's and `.txt`: lines `dtype: <f4`, `shape: 1, 64, 64, 1, 2`, `axes: frame,
    /// y, x, sample, dim` and, of levels, `levels: 65536`; those of axes and of levels may be missing.
    pub dtype: Option<Dtype>,
    /// The name of the array, where a C or C++ source text has several.
    pub array: Option<String>,
}

/// A table, and what was taken for what.
///
/// As text it is one sentence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The table.
    pub table: SampleTable,
    /// Type of the values as the file writes it; `text` for text.
    pub dtype: String,
    /// Shape of the file.
    pub shape: Vec<usize>,
    /// Its axes; empty where it is a list of samples in the order of a table.
    pub axes: Vec<Axis>,
    /// Levels of whole numbers; `None` for fractions.
    pub levels: Option<u64>,
    /// The lowest level: 1 for ranks that are counted from 1.
    pub first_level: u64,
    /// Values of 1 that became the largest number below.
    pub ones: usize,
    /// Channels of a texture that were left out, because they are constant or like another.
    pub left_out: Vec<usize>,
    /// The record of the export that said how to read the file.
    pub record: Option<PathBuf>,
}

enum Problem {
    Fault(Fault),
    Import(ImportError),
}

impl Problem {
    fn of(self, path: &Path) -> TableError {
        match self {
            Self::Fault(fault) => fault.of(path),
            Self::Import(problem) => TableError::Import { path: path.into(), problem },
        }
    }
}

impl<F: Into<Fault>> From<F> for Problem {
    fn from(fault: F) -> Self {
        Self::Fault(fault.into())
    }
}

impl From<ImportError> for Problem {
    fn from(problem: ImportError) -> Self {
        Self::Import(problem)
    }
}

impl From<Unread> for Problem {
    fn from(unread: Unread) -> Self {
        match unread {
            Unread::Io(error) => error.into(),
            Unread::Import(problem) => problem.into(),
        }
    }
}

impl SampleTable {
    /// Makes a table of somebody else's file: a `.npy` array of floats or integers of any size, byte order
    /// and memory order; a PNG, KTX 2 or EXR texture; text with numbers between blanks, commas or semicolons,
    /// one sample or one row of a picture a line, such as the `.dat` files of published codes; an array in C
    /// or C++; bare numbers, of which options or a text beside them say what they are. What
    /// [`export`](Self::export) has written is read by its record, unless options say otherwise.
    ///
    /// Values are rounded to the nearest `f32`, but never to 1. Time and memory are linear in the file: 8
    /// bytes a value beside the table.
    ///
    /// # Errors
    /// A file that cannot be read ([`TableError::Io`]), is damaged ([`TableError::Format`]), or cannot be a
    /// table with these options ([`TableError::Import`]).
    ///
    /// ```
    /// use fsot::SampleTable;
    /// use fsot::files::ImportOptions;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("mask.dat");
    /// std::fs::write(&path, "0.25 0.5\n0.75 1.0\n0.5 0.5\n0.125 0\n")?;
    /// let imported = SampleTable::import(&path, &ImportOptions::default())?;
    /// assert_eq!(imported.table.shape(), [1, 2, 2, 1, 2]);
    /// assert_eq!(imported.table.view()[[0, 1, 1, 0, 0]], 0.125);
    /// println!("{imported}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn import(path: impl AsRef<Path>, options: &ImportOptions) -> Result<Imported, TableError> {
        let path = path.as_ref();
        match recorded::import(path, options) {
            Some(imported) => imported,
            None => import(path, options).map_err(|problem| problem.of(path)),
        }
    }
}

fn import(path: &Path, options: &ImportOptions) -> Result<Imported, Problem> {
    match Pattern::of(path) {
        Some(pattern) => {
            let source = set::read(&pattern, options)?;
            let options = ImportOptions { levels: options.levels, ..ImportOptions::default() };
            arranged(source, &options)
        }
        None => arranged(source::read(path, options)?, options),
    }
}

/// A table of the numbers.
fn arranged(mut source: Source, options: &ImportOptions) -> Result<Imported, Problem> {
    let is_said = !options.axes.is_empty() || options.lengths().is_some();
    let left_out = if is_said { Vec::new() } else { source.tell_frames_and_channels() };
    let Source { values, shape, axes, fortran, dtype, levels, descr } = source;
    let layout = Layout::of(&shape, &axes, options)?;
    let scale = Scale::of(&values, dtype, options.levels.or(levels))?;
    let ones = if scale.levels.is_none() { values.iter().filter(|&&value| value == 1.0).count() } else { 0 };
    let mut table = source::reserved(values.len())?;
    if fortran || !layout.axes.is_empty() {
        // Axes of length 1 that were dropped change nothing in the order.
        let kept =
            if layout.axes.is_empty() { &shape[..] } else { &shape[shape.len() - layout.axes.len()..] };
        let mut array =
            ArrayD::from_shape_vec(IxDyn(kept).set_f(fortran), values).map_err(io::Error::other)?;
        if !layout.axes.is_empty() {
            let place = |axis: &Axis| layout.axes.iter().position(|found| found == axis);
            let order: Vec<usize> = Axis::ALL.iter().filter_map(place).collect();
            array = array.permuted_axes(order);
        }
        table.extend(array.iter().map(|&value| scale.apply(value)));
    } else {
        table.extend(values.iter().map(|&value| scale.apply(value)));
    }
    Ok(Imported {
        table: SampleTable::trusted(layout.extent, layout.dims, table),
        dtype: descr,
        shape,
        axes: layout.axes,
        levels: scale.levels,
        first_level: scale.first,
        ones,
        left_out,
        record: None,
    })
}

impl ImportOptions {
    /// The lengths, if any is given: `[frames, height, width, spp, dims]`.
    pub(super) fn lengths(&self) -> Option<[Option<usize>; 5]> {
        let lengths = [self.frames, self.height, self.width, self.spp, self.dims];
        lengths.iter().any(Option::is_some).then_some(lengths)
    }

    /// The options that a refusal asks for; `None` if none would help.
    fn following(&self, refusal: &ImportError) -> Option<Self> {
        let mut options = self.clone();
        match *refusal {
            ImportError::Levels { suggested, .. } if options.levels.is_none() => {
                options.levels = Some(suggested)
            }
            ImportError::NoSquare { axis: "frames", length, .. } => options.frames = Some(length),
            ImportError::NoSquare { axis: "spp", length, .. } => options.spp = Some(length),
            ImportError::NoSquare { length, .. } => options.height = Some(length),
            _ => return None,
        }
        Some(options)
    }
}

impl fmt::Display for ImportOptions {
    /// As flags of the command.
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let axes: Vec<&str> = self.axes.iter().map(|axis| axis.name()).collect();
        let axes = (!axes.is_empty()).then(|| axes.join(","));
        let number = |number: Option<usize>| number.map(|number| number.to_string());
        let flags = [
            ("axes", axes),
            ("levels", self.levels.map(|levels| levels.to_string())),
            ("frames", number(self.frames)),
            ("height", number(self.height)),
            ("width", number(self.width)),
            ("spp", number(self.spp)),
            ("dims", number(self.dims)),
            ("channels", number(self.channels)),
            ("dtype", self.dtype.map(|dtype| shell::word(dtype.to_string()))),
            ("array", self.array.as_deref().map(shell::word)),
        ];
        let flags = flags.into_iter().filter_map(|(flag, value)| Some(format!("--{flag} {}", value?)));
        out.write_str(&flags.collect::<Vec<_>>().join(" "))
    }
}

impl fmt::Display for Imported {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let Self { dtype, shape, axes, levels, first_level, ones, left_out, record, .. } = self;
        write!(out, "{} of shape {shape:?} as ", dtype.trim_matches(['\'', '"']))?;
        match axes.as_slice() {
            [] => write!(out, "a list of samples in the order of a table")?,
            axes => write!(out, "{}", axes.iter().map(|axis| axis.name()).collect::<Vec<_>>().join(", "))?,
        }
        match (levels, first_level) {
            (None, _) => write!(out, ", values as they are")?,
            (Some(levels), 0) => write!(out, ", {levels} levels as (v + 1/2) / {levels}")?,
            (Some(levels), _) => write!(out, ", ranks from 1 as (v - 1/2) / {levels}")?,
        }
        if *ones > 0 {
            write!(out, ", {ones} of them 1, which became the largest number below")?;
        }
        if !left_out.is_empty() {
            let names: Vec<String> = left_out.iter().map(usize::to_string).collect();
            write!(out, ", without channel {}, constant or like another", names.join(", "))?;
        }
        match record {
            Some(record) => write!(out, ", as {} says", record.display()),
            None => Ok(()),
        }
    }
}

/// What makes a table of a file that is none: a command that was tried, or what stands against all of them.
pub(super) fn advice(path: &Path) -> String {
    let small = std::fs::metadata(path).is_ok_and(|found| found.len() <= MOST_BYTES);
    let mut options = ImportOptions::default();
    // Levels, and a length.
    for _ in 0..if small { 3 } else { 0 } {
        match import(path, &options) {
            Ok(_) => break,
            Err(Problem::Import(problem)) => match options.following(&problem) {
                Some(following) => options = following,
                None => return problem.to_string(),
            },
            Err(Problem::Fault(Fault::Format(problem))) => return problem.to_string(),
            Err(Problem::Fault(Fault::Io(_))) => return GIVE_NPY.into(),
        }
    }
    let flags = options.to_string();
    let flags = if flags.is_empty() { flags } else { format!("{flags} ") };
    let [from, to] = [path, &path.with_extension("table.npy")].map(shell::path);
    format!("run `fsot import {from} {flags}--out {to}`, or SampleTable::import with these options")
}
