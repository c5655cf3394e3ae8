//! What a caller got wrong, with the values that show it. Every message ends in what to do about it.

use std::path::PathBuf;

use thiserror::Error;

/// A configuration that cannot be optimised.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// An axis of the table has no entries.
    #[error("{axis} is 0: give at least 1")]
    EmptyAxis {
        /// Name of the axis.
        axis: &'static str,
    },
    /// The table has more values than can be numbered.
    #[error("the table would hold {values} values: stay at or below 2147483647 (2^31 - 1)")]
    TooLarge {
        /// Number of values asked for (saturating).
        values: u64,
    },
    /// A scalar parameter lies outside its range.
    #[error("{name} is {value}: give a value {expected}")]
    OutOfRange {
        /// Name of the parameter.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The admissible range, in words.
        expected: &'static str,
    },
    /// A list of filter weights cannot serve as a kernel.
    #[error("{kernel} has weight {weight} at tap {index}: weights must be finite and at least 0")]
    BadTap {
        /// Which kernel.
        kernel: &'static str,
        /// Position in the list of taps.
        index: usize,
        /// The weight given.
        weight: f64,
    },
    /// A kernel without any positive weight.
    #[error("{kernel} has no positive weight: give at least one tap above 0")]
    EmptyKernel {
        /// Which kernel.
        kernel: &'static str,
    },
    /// A dimension group without dimensions.
    #[error("dimension group {group} is empty: name at least one dimension")]
    EmptyGroup {
        /// Position of the group's term.
        group: usize,
    },
    /// A dimension group names a dimension that the table does not have.
    #[error("dimension group {group} names dimension {dimension}, but the table has {dims}: name dimensions from 0 to {}", dims - 1)]
    NoSuchDimension {
        /// Position of the group's term.
        group: usize,
        /// The dimension named.
        dimension: usize,
        /// Dimensions of the table.
        dims: usize,
    },
    /// A dimension group names a dimension twice.
    #[error("dimension group {group} names dimension {dimension} twice: name each dimension once")]
    RepeatedDimension {
        /// Position of the group's term.
        group: usize,
        /// The dimension named.
        dimension: usize,
    },
    /// Nothing to optimise.
    #[error("the objective has no term with a positive weight: give at least one")]
    NoTerms,
    /// A family of classes none of which holds a sample.
    #[error("no class of {family} holds a sample: give at least one that does")]
    NoClasses {
        /// Which family.
        family: &'static str,
    },
    /// A list of numbers does not have one per sample.
    #[error("{what} holds {given} entries, but the table has {expected} samples: give one per sample")]
    SampleCount {
        /// Which list.
        what: &'static str,
        /// Entries given.
        given: usize,
        /// Samples of the table.
        expected: usize,
    },
    /// A prefix that is empty or longer than what it is a part of.
    #[error("a prefix has length {length}: give a length from 1 to {most}")]
    PrefixLength {
        /// The length given.
        length: usize,
        /// Samples of the whole.
        most: usize,
    },
    /// A caller's own class cannot serve as one.
    #[error("class {member} of \"{name}\" gives sample {sample} weight {weight}: {problem}")]
    CustomClass {
        /// Name of the family.
        name: Box<str>,
        /// Number of the class.
        member: u32,
        /// The sample.
        sample: u32,
        /// Its weight.
        weight: f64,
        /// What to do.
        problem: &'static str,
    },
    /// The values of a density are not one per pixel.
    #[error("{given} values for a density of {width} by {height} pixels: give {expected}, row by row")]
    DensityCount {
        /// Values given.
        given: usize,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Values expected.
        expected: usize,
    },
    /// A value cannot be a density.
    #[error("the density at column {x}, row {y} is {value}: give finite values of at least 0")]
    BadDensity {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The value.
        value: f64,
    },
    /// A density that is 0 everywhere: an all-black picture, where bright draws points.
    #[error(
        "the density is 0 in all of its {width} by {height} pixels, so that no point has a place: give at least one above 0 \
         (a picture needs some ink, or the other tone)"
    )]
    NoDensity {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Densities of different sizes cannot be added.
    #[error("a density has {given:?} columns and rows, another {expected:?}: bring all to the same size")]
    OtherDensity {
        /// Columns and rows.
        given: [usize; 2],
        /// Those of the first.
        expected: [usize; 2],
    },
    /// A target's law along a direction is not a law.
    #[error("the target of term {term} has no finite law along {direction:?}: correct its projection")]
    BadLaw {
        /// Position of the term.
        term: usize,
        /// The direction.
        direction: Vec<f64>,
    },
    /// A target cannot be projected on the dimensions of its term.
    #[error(
        "term {term}: the target has {target} dimensions, but the term sees {dims}: name as many dimensions"
    )]
    TargetDims {
        /// Position of the term.
        term: usize,
        /// Dimensions of the target.
        target: usize,
        /// Dimensions of the term.
        dims: usize,
    },
    /// A target that is not uniform in a dimension that wraps.
    #[error(
        "term {term} sees dimension {dimension}, a torus, but its target is not uniform: make it an interval"
    )]
    TargetOnTorus {
        /// Position of the term.
        term: usize,
        /// The dimension.
        dimension: usize,
    },
    /// A demand that no term of the objective serves.
    #[error("nothing is demanded: demand at least one pixel and a dimension that a term sees")]
    NoDemand,
    /// Sweeps were asked for, but a term has no closed form over all slices.
    #[error("term {term} cannot be swept, since {why}: use slices")]
    NotInClosedForm {
        /// Position of the term.
        term: usize,
        /// What stands against it.
        why: &'static str,
    },
    /// The list of domains does not fit the table.
    #[error("{given} domains for {dims} dimensions: give one domain per dimension")]
    DomainCount {
        /// Domains given.
        given: usize,
        /// Dimensions of the table.
        dims: usize,
    },
    /// A list of numbers does not fit the table.
    #[error("{what} holds {given} values, but the table has {expected}: give one value per coordinate")]
    ValueCount {
        /// Which list.
        what: &'static str,
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// A table of another shape than the objective was planned for.
    #[error(
        "the table has shape {given:?} instead of {expected:?}: bring one of that [frame, y, x, sample, dim]"
    )]
    OtherShape {
        /// Shape of the table.
        given: Box<[usize; 5]>,
        /// Shape that the objective is planned for.
        expected: Box<[usize; 5]>,
    },
    /// A point lies outside the unit cube.
    #[error("point coordinate {index} is {value}: give finite values in [0, 1)")]
    BadPoint {
        /// Index into the list of coordinates.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A slice refers to something that the objective does not have.
    #[error("slice {slice}: {what} is {given}, but the objective has {limit}: stay below it")]
    BadSlice {
        /// Position of the slice in the list.
        slice: usize,
        /// Which field.
        what: &'static str,
        /// The value given.
        given: usize,
        /// Number of such things.
        limit: usize,
    },
    /// A slice's direction or cut does not fit its dimension group.
    #[error(
        "slice {slice}: {what} has {given} components, but its group has {expected} dimensions: give one each"
    )]
    SliceShape {
        /// Position of the slice in the list.
        slice: usize,
        /// Which field.
        what: &'static str,
        /// Components given.
        given: usize,
        /// Components expected.
        expected: usize,
    },
    /// A number of a slice cannot be used.
    #[error("slice {slice}: {what} is {value}: give {expected}")]
    SliceValue {
        /// Position of the slice in the list.
        slice: usize,
        /// Which field.
        what: &'static str,
        /// The value given.
        value: f64,
        /// What is admissible, in words.
        expected: &'static str,
    },
}

/// A picture that cannot serve as a density.
#[cfg(feature = "image")]
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}; give a PNG or EXR file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
    /// The file is no picture of a known format.
    #[error(
        "cannot read {}: its first bytes, \"{}\", are of no picture; give a PNG or EXR file",
        path.display(),
        start.escape_ascii()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Its first bytes, eight at most.
        start: Vec<u8>,
    },
    /// A PNG file is damaged, or of a kind that cannot be read.
    #[error("cannot read the PNG {}: {source}; save it anew or give another PNG or EXR file", path.display())]
    Png {
        /// The file.
        path: PathBuf,
        /// The decoder's word.
        source: png::DecodingError,
    },
    /// An EXR file is damaged, or of a kind that cannot be read.
    #[error("cannot read the EXR {}: {source}; save it anew or give another PNG or EXR file", path.display())]
    Exr {
        /// The file.
        path: PathBuf,
        /// The decoder's word.
        source: exr::error::Error,
    },
    /// The file says that it has more pixels than are read.
    #[error("{} has {width} x {height} pixels: make it smaller, of at most {most} in all", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels that are read at most.
        most: usize,
    },
    /// The picture is no density.
    #[error("{}: {problem}", path.display())]
    Density {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: ConfigError,
    },
}

/// A table that cannot be made, read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// The extent or the number of dimensions is not admissible.
    #[error(transparent)]
    Extent(#[from] ConfigError),
    /// The number of values does not fit the extent.
    #[error("{given} values for a table of {expected}: give frames * height * width * spp * dims values")]
    Length {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// A value lies outside `[0, 1)` or is not finite.
    #[error("the value at [frame {}, y {}, x {}, sample {}, dim {}] is {value}: values must lie in [0, 1)", at[0], at[1], at[2], at[3], at[4])]
    Value {
        /// `[frame, y, x, sample, dim]`.
        at: [usize; 5],
        /// The value.
        value: f32,
    },
    /// The file could not be opened, read or written.
    #[error("cannot {verb} {}: {source}; check the path and its permissions", path.display())]
    Io {
        /// `read` or `write`.
        verb: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
    /// The path cannot name a table.
    #[error(
        "{path:?} cannot name a table: give a file name that ends in .npy; .json is for the metadata beside it"
    )]
    FileName {
        /// The path.
        path: PathBuf,
    },
    /// The file was read, but it is not what this crate writes.
    #[error("{}: {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FormatError,
    },
}

/// What is wrong with a file that should hold a table or its metadata.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// A directory, a device or a pipe.
    #[error("not an ordinary file: give the path of a .npy file and of the .json beside it")]
    NotAFile,
    /// Another kind of file.
    #[error("starts with \"{}\" instead of \"\\x93NUMPY\": give a .npy file", start.escape_ascii())]
    NotNpy {
        /// First bytes of the file.
        start: Vec<u8>,
    },
    /// The file ends before the values begin.
    #[error("ends after {bytes} bytes, but its header takes {needed}: it was cut off, write it again")]
    Truncated {
        /// Length of the file.
        bytes: u64,
        /// Length up to the first value, as far as the file tells.
        needed: u64,
    },
    /// A version of the `.npy` format that is not known.
    #[error(".npy format version {major}.{minor} is not known: save it as version 1.0, 2.0 or 3.0")]
    Version {
        /// Major version.
        major: u8,
        /// Minor version.
        minor: u8,
    },
    /// The header announces a length that no table needs.
    #[error("the header announces {bytes} bytes, more than {limit}: the file is damaged, write it again")]
    HeaderLength {
        /// Length that the header announces.
        bytes: u64,
        /// Longest header that is read.
        limit: u64,
    },
    /// The header cannot be understood.
    #[error("the .npy header cannot be read ({reason}): save a plain array of '<f4' with numpy.save")]
    Header {
        /// What the parser stumbled over.
        reason: String,
    },
    /// The values are not little-endian `f32`.
    #[error(
        "the dtype is {dtype} instead of '<f4': convert the values with astype('<f4') and save them again"
    )]
    Dtype {
        /// Type descriptor of the file.
        dtype: String,
    },
    /// The values are in Fortran order.
    #[error("the array of shape {shape:?} is in Fortran order: save numpy.ascontiguousarray(array) instead")]
    FortranOrder {
        /// Shape of the file.
        shape: Vec<usize>,
    },
    /// The array does not have five axes.
    #[error("shape {shape:?} has {} axes instead of 5: reshape to [frame, y, x, sample, dim], 1 for an absent axis", shape.len())]
    Axes {
        /// Shape of the file.
        shape: Vec<usize>,
    },
    /// The array is empty or too large.
    #[error("shape {shape:?} cannot be a table: {problem}")]
    Extent {
        /// Shape of the file.
        shape: [usize; 5],
        /// Which axis, or how many values.
        problem: ConfigError,
    },
    /// The file does not hold as many values as its shape says.
    #[error(
        "{given} bytes of values, but shape {shape:?} takes {expected}: the file was cut off or appended to, write it again"
    )]
    Length {
        /// Bytes after the header.
        given: u64,
        /// Bytes that the shape takes.
        expected: u64,
        /// Shape of the file.
        shape: [usize; 5],
    },
    /// A value lies outside `[0, 1)` or is not finite.
    #[error("the value at [frame {}, y {}, x {}, sample {}, dim {}] is {value}: bring all values into [0, 1) and save them again", at[0], at[1], at[2], at[3], at[4])]
    Value {
        /// `[frame, y, x, sample, dim]`.
        at: [usize; 5],
        /// The value.
        value: f32,
    },
    /// The metadata is not JSON, or lacks a field.
    #[error("{reason}: correct line {line}, or save the table again with its metadata")]
    Json {
        /// Line, from 1.
        line: usize,
        /// Column, from 1; 0 is the end of the line before.
        column: usize,
        /// What the parser stumbled over, with line and column.
        reason: String,
    },
    /// A field of the metadata says that the table is in a format that this version does not know.
    #[error(
        "{field} is {given:?} instead of {expected:?}: use the version of this crate that wrote the file"
    )]
    Field {
        /// Which field.
        field: &'static str,
        /// What it says.
        given: String,
        /// What it must say.
        expected: String,
    },
    /// The metadata describes another table.
    #[error(
        "the metadata says shape {metadata:?}, but the table has {table:?}: bring the two that belong together"
    )]
    OtherTable {
        /// Shape according to the metadata.
        metadata: [usize; 5],
        /// Shape of the table.
        table: [usize; 5],
    },
}
