//! The numbers of a file and what it says of them, whichever kind of file it is.

use std::fs::File;
#[cfg(feature = "image")]
use std::io::BufReader;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use ndarray::{ArrayD, IxDyn, ShapeBuilder};

use super::{ImportOptions, Problem, ktx2, raw, written};
use crate::error::{FormatError, ImportError};
use crate::files::dtype::Dtype;
use crate::files::header::{self, Fault, Header};
use crate::files::layout::{Axis, Layout, PICTURE};
use crate::table::extent::Extent;

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
    /// Numbers of which nothing else is known.
    pub(super) fn of(values: Vec<f64>, shape: Vec<usize>, descr: String) -> Self {
        Self { values, shape, fortran: false, dtype: None, descr, levels: None, axes: Vec::new() }
    }

    /// The same as all five axes of a table, where the file names its axes for certain.
    pub(super) fn in_order(mut self, axes: &[Axis]) -> Result<Self, Problem> {
        let layout =
            Layout::of(&self.shape, &[], &ImportOptions { axes: axes.to_vec(), ..Default::default() })?;
        let Extent { frames, height, width, spp } = layout.extent;
        let shape = vec![frames, height, width, spp, layout.dims];
        let place = |axis: &Axis| axes.iter().position(|found| found == axis);
        let order: Vec<usize> = Axis::ALL.iter().filter_map(place).collect();
        if self.fortran || !order.is_sorted() {
            let values = std::mem::take(&mut self.values);
            let array = ArrayD::from_shape_vec(IxDyn(&self.shape).set_f(self.fortran), values);
            let array = array.map_err(io::Error::other)?.permuted_axes(order);
            self.values = reserved(array.len())?;
            self.values.extend(array.iter());
        }
        Ok(Self { shape, fortran: false, ..self })
    }

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
    let mut source = match (raw::by_options(options), picture(&mut file, bytes)?) {
        (Some(described), _) => raw::read(file, bytes, described)?,
        (None, Some(picture)) => picture,
        (None, None) => match header::read(&mut file, bytes) {
            Err(Fault::Format(FormatError::NotNpy { .. })) => {
                file.seek(SeekFrom::Start(0))?;
                written::read(path, file, options)?
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
        return super::png::read(BufReader::new(file), bytes).map(Some);
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
    Ok(Source { fortran: header.fortran, dtype: Some(dtype), ..Source::of(values, shape, header.descr) })
}

/// So many numbers of a type.
pub(super) fn numbers(mut file: File, count: usize, dtype: Dtype) -> io::Result<Vec<f64>> {
    let mut values = reserved(count)?;
    let mut block = vec![0; 1 << 16];
    while values.len() < count {
        let bytes = block.len().min(dtype.size * (count - values.len()));
        file.read_exact(&mut block[..bytes])?;
        values.extend(block[..bytes].chunks_exact(dtype.size).map(|bytes| dtype.decode(bytes)));
    }
    Ok(values)
}
