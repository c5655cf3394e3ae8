//! What the files of an export do not say themselves, in a `.json` beside them.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::options::{Depth, Format, Rounding};

/// Kind and version of the file; the number grows when an old reader would misunderstand a new file.
const KIND: &str = "fsot export 1";

/// How to read the files of an export: by this, [`SampleTable::import`](crate::SampleTable::import) makes a
/// table of them again.
///
/// It lies beside them, under the path that was given to [`SampleTable::export`](crate::SampleTable::export)
/// and `.json`: that of `mask.png` is `mask.png.json`. Fields that are not known are ignored when reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExportRecord {
    /// Kind and version of the file: `fsot export 1`.
    pub kind: String,
    /// Version of this crate that wrote the files.
    pub crate_version: String,
    /// The format of the files.
    pub format: Format,
    /// The numbers in them.
    pub bits: Depth,
    /// How values became levels.
    pub rounding: Rounding,
    /// What a number stands for: `(k + 0.5) / 256`, or `v` for the number itself.
    pub decode: String,
    /// Lengths of the table's axes: frame, y, x, sample, dim.
    pub shape: [usize; 5],
    /// SHA-256 of the values that the numbers stand for, as little-endian `f32` in the order of the table: as
    /// in the metadata of the table that import makes of them.
    pub sha256: String,
    /// The files and what each of them holds.
    pub files: Vec<RecordedFile>,
}

/// A file of an export. Ranges are `[first, last + 1]`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordedFile {
    /// Its name, in the folder of the record.
    pub name: String,
    /// Frames that it holds.
    pub frames: [usize; 2],
    /// Samples of a pixel that it holds.
    pub samples: [usize; 2],
    /// Dimensions of a sample that it holds.
    pub dims: [usize; 2],
}

impl ExportRecord {
    /// What [`kind`](Self::kind) is.
    pub(in crate::files) const KIND: &str = KIND;

    /// Where the record of an export lies: the path that was given, and `.json`.
    pub fn path_beside(path: &Path) -> PathBuf {
        let mut name = path.as_os_str().to_owned();
        name.push(".json");
        name.into()
    }
}
