//! Numbers that are written as text, one sample or one row of a picture a line, or as C and C++.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use super::source::Source;
use super::{ImportOptions, Problem, raw};
use crate::error::ImportError;
use crate::files::c_source::{self, Array};
use crate::files::export::source::PBRT_ARRAY;
use crate::files::layout::Axis;
use crate::files::text;

/// What a text is, by its name and its beginning.
enum Text {
    /// Numbers between blanks and commas.
    Numbers,
    /// C or C++.
    Source,
    /// None.
    Bare,
}

fn kind_of_text(path: &Path, file: &mut File, options: &ImportOptions) -> io::Result<Text> {
    let ends = |endings: &[&str]| {
        path.extension().is_some_and(|found| endings.iter().any(|ending| found.eq_ignore_ascii_case(ending)))
    };
    let mut start = Vec::new();
    file.by_ref().take(1 << 16).read_to_end(&mut start)?;
    file.seek(SeekFrom::Start(0))?;
    let is_source = options.array.is_some()
        || ends(&["h", "hh", "hpp", "hxx", "c", "cc", "cpp", "cxx", "cu", "cuh", "inc", "inl"])
        || !ends(&["csv", "dat", "tsv", "txt"]) && start.contains(&b'{');
    Ok(match (start.contains(&0), is_source) {
        (true, _) => Text::Bare,
        (_, true) => Text::Source,
        _ => Text::Numbers,
    })
}

/// Reads what is no array and no texture.
pub(super) fn read(path: &Path, mut file: File, options: &ImportOptions) -> Result<Source, Problem> {
    if let Some(described) = raw::by_text(path, options)? {
        let bytes = file.metadata()?.len();
        return raw::read(file, bytes, described);
    }
    match kind_of_text(path, &mut file, options)? {
        Text::Bare => Err(ImportError::NoDtype.into()),
        Text::Source => read_source(file, options),
        Text::Numbers => read_numbers(file, options),
    }
}

fn read_numbers(file: File, options: &ImportOptions) -> Result<Source, Problem> {
    let numbers = text::read(file)?;
    let count = numbers.values.len();
    let shape = match numbers.columns {
        // All on one line, in whichever order: a list.
        Ok(columns) if columns == count && columns > 16 => vec![count],
        Ok(columns) => vec![count / columns, columns],
        Err(_) if options.dims.is_some() => vec![count],
        Err(ragged) => return Err(ragged.into()),
    };
    Ok(Source::of(numbers.values, shape, "text".into()))
}

fn read_source(file: File, options: &ImportOptions) -> Result<Source, Problem> {
    let array = c_source::read(file, options.array.as_deref())?;
    let (shape, axes) = axes_of(&array, options);
    let Array { values, dtype, macros, descr, .. } = array;
    let levels = macros.iter().find(|(name, _)| *name == "_LEVELS").map(|(_, levels)| *levels);
    let descr = if descr.is_empty() { "C".into() } else { format!("C {descr}") };
    let source = Source { dtype, levels, ..Source::of(values, shape, descr) };
    if axes.is_empty() { Ok(source) } else { source.in_order(&axes) }
}

/// What the axes of an array are, by its name and by macros; none if nothing tells.
fn axes_of(array: &Array, options: &ImportOptions) -> (Vec<usize>, Vec<Axis>) {
    let by_macro = |ending: &str| {
        let found = array.macros.iter().find(|(name, _)| *name == ending);
        found.and_then(|(_, length)| usize::try_from(*length).ok())
    };
    let is_free = options.axes.is_empty() && options.channels.is_none();
    let of_macros = ["_FRAMES", "_HEIGHT", "_WIDTH", "_SPP", "_DIMS"].map(by_macro);
    if let (PBRT_ARRAY, &[textures, width, height], true) = (array.name.as_str(), &array.shape[..], is_free) {
        let [frames, .., spp, dims] = options.lengths().unwrap_or(of_macros);
        let rest = |[one, other]: [Option<usize>; 2]| {
            let known = one.unwrap_or(1).saturating_mul(other.unwrap_or(1)).max(1);
            if textures % known == 0 { textures / known } else { 1 }
        };
        // Textures of which nobody says more are dimensions, as in pbrt.
        let (frames, spp, dims) = match (frames, spp, dims) {
            (frames, spp, None) => (frames.unwrap_or(1), spp.unwrap_or(1), rest([frames, spp])),
            (None, spp, Some(dims)) => (rest([spp, Some(dims)]), spp.unwrap_or(1), dims),
            (Some(frames), spp, Some(dims)) => {
                (frames, spp.unwrap_or_else(|| rest([Some(frames), Some(dims)])), dims)
            }
        };
        if frames.saturating_mul(spp).saturating_mul(dims) == textures {
            let axes = vec![Axis::Frame, Axis::Sample, Axis::Dim, Axis::X, Axis::Y];
            return (vec![frames, spp, dims, width, height], axes);
        }
    }
    if let ([Some(frames), Some(height), Some(width), Some(spp), Some(dims)], true, None) =
        (of_macros, is_free, options.lengths())
    {
        let shape = vec![frames, height, width, spp, dims];
        if shape.iter().try_fold(1_usize, |all, one| all.checked_mul(*one)) == Some(array.values.len()) {
            return (shape, Axis::ALL.to_vec());
        }
    }
    (array.shape.clone(), Vec::new())
}
