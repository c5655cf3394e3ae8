//! A table to and from `.npy`, numpy's format for one array[^npy]: little-endian `f32`, five axes
//! `[frame][y][x][sample][dim]`, C order.
//!
//! Headers are written as numpy writes them, and read in every dialect that numpy reads. A file is written
//! under a temporary name and renamed when it is complete, so a crash leaves the old table or the new one, at
//! worst with a forgotten `.fsot-*.tmp` beside it. Reading trusts nothing: what comes back without an error
//! is a valid table.
//!
//! [^npy]: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

use std::io::{self, Read, Write};
use std::path::Path;

use ndarray_npy::npy::header::{Header, Layout, WriteHeaderError};

use super::WholeFile;
use super::dtype::Dtype;
use super::header::{self, Fault};
use super::import;
use super::metadata::{self, Metadata};
use crate::error::{FormatError, TableError};
use crate::table::SampleTable;
use crate::table::extent::Extent;

impl SampleTable {
    /// Writes the table as `.npy`. An existing file is replaced when the new one is complete; a failure
    /// leaves it as it was. A symbolic link is followed. A `.json` that lies beside the file stays as it is,
    /// and [`load_with`](Self::load_with) will say that it belongs to other values.
    ///
    /// # Errors
    /// A path that cannot name a table ([`TableError::FileName`]) or cannot be written ([`TableError::Io`]).
    ///
    /// ```
    /// use fsot::{Extent, SampleTable};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("table.npy");
    /// let table = SampleTable::white_noise(Extent::still(8, 8), 2, 0)?;
    /// table.save(&path)?;
    /// assert_eq!(SampleTable::load(&path)?, table);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        self.pending(path).and_then(WholeFile::commit).map_err(|error| cannot_write(path, error))
    }

    /// Writes the table as `.npy` and its metadata as `.json` beside it ([`Metadata::path_beside`]). Both
    /// files are complete before either is renamed; the metadata is renamed first, the table last. A failure
    /// leaves both as they were. The metadata is written with the hash of these values
    /// ([`Metadata::sha256`]), so that a process killed between the two, or another one that writes at the
    /// same time, leaves a pair that [`load_with`](Self::load_with) refuses.
    ///
    /// # Errors
    /// As [`save`](Self::save), and metadata that belong to a table of another shape or could not be read
    /// back ([`TableError::Format`]).
    pub fn save_with(&self, path: impl AsRef<Path>, metadata: &Metadata) -> Result<(), TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        let beside = Metadata::path_beside(path);
        let cannot_write_beside = |error| cannot_write(&beside, error);
        metadata
            .check_format()
            .and_then(|()| metadata.check_shape(self.shape()))
            .map_err(|problem| TableError::Format { path: beside.clone(), problem })?;
        let metadata = Metadata { sha256: Some(metadata::sha256(self.values())), ..metadata.clone() };
        let json = WholeFile::write(&beside, |out| {
            serde_json::to_writer_pretty(&mut *out, &metadata)?;
            out.write_all(b"\n")
        })
        .map_err(cannot_write_beside)?;
        let table = self.pending(path).map_err(|error| cannot_write(path, error))?;
        let replaced = json.replace().map_err(cannot_write_beside)?;
        table.commit().map_err(|error| {
            replaced.undo();
            cannot_write(path, error)
        })
    }

    /// Reads a table from `.npy`. [`import`](Self::import) makes tables of other files.
    ///
    /// # Errors
    /// A path that cannot name a table ([`TableError::FileName`]), a file that cannot be read
    /// ([`TableError::Io`]), a file that is anything but an array of five axes, dtype `<f4`, C order, with as
    /// many values as its shape says, all in `[0, 1)` ([`TableError::Format`], which names the command that
    /// makes a table of it, if there is one; finding out takes reading files up to 256 MiB again).
    pub fn load(path: impl AsRef<Path>) -> Result<Self, TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        read(path).map_err(|fault| fault.of(path))
    }

    /// Reads a table and the metadata beside it, and checks that they belong together
    /// ([`Metadata::check`]).
    ///
    /// # Errors
    /// As [`load`](Self::load) and [`Metadata::load`], and metadata of a table of another shape
    /// ([`FormatError::OtherTable`]) or of other values ([`FormatError::OtherValues`]): then
    /// [`load`](Self::load) reads the table alone.
    pub fn load_with(path: impl AsRef<Path>) -> Result<(Self, Metadata), TableError> {
        let path = path.as_ref();
        let table = Self::load(path)?;
        let metadata = Metadata::load(path)?;
        metadata
            .check(&table)
            .map_err(|problem| TableError::Format { path: Metadata::path_beside(path), problem })?;
        Ok((table, metadata))
    }

    /// Finds out before the work whether a table and its metadata could be saved at `path`. Leaves nothing
    /// behind.
    ///
    /// # Errors
    /// As [`save_with`](Self::save_with).
    pub fn check_writable(path: impl AsRef<Path>) -> Result<(), TableError> {
        let path = path.as_ref();
        metadata::check_name(path)?;
        for file in [path, &Metadata::path_beside(path)] {
            WholeFile::write(file, |_| Ok(())).map_err(|error| cannot_write(file, error))?;
        }
        Ok(())
    }

    /// Writes header and values beside `path`.
    fn pending(&self, path: &Path) -> io::Result<WholeFile> {
        WholeFile::write(path, |out| {
            // The header is made here, and not by `WriteNpyExt`, because that writes the machine's byte
            // order.
            let type_descriptor = "'<f4'".parse().map_err(io::Error::other)?;
            let shape = self.shape().to_vec();
            let header = Header { type_descriptor, layout: Layout::Standard, shape };
            header.write(&mut *out).map_err(|error| match error {
                WriteHeaderError::Io(error) => error,
                other => io::Error::other(other),
            })?;
            self.values().iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
        })
    }
}

fn cannot_write(path: &Path, source: io::Error) -> TableError {
    TableError::Io { verb: "write", path: path.to_path_buf(), source }
}

/// What is strictly a table. Memory for values is asked for only after the file proved to hold them.
fn read(path: &Path) -> Result<SampleTable, Fault> {
    let (mut file, bytes) = header::open(path)?;
    let header = header::read(&mut file, bytes).map_err(|fault| match fault {
        Fault::Format(FormatError::NotNpy { start, .. }) => {
            FormatError::NotNpy { start, advice: import::advice(path) }.into()
        }
        other => other,
    })?;
    if header.dtype != Ok(Dtype::TABLE) {
        return Err(FormatError::Dtype { dtype: header.descr, advice: import::advice(path) }.into());
    }
    if header.fortran {
        return Err(FormatError::FortranOrder { shape: header.shape, advice: import::advice(path) }.into());
    }
    let Ok(shape) = <[usize; 5]>::try_from(header.shape.as_slice()) else {
        return Err(FormatError::Axes { shape: header.shape, advice: import::advice(path) }.into());
    };
    let [frames, height, width, spp, dims] = shape;
    let extent = Extent { frames, height, width, spp };
    extent.validate(dims).map_err(|problem| FormatError::Extent { shape, problem })?;
    let len = extent.samples() * dims;
    let (given, expected) = (bytes - header.bytes, len as u64 * size_of::<f32>() as u64);
    if given != expected {
        return Err(FormatError::Length { given, expected, shape: header.shape }.into());
    }
    // Read here, and not by `ReadableElement`, because that aborts where memory does not suffice.
    let mut values = Vec::new();
    values.try_reserve_exact(len).map_err(io::Error::from)?;
    let mut block = [0; 1 << 14];
    while values.len() < len {
        let bytes = block.len().min(size_of::<f32>() * (len - values.len()));
        file.read_exact(&mut block[..bytes])?;
        values.extend(block[..bytes].as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)));
    }
    SampleTable::new(extent, dims, values).map_err(|error| match error {
        TableError::Value { at, value } => {
            FormatError::Value { at, value, advice: import::advice(path) }.into()
        }
        other => io::Error::other(other).into(),
    })
}
