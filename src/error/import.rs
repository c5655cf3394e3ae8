//! What stands against making a table of somebody else's file.

use thiserror::Error;

use super::{ExtentError, Short};

/// Why a file of numbers cannot become a table, and with which options it could.
///
/// Options are called as they are on the command line; those of
/// [`ImportOptions`](crate::files::ImportOptions) have the same names without dashes.
///
/// ```
/// use fsot::SampleTable;
/// use fsot::files::{ImportError, ImportOptions, TableError};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("bytes.dat");
/// std::fs::write(&path, "0\n17\n255\n96\n")?;
/// let error = SampleTable::import(&path, &ImportOptions::default()).unwrap_err();
/// let TableError::Import { problem, .. } = error else { panic!("{error}") };
/// assert!(matches!(problem, ImportError::Levels { suggested: 256, .. }));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The array holds something else than plain numbers.
    #[error(
        "its type {dtype} is no number of at most 64 bits: save an array of such numbers with numpy.save"
    )]
    Dtype {
        /// The type as the file writes it.
        dtype: String,
    },
    /// Not as many names as axes.
    #[error("shape {shape:?} has {} axes, but --axes names {named}: name every axis", shape.len())]
    AxesCount {
        /// Shape of the file.
        shape: Vec<usize>,
        /// Names given.
        named: usize,
    },
    /// A name stands twice.
    #[error("--axes names {axis} twice: name each axis once")]
    AxisTwice {
        /// The axis.
        axis: &'static str,
    },
    /// Two ways to say the same thing.
    #[error("--axes and lengths of axes exclude each other: give --axes alone, or lengths alone")]
    AxesAndLengths,
    /// A table has five axes.
    #[error(
        "shape {shape:?} has more than 5 axes: give the lengths --frames, --height, --width, --spp and --dims"
    )]
    TooManyAxes {
        /// Shape of the file.
        shape: Vec<usize>,
    },
    /// The lengths that were given do not fit the numbers.
    #[error(
        "{values} numbers do not fill the lengths that are given, {given}: give lengths that divide them"
    )]
    Lengths {
        /// Numbers in the file.
        values: usize,
        /// Product of the lengths.
        given: usize,
    },
    /// The picture's sides could not be deduced.
    #[error(
        "{samples} samples make no square picture: give --width and --height, or for example \
         --{axis} {length}"
    )]
    NoSquare {
        /// Samples that are to be divided into rows and columns.
        samples: usize,
        /// A length that makes the rest a square, or a single row.
        axis: &'static str,
        /// That length.
        length: usize,
    },
    /// There is more than a picture.
    #[error("there are {times} samples for every pixel: give --frames {times}, or --spp {times}")]
    FramesOrSamples {
        /// Samples per pixel and frame, or frames.
        times: usize,
    },
    /// A word in a text file.
    #[error(
        "line {line} has {text:?}, which is no number: give a .npy file, or numbers between blanks or commas"
    )]
    Number {
        /// Line, from 1.
        line: usize,
        /// The word.
        text: String,
    },
    /// Something else than a number in a C array.
    #[error(
        "line {line} has {text:?} where a number must stand: write plain numbers between commas, without \
         names, letters in quotes, casts or places in brackets"
    )]
    Literal {
        /// Line, from 1.
        line: usize,
        /// What stands there.
        text: String,
    },
    /// Lines of a text file have unequal lengths.
    #[error(
        "line {line} has {given} numbers and the lines before it {expected}: \
         give --dims, or write as many numbers on every line"
    )]
    Ragged {
        /// Line, from 1.
        line: usize,
        /// Its numbers.
        given: usize,
        /// Numbers of every line before.
        expected: usize,
    },
    /// Lists of a C array that stand beside each other have unequal lengths.
    #[error(
        "a list that ends on line {line} has {given} members and those before it {expected}: \
         write as many in every list"
    )]
    Lists {
        /// Line, from 1.
        line: usize,
        /// Its members.
        given: usize,
        /// Members of every list before.
        expected: usize,
    },
    /// Lists and numbers of a C array stand beside each other, or lists lie too deep in each other.
    #[error(
        "line {line} has braces where others have numbers, or more than 16 of them in each other: \
         nest all numbers alike"
    )]
    Nesting {
        /// Line, from 1.
        line: usize,
    },
    /// A C array without its last brace.
    #[error("it ends before its array does: it was cut off, write it again")]
    Unclosed,
    /// C without an array of numbers.
    #[error("there is no array in it: give a source text with `name[] = {{ numbers }}`")]
    NoArray,
    /// More than one C array.
    #[error("it has several arrays, {names}: name one, --array NAME")]
    Arrays {
        /// The first of them.
        names: String,
    },
    /// No C array of this name.
    #[error("it has no array {name:?}: give another --array, of {names}")]
    NoSuchArray {
        /// The name that was asked for.
        name: String,
        /// The first of those that are there.
        names: String,
    },
    /// Bare numbers of which nobody says what they are.
    #[error(
        "it is neither .npy nor text, and no .txt beside it says what its numbers are: \
         if they are bare, give --dtype, such as '<f4', and lengths"
    )]
    NoDtype,
    /// The text beside bare numbers has a line that is not understood.
    #[error(
        "line {line} of the .txt beside it has {text:?}: \
         write `dtype: <f4`, `shape: 64, 64, 2` and `axes: y, x, dim`, or give --dtype and lengths"
    )]
    Description {
        /// Line, from 1.
        line: usize,
        /// What stands behind the colon.
        text: String,
    },
    /// Samples of so many numbers, of which the first are read, do not make up the numbers.
    #[error(
        "its {values} numbers are no samples of {channels} of which {dims} could be read: \
         give --channels that divide them, and at most as many --dims"
    )]
    Channels {
        /// Numbers in the file.
        values: usize,
        /// Numbers of a sample.
        channels: usize,
        /// Numbers that are read.
        dims: usize,
    },
    /// The record of an export contradicts itself.
    #[error("it {problem}: export the table again, or remove it and import each file by itself")]
    Record {
        /// What the record does.
        problem: String,
    },
    /// The files of an export hold other values than their record says.
    #[error(
        "its files hold other values than were exported: export the table again, \
         or remove this record to import what is there"
    )]
    Changed,
    /// A text file without numbers.
    #[error("there are no numbers in it: give a .npy file, or numbers between blanks or commas")]
    Empty,
    /// A value is negative, not finite, or above 1 among fractions.
    #[error(
        "value number {at} is {}: bring all values into [0, 1], or make whole numbers from 0 of them",
        Short::from(value)
    )]
    Value {
        /// Position in the file, from 0.
        at: usize,
        /// The value.
        value: f64,
    },
    /// Whole numbers of which nobody says how many there could be.
    #[error(
        "its values are whole numbers up to {}, neither each as often as the others nor of the whole \
         range of their type: give --levels {suggested}, or another number of levels",
        Short::from(greatest)
    )]
    Levels {
        /// The greatest value.
        greatest: f64,
        /// The next power of two.
        suggested: u64,
    },
    /// Levels are whole numbers below their number.
    #[error(
        "value number {at} is {}, and no whole number below {levels}: \
         give more --levels, or none for fractions in [0, 1]",
        Short::from(value)
    )]
    NoLevel {
        /// Position in the file, from 0.
        at: usize,
        /// The value.
        value: f64,
        /// Levels given.
        levels: u64,
    },
    /// The lengths make no table.
    #[error("as {shape:?} it cannot be a table: {problem}; name other --axes or lengths")]
    Extent {
        /// `[frame, y, x, sample, dim]`.
        shape: [usize; 5],
        /// Which axis, or how many values.
        problem: ExtentError,
    },
    /// A texture that breaks off, or says what cannot be.
    #[error("the {kind} cannot be read ({reason}): write it anew, or give another file")]
    Damaged {
        /// What it is.
        kind: &'static str,
        /// The decoder's word.
        reason: String,
    },
    /// A texture of a kind that is no array of numbers.
    #[error("the {kind} {what}: {advice}")]
    Unsupported {
        /// What it is.
        kind: &'static str,
        /// What it has.
        what: String,
        /// What is read.
        advice: &'static str,
    },
    /// PNG and EXR are read by crates that were left out.
    #[error("PNG and EXR are read with the feature `image` of this library alone: build it with that")]
    Feature,
    /// No file has a name of the pattern.
    #[error("no file is called so with a number in the place of each brace: give the name of one as it is")]
    NoFiles,
    /// More files than a table has frames.
    #[error("{files} files are called so, more than {most}: move those that do not belong to it")]
    TooManyFiles {
        /// Files of such names.
        files: usize,
        /// Most that are read.
        most: usize,
    },
    /// Two names have the same number.
    #[error("{names:?} have the same number: move one of them")]
    SameNumber {
        /// The names.
        names: [String; 2],
    },
    /// A number is left out.
    #[error("after number {before} of {place} comes {after}: bring the files between them, or rename those")]
    Gap {
        /// Whose number.
        place: &'static str,
        /// The last before the gap.
        before: u64,
        /// The first behind it.
        after: u64,
    },
    /// Files for some frames only.
    #[error("no file is there for frame {frame}, sample {sample}, dims {dim}: bring it")]
    MissingFile {
        /// Frame, as in the names.
        frame: u64,
        /// Sample of a pixel.
        sample: u64,
        /// First dimension.
        dim: u64,
    },
    /// Files of different kinds.
    #[error("{names:?} hold numbers of different types: write all of them alike")]
    Unlike {
        /// The first file and one of another kind.
        names: [String; 2],
    },
    /// Files of different sizes.
    #[error("the files have the shapes {shapes:?} [frame, y, x, sample, dim]: bring files of one shape")]
    UnlikeShapes {
        /// Shapes that do not go together.
        shapes: Vec<Vec<usize>>,
    },
}
