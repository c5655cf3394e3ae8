//! What an export has written, by the record beside it.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::super::export::{ExportRecord, Format, RecordedFile, fast};
use super::super::header::shortened;
use super::super::layout::Axis;
use super::super::metadata;
use super::{ImportOptions, Imported};
use crate::error::{FormatError, ImportError, TableError};
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// Larger records are none.
const MOST_BYTES: u64 = 256 << 20;

/// Beginning of the kind of any record.
const KIND: &str = "fsot export ";

/// Imports all files of the record that lies beside this path, or there itself; `None` if there is none, or
/// if options say how to read the file.
pub(super) fn import(path: &Path, options: &ImportOptions) -> Option<Result<Imported, TableError>> {
    if *options != ImportOptions::default() {
        return None;
    }
    let is_record = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let place = if is_record { path.to_owned() } else { ExportRecord::path_beside(path) };
    let record = read(&place)?;
    let named = path.file_name().map(|name| name.to_string_lossy());
    // A file beside those of the record has only its name from them.
    let is_listed =
        |record: &ExportRecord| record.files.iter().any(|file| Some(&*file.name) == named.as_deref());
    if record.as_ref().is_ok_and(|record| !is_record && path.exists() && !is_listed(record)) {
        return None;
    }
    Some(record.and_then(|record| all(&place, &record)))
}

/// The record at this place; `None` if what is there is none.
fn read(place: &Path) -> Option<Result<ExportRecord, TableError>> {
    #[derive(Deserialize)]
    struct Any {
        kind: String,
    }
    let found = fs::metadata(place).ok()?;
    if !found.is_file() || found.len() > MOST_BYTES {
        return None;
    }
    let bytes = fs::read(place).ok()?;
    let Any { kind } = serde_json::from_slice(&bytes).ok()?;
    if !kind.starts_with(KIND) {
        return None;
    }
    let refuse = |problem| Some(Err(TableError::Format { path: place.into(), problem }));
    if kind != ExportRecord::KIND {
        let (given, expected) = (shortened(kind), ExportRecord::KIND.into());
        return refuse(FormatError::Field { field: "kind", given, expected });
    }
    match serde_json::from_slice(&bytes) {
        Ok(record) => Some(Ok(record)),
        Err(error) => {
            let reason = shortened(error.to_string());
            refuse(FormatError::Json { line: error.line(), column: error.column(), reason })
        }
    }
}

/// A file of a record and what it holds.
struct Piece {
    path: PathBuf,
    frames: Range<usize>,
    samples: Range<usize>,
    dims: Range<usize>,
}

fn all(place: &Path, record: &ExportRecord) -> Result<Imported, TableError> {
    let refuse = |problem: &str| {
        let problem = ImportError::Record { problem: problem.into() };
        TableError::Import { path: place.into(), problem }
    };
    let [frames, height, width, spp, dims] = record.shape;
    let extent = Extent { frames, height, width, spp };
    extent.validate(dims)?;
    let pieces: Option<Vec<Piece>> = record.files.iter().map(|file| piece(place, record, file)).collect();
    let pieces =
        pieces.ok_or_else(|| refuse("names a file in another folder, or more than its shape has"))?;
    let held = |piece: &Piece| (piece.frames.len() * piece.samples.len() * piece.dims.len()) as u64;
    let total = pieces.iter().map(held).fold(0, u64::saturating_add);
    if total != (frames * spp * dims) as u64 {
        return Err(refuse("holds a part of the table twice, or not at all"));
    }
    let mut imported = match &pieces[..] {
        [piece] => one(piece, record, extent)?,
        pieces => several(place, pieces, record, extent, refuse)?,
    };
    if metadata::sha256(imported.table.values()) != record.sha256.to_ascii_lowercase() {
        return Err(TableError::Import { path: place.into(), problem: ImportError::Changed });
    }
    imported.axes = Axis::ALL.to_vec();
    imported.shape = record.shape.to_vec();
    imported.record = Some(place.into());
    Ok(imported)
}

fn piece(place: &Path, record: &ExportRecord, file: &RecordedFile) -> Option<Piece> {
    let RecordedFile { name, frames, samples, dims } = file;
    let is_plain = Path::new(name).file_name().is_some_and(|plain| plain == name.as_str());
    let range =
        |[start, end]: [usize; 2], length: usize| (start < end && end <= length).then_some(start..end);
    let [of_frames, .., of_samples, of_dims] = record.shape;
    Some(Piece {
        path: is_plain.then(|| place.with_file_name(name))?,
        frames: range(*frames, of_frames)?,
        samples: range(*samples, of_samples)?,
        dims: range(*dims, of_dims)?,
    })
}

/// Reads one file; what it holds is a table of its own.
fn one(piece: &Piece, record: &ExportRecord, extent: Extent) -> Result<Imported, TableError> {
    let Extent { height, width, .. } = extent;
    let (frames, spp, dims) = (piece.frames.len(), piece.samples.len(), piece.dims.len());
    let [frames, height, width, spp, dims] = [frames, height, width, spp, dims].map(Some);
    let dtype = matches!(record.format, Format::Fast | Format::Raw).then(|| record.bits.dtype());
    let channels = (record.format == Format::Fast).then_some(fast::CHANNELS);
    let levels = record.bits.levels().map(u64::from);
    let options = ImportOptions {
        frames,
        height,
        width,
        spp,
        dims,
        channels,
        dtype,
        levels,
        ..ImportOptions::default()
    };
    super::import(&piece.path, &options).map_err(|problem| problem.of(&piece.path))
}

fn several(
    place: &Path,
    pieces: &[Piece],
    record: &ExportRecord,
    extent: Extent,
    refuse: impl Fn(&str) -> TableError,
) -> Result<Imported, TableError> {
    let dims = record.shape[4];
    let count = extent.samples() * dims;
    let mut values = Vec::new();
    let no_memory = |error| TableError::Io { verb: "read", path: place.into(), source: error };
    values.try_reserve_exact(count).map_err(|error| no_memory(error.into()))?;
    values.resize(count, f32::NAN);
    let mut last = None;
    for piece in pieces {
        let imported = one(piece, record, extent)?;
        let mut read = imported.table.values().iter();
        for frame in piece.frames.clone() {
            for site in frame * extent.height * extent.width..(frame + 1) * extent.height * extent.width {
                for sample in piece.samples.clone() {
                    let at = (site * extent.spp + sample) * dims;
                    let place = &mut values[at + piece.dims.start..at + piece.dims.end];
                    place.iter_mut().zip(&mut read).for_each(|(place, value)| *place = *value);
                }
            }
        }
        last = Some(imported);
    }
    // Numbers that were read are none, so that a part without a file is one that another has twice.
    let Some(imported) = last.filter(|_| !values.iter().any(|value| value.is_nan())) else {
        return Err(refuse("holds a part of the table twice, or not at all"));
    };
    Ok(Imported { table: SampleTable::trusted(extent, dims, values), ..imported })
}
