//! What a table file does not say itself: how it was made and how good it is, in a `.json` beside it.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::bytes::hexadecimal;
use super::header::shortened;
use crate::error::{FormatError, TableError};
use crate::kernel::Tap;
use crate::table::SampleTable;
use crate::table::extent::Extent;

/// Kind and version of the file; the number grows when an old reader would misunderstand a new file.
const FORMAT: &str = "fsot sample table 1";
pub(super) const AXES: [&str; 5] = ["frame", "y", "x", "sample", "dim"];
const DTYPE: &str = "<f4";
const ORDER: &str = "C";
const RANGE: &str = "[0, 1)";

/// Provenance of a table: everything needed to make it again, and what came of it.
///
/// [`Metadata::new`] fills in what follows from the table; the rest is the caller's. Fields that are not
/// known are [`notes`](Metadata::notes), which may be added to the file by hand.
///
/// JSON has no NaN and no infinities: where an `f64` of this structure is not finite, the file says `"NaN"`,
/// `"inf"` or `"-inf"`. Seeds are plain JSON integers of up to 64 bits; readers that keep all numbers as
/// `f64` (JavaScript) round those above 2^53.
///
/// ```
/// use fsot::files::Metadata;
/// use fsot::{Config, Extent, Optimizer, SampleTable, Until};
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2).with_seed(7))?;
/// let report = optimizer.run(Until::Sweeps(4))?;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("table.npy");
/// optimizer.table().save_with(&path, &optimizer.metadata(&report))?;
///
/// let Metadata { seed, configuration, run, .. } = Metadata::load(&path)?;
/// assert_eq!((seed, run.sweeps), (7, 4));
/// let config: Config = serde_json::from_value(configuration)?;
/// assert_eq!(&config, optimizer.config());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// Kind and version of the file: `fsot sample table 1`.
    pub format: String,
    /// Version of this crate that made the table.
    pub crate_version: String,
    /// Names of the axes, slowest first: `frame`, `y`, `x`, `sample`, `dim`.
    pub axes: [String; 5],
    /// Lengths of the axes.
    pub shape: [usize; 5],
    /// Type of the values, as numpy names it: `<f4`, little-endian `f32`.
    pub dtype: String,
    /// Memory order: `C`, the last axis varies fastest.
    pub order: String,
    /// Range of the values: `[0, 1)`.
    pub range: String,
    /// SHA-256 of the values that this is the metadata of, as they lie in the `.npy` behind its header
    /// (little-endian, C order), in hexadecimal digits. [`SampleTable::save_with`] fills it in. `None` if it
    /// is not known, as in files of before 2026-11-27.
    ///
    /// A checksum against mix-ups, no signature: whoever writes other values may write another hash.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The whole configuration of the optimiser.
    pub configuration: serde_json::Value,
    /// Weights of the pixel and frame filters, one entry per term of the objective that has a kernel of at
    /// most 128 taps; longer ones follow from the configuration.
    pub kernels: Vec<KernelTaps>,
    /// The error bound before and after, if it was measured.
    pub bound: Option<BoundRecord>,
    /// How much work was done.
    pub run: RunRecord,
    /// Whatever else is said, under other names than these.
    #[serde(flatten)]
    pub notes: serde_json::Map<String, serde_json::Value>,
}

/// The weights of a term's kernel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KernelTaps {
    /// Position of the term in the objective.
    pub term: usize,
    /// Its weights; offsets that are not listed weigh nothing.
    pub taps: Vec<Tap>,
}

/// The error bound of the table before and after its optimisation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundRecord {
    /// Of the table that the optimisation started from.
    pub before: BoundEstimate,
    /// Of the table that was saved.
    pub after: BoundEstimate,
}

/// A Monte Carlo estimate of the error bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundEstimate {
    /// Mean 1-Wasserstein distance along a slice per sample that a slice touches, in units of the unit cube:
    /// the level-set objective `E[(n / N) W1]` divided by `E[n / N]`.
    #[serde(with = "number")]
    pub value: f64,
    /// Standard error of `value`.
    #[serde(with = "number")]
    pub standard_error: f64,
    /// The bound, divided by that of white noise of the same shape.
    #[serde(with = "number")]
    pub ratio_to_white_noise: f64,
    /// Standard error of `ratio_to_white_noise`.
    #[serde(with = "number")]
    pub ratio_standard_error: f64,
}

/// How much work made a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Sweeps of the frame that an animation began with.
    #[serde(default)]
    pub frame_sweeps: u64,
    /// Slices per pixel and frame that the run was planned for; with `steps` the length of its schedules.
    pub slices_per_class: u64,
    /// Sweeps that the run was planned for.
    #[serde(default)]
    pub sweeps: u64,
    /// Whether the run was broken off or converged before all of them were drawn.
    #[serde(default)]
    pub ended_early: bool,
    /// Steps of the descent.
    pub steps: u64,
    /// Wall-clock time in seconds.
    #[serde(with = "number")]
    pub seconds: f64,
    /// Number of the next step of slices, which names its random numbers: `from_table_with` goes on there.
    /// `None` in files of before 2026-11-27.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_step: Option<u64>,
    /// Number of the next sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_sweep: Option<u64>,
    /// What the run began with. `None` in files of before 2026-11-28; see [`beginning`](Self::beginning).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<RunStart>,
}

/// What a run began with: whether its configuration and its work say all that it takes to make it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RunStart {
    /// With the white noise of its seed, for the whole table: a run of the same work makes it again.
    WhiteNoise,
    /// With points from elsewhere, or that other steps or runs had moved before or have moved since: metadata
    /// do not hold them.
    Elsewhere,
    /// With a demand, which metadata do not hold either.
    Demand,
}

impl RunRecord {
    /// What the run began with, as far as is known: white noise, unless it says otherwise or its steps and
    /// sweeps are numbered otherwise than from the first on.
    ///
    /// ```
    /// use fsot::files::RunStart;
    /// use fsot::{Config, Extent, Optimizer, Until};
    ///
    /// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
    /// let first = optimizer.run(Until::Sweeps(2))?;
    /// assert_eq!(optimizer.metadata(&first).run.beginning(), RunStart::WhiteNoise);
    /// let second = optimizer.run(Until::Sweeps(2))?;
    /// assert_eq!(optimizer.metadata(&second).run.beginning(), RunStart::Elsewhere);
    /// # Ok::<(), fsot::ConfigError>(())
    /// ```
    pub fn beginning(&self) -> RunStart {
        let Self { steps, sweeps, next_step, next_sweep, start, .. } = *self;
        let is_later = next_step.is_some_and(|next| next > steps);
        let is_later = is_later || next_sweep.is_some_and(|next| next > sweeps);
        match start.unwrap_or(RunStart::WhiteNoise) {
            RunStart::WhiteNoise if is_later => RunStart::Elsewhere,
            start => start,
        }
    }
}

impl Metadata {
    /// Metadata of a table of this extent and so many dimensions, without kernels, bound and run record:
    /// assign those that are known. [`Optimizer::metadata`](crate::Optimizer::metadata) knows most of them.
    pub fn new(extent: Extent, dims: usize, seed: u64, configuration: serde_json::Value) -> Self {
        let Extent { frames, height, width, spp } = extent;
        Self {
            format: FORMAT.into(),
            crate_version: env!("CARGO_PKG_VERSION").into(),
            axes: AXES.map(String::from),
            shape: [frames, height, width, spp, dims],
            dtype: DTYPE.into(),
            order: ORDER.into(),
            range: RANGE.into(),
            sha256: None,
            seed,
            configuration,
            kernels: Vec::new(),
            bound: None,
            run: RunRecord::default(),
            notes: serde_json::Map::new(),
        }
    }

    /// Where the metadata of a table lies: the same path with the extension `.json`.
    pub fn path_beside(table_path: &Path) -> PathBuf {
        table_path.with_extension("json")
    }

    /// Reads the metadata beside a table. The table itself is not read: [`check`](Self::check) says whether
    /// they belong together, and [`SampleTable::load_with`] reads both and checks.
    ///
    /// # Errors
    /// The path of a table that cannot have metadata beside it ([`TableError::FileName`]), a file that cannot
    /// be read ([`TableError::Io`]), damaged JSON with line and column or a format that this version does not
    /// know ([`TableError::Format`]).
    pub fn load(table_path: impl AsRef<Path>) -> Result<Self, TableError> {
        let table_path = table_path.as_ref();
        check_name(table_path)?;
        let path = Self::path_beside(table_path);
        let format = |problem| TableError::Format { path: path.clone(), problem };
        let io = |source| TableError::Io { verb: "read", path: path.clone(), source };
        // Before opening, because opening a pipe waits for its writer.
        if !fs::metadata(&path).map_err(io)?.is_file() {
            return Err(format(FormatError::NotAFile));
        }
        let bytes = fs::read(&path).map_err(io)?;
        let metadata: Self = serde_json::from_slice(&bytes).map_err(|error| {
            let reason = error.to_string();
            format(FormatError::Json { line: error.line(), column: error.column(), reason })
        })?;
        metadata.check_format().map_err(format)?;
        Ok(metadata)
    }

    /// Checks the fields that say how to read the table.
    pub(crate) fn check_format(&self) -> Result<(), FormatError> {
        let scalars = [
            ("format", &self.format, FORMAT),
            ("dtype", &self.dtype, DTYPE),
            ("order", &self.order, ORDER),
            ("range", &self.range, RANGE),
        ];
        let axes = self.axes.iter().zip(AXES).map(|(given, expected)| ("axes", given, expected));
        for (field, given, expected) in scalars.into_iter().chain(axes) {
            if given != expected {
                return Err(FormatError::Field { field, given: given.clone(), expected: expected.into() });
            }
        }
        Ok(())
    }

    /// Checks that this is the metadata of this table: that it says the same shape, and the hash of these
    /// values if it says one.
    ///
    /// # Errors
    /// [`FormatError::OtherTable`] or [`FormatError::OtherValues`].
    ///
    /// ```
    /// use fsot::files::{FormatError, Metadata};
    /// use fsot::{Extent, SampleTable};
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("table.npy");
    /// let extent = Extent::still(8, 8);
    /// let [first, second] = [1, 2].map(|seed| SampleTable::white_noise(extent, 2, seed).unwrap());
    /// first.save_with(&path, &Metadata::new(extent, 2, 1, "white noise".into()))?;
    /// // The metadata of the first table stay where they are.
    /// second.save(&path)?;
    /// let metadata = Metadata::load(&path)?;
    /// assert_eq!(metadata.check(&first), Ok(()));
    /// assert!(matches!(metadata.check(&second), Err(FormatError::OtherValues { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check(&self, table: &SampleTable) -> Result<(), FormatError> {
        self.check_shape(table.shape())?;
        let Some(known) = &self.sha256 else { return Ok(()) };
        let found = sha256(table.values());
        if known.eq_ignore_ascii_case(&found) {
            return Ok(());
        }
        Err(FormatError::OtherValues { metadata: shortened(known.clone()), table: found })
    }

    /// Checks that this is the metadata of a table of this shape.
    pub(crate) fn check_shape(&self, table: [usize; 5]) -> Result<(), FormatError> {
        let metadata = self.shape;
        if metadata == table { Ok(()) } else { Err(FormatError::OtherTable { metadata, table }) }
    }
}

/// The hash of values as they lie in a file.
pub(super) fn sha256(values: &[f32]) -> String {
    let mut hash = Hash::default();
    values.iter().for_each(|&value| hash.add(value));
    hash.digits()
}

/// The hash of values that come one by one.
pub(super) struct Hash {
    hash: Sha256,
    block: [u8; 1 << 12],
    filled: usize,
}

impl Default for Hash {
    fn default() -> Self {
        Self { hash: Sha256::new(), block: [0; 1 << 12], filled: 0 }
    }
}

impl Hash {
    /// Adds the next value.
    pub(super) fn add(&mut self, value: f32) {
        self.block[self.filled..self.filled + size_of::<f32>()].copy_from_slice(&value.to_le_bytes());
        self.filled += size_of::<f32>();
        if self.filled == self.block.len() {
            self.hash.update(self.block);
            self.filled = 0;
        }
    }

    /// In hexadecimal digits.
    pub(super) fn digits(mut self) -> String {
        self.hash.update(&self.block[..self.filled]);
        hexadecimal(&self.hash.finalize())
    }
}

/// Refuses paths beside which no metadata can lie: without a file name, or with the extension of metadata.
pub(crate) fn check_name(table_path: &Path) -> Result<(), TableError> {
    // In any case, because some file systems do not tell `.JSON` from `.json`.
    let json = table_path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    if json || table_path.file_name().is_none() {
        return Err(TableError::FileName { path: table_path.to_path_buf() });
    }
    Ok(())
}

/// `f64` as a JSON number, or as `"NaN"`, `"inf"`, `"-inf"`: a standard error that could not be estimated
/// must neither stop a table from being saved nor turn into something else.
mod number {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Number {
        Finite(f64),
        Other(String),
    }

    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() { serializer.serialize_f64(*value) } else { serializer.collect_str(value) }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        match Number::deserialize(deserializer)? {
            Number::Finite(value) => Ok(value),
            Number::Other(text) if ["NaN", "inf", "-inf"].contains(&text.as_str()) => {
                text.parse().map_err(D::Error::custom)
            }
            Number::Other(text) => Err(D::Error::custom(format!(
                "\"{text}\" where a number, \"NaN\", \"inf\" or \"-inf\" should stand"
            ))),
        }
    }
}
