//! Several files that are one table: `mask_{frame}.png`, and so on.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use ndarray::{ArrayD, IxDyn, ShapeBuilder, concatenate};

use super::source::{self, Source};
use super::{ImportOptions, Problem};
use crate::error::ImportError;
use crate::files::layout::{Axis, Layout};

/// Longest set: what a slip may name.
const MOST_FILES: usize = 1 << 16;

/// A path whose name has places for numbers.
pub(super) struct Pattern {
    path: PathBuf,
    /// What stands before, between and behind the places.
    texts: Vec<String>,
    /// What is counted in each place.
    axes: Vec<Axis>,
}

/// Places of a pattern, by the axes along which the files follow each other.
const PLACES: [(&str, Axis); 3] =
    [("{frame}", Axis::Frame), ("{sample}", Axis::Sample), ("{dims}", Axis::Dim)];

impl Pattern {
    /// The pattern of a path, if it has places and is no file.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let mut rest = path.file_name()?.to_str()?;
        let (mut texts, mut axes) = (Vec::new(), Vec::new());
        let next = |rest: &str| {
            let found = PLACES.iter().filter_map(|&(place, axis)| Some((rest.find(place)?, place, axis)));
            found.min_by_key(|&(at, ..)| at)
        };
        while let Some((at, place, axis)) = next(rest) {
            texts.push(rest[..at].to_string());
            axes.push(axis);
            rest = &rest[at + place.len()..];
        }
        texts.push(rest.to_string());
        (!axes.is_empty() && !path.exists()).then(|| Self { path: path.into(), texts, axes })
    }

    /// The numbers in the places of a name, as `[frame, sample, dim]`. Of a range, its first.
    fn numbers(&self, name: &str) -> Option<[u64; 3]> {
        let mut numbers = [0; 3];
        let mut rest = name.strip_prefix(self.texts[0].as_str())?;
        for (at, axis) in self.axes.iter().enumerate() {
            let is_number = |c: char| c.is_ascii_digit() || c == '-' && *axis == Axis::Dim;
            let end = rest.find(|c| !is_number(c)).unwrap_or(rest.len());
            let number = rest[..end].split('-').next()?.parse().ok()?;
            numbers[PLACES.iter().position(|(_, known)| known == axis)?] = number;
            rest = rest[end..].strip_prefix(self.texts[at + 1].as_str())?;
        }
        rest.is_empty().then_some(numbers)
    }

    /// The files, in the order of their numbers.
    fn files(&self) -> Result<BTreeMap<[u64; 3], PathBuf>, Problem> {
        let folder = match self.path.parent() {
            Some(folder) if folder != OsStr::new("") => folder,
            _ => Path::new("."),
        };
        let mut files = BTreeMap::new();
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name();
            let Some(numbers) = name.to_str().and_then(|name| self.numbers(name)) else { continue };
            if let Some(other) = files.insert(numbers, self.path.with_file_name(&name)) {
                let names = [&other, &self.path.with_file_name(&name)].map(|path| name_of(path));
                return Err(ImportError::SameNumber { names }.into());
            }
        }
        match files.len() {
            0 => Err(ImportError::NoFiles.into()),
            1..=MOST_FILES => Ok(files),
            files => Err(ImportError::TooManyFiles { files, most: MOST_FILES }.into()),
        }
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads all files and puts them beside each other, as `[frame, y, x, sample, dim]`.
pub(super) fn read(pattern: &Pattern, options: &ImportOptions) -> Result<Source, Problem> {
    let files = pattern.files()?;
    let counted = |axis: usize| {
        let mut numbers: Vec<u64> = files.keys().map(|numbers| numbers[axis]).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    };
    let [frames, samples, dims] = [0, 1, 2].map(counted);
    check_counted(&frames, "{frame}")?;
    check_counted(&samples, "{sample}")?;
    let mut first: Option<(Source, String)> = None;
    let mut stacked: Vec<ArrayD<f64>> = Vec::new();
    for &frame in &frames {
        let mut beside: Vec<ArrayD<f64>> = Vec::new();
        for &sample in &samples {
            let mut parts: Vec<ArrayD<f64>> = Vec::new();
            for &dim in &dims {
                let path = files.get(&[frame, sample, dim]).ok_or(ImportError::MissingFile {
                    frame,
                    sample,
                    dim,
                })?;
                let (array, source) = five_axes(source::read(path, options)?, options)?;
                let name = name_of(path);
                match &first {
                    None => first = Some((source, name)),
                    Some((first, of)) if first.descr != source.descr => {
                        let names = [of.clone(), name];
                        return Err(ImportError::Unlike { names }.into());
                    }
                    Some(_) => {}
                }
                parts.push(array);
            }
            beside.push(joined(&parts, 4)?);
        }
        stacked.push(joined(&beside, 3)?);
    }
    let table = joined(&stacked, 0)?;
    let Some((first, _)) = first else { return Err(ImportError::NoFiles.into()) };
    Ok(Source {
        shape: table.shape().to_vec(),
        values: table.into_iter().collect(),
        descr: format!("{} files, {}", files.len(), first.descr),
        axes: Axis::ALL.to_vec(),
        ..first
    })
}

/// Refuses numbers that leave one out.
fn check_counted(numbers: &[u64], place: &'static str) -> Result<(), ImportError> {
    match numbers.windows(2).find(|pair| pair[1] != pair[0] + 1) {
        Some(gap) => Err(ImportError::Gap { place, before: gap[0], after: gap[1] }),
        None => Ok(()),
    }
}

/// The numbers of a file with all axes of a table, and the rest of it.
fn five_axes(mut source: Source, options: &ImportOptions) -> Result<(ArrayD<f64>, Source), Problem> {
    let layout = Layout::of(&source.shape, &source.axes, options)?;
    let failed = std::io::Error::other;
    let values = std::mem::take(&mut source.values);
    let Layout { axes, extent, dims } = layout;
    let shape = [extent.frames, extent.height, extent.width, extent.spp, dims];
    let kept = if axes.is_empty() { &shape[..] } else { &source.shape[source.shape.len() - axes.len()..] };
    let mut array = ArrayD::from_shape_vec(IxDyn(kept).set_f(source.fortran), values).map_err(failed)?;
    if !axes.is_empty() {
        let place = |axis: &Axis| axes.iter().position(|found| found == axis);
        array = array.permuted_axes(Axis::ALL.iter().filter_map(place).collect::<Vec<_>>());
        let values = array.iter().copied().collect();
        array = ArrayD::from_shape_vec(IxDyn(&shape), values).map_err(failed)?;
    }
    source.fortran = false;
    Ok((array, source))
}

fn joined(parts: &[ArrayD<f64>], axis: usize) -> Result<ArrayD<f64>, Problem> {
    let views: Vec<_> = parts.iter().map(|part| part.view()).collect();
    concatenate(ndarray::Axis(axis), &views).map_err(|_| {
        let shapes = parts.iter().map(|part| part.shape().to_vec());
        let mut shapes: Vec<Vec<usize>> = shapes.collect();
        shapes.dedup();
        ImportError::UnlikeShapes { shapes }.into()
    })
}
