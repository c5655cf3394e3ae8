//! Bare numbers, of which a text beside them or options say what they are.

use std::fs::{self, File};
use std::path::Path;

use super::source::{Source, numbers};
use super::{ImportOptions, Problem};
use crate::error::{FormatError, ImportError};
use crate::files::dtype::Dtype;
use crate::files::export::raw::text_path;
use crate::files::header::shortened;
use crate::files::layout::Axis;

/// Longest text that is taken for a description.
const MOST_BYTES: u64 = 1 << 16;

/// What is known of bare numbers.
pub(super) struct Described {
    dtype: Dtype,
    /// A list where it is not known.
    shape: Option<Vec<usize>>,
    axes: Vec<Axis>,
    levels: Option<u64>,
    fortran: bool,
}

/// What options say; `None` if they say no type.
pub(super) fn by_options(path: &Path, options: &ImportOptions) -> Result<Option<Described>, ImportError> {
    let Some(dtype) = options.dtype else { return Ok(None) };
    Ok(Some(match by_text(path, options)? {
        Some(described) => Described { dtype, ..described },
        None => Described { dtype, shape: None, axes: Vec::new(), levels: None, fortran: false },
    }))
}

/// What the text beside a file says; `None` if it says no type.
pub(super) fn by_text(path: &Path, options: &ImportOptions) -> Result<Option<Described>, ImportError> {
    let beside = text_path(path);
    let is_text = fs::metadata(&beside).is_ok_and(|found| found.is_file() && found.len() <= MOST_BYTES);
    let text = if is_text { fs::read_to_string(&beside).unwrap_or_default() } else { String::new() };
    let Some(mut described) = parse(&text).transpose()? else { return Ok(None) };
    if options.lengths().is_some() || options.channels.is_some() {
        (described.shape, described.axes, described.fortran) = (None, Vec::new(), false);
    }
    if !options.axes.is_empty() {
        described.axes = Vec::new();
    }
    Ok(Some(described))
}

/// Reads `key: value` line by line; `None` if no line has a type.
fn parse(text: &str) -> Option<Result<Described, ImportError>> {
    let lines = text.lines().enumerate().filter_map(|(at, line)| {
        let (key, value) = line.split_once(':')?;
        Some((at + 1, key.trim().to_ascii_lowercase(), value.trim()))
    });
    let lines: Vec<_> = lines.collect();
    let find =
        |wanted: &str| lines.iter().find(|(_, key, _)| key == wanted).map(|(at, _, value)| (*at, *value));
    let bad = |(line, value): (usize, &str)| ImportError::Description { line, text: shortened(value.into()) };
    let dtype = find("dtype")?;
    let read = || {
        let dtype = Dtype::named(dtype.1.trim_matches(['\'', '"'])).ok_or_else(|| bad(dtype))?;
        let list = |line: (usize, &str)| {
            let list = line.1.trim_matches(['[', ']', '(', ')']);
            let lengths = list.split([',', ' ']).filter(|length| !length.is_empty());
            lengths.map(str::parse).collect::<Result<Vec<usize>, _>>().map_err(|_| bad(line))
        };
        let names = |line: (usize, &str)| {
            let names = line.1.split([',', ' ']).filter(|name| !name.is_empty());
            names.map(str::parse).collect::<Result<Vec<Axis>, _>>().map_err(|_| bad(line))
        };
        let shape = find("shape").map(list).transpose()?;
        let axes = find("axes").map(names).transpose()?.unwrap_or_default();
        let levels = find("levels").filter(|(_, value)| *value != "none");
        let levels = levels.map(|line| line.1.parse().map_err(|_| bad(line))).transpose()?;
        let fortran = find("order").is_some_and(|(_, value)| value.starts_with(['F', 'f']));
        // Axes of what has no lengths name nothing.
        let axes = if shape.is_some() { axes } else { Vec::new() };
        Ok(Described { dtype, shape, axes, levels, fortran })
    };
    Some(read())
}

/// Reads the numbers.
pub(super) fn read(file: File, bytes: u64, described: Described) -> Result<Source, Problem> {
    let Described { dtype, shape, axes, levels, fortran } = described;
    let size = dtype.size as u64;
    let shape = shape.unwrap_or_else(|| vec![usize::try_from(bytes / size).unwrap_or(usize::MAX)]);
    let count = shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    let expected = count.map_or(u64::MAX, |count| (count as u64).saturating_mul(size));
    if bytes != expected {
        return Err(FormatError::Length { given: bytes, expected, shape }.into());
    }
    let values = numbers(file, count.unwrap_or(0), dtype)?;
    let source =
        Source { fortran, dtype: Some(dtype), levels, ..Source::of(values, shape, dtype.to_string()) };
    if axes.is_empty() { Ok(source) } else { source.in_order(&axes) }
}
