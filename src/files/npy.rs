//! A table to and from `.npy`, numpy's format for one array[^npy]: little-endian `f32`, five axes
//! `[frame][y][x][sample][dim]`, C order.
//!
//! A file is written under a temporary name and renamed when it is complete, so a crash leaves the old table
//! or the new one, at worst with a forgotten `.fsot-*.tmp` beside it. Reading trusts nothing: what comes back
//! without an error is a valid table.
//!
//! [^npy]: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;

use ndarray_npy::npy::header::{Header, Layout, ParseHeaderError, ReadHeaderError, WriteHeaderError};

use crate::error::{FormatError, TableError};
use crate::files::WholeFile;
use crate::files::metadata::{self, Metadata};
use crate::table::SampleTable;
use crate::table::extent::Extent;

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest header that is read; numpy draws the same line. Headers of tables have 128 bytes.
const MAX_HEADER: usize = 10_000;

/// Most axes that a shape in an error message has, and most axes of a numpy array.
const MAX_AXES: usize = 64;

/// Deepest nesting of brackets in a header. A table's has 2, a structured dtype 4. The time of the parser
/// doubles with each level, so a damaged header could keep it busy forever.
const MAX_NESTING: usize = 4;

impl SampleTable {
    /// Writes the table as `.npy`. An existing file is replaced when the new one is complete; a failure
    /// leaves it as it was. A symbolic link is followed. A `.json` that lies beside the file stays as it is.
    ///
    /// # Errors
    /// A path that cannot name a table ([`TableError::FileName`]) or cannot be written ([`TableError::Io`]).
    ///
    /// ```
    /// use fsot::{Extent, SampleTable};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("table.npy");
    /// let table = SampleTable::white_noise(Extent::still(8, 8), 2, 0)?;
    /// table.save(&path)?;
    /// assert_eq!(SampleTable::load(&path)?, table);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        self.pending(path).and_then(WholeFile::commit).map_err(|error| cannot_write(path, error))
    }

    /// Writes the table as `.npy` and its metadata as `.json` beside it ([`Metadata::path_beside`]). Both
    /// files are complete before either is renamed; the metadata is renamed first, the table last. A failure
    /// leaves both as they were.
    ///
    /// # Errors
    /// As [`save`](Self::save), and metadata that belong to a table of another shape or could not be read
    /// back ([`TableError::Format`]).
    pub fn save_with(&self, path: impl AsRef<Path>, metadata: &Metadata) -> Result<(), TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        let beside = Metadata::path_beside(path);
        let cannot_write_beside = |error| cannot_write(&beside, error);
        metadata
            .check_format()
            .and_then(|()| metadata.check_shape(self.shape()))
            .map_err(|problem| TableError::Format { path: beside.clone(), problem })?;
        let json = WholeFile::write(&beside, |out| {
            serde_json::to_writer_pretty(&mut *out, metadata)?;
            out.write_all(b"\n")
        })
        .map_err(cannot_write_beside)?;
        let table = self.pending(path).map_err(|error| cannot_write(path, error))?;
        let replaced = json.replace().map_err(cannot_write_beside)?;
        table.commit().map_err(|error| {
            replaced.undo();
            cannot_write(path, error)
        })
    }

    /// Reads a table from `.npy`.
    ///
    /// # Errors
    /// A path that cannot name a table ([`TableError::FileName`]), a file that cannot be read
    /// ([`TableError::Io`]), a file that is anything but an array of five axes, dtype `<f4`, C order, with as
    /// many values as its shape says, all in `[0, 1)` ([`TableError::Format`]).
    pub fn load(path: impl AsRef<Path>) -> Result<Self, TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        read(path).map_err(|fault| match fault {
            Fault::Io(source) => TableError::Io { verb: "read", path: path.to_path_buf(), source },
            Fault::Format(problem) => TableError::Format { path: path.to_path_buf(), problem },
        })
    }

    /// Reads a table and the metadata beside it, and checks that they agree on the shape.
    ///
    /// # Errors
    /// As [`load`](Self::load) and [`Metadata::load`], and metadata of a table of another shape
    /// ([`FormatError::OtherTable`]).
    pub fn load_with(path: impl AsRef<Path>) -> Result<(Self, Metadata), TableError> {
        let path = path.as_ref();
        let table = Self::load(path)?;
        let metadata = Metadata::load(path)?;
        metadata
            .check_shape(table.shape())
            .map_err(|problem| TableError::Format { path: Metadata::path_beside(path), problem })?;
        Ok((table, metadata))
    }

    /// Finds out before the work whether a table and its metadata could be saved at `path`. Leaves nothing
    /// behind.
    ///
    /// # Errors
    /// As [`save_with`](Self::save_with).
    pub fn check_writable(path: impl AsRef<Path>) -> Result<(), TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        for file in [path, &Metadata::path_beside(path)] {
            WholeFile::write(file, |_| Ok(())).map_err(|error| cannot_write(file, error))?;
        }
        Ok(())
    }

    /// Writes header and values beside `path`.
    fn pending(&self, path: &Path) -> io::Result<WholeFile> {
        WholeFile::write(path, |out| {
            // The header is made here, and not by `WriteNpyExt`, because that writes the machine's byte
            // order.
            let type_descriptor = "'<f4'".parse().map_err(io::Error::other)?;
            let shape = self.shape().to_vec();
            let header = Header { type_descriptor, layout: Layout::Standard, shape };
            header.write(&mut *out).map_err(|error| match error {
                WriteHeaderError::Io(error) => error,
                other => io::Error::other(other),
            })?;
            self.values().iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
        })
    }
}

fn cannot_write(path: &Path, source: io::Error) -> TableError {
    TableError::Io { verb: "write", path: path.to_path_buf(), source }
}

/// Why a file was not read; the path is added by the caller.
enum Fault {
    Io(io::Error),
    Format(FormatError),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<FormatError> for Fault {
    fn from(problem: FormatError) -> Self {
        Self::Format(problem)
    }
}

/// Reads and validates a table. Memory for values is asked for only after the file proved to hold them.
fn read(path: &Path) -> Result<SampleTable, Fault> {
    // Before opening, because opening a pipe waits for its writer.
    if !fs::metadata(path)?.is_file() {
        return Err(FormatError::NotAFile.into());
    }
    let mut file = File::open(path)?;
    let bytes = file.metadata()?.len();
    let (header, header_bytes) = read_header(&mut file, bytes)?;
    if header.type_descriptor.as_string().is_none_or(|dtype| dtype != "<f4") {
        return Err(FormatError::Dtype { dtype: shortened(header.type_descriptor.to_string()) }.into());
    }
    if header.layout.is_fortran() {
        return Err(FormatError::FortranOrder { shape: header.shape }.into());
    }
    let Ok(shape) = <[usize; 5]>::try_from(header.shape.as_slice()) else {
        return Err(FormatError::Axes { shape: header.shape }.into());
    };
    let [frames, height, width, spp, dims] = shape;
    let extent = Extent { frames, height, width, spp };
    extent.validate(dims).map_err(|problem| FormatError::Extent { shape, problem })?;
    let len = extent.samples() * dims;
    let (given, expected) = (bytes - header_bytes, len as u64 * size_of::<f32>() as u64);
    if given != expected {
        return Err(FormatError::Length { given, expected, shape }.into());
    }
    // Read here, and not by `ReadableElement`, because that aborts where memory does not suffice.
    let mut values = Vec::new();
    values.try_reserve_exact(len).map_err(io::Error::from)?;
    let mut block = [0; 1 << 14];
    while values.len() < len {
        let bytes = block.len().min(size_of::<f32>() * (len - values.len()));
        file.read_exact(&mut block[..bytes])?;
        values.extend(block[..bytes].as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)));
    }
    SampleTable::new(extent, dims, values).map_err(|error| match error {
        TableError::Value { at, value } => FormatError::Value { at, value }.into(),
        other => io::Error::other(other).into(),
    })
}

/// Reads the header, and its length in bytes, of a file of `bytes` bytes. What the parser of `ndarray-npy` is
/// given has been checked for length and depth.
fn read_header(file: &mut File, bytes: u64) -> Result<(Header, u64), Fault> {
    // Magic string, two bytes of version, length of the dictionary: two bytes in version 1, four later.
    let mut text = vec![0; 10];
    let start = bytes.min(10) as usize;
    file.read_exact(&mut text[..start])?;
    let magic = start.min(MAGIC.len());
    if text[..magic] != MAGIC[..magic] {
        return Err(FormatError::NotNpy { start: text[..magic].to_vec() }.into());
    }
    if start < text.len() {
        return Err(FormatError::Truncated { bytes, needed: 10 }.into());
    }
    let announced = match (text[6], text[7]) {
        (1, 0) => u64::from(u16::from_le_bytes([text[8], text[9]])),
        (2 | 3, 0) => {
            if bytes < 12 {
                return Err(FormatError::Truncated { bytes, needed: 12 }.into());
            }
            text.resize(12, 0);
            file.read_exact(&mut text[10..])?;
            u64::from(u32::from_le_bytes([text[8], text[9], text[10], text[11]]))
        }
        (major, minor) => return Err(FormatError::Version { major, minor }.into()),
    };
    let prefix = text.len();
    if announced > MAX_HEADER as u64 {
        return Err(FormatError::HeaderLength { bytes: announced, limit: MAX_HEADER as u64 }.into());
    }
    let needed = prefix as u64 + announced;
    if bytes < needed {
        return Err(FormatError::Truncated { bytes, needed }.into());
    }
    text.resize(needed as usize, 0);
    file.read_exact(&mut text[prefix..])?;
    let nesting = nesting(&text[prefix..]);
    if nesting > MAX_NESTING {
        let reason = format!("brackets are nested {nesting} deep");
        return Err(FormatError::Header { reason }.into());
    }
    match Header::from_reader(&mut text.as_slice()) {
        Ok(Header { shape, .. }) if shape.len() > MAX_AXES => {
            let reason = format!("the shape has {} axes", shape.len());
            Err(FormatError::Header { reason }.into())
        }
        Ok(header) => Ok((header, needed)),
        Err(ReadHeaderError::Io(error)) => Err(error.into()),
        Err(ReadHeaderError::Parse(error)) => {
            let reason = match error {
                // The parser's own report draws the whole header over several lines.
                ParseHeaderError::DictParse(_) => {
                    format!("not a dictionary: {}", String::from_utf8_lossy(text[prefix..].trim_ascii()))
                }
                // The word of `ndarray-npy` 0.10 for this key has a letter too many.
                ParseHeaderError::MissingKey(key) if key == "shaper" => "missing key: shape".into(),
                other => other.to_string(),
            };
            Err(FormatError::Header { reason: shortened(reason) }.into())
        }
    }
}

/// A quotation from a damaged file, fit for a message.
fn shortened(text: String) -> String {
    const LONGEST: usize = 200;
    let text = text.replace(char::is_control, "\u{fffd}");
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text,
    }
}

/// Deepest nesting of brackets, of any kind, closed or not.
fn nesting(text: &[u8]) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    for byte in text {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}
