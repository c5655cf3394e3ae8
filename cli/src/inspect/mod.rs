//! `fsot inspect`: says what a sample table is worth, in figures.
//!
//! Prints shape, metadata, filtered error, bias, uniformity, low frequencies and the bound, as ratios to
//! white noise of the same shape. [`report`](crate::report) shows them on a page with pictures.

pub(crate) mod evenness;
pub(crate) mod figures;
mod words;

use std::path::{Path, PathBuf};

use clap::Args;
use fsot::config::DimensionGroup;
use fsot::files::{FormatError, Metadata, TableError};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Kernel, SampleTable};

use self::figures::GroupFigures;
pub(crate) use self::words::{filter, shape, temporal_flag};
use crate::console::Console;
use crate::{Ended, Failure, Shared, temporal};

/// Pairs of samples whose comparison takes some ten seconds.
const MOST_PAIRS: u64 = 10_000_000_000;

const EXAMPLES: &str = "\
Examples:
  fsot inspect table.npy
      all figures, under the filter exp(-r^2/2.1^2) and, where there are frames, the eye's at 60 Hz
  fsot inspect table.npy --sigma 1.5 --temporal ema:0.1
      under another filter
  fsot inspect table.npy --json | jq .bound.ratio_to_white_noise
      one figure for a script

fsot report draws a page of a table, or of several. A signal ends it at once.
Exit codes: 0 done, 1 refused or failed, 2 bad command line.";

/// Measures a sample table against white noise of the same shape.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// The table: a .npy file with axes [frame, y, x, sample, dim].
    path: PathBuf,
    /// Test integrands per family. 256 leave a standard error of about 2 % in the mean.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: u32,
    /// Slices per term of the bound, fewer for large subsets. The default leaves a standard error of about
    /// half a percent.
    #[arg(long, default_value_t = 16_384, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    bound_slices: u32,
    #[command(flatten)]
    yardstick: Yardstick,
    #[command(flatten)]
    shared: Shared,
}

/// Under what tables are measured.
#[derive(Args, Clone, Debug)]
pub struct Yardstick {
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current
    /// frame first [default: perceptual:60; none for a single frame].
    #[arg(long, value_parser = temporal::parse)]
    pub temporal: Option<TemporalKernel>,
    /// Width of the spatial Gaussian exp(-r²/sigma²), in pixels.
    #[arg(long, default_value_t = 2.1)]
    pub sigma: f64,
    /// Names the integrands, the slices of the bound and white noise.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// A filter of any other kind, instead of both.
    #[arg(skip)]
    pub kernel: Option<Kernel>,
}

/// As on a command line without flags.
impl Default for Yardstick {
    fn default() -> Self {
        Self { temporal: None, sigma: 2.1, seed: 0, kernel: None }
    }
}

impl Yardstick {
    /// The filter of a table of so many frames.
    pub fn kernel(&self, frames: usize) -> Kernel {
        if let Some(kernel) = &self.kernel {
            return kernel.clone();
        }
        let temporal = temporal::or_default(self.temporal.as_ref(), frames);
        Kernel::product(SpatialKernel::Gaussian { sigma_px: self.sigma }, temporal)
    }
}

/// A table and how it is looked at.
pub(crate) struct Inspection {
    /// Of the file, without its folder.
    pub name: String,
    pub table: SampleTable,
    pub kernel: Kernel,
    pub seed: u64,
    pub effort: Effort,
}

/// How much is spent on the figures.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Test integrands per family.
    pub integrands: usize,
    /// The same for biases, which take all samples whatever else does.
    pub of_bias: usize,
    /// The same for spectra, whose speckle goes away by slabs, not by integrands.
    pub of_spectra: usize,
    /// Frames whose filtered errors are averaged; all if `None`.
    pub frames: Option<usize>,
    /// Frames of the spectrum in x and y, and rows of that in x and t.
    pub slabs: [usize; 2],
    /// Pairs of samples that a discrepancy may compare.
    pub most_pairs: u64,
    /// Slices per term of the bound.
    pub bound_slices: usize,
    /// Whether terms that balance whole frames and the whole table count in the bound. Of many samples they
    /// take nearly all of the time, and nearly no part of the sum.
    pub balance: bool,
}

/// What lies beside the table.
pub(crate) enum Beside {
    Nothing,
    Unusable(TableError),
    /// Metadata of another table.
    Foreign(FormatError),
    /// Metadata of this table, or which do not say of which values they are.
    Own(Box<Metadata>),
}

impl Beside {
    /// What is known of a table that has no file.
    pub fn given(metadata: Option<Metadata>, table: &SampleTable) -> Self {
        match metadata {
            None => Self::Nothing,
            Some(metadata) => Self::of(metadata, table),
        }
    }

    fn of(metadata: Metadata, table: &SampleTable) -> Self {
        match metadata.check(table) {
            Err(problem) => Self::Foreign(problem),
            Ok(()) => Self::Own(metadata.into()),
        }
    }

    pub fn find(path: &Path, table: &SampleTable) -> Self {
        if !Metadata::path_beside(path).exists() {
            return Self::Nothing;
        }
        match Metadata::load(path) {
            Err(error) => Self::Unusable(error),
            Ok(metadata) => Self::of(metadata, table),
        }
    }
}

impl Inspection {
    /// All of a table, with so many integrands per family and slices per term of the bound.
    fn whole(
        name: String,
        table: SampleTable,
        yardstick: &Yardstick,
        [integrands, bound_slices]: [usize; 2],
    ) -> Self {
        let effort = Effort {
            integrands,
            of_bias: integrands,
            of_spectra: integrands,
            frames: None,
            slabs: [usize::MAX; 2],
            most_pairs: MOST_PAIRS,
            bound_slices,
            balance: true,
        };
        Self { name, kernel: yardstick.kernel(table.extent().frames), table, seed: yardstick.seed, effort }
    }

    /// Width of the spatial Gaussian.
    pub fn sigma(&self) -> f64 {
        match self.kernel.spatial {
            SpatialKernel::Gaussian { sigma_px } => sigma_px,
            _ => f64::NAN,
        }
    }
}

/// Inspects the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { path, integrands, bound_slices, yardstick, shared } = arguments;
    let table = SampleTable::load(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let efforts = [*integrands, *bound_slices].map(|count| count as usize);
    let inspection = Inspection::whole(name, table, yardstick, efforts);
    // A bad kernel is found out before anything is said.
    inspection.kernel.taps(&inspection.table.extent())?;
    shared.start_threads()?;

    let mut console = Console::new(shared);
    let metadata = Beside::find(path, &inspection.table);
    console.say(|out| words::header(out, &inspection));
    console.say(|out| words::metadata(out, &metadata));
    console.say(words::key);
    let dims = DimensionGroup::pairs_and_whole(inspection.table.dims());
    let mut groups = Vec::new();
    for group in &dims {
        let measured = GroupFigures::measure(&inspection, group.dims.clone())?;
        console.say(|out| words::group(out, &measured));
        groups.push(measured);
    }
    let bound = figures::bound(&inspection, &dims)?;
    console.say(|out| words::bound(out, &bound));
    console.figures(&figures::json(&inspection, &metadata, &groups, &bound));
    console.end(Ended::Done)
}

/// The figures that `fsot inspect --json` prints, of a table in memory. Prints nothing.
///
/// # Errors
/// Whatever stands against it, in one sentence.
///
/// ```
/// use fsot::{Extent, SampleTable};
/// use fsot_cli::inspect::{Yardstick, figures_of};
///
/// let table = SampleTable::white_noise(Extent::still(8, 8), 2, 0)?;
/// let figures = figures_of("noise".into(), table, None, &Yardstick::default(), 16, 64)?;
/// assert_eq!(figures["shape"], serde_json::json!([1, 8, 8, 1, 2]));
/// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
/// ```
pub fn figures_of(
    name: String,
    table: SampleTable,
    metadata: Option<Metadata>,
    yardstick: &Yardstick,
    integrands: usize,
    bound_slices: usize,
) -> Result<serde_json::Value, Failure> {
    let beside = Beside::given(metadata, &table);
    let inspection = Inspection::whole(name, table, yardstick, [integrands, bound_slices]);
    inspection.kernel.taps(&inspection.table.extent())?;
    let dims = DimensionGroup::pairs_and_whole(inspection.table.dims());
    let groups = dims.iter().map(|group| GroupFigures::measure(&inspection, group.dims.clone()));
    let groups = groups.collect::<Result<Vec<_>, Failure>>()?;
    let bound = figures::bound(&inspection, &dims)?;
    Ok(figures::json(&inspection, &beside, &groups, &bound))
}
