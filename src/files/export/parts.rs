//! Which part of a table is in which file, and how the files are called.
//!
//! The rule that all formats share: a file holds all frames, or one; all samples of a pixel, or one; and as
//! many consecutive dimensions as it has channels. What does not fit goes to further files, which are told
//! apart by their names only as far as needed.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::options::{ExportOptions, Rule};
use crate::error::ExportError;
use crate::table::extent::Extent;

/// What of a table is in a file: all rows and columns of these.
///
/// Its numbers lie in the order of the table, `[frame][y][x][sample][dim]`, unless the format says otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Frames of the table.
    pub frames: Range<usize>,
    /// Samples of a pixel.
    pub samples: Range<usize>,
    /// Dimensions of a sample.
    pub dims: Range<usize>,
}

impl Part {
    /// Positions of the numbers of a row in the memory of the table: pixel by pixel from the left, sample by
    /// sample, dimension by dimension.
    pub(in crate::files) fn row(
        &self,
        extent: Extent,
        dims: usize,
        frame: usize,
        y: usize,
    ) -> impl Iterator<Item = usize> + use<> {
        let Extent { height, width, spp, .. } = extent;
        let (samples, channels) = (self.samples.clone(), self.dims.clone());
        let first = (frame * height + y) * width;
        (first..first + width).flat_map(move |site| {
            let channels = channels.clone();
            samples
                .clone()
                .flat_map(move |sample| channels.clone().map(move |dim| (site * spp + sample) * dims + dim))
        })
    }

    /// Lengths `[frame, y, x, sample, dim]` of the part of a table of this extent.
    pub(in crate::files) fn shape(&self, extent: Extent) -> [usize; 5] {
        [self.frames.len(), extent.height, extent.width, self.samples.len(), self.dims.len()]
    }
}

/// The files of an export, in the order of frames within dimensions within samples.
pub(super) fn files(
    path: &Path,
    options: &ExportOptions,
    extent: Extent,
    dims: usize,
) -> Result<Vec<(PathBuf, Part)>, ExportError> {
    let rule = options.format.rule();
    let stem =
        path.file_stem().filter(|_| has_extension(path, rule.extension)).and_then(|stem| stem.to_str());
    let stem = stem.ok_or_else(|| ExportError::FileName { path: path.into(), extension: rule.extension })?;
    let parts = parts(&rule, extent, dims);
    let default = default_name(&parts, rule.all_frames);
    let pattern = options.name.as_deref().unwrap_or(&default);
    let mut files: Vec<(PathBuf, Part)> = Vec::with_capacity(parts.len());
    for part in parts {
        let name = filled(pattern, stem, extent, &part)?;
        files.push((path.with_file_name(format!("{name}.{}", rule.extension)), part));
    }
    check_distinct(pattern, &files)?;
    Ok(files)
}

/// Whether the file's name ends like this, in any case.
fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

fn parts(rule: &Rule, extent: Extent, dims: usize) -> Vec<Part> {
    let cut = |len: usize, step: usize| (0..len).step_by(step).map(move |at| at..len.min(at + step));
    let samples = || cut(extent.spp, if rule.all_samples { extent.spp } else { 1 });
    let frames = || cut(extent.frames, if rule.all_frames { extent.frames } else { 1 });
    let dims = || cut(dims, rule.most_dims.min(dims));
    samples()
        .flat_map(|samples| dims().map(move |dims| (samples.clone(), dims)))
        .flat_map(|(samples, dims)| {
            frames().map(move |frames| Part { frames, samples: samples.clone(), dims: dims.clone() })
        })
        .collect()
}

/// Tells apart what needs it. Files of single frames say what they are frames of, as those of spatio-temporal
/// blue noise do, and are numbered even where there is one.
fn default_name(parts: &[Part], all_frames: bool) -> String {
    let differ = |of: fn(&Part) -> &Range<usize>| parts.iter().any(|part| of(part) != of(&parts[0]));
    let mut name = String::from("{name}");
    for (is_told, suffix) in [
        (!all_frames, "_{kind}_2Dx1D_{width}x{height}x{frames}"),
        (differ(|part| &part.samples), "_s{sample}"),
        (differ(|part| &part.dims), "_d{dims}"),
        (!all_frames, "_{frame}"),
    ] {
        name += if is_told { suffix } else { "" };
    }
    name
}

/// The pattern with its places filled.
fn filled(pattern: &str, stem: &str, extent: Extent, part: &Part) -> Result<String, ExportError> {
    let bad = |problem: String| ExportError::Pattern { pattern: pattern.into(), problem };
    let mut name = String::new();
    let mut rest = pattern;
    while let Some(open) = rest.find(['{', '}']) {
        name += &rest[..open];
        let place = rest[open..].strip_prefix('{').and_then(|after| after.split_once('}'));
        let (place, after) = place.ok_or_else(|| bad("has a brace alone".into()))?;
        name += &match place {
            "name" => stem.to_string(),
            "kind" if part.dims.len() == 1 => "scalar".into(),
            "kind" => format!("vec{}", part.dims.len()),
            "width" => extent.width.to_string(),
            "height" => extent.height.to_string(),
            "frames" => extent.frames.to_string(),
            "frame" => range(&part.frames),
            "sample" => range(&part.samples),
            "dims" => range(&part.dims),
            _ => return Err(bad(format!("has no meaning for {{{place}}}"))),
        };
        rest = after;
    }
    name += rest;
    if name.is_empty() || name.contains(['/', '\\', '\0']) {
        return Err(bad(format!("makes {name:?}, which is no name of a file")));
    }
    Ok(name)
}

/// `3`, or `0-3` with both ends.
fn range(range: &Range<usize>) -> String {
    match range.len() {
        1 => range.start.to_string(),
        _ => format!("{}-{}", range.start, range.end - 1),
    }
}

fn check_distinct(pattern: &str, files: &[(PathBuf, Part)]) -> Result<(), ExportError> {
    let mut sorted: Vec<_> = files.iter().collect();
    sorted.sort_by(|(first, _), (second, _)| first.cmp(second));
    let Some(twins) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) else { return Ok(()) };
    let [(path, first), (_, second)] = [twins[0], twins[1]];
    let place = match (first.samples == second.samples, first.dims == second.dims) {
        (false, _) => "{sample}",
        (_, false) => "{dims}",
        _ => "{frame}",
    };
    Err(ExportError::SameName { pattern: pattern.into(), path: path.clone(), place })
}
