//! The numbers of a file and what it says of them, whichever kind of file it is.

use std::fs::File;
#[cfg(feature = "image")]
use std::io::BufReader;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use super::super::c_source::{self, Array};
use super::super::dtype::Dtype;
use super::super::export::source::PBRT_ARRAY;
use super::super::header::{self, Fault, Header};
use super::super::layout::{Axis, PICTURE};
use super::super::text;
use super::{ImportOptions, Problem, ktx2, raw};
use crate::error::{FormatError, ImportError};

/// The numbers of a file, as they lie there.
pub(super) struct Source {
    pub(super) values: Vec<f64>,
    pub(super) shape: Vec<usize>,
    /// Axes that the file names itself; none otherwise.
    pub(super) axes: Vec<Axis>,
    pub(super) fortran: bool,
    pub(super) dtype: Option<Dtype>,
    /// Levels that the file names itself.
    pub(super) levels: Option<u64>,
    pub(super) descr: String,
}

impl Source {
    /// Of a picture that is several times as high as wide, the frames, one below the other; and of channels
    /// those that say something. Returns the others.
    pub(super) fn tell_frames_and_channels(&mut self) -> Vec<usize> {
        if let ([rows, columns, channels], true) = (&self.shape[..], self.axes == PICTURE) {
            let [rows, columns, channels] = [*rows, *columns, *channels];
            if columns > 1 && rows > columns && rows.is_multiple_of(columns) {
                self.shape = vec![rows / columns, columns, columns, channels];
                self.axes.insert(0, Axis::Frame);
            }
        }
        let channels = match self.axes.last() {
            Some(Axis::Dim) => self.shape[self.shape.len() - 1],
            _ => return Vec::new(),
        };
        let texels = || self.values.chunks_exact(channels.max(1));
        let is_constant = |at: usize| texels().all(|texel| texel[at] == self.values[at]);
        let is_new = |at: usize| (0..at).all(|before| texels().any(|texel| texel[at] != texel[before]));
        let mut kept: Vec<usize> = (0..channels).filter(|&at| !is_constant(at) && is_new(at)).collect();
        if kept.is_empty() || kept.len() == channels {
            // All of them are constant, or none.
            kept = if kept.is_empty() && channels > 0 { vec![0] } else { return Vec::new() };
        }
        self.values = texels().flat_map(|texel| kept.iter().map(|&at| texel[at])).collect();
        if let Some(last) = self.shape.last_mut() {
            *last = kept.len();
        }
        (0..channels).filter(|at| !kept.contains(at)).collect()
    }
}

/// Reads all numbers of a file.
pub(super) fn read(path: &Path, options: &ImportOptions) -> Result<Source, Problem> {
    let (mut file, bytes) = header::open(path)?;
    let mut source = match (raw::described(path, options)?, picture(&mut file, bytes)?) {
        (Some(described), _) => raw::read(file, bytes, described)?,
        (None, Some(picture)) => picture,
        (None, None) => match header::read(&mut file, bytes) {
            Err(Fault::Format(FormatError::NotNpy { .. })) => {
                file.seek(SeekFrom::Start(0))?;
                read_text(path, file, options)?
            }
            Err(fault) => return Err(fault.into()),
            Ok(header) => read_npy(file, bytes, header)?,
        },
    };
    if let Some(channels) = options.channels {
        source.drop_channels(channels, options)?;
    }
    Ok(source)
}

/// A texture, if the file begins like one.
fn picture(file: &mut File, bytes: u64) -> Result<Option<Source>, Problem> {
    let mut start = Vec::new();
    file.take(8).read_to_end(&mut start)?;
    file.seek(SeekFrom::Start(0))?;
    if start == ktx2::SIGNATURE {
        let mut bytes = reserved(usize::try_from(bytes).unwrap_or(usize::MAX))?;
        file.read_to_end(&mut bytes)?;
        return ktx2::read(&bytes).map(Some);
    }
    #[cfg(feature = "image")]
    if start == super::png::SIGNATURE {
        return super::png::read(BufReader::new(file)).map(Some);
    }
    #[cfg(feature = "image")]
    if start.starts_with(&super::exr::SIGNATURE) {
        return super::exr::read(BufReader::new(file), bytes).map(Some);
    }
    #[cfg(not(feature = "image"))]
    if start == *b"\x89PNG\r\n\x1a\n" || start.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Err(ImportError::Feature.into());
    }
    Ok(None)
}

/// An empty list with room for so many.
pub(super) fn reserved<T>(count: usize) -> Result<Vec<T>, io::Error> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(io::Error::from)?;
    Ok(list)
}

fn read_npy(file: File, bytes: u64, header: Header) -> Result<Source, Problem> {
    let dtype = header.dtype.map_err(|dtype| ImportError::Dtype { dtype })?;
    let shape = header.shape;
    let count = shape.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    let expected = count.and_then(|count| count.checked_mul(dtype.size)).unwrap_or(usize::MAX) as u64;
    let given = bytes - header.bytes;
    if given != expected {
        return Err(FormatError::Length { given, expected, shape }.into());
    }
    let values = numbers(file, count.unwrap_or(0), dtype)?;
    let (axes, fortran, dtype, levels) = (Vec::new(), header.fortran, Some(dtype), None);
    Ok(Source { values, shape, axes, fortran, dtype, levels, descr: header.descr })
}

/// So many numbers of a type.
pub(super) fn numbers(mut file: File, count: usize, dtype: Dtype) -> io::Result<Vec<f64>> {
    let mut values = Vec::new();
    values.try_reserve_exact(count)?;
    let mut block = vec![0; 1 << 16];
    while values.len() < count {
        let bytes = block.len().min(dtype.size * (count - values.len()));
        file.read_exact(&mut block[..bytes])?;
        values.extend(block[..bytes].chunks_exact(dtype.size).map(|bytes| dtype.decode(bytes)));
    }
    Ok(values)
}

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

fn read_text(path: &Path, mut file: File, options: &ImportOptions) -> Result<Source, Problem> {
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
    let (values, axes, fortran, dtype, levels) = (numbers.values, Vec::new(), false, None, None);
    Ok(Source { values, shape, axes, fortran, dtype, levels, descr: "text".into() })
}

fn read_source(file: File, options: &ImportOptions) -> Result<Source, Problem> {
    let array = c_source::read(file, options.array.as_deref())?;
    let (shape, axes) = axes_of(&array, options);
    let Array { values, dtype, macros, descr, .. } = array;
    let levels = macros.iter().find(|(name, _)| *name == "_LEVELS").map(|(_, levels)| *levels);
    let descr = if descr.is_empty() { "C".into() } else { format!("C {descr}") };
    Ok(Source { values, shape, axes, fortran: false, dtype, levels, descr })
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

impl Source {
    /// Keeps the first `dims` numbers of every sample of so many.
    fn drop_channels(&mut self, channels: usize, options: &ImportOptions) -> Result<(), ImportError> {
        if !options.axes.is_empty() {
            return Err(ImportError::AxesAndLengths);
        }
        let dims = options.dims.unwrap_or(channels);
        let samples = self.values.len().checked_div(channels).unwrap_or(0);
        if samples * channels != self.values.len() || dims > channels || dims == 0 {
            return Err(ImportError::Channels { values: self.values.len(), channels, dims });
        }
        for sample in 0..samples {
            for dim in 0..dims {
                self.values[sample * dims + dim] = self.values[sample * channels + dim];
            }
        }
        self.values.truncate(samples * dims);
        (self.shape, self.axes) = (vec![samples, dims], Vec::new());
        Ok(())
    }
}
