//! The part of a `.npy` file before its values[^npy]: magic string, version, and a dictionary in Python's
//! words. Nothing in it is trusted.
//!
//! [^npy]: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use super::dtype::Dtype;
use super::literal::{Item, Parser, Value};
use crate::error::{FormatError, TableError};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest header that is read; numpy draws the same line. Headers of tables have 128 bytes.
const MAX_HEADER: usize = 10_000;

/// Most axes that a shape in an error message has, and most axes of a numpy array.
const MAX_AXES: usize = 64;

/// Why a file was not read; the path is added by the caller.
pub(super) enum Fault {
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

impl Fault {
    /// The same, with the path.
    pub(super) fn of(self, path: &Path) -> TableError {
        match self {
            Self::Io(source) => TableError::Io { verb: "read", path: path.to_path_buf(), source },
            Self::Format(problem) => TableError::Format { path: path.to_path_buf(), problem },
        }
    }
}

/// What a header says, in its own words where they are not understood.
#[derive(Debug)]
pub(super) struct Header {
    /// `Err` is the text of a type that is no plain number of at most 64 bits.
    pub(super) dtype: Result<Dtype, String>,
    /// The type as it is written.
    pub(super) descr: String,
    pub(super) fortran: bool,
    pub(super) shape: Vec<usize>,
    /// Bytes before the first value.
    pub(super) bytes: u64,
}

/// An ordinary file, and its length. Anything else is refused before it is opened, because opening a pipe
/// waits for its writer.
pub(super) fn open(path: &Path) -> Result<(File, u64), Fault> {
    if !fs::metadata(path)?.is_file() {
        return Err(FormatError::NotAFile.into());
    }
    let file = File::open(path)?;
    let bytes = file.metadata()?.len();
    Ok((file, bytes))
}

/// Reads the header of a file of `bytes` bytes.
pub(super) fn read(file: &mut File, bytes: u64) -> Result<Header, Fault> {
    // Magic string, two bytes of version, length of the dictionary: two bytes in version 1, four later.
    let mut text = vec![0; 10];
    let start = bytes.min(10) as usize;
    file.read_exact(&mut text[..start])?;
    let magic = start.min(MAGIC.len());
    if text[..magic] != MAGIC[..magic] {
        return Err(FormatError::NotNpy { start: text[..magic].to_vec(), advice: GIVE_NPY.into() }.into());
    }
    if start < text.len() {
        return Err(FormatError::Truncated { bytes, needed: 10 }.into());
    }
    let version = text[6];
    let announced = match (version, text[7]) {
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
    let parsed = decoded(&text[prefix..], version).and_then(|text| parse(&text, version));
    parsed
        .map(|header| Header { bytes: needed, ..header })
        .map_err(|reason| FormatError::Header { reason: shortened(reason) }.into())
}

/// What to do with a file that is neither `.npy` nor numbers as text.
pub(super) const GIVE_NPY: &str = "give a .npy file";

/// Characters with line ends as Python sees them: Latin-1 up to version 2, UTF-8 from version 3 on.
fn decoded(bytes: &[u8], version: u8) -> Result<Vec<char>, String> {
    let text = match version {
        3 => String::from_utf8(bytes.to_vec()).map_err(|_| "it is no UTF-8".to_string())?,
        _ => bytes.iter().copied().map(char::from).collect(),
    };
    Ok(text.replace("\r\n", "\n").replace('\r', "\n").chars().collect())
}

/// The dictionary.
fn parse(text: &[char], version: u8) -> Result<Header, String> {
    let item = Parser::new(text, version < 3).parse().map_err(|reason| {
        let text: String = text.iter().collect();
        if text.trim().is_empty() { reason } else { format!("{reason} in {}", text.trim()) }
    })?;
    let Value::Dict(entries) = item.value else {
        return Err(format!("not a dictionary: {}", quote(text, &item).trim()));
    };
    let (mut descr, mut fortran, mut shape) = (None, None, None);
    for [key, value] in entries.as_chunks().0 {
        // Of keys that stand twice the last one counts.
        let place = match &key.value {
            Value::Text(key) if key == "descr" => &mut descr,
            Value::Text(key) if key == "fortran_order" => &mut fortran,
            Value::Text(key) if key == "shape" => &mut shape,
            _ => return Err(format!("unknown key: {}", quote(text, key))),
        };
        *place = Some(value);
    }
    let missing = |key: &str| format!("missing key: {key}");
    let descr = descr.ok_or_else(|| missing("descr"))?;
    let dtype = match &descr.value {
        Value::Text(name) => Dtype::named(name),
        _ => None,
    };
    let fortran = fortran.ok_or_else(|| missing("fortran_order"))?;
    let Value::Bool(is_fortran) = fortran.value else {
        return Err(format!("fortran_order: {} is neither True nor False", quote(text, fortran)));
    };
    let shape = shape.ok_or_else(|| missing("shape"))?;
    let Value::Tuple(axes) = &shape.value else {
        return Err(format!("shape: {} is no tuple of lengths", quote(text, shape)));
    };
    if axes.len() > MAX_AXES {
        return Err(format!("the shape has {} axes", axes.len()));
    }
    let length = |&length: &u64| usize::try_from(length).map_err(|_| format!("an axis has length {length}"));
    let written = shortened(quote(text, descr));
    Ok(Header {
        dtype: dtype.ok_or_else(|| written.clone()),
        descr: written,
        fortran: is_fortran,
        shape: axes.iter().map(length).collect::<Result<_, _>>()?,
        bytes: 0,
    })
}

fn quote(text: &[char], item: &Item) -> String {
    text[item.from..item.to].iter().collect()
}

/// A quotation from a damaged file, fit for a message.
pub(super) fn shortened(text: String) -> String {
    const LONGEST: usize = 200;
    let text = text.replace(char::is_control, "\u{fffd}");
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text,
    }
}
