//! What the rest of a run depends on, as a file.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::course::{Course, MOST_COUNTED};
use super::frame::displaced;
use super::record::Past;
use crate::config::{Config, Work};
use crate::error::CheckpointError;
use crate::files::{WholeFile, hexadecimal, little_endian};
use crate::objective::Objective;
use crate::slices::Walker;
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// Kind and version of the file; the number grows with everything that alters what a run does next.
const START: &str = "fsot checkpoint 1\n";
/// Longer configurations (those that hold large pictures) are only known by their hash.
const MOST_CONFIGURATION: usize = 1 << 25;
/// A header is some hundred bytes.
const MOST_HEADER: u64 = 1 << 16;
/// Bytes of the hash at the end.
const HASH: usize = 32;

/// A run, or an optimiser between runs, at one moment: coordinates, moments, counters, and where in its
/// schedules it is.
///
/// [`StepReport::checkpoint`](super::StepReport::checkpoint) takes one in the middle of a run,
/// [`Optimizer::checkpoint`](crate::Optimizer::checkpoint) between runs and steps;
/// [`Optimizer::resume`](crate::Optimizer::resume) continues it, with the same bits as if nothing had
/// happened, at any thread count.
///
/// # The file
///
/// The line `fsot checkpoint 1`; the length of the header as a little-endian `u64`; the header, which is
/// JSON; the coordinates and the moments of the descent as little-endian `f32`; the SHA-256 of all that. It
/// takes 4 bytes a coordinate, 8 with SGD, 12 with Adam.
///
/// ```
/// use fsot::optimizer::Checkpoint;
/// use fsot::{Config, Extent, Optimizer};
///
/// // Between steps that follow a schedule of one's own.
/// let config = Config::new(Extent::still(16, 16), 2);
/// let mut optimizer = Optimizer::new(config.clone())?;
/// optimizer.step(1.0, 1.0)?;
/// let checkpoint = optimizer.checkpoint();
/// optimizer.step(0.9, 1.0)?;
///
/// let mut again = Optimizer::new(config)?;
/// again.resume(checkpoint)?;
/// again.step(0.9, 1.0)?;
/// assert_eq!(again.points(), optimizer.points());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Checkpoint {
    pub(super) header: Header,
    /// As JSON; empty if it is too long.
    configuration: Arc<[u8]>,
    /// Of all frames, or of the one that an animation begins with.
    pub(super) points: Vec<f32>,
    pub(super) moments: [Vec<f32>; 2],
}

/// All but the long lists.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    crate_version: String,
    extent: Extent,
    dims: usize,
    /// Of what is optimised.
    pub hash: String,
    /// Bytes of the configuration.
    configuration: usize,
    /// Lengths of the lists.
    lengths: [usize; 3],
    pub place: Counters,
    pub course: Option<Course>,
}

/// What an optimiser counts.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Counters {
    /// Steps of slices, which name their random numbers.
    pub steps: u64,
    /// Sweeps that were begun.
    pub swept: u64,
    pub fresh: bool,
    /// Steps that made the moments.
    pub descended: i32,
    /// What moved the points; it is about metadata alone.
    #[serde(default)]
    pub past: Past,
}

/// Where an optimiser is, but for its coordinates.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub counters: Counters,
    pub walker: &'a Walker,
}

/// What is optimised.
#[derive(Debug)]
pub(super) struct Identity {
    pub hash: String,
    /// As JSON; empty if it is too long.
    configuration: Arc<[u8]>,
}

impl Identity {
    pub(super) fn new(config: &Config, objective: &Objective) -> Self {
        let mut text = Text::default();
        serde_json::to_writer(&mut text, config).expect("a configuration is plain data");
        let Text { mut hash, start, length } = text;
        hash.update(objective.demanded());
        let whole = if length <= MOST_CONFIGURATION { start } else { Vec::new() };
        Self { hash: hexadecimal(&hash.finalize()), configuration: whole.into() }
    }
}

/// A text that is hashed, and kept if it is short.
#[derive(Default)]
struct Text {
    hash: Sha256,
    start: Vec<u8>,
    length: usize,
}

impl Write for Text {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.hash.update(bytes);
        self.length += bytes.len();
        if self.length <= MOST_CONFIGURATION {
            self.start.extend_from_slice(bytes);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Checkpoint {
    pub(super) fn new(
        config: &Config,
        identity: &Identity,
        course: Option<Course>,
        Place { counters, walker }: Place,
        points: Vec<f32>,
    ) -> Self {
        // The frame that an animation begins with is swept: nothing has descended yet.
        let is_whole = points.len() == config.extent.samples() * config.dims;
        let moments = walker.moments().map(|moments| if is_whole { moments.to_vec() } else { Vec::new() });
        let header = Header {
            crate_version: env!("CARGO_PKG_VERSION").into(),
            extent: config.extent,
            dims: config.dims,
            hash: identity.hash.clone(),
            configuration: identity.configuration.len(),
            lengths: [points.len(), moments[0].len(), moments[1].len()],
            place: counters,
            course,
        };
        Self { header, configuration: Arc::clone(&identity.configuration), points, moments }
    }

    /// What its run optimises. The demand of [`Optimizer::for_demand`](crate::Optimizer::for_demand) is not a
    /// part of it.
    ///
    /// # Errors
    /// [`CheckpointError::NoConfig`] where it is longer than a MiB of JSON, as with pictures and long lists
    /// of labels, or names code.
    pub fn config(&self) -> Result<Config, CheckpointError> {
        let no_config = |reason: String| CheckpointError::NoConfig { reason };
        if self.configuration.is_empty() {
            return Err(no_config(format!("it is longer than {MOST_CONFIGURATION} bytes")));
        }
        serde_json::from_slice(&self.configuration).map_err(|error| no_config(error.to_string()))
    }

    /// The table as it was then; a copy.
    pub fn table(&self) -> SampleTable {
        let Header { extent, dims, .. } = self.header;
        let is_whole = self.points.len() == extent.samples() * dims;
        let points = if is_whole { self.points.clone() } else { displaced(extent, &self.points) };
        SampleTable::trusted(extent, dims, points)
    }

    /// Version of this crate that took it. Another one reads it as long as the first line of the file is the
    /// same, but may round otherwise.
    pub fn crate_version(&self) -> &str {
        &self.header.crate_version
    }

    /// The work of the run that goes on, and the steps that were taken of it; `None` between runs.
    pub fn progress(&self) -> Option<(Work, u64)> {
        self.header.course.as_ref().map(|course| (course.work, course.step))
    }

    /// Writes the file, without buffering.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        let mut out = Hashed { inner: &mut *writer, hash: Sha256::new() };
        let header = serde_json::to_vec(&self.header)?;
        out.write_all(START.as_bytes())?;
        out.write_all(&(header.len() as u64).to_le_bytes())?;
        out.write_all(&header)?;
        out.write_all(&self.configuration)?;
        for list in [&self.points, &self.moments[0], &self.moments[1]] {
            little_endian(list, |bytes| out.write_all(bytes))?;
        }
        let hash = out.hash.finalize();
        writer.write_all(&hash)
    }

    /// Reads what [`write`](Self::write) has written.
    ///
    /// # Errors
    /// Those of the reader; another kind or version of file ([`CheckpointError::Foreign`]); a file that was
    /// cut short or changed ([`CheckpointError::Damaged`]).
    pub fn read(reader: &mut impl Read) -> Result<Self, CheckpointError> {
        let mut from = Hashed { inner: reader, hash: Sha256::new() };
        let start = from.take_up_to(START.len() as u64)?;
        if start != START.as_bytes() {
            return Err(CheckpointError::Foreign { start, expected: START.trim_end() });
        }
        let length = from.take_exactly(size_of::<u64>() as u64)?;
        let length = u64::from_le_bytes(length.try_into().expect("eight bytes"));
        if length > MOST_HEADER {
            return Err(damaged("its header is too long"));
        }
        let header = from.take_exactly(length)?;
        let header: Header = serde_json::from_slice(&header).map_err(|error| damaged(error.to_string()))?;
        let coordinates = header.check()?;
        let configuration = from.take_exactly(header.configuration as u64)?.into();
        let mut lists = [const { Vec::new() }; 3];
        for (list, &length) in lists.iter_mut().zip(&header.lengths) {
            if length != 0 && length != coordinates {
                return Err(damaged(format!("{length} numbers for {coordinates} coordinates")));
            }
            let bytes = from.take_exactly((length * size_of::<f32>()) as u64)?;
            let (numbers, _) = bytes.as_chunks();
            *list = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        }
        let expected = from.hash.finalize_reset();
        if from.take_exactly(HASH as u64)? != expected.as_slice() {
            return Err(damaged("its hash is of something else"));
        }
        let [points, first, second] = lists;
        if let Some(value) = points.iter().find(|value| !(0.0..1.0).contains(*value)) {
            return Err(damaged(format!("a coordinate is {value}")));
        }
        Ok(Self { header, configuration, points, moments: [first, second] })
    }

    /// Writes the file, which appears whole or not at all.
    ///
    /// # Errors
    /// [`CheckpointError::File`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), CheckpointError> {
        let path = path.as_ref();
        let written = WholeFile::write(path, |out| self.write(out)).and_then(WholeFile::commit);
        written.map_err(|error| of_file("write", path, error.into()))
    }

    /// Reads what [`save`](Self::save) has written.
    ///
    /// # Errors
    /// [`CheckpointError::File`], with what [`read`](Self::read) refuses.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, CheckpointError> {
        let path = path.as_ref();
        let file = || {
            // Before opening, because opening a pipe waits for its writer.
            if !std::fs::metadata(path)?.is_file() {
                return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no ordinary file"));
            }
            File::open(path)
        };
        let read =
            file().map_err(CheckpointError::from).and_then(|file| Self::read(&mut BufReader::new(file)));
        read.map_err(|problem| of_file("read", path, problem))
    }
}

fn of_file(verb: &'static str, path: &Path, problem: CheckpointError) -> CheckpointError {
    CheckpointError::File { verb, path: path.to_path_buf(), problem: problem.into() }
}

pub(super) fn damaged(reason: impl Into<String>) -> CheckpointError {
    CheckpointError::Damaged { reason: reason.into() }
}

impl Header {
    /// Coordinates that are held, if they are those of a table or of one of its frames.
    fn check(&self) -> Result<usize, CheckpointError> {
        let Self { extent, dims, lengths: [held, ..], .. } = *self;
        extent.validate(dims).map_err(|error| damaged(error.to_string()))?;
        let all = extent.samples() * dims;
        if held != all && held != all / extent.frames {
            return Err(damaged(format!("{held} coordinates for a table of {all}")));
        }
        let Counters { steps, swept, descended, .. } = self.place;
        let is_counted = steps.max(swept) <= MOST_COUNTED && descended >= 0;
        if !is_counted || !self.course.as_ref().is_none_or(Course::is_possible) {
            return Err(damaged("its counters are those of no run"));
        }
        Ok(held)
    }
}

/// What is read or written is hashed.
struct Hashed<T> {
    inner: T,
    hash: Sha256,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<R: Read> Hashed<R> {
    /// So many bytes, or what there is: a length that is not true takes no memory.
    fn take_up_to(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.inner.by_ref().take(length).read_to_end(&mut bytes)?;
        self.hash.update(&bytes);
        Ok(bytes)
    }

    fn take_exactly(&mut self, length: u64) -> Result<Vec<u8>, CheckpointError> {
        let bytes = self.take_up_to(length)?;
        if bytes.len() as u64 == length { Ok(bytes) } else { Err(damaged("it ends too soon")) }
    }
}
