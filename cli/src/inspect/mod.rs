//! Says what a sample table is worth, in figures and on one page of pictures.
//!
//! ```text
//! cargo run --release --example inspect_table -- table.npy --out page.png
//! ```
//!
//! Prints shape, metadata, filtered error, bias, uniformity, low frequencies and the bound, as ratios to white noise
//! of the same shape. The page shows a table and white noise side by side: the error of one integrand, before and
//! after the filter, its spectrum, and the samples themselves.

mod evenness;
mod integrand;
mod page;
mod panels;
mod report;

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::{Failure, temporal};
use clap::Args;
use fsot::files::Metadata;
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Kernel, SampleTable};

/// Measure a sample table against white noise of the same shape, and draw a page of it.
#[derive(Args)]
pub struct Arguments {
    /// The table: a .npy file with axes [frame, y, x, sample, dim].
    path: PathBuf,
    /// Where to write the page [default: beside the table, as NAME.inspect.png].
    #[arg(long, value_name = "PNG")]
    out: Option<PathBuf>,
    /// Test integrands per family. 256 leave a standard error of about 2 % in the mean.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: u32,
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current frame first
    /// [default: perceptual:60; none for a single frame].
    #[arg(long, value_parser = temporal::parse)]
    temporal: Option<TemporalKernel>,
    /// Width of the spatial Gaussian exp(-r²/sigma²), in pixels.
    #[arg(long, default_value_t = 2.1)]
    sigma: f64,
    /// Slices per term of the bound, fewer for large subsets. The default leaves a standard error of about half a
    /// percent.
    #[arg(long, default_value_t = 16_384, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    bound_slices: u32,
    /// Names the integrands, the slices of the bound and the white noise that is shown.
    #[arg(long, default_value_t = 0)]
    seed: u64,
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
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { path, integrands, bound_slices, sigma, seed, .. } = arguments;
    let table = SampleTable::load(path)?;
    let out = arguments.out.clone().unwrap_or_else(|| path.with_extension("inspect.png"));
    check_out(&out, path)?;
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

    let mut console = std::io::stdout().lock();
    report::header(&mut console, &inspection)?;
    let beside = if Metadata::path_beside(path).exists() { Some(SampleTable::load_with(path)) } else { None };
    report::metadata(&mut console, beside)?;
    let shown = report::measure(&mut console, &inspection)?;
    page::draw(&inspection, &shown)?.save(&out)?;
    writeln!(console, "page: {}", out.display())?;
    Ok(())
}

/// Refuses, before the work, to write over the table and into folders that do not exist.
fn check_out(out: &Path, table: &Path) -> Result<(), Failure> {
    for input in [table.to_owned(), Metadata::path_beside(table)] {
        let same = match (out.canonicalize(), input.canonicalize()) {
            (Ok(out), Ok(input)) => out == input,
            _ => false,
        };
        if same {
            return Err(format!("the page would overwrite {}: choose another --out", input.display()).into());
        }
    }
    let folder = match out.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(
            format!("there is no folder {}: make it or choose another --out", folder.display()).into()
        );
    }
    if out.is_dir() {
        return Err(format!("{} is a folder: give --out the name of a file", out.display()).into());
    }
    Ok(())
}
