//! Tables in the formats of engines.
//!
//! [`parts`] says which part of a table is in which file, [`encode`] what number a value becomes; a format
//! is a rule ([`options`]) and a function that writes one file.

mod diffuse;
mod encode;
#[cfg(feature = "image")]
mod exr;
pub(in crate::files) mod fast;
mod ktx2;
mod lines;
mod options;
mod parts;
#[cfg(feature = "image")]
mod png;
pub(in crate::files) mod raw;
mod record;
pub(in crate::files) mod source;
mod watch;

use std::fmt;
use std::io::{self, Seek, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};

use self::encode::Encoded;
pub use self::options::{Depth, ExportOptions, Format, Rounding};
use self::parts::Part;
pub use self::record::{ExportRecord, RecordedFile};
use self::watch::{Watch, Watched};
use super::metadata::Hash;
use super::whole::{self, WholeFile};
use crate::error::ExportError;
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// Files that were written, and what they hold.
///
/// As text it is one sentence.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Exported {
    /// The files, without the record.
    #[serde(serialize_with = "texts")]
    pub files: Vec<PathBuf>,
    /// The record beside them.
    #[serde(serialize_with = "text")]
    pub record_path: PathBuf,
    /// What the record says.
    pub record: ExportRecord,
}

/// Paths that are no UTF-8 are shown as well as can be.
fn text<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

fn texts<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(|path| path.display().to_string()))
}

impl ExportOptions {
    /// The files that an export to this path writes, the record last. Nothing is written.
    ///
    /// # Errors
    /// Those of [`SampleTable::export`], but the system's.
    pub fn files(
        &self,
        path: impl AsRef<Path>,
        extent: Extent,
        dims: usize,
    ) -> Result<Vec<PathBuf>, ExportError> {
        let path = path.as_ref();
        let mut files: Vec<PathBuf> =
            self.plan(path, extent, dims)?.into_iter().map(|(path, _)| path).collect();
        files.extend(self.text_path(&files[0]));
        files.push(ExportRecord::path_beside(path));
        Ok(files)
    }

    /// The text file beside a format that says nothing itself.
    fn text_path(&self, path: &Path) -> Option<PathBuf> {
        (self.format == Format::Raw).then(|| raw::text_path(path))
    }

    fn plan(&self, path: &Path, extent: Extent, dims: usize) -> Result<Vec<(PathBuf, Part)>, ExportError> {
        let (depth, depths) = (self.depth(), self.format.rule().depths);
        if !depths.contains(&depth) {
            let holds = depths.iter().map(|depth| depth.name()).collect::<Vec<_>>().join(" or ");
            return Err(ExportError::Depth { format: self.format.name(), given: depth.name(), holds });
        }
        parts::files(path, self, extent, dims)
    }
}

impl SampleTable {
    /// Writes the table in a format of somebody else's, and how to read it in a `.json` beside it
    /// ([`ExportRecord::path_beside`]). [`import`](Self::import) reads it back.
    ///
    /// What a file cannot hold goes to several: one for each sample of a pixel, and for each four
    /// consecutive dimensions (see [`ExportOptions::name`]). All of them are complete before the first
    /// takes its name; if one can't, those before it are as they were. Takes less memory than the table
    /// beside it.
    ///
    /// # Errors
    /// What the format cannot hold, names that are none, and whatever stands against writing.
    ///
    /// ```
    /// use fsot::files::{ExportOptions, Format};
    /// use fsot::{Extent, SampleTable};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("mask.ktx2");
    /// let table = SampleTable::white_noise(Extent::animation(4, 16, 16), 2, 0)?;
    /// let exported = table.export(&path, &ExportOptions::new(Format::Ktx2))?;
    /// assert_eq!(exported.files, [path]);
    /// println!("{exported}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn export(&self, path: impl AsRef<Path>, options: &ExportOptions) -> Result<Exported, ExportError> {
        self.export_observed(path, options, |_| ControlFlow::Continue(()))
    }

    /// The same, telling the share of the files that are complete, before each file and some ten times per
    /// megabyte. Once all are complete they take their names, and nothing breaks that off.
    ///
    /// # Errors
    /// As [`export`](Self::export); [`ExportError::Stopped`] if `observe` breaks off: then every file is as
    /// it was, and nothing is left beside them.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use fsot::files::{ExportError, ExportOptions, Format};
    /// use fsot::{Extent, SampleTable};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let table = SampleTable::white_noise(Extent::animation(4, 16, 16), 2, 0)?;
    /// let options = ExportOptions::new(Format::Slices);
    /// let stopped = table.export_observed(folder.path().join("mask.png"), &options, |share| {
    ///     if share < 0.5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    /// });
    /// assert!(matches!(stopped, Err(ExportError::Stopped)));
    /// assert_eq!(std::fs::read_dir(folder.path())?.count(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn export_observed(
        &self,
        path: impl AsRef<Path>,
        options: &ExportOptions,
        mut observe: impl FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Exported, ExportError> {
        let path = path.as_ref();
        let watch = Watch::new(&mut observe);
        let plan = options.plan(path, self.extent(), self.dims())?;
        let record_path = ExportRecord::path_beside(path);
        let cannot_write = |path: &Path, source| match watch.stopped() {
            true => ExportError::Stopped,
            false => ExportError::Io { path: path.into(), source },
        };
        let text_path = options.text_path(&plan[0].0);
        let paths = plan.iter().map(|(path, _)| path).chain(&text_path).chain([&record_path]);
        for path in paths {
            whole::check(path).map_err(|error| cannot_write(path, error))?;
        }
        let encoded = Encoded::new(self, options, &mut || watch.stops());
        let mut complete = Vec::with_capacity(plan.len() + 1);
        for (done, (path, part)) in plan.iter().enumerate() {
            watch.reach(done as f64 / plan.len() as f64);
            if watch.stops() {
                return Err(ExportError::Stopped);
            }
            let file = WholeFile::write(path, |out| {
                let mut out = Watched { out, watch: &watch, bytes: 0 };
                write(&mut out, path, options.format, &encoded, part)
            });
            complete.push(file.map_err(|error| cannot_write(path, error))?);
        }
        if let Some(text_path) = &text_path {
            let (path, part) = &plan[0];
            let text = raw::text(path, &encoded, part);
            let file = WholeFile::write(text_path, |out| out.write_all(text.as_bytes()));
            complete.push(file.map_err(|error| cannot_write(text_path, error))?);
        }
        let record = record(&encoded, options, &plan);
        let beside = WholeFile::write(&record_path, |out| {
            serde_json::to_writer_pretty(&mut *out, &record)?;
            out.write_all(b"\n")
        });
        complete.push(beside.map_err(|error| cannot_write(&record_path, error))?);
        watch.reach(1.0);
        if watch.stops() {
            return Err(ExportError::Stopped);
        }
        whole::commit_all(complete).map_err(|(path, error)| cannot_write(&path, error))?;
        let files = plan.into_iter().map(|(path, _)| path).chain(text_path).collect();
        Ok(Exported { files, record_path, record })
    }
}

/// Writes one file.
fn write(
    out: &mut (impl Write + Seek),
    path: &Path,
    format: Format,
    values: &Encoded,
    part: &Part,
) -> io::Result<()> {
    match format {
        #[cfg(feature = "image")]
        Format::Atlas | Format::Slices => png::write(out, values, part),
        #[cfg(feature = "image")]
        Format::Exr | Format::ExrLayers => exr::write(out, values, part),
        Format::Ktx2 => ktx2::write(out, values, part),
        Format::Raw => raw::write(out, values, part),
        Format::Fast => fast::write(out, values, part),
        Format::Pbrt => source::write_pbrt(out, path, values, part),
        Format::C => source::write_header(out, path, values, part),
        Format::Csv => lines::write(out, values, part, ",", true),
        Format::Dat => lines::write(out, values, part, " ", false),
    }
}

fn record(values: &Encoded, options: &ExportOptions, plan: &[(PathBuf, Part)]) -> ExportRecord {
    let Extent { frames, height, width, spp } = values.extent();
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let files = plan.iter().map(|(path, part)| {
        let [frames, samples, dims] =
            [&part.frames, &part.samples, &part.dims].map(|range| [range.start, range.end]);
        RecordedFile { name: name(path), frames, samples, dims }
    });
    let count = frames * height * width * spp * values.dims();
    let mut hash = Hash::default();
    (0..count).for_each(|at| hash.add(values.decoded(at)));
    ExportRecord {
        kind: ExportRecord::KIND.into(),
        crate_version: env!("CARGO_PKG_VERSION").into(),
        format: options.format,
        bits: values.depth,
        rounding: options.rounding,
        decode: values.depth.decode_rule().into(),
        shape: [frames, height, width, spp, values.dims()],
        sha256: hash.digits(),
        files: files.collect(),
    }
}

impl fmt::Display for Exported {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let Self { files, record, .. } = self;
        match files.as_slice() {
            [file] => write!(out, "{}", file.display())?,
            [first, second] => write!(out, "{} and {}", first.display(), second.display())?,
            [first, .., last] => {
                write!(out, "{} files, {} to {}", files.len(), first.display(), last.display())?
            }
            [] => write!(out, "no files")?,
        }
        let ExportRecord { format, bits, decode, shape, .. } = record;
        write!(out, ": {format} of [frame, y, x, sample, dim] = {shape:?}, ")?;
        match bits.levels() {
            Some(_) => write!(out, "{bits} bits, k stands for {decode}"),
            None => write!(out, "floats of {} bits", 8 * bits.bytes()),
        }
    }
}
