//! Files of an export, by the record beside them.

use std::fs;
use std::path::{Path, PathBuf};

use super::source::{Problem, Source, reserved, source};
use super::{ImportOptions, Imported};
use crate::error::{FormatError, ImportError};
use crate::files::export::{self, ExportRecord, Format, Part};
use crate::files::layout::Axis;
use crate::files::metadata;
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// The record beside a path, or at it; `None` where there is none.
pub(super) fn find(path: &Path) -> Result<Option<(PathBuf, ExportRecord)>, Problem> {
    let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let place = if is_json { path.into() } else { ExportRecord::path_beside(path) };
    if !fs::metadata(&place).is_ok_and(|found| found.is_file()) {
        return Ok(None);
    }
    let bytes = fs::read(&place)?;
    let record: ExportRecord = match serde_json::from_slice(&bytes) {
        Ok(record) => record,
        // Somebody else's file of that name.
        Err(_) if !is_json && !String::from_utf8_lossy(&bytes).contains(export::KIND) => return Ok(None),
        Err(error) => return Err(ImportError::Record { path: place, reason: error.to_string() }.into()),
    };
    if record.kind != export::KIND {
        let (field, expected) = ("kind", export::KIND.into());
        return Err(FormatError::Field { field, given: record.kind, expected }.into());
    }
    Ok(Some((place, record)))
}

/// Reads the files that the record lists.
pub(super) fn read(path: &Path, (place, record): (PathBuf, ExportRecord)) -> Result<Imported, Problem> {
    let bad = |reason: String| Problem::from(ImportError::Record { path: place.clone(), reason });
    let [frames, height, width, spp, dims] = record.shape;
    let extent = Extent { frames, height, width, spp };
    extent.validate(dims).map_err(|problem| bad(problem.to_string()))?;
    let mut values = reserved(extent.samples() * dims)?;
    values.resize(values.capacity(), f32::NAN);
    for file in &record.files {
        let part = file.part();
        let ends = [(&part.frames, frames), (&part.samples, spp), (&part.dims, dims)];
        let is_name = Path::new(&file.name).file_name().is_some_and(|name| *name == *file.name);
        if !is_name || ends.iter().any(|(range, len)| range.is_empty() || range.end > *len) {
            return Err(bad(format!("{:?} holds what the table has not", file.name)));
        }
        let of_file = path.with_file_name(&file.name);
        put(&mut values, &record, &part, numbers(&of_file, &part, &record, extent)?)
            .map_err(|reason| bad(format!("{:?}: {reason}", file.name)))?;
    }
    if values.iter().any(|value| value.is_nan()) {
        return Err(bad("its files do not hold the whole table".into()));
    }
    let found = metadata::sha256(&values);
    if !found.eq_ignore_ascii_case(&record.sha256) {
        return Err(ImportError::OtherValues { path: place, record: record.sha256, found }.into());
    }
    Ok(Imported {
        table: SampleTable::trusted(extent, dims, values),
        dtype: format!("{} of {} bits", record.format, 8 * record.bits.bytes()),
        shape: record.shape.to_vec(),
        axes: Axis::ALL.to_vec(),
        levels: record.bits.levels().map(u64::from),
        first_level: 0,
        ones: 0,
        left_out: Vec::new(),
        record: Some(place),
    })
}

/// The numbers of a file, in the order of a part.
fn numbers(path: &Path, part: &Part, record: &ExportRecord, extent: Extent) -> Result<Vec<f64>, Problem> {
    let shape = part.shape(extent);
    let expected: usize = shape.iter().product();
    let [frames, .., spp, dims] = shape.map(Some);
    // What files say themselves of their axes, so that they are known where they do not.
    let options = match record.format {
        Format::Raw => ImportOptions { dtype: Some(record.bits.dtype()), frames, ..Default::default() },
        Format::Fast => {
            let (dtype, channels) = (Some(record.bits.dtype()), Some(export::fast::CHANNELS));
            ImportOptions { dtype, channels, dims, ..ImportOptions::default() }
        }
        Format::Pbrt => ImportOptions { frames, spp, dims, ..ImportOptions::default() },
        _ => ImportOptions::default(),
    };
    // Frames, rows from the top, pixels from the left, samples, channels: the order of a part.
    let Source { values: found, .. } = source(path, &options)?;
    if found.len() != expected {
        let (given, name) = (found.len(), path.display().to_string());
        return Err(ImportError::OtherCount { name, given, expected }.into());
    }
    Ok(found)
}

/// Puts the numbers of a file where they belong.
fn put(values: &mut [f32], record: &ExportRecord, part: &Part, numbers: Vec<f64>) -> Result<(), String> {
    let [_, height, width, spp, dims] = record.shape;
    let extent = Extent { frames: record.shape[0], height, width, spp };
    let mut numbers = numbers.into_iter();
    for frame in part.frames.clone() {
        for y in 0..height {
            for (at, number) in part.row(extent, dims, frame, y).zip(numbers.by_ref()) {
                let value = export::decoded(record.bits, number);
                let value = value.filter(|value| (0.0..1.0).contains(value));
                let value =
                    value.ok_or_else(|| format!("{number} is no number of --bits {}", record.bits))?;
                if !values[at].is_nan() {
                    return Err("another file holds the same".into());
                }
                values[at] = value;
            }
        }
    }
    Ok(())
}
