//! `fsot inspect`: says what a sample table is worth, in figures and on one page of pictures.
//!
//! Prints shape, metadata, filtered error, bias, uniformity, low frequencies and the bound, as ratios to
//! white noise of the same shape. The page shows a table and white noise side by side: the error of one
//! integrand, before and after the filter, its spectrum, and the samples themselves.

mod evenness;
mod figures;
mod integrand;
mod page;
mod panels;
mod report;

use std::path::{Path, PathBuf};

use clap::Args;
use fsot::config::DimensionGroup;
use fsot::files::{FormatError, Metadata, TableError};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Kernel, SampleTable};

use self::figures::GroupFigures;
pub(crate) use self::report::shape;
use crate::console::Console;
use crate::output::{self, Output};
use crate::{Ended, Failure, Shared, temporal};

const EXAMPLES: &str = "\
Examples:
  fsot inspect table.npy
      figures, and a page of pictures in table.inspect.png
  fsot inspect table.npy --sigma 1.5 --temporal ema:0.1 --out page.png
      under another filter than the default
  fsot inspect table.npy --no-page --json | jq .bound.ratio_to_white_noise
      one figure for a script

A signal ends it at once; the page is written whole or not at all.
Exit codes: 0 done, 1 refused or failed, 2 bad command line.";

/// Measures a sample table against white noise of the same shape, and draws a page of it.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// The table: a .npy file with axes [frame, y, x, sample, dim].
    path: PathBuf,
    /// Where to write the page [default: beside the table, as NAME.inspect.png].
    #[arg(long, value_name = "PNG")]
    out: Option<PathBuf>,
    /// Do not draw the page.
    #[arg(long, conflicts_with = "out")]
    no_page: bool,
    /// Test integrands per family. 256 leave a standard error of about 2 % in the mean.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: u32,
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current
    /// frame first [default: perceptual:60; none for a single frame].
    #[arg(long, value_parser = temporal::parse)]
    temporal: Option<TemporalKernel>,
    /// Width of the spatial Gaussian exp(-r²/sigma²), in pixels.
    #[arg(long, default_value_t = 2.1)]
    sigma: f64,
    /// Slices per term of the bound, fewer for large subsets. The default leaves a standard error of about
    /// half a percent.
    #[arg(long, default_value_t = 16_384, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    bound_slices: u32,
    /// Names the integrands, the slices of the bound and the white noise that is shown.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    shared: Shared,
}

/// A table and how it is looked at.
struct Inspection {
    /// Of the file, without its folder.
    name: String,
    table: SampleTable,
    kernel: Kernel,
    /// Test integrands per family.
    integrands: usize,
    /// Slices per term of the bound.
    bound_slices: usize,
    seed: u64,
}

/// What lies beside the table.
enum Beside {
    Nothing,
    Unusable(TableError),
    /// Metadata of another table.
    Foreign(FormatError),
    /// Metadata of this table, or which do not say of which values they are.
    Own(Box<Metadata>),
}

impl Beside {
    fn find(path: &Path, table: &SampleTable) -> Self {
        if !Metadata::path_beside(path).exists() {
            return Self::Nothing;
        }
        match Metadata::load(path) {
            Err(error) => Self::Unusable(error),
            Ok(metadata) => match metadata.check(table) {
                Err(problem) => Self::Foreign(problem),
                Ok(()) => Self::Own(metadata.into()),
            },
        }
    }
}

impl Inspection {
    fn sigma(&self) -> f64 {
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
    let Arguments { path, integrands, bound_slices, sigma, seed, shared, .. } = arguments;
    let table = SampleTable::load(path)?;
    let beside = Metadata::path_beside(path);
    let page = arguments.page();
    if let Some(page) = &page {
        let output = Output { flag: "--out", path: page, endings: &["png"] };
        output::check(&[output], &[path, &beside])?;
    }
    let temporal = temporal::or_default(arguments.temporal.as_ref(), table.extent().frames);
    let inspection = Inspection {
        name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        table,
        kernel: Kernel::product(SpatialKernel::Gaussian { sigma_px: *sigma }, temporal),
        integrands: *integrands as usize,
        bound_slices: *bound_slices as usize,
        seed: *seed,
    };
    // A bad kernel is found out before anything is said.
    inspection.kernel.taps(&inspection.table.extent())?;
    shared.start_threads()?;

    let mut console = Console::new(shared);
    let metadata = Beside::find(path, &inspection.table);
    console.say(|out| report::header(out, &inspection));
    console.say(|out| report::metadata(out, &metadata));
    console.say(report::key);
    let dims = DimensionGroup::pairs_and_whole(inspection.table.dims());
    let mut groups = Vec::new();
    for group in &dims {
        let measured = GroupFigures::measure(&inspection, group.dims.clone())?;
        console.say(|out| report::group(out, &measured));
        groups.push(measured);
    }
    let bound = figures::bound(&inspection, &dims)?;
    console.say(|out| report::bound(out, &bound));
    if let (Some(page), Some(first)) = (&page, groups.first()) {
        page::draw(&inspection, first)?.save(page)?;
        console.say(|out| writeln!(out, "page: {}", page.display()));
    }
    console.figures(&figures::json(&inspection, &metadata, &groups, &bound, page.as_deref()));
    console.end(Ended::Done)
}

impl Arguments {
    /// Where the page is drawn, if it is.
    fn page(&self) -> Option<PathBuf> {
        let page = || self.out.clone().unwrap_or_else(|| self.path.with_extension("inspect.png"));
        (!self.no_page).then(page)
    }
}
