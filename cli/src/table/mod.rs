//! Optimises a spatio-temporal sample table and writes it as `.npy`, with its metadata in a `.json` beside it.
//!
//! `cargo run --release --example spatiotemporal_table -- --help`

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::{Failure, temporal};
use clap::{Args, ValueEnum};
use fsot::config::{Descent, DimensionGroup, Domain, EndReason, Work};
use fsot::files::{BoundRecord, Metadata};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Config, Extent, Kernel, Optimizer, RunReport, SampleTable, Until, metrics};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Optimises a table of random numbers so that a renderer's error is blue noise in space and time.
#[derive(Args)]
pub struct Arguments {
    /// Columns of a frame, in pixels.
    #[arg(long, default_value_t = 64)]
    width: usize,
    /// Rows of a frame, in pixels.
    #[arg(long, default_value_t = 64)]
    height: usize,
    /// Frames; the animation wraps.
    #[arg(long, default_value_t = 10)]
    frames: usize,
    /// Samples per pixel.
    #[arg(long, default_value_t = 1)]
    spp: usize,
    /// Dimensions per sample, at most 64.
    #[arg(long, default_value_t = 2)]
    dims: usize,
    /// Width of the spatial Gaussian exp(-r²/sigma²), in pixels.
    #[arg(long, default_value_t = 2.1)]
    sigma: f64,
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current frame first
    /// [default: perceptual:60; none for a single frame].
    #[arg(long, value_parser = temporal::parse)]
    temporal: Option<TemporalKernel>,
    /// Dimension groups with weights, as in "0,1:1;2,3:1;0-3:0.5" [default: consecutive pairs, and the whole at half
    /// their weight].
    #[arg(long, value_parser = parse_groups)]
    groups: Option<Groups>,
    /// Whether a dimension ends or wraps.
    #[arg(long, value_enum, default_value_t = DomainName::Interval)]
    domain: DomainName,
    /// How slices move the samples [default: barycentric].
    #[arg(long, value_enum)]
    optimizer: Option<DescentName>,
    /// Slices drawn per pixel and frame [default: 320 with --domain torus or --optimizer; otherwise 128 if there are several
    /// samples per pixel, else 0].
    #[arg(long, conflicts_with = "seconds")]
    slices_per_class: Option<u64>,
    /// Sweeps over all samples, after the slices; not with --domain torus [default: 100 for one sample per pixel, 64 for
    /// several; 0 with --slices-per-class, --domain torus or --optimizer].
    #[arg(long, conflicts_with = "seconds")]
    sweeps: Option<u64>,
    /// Time for the optimisation alone, instead of an amount of work.
    #[arg(long)]
    seconds: Option<f64>,
    /// Do not measure the bound before and after.
    #[arg(long)]
    no_bound: bool,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; 0 uses every core. The result does not depend on it.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Where to write the table; its metadata goes beside it.
    #[arg(long, default_value = "table.npy")]
    out: PathBuf,
    /// No progress bar and no summary.
    #[arg(long)]
    quiet: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum DomainName {
    Interval,
    Torus,
}

#[derive(Clone, Copy, ValueEnum)]
enum DescentName {
    Barycentric,
    Adam,
    Sgd,
}

#[derive(Clone)]
struct Groups(Vec<DimensionGroup>);

/// Makes the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build()?;
    threads.install(|| optimize(arguments))
}

fn optimize(arguments: &Arguments) -> Result<(), Failure> {
    let mut optimizer = Optimizer::new(config(arguments))?;
    // An unwritable path is found out before the work, not after it.
    SampleTable::check_writable(&arguments.out)?;

    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;
    let bar = ProgressBar::new(0).with_style(ProgressStyle::with_template(
        "{elapsed_precise} {wide_bar} {pos}/{len} steps, {per_sec}, {eta} left{msg}",
    )?);
    if arguments.quiet {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    let report = optimizer.run_observed(until(arguments), |step| {
        bar.set_length(step.steps);
        bar.set_position(step.step);
        bar.set_message(format!(", displacement {:.4}", step.displacement));
        if interrupted.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    bar.finish_and_clear();

    let bound = if arguments.no_bound { None } else { Some(bound(&optimizer)?) };
    let seconds = report.elapsed.as_secs_f64();
    let ended_early = report.ended != EndReason::Finished;
    let metadata = Metadata { bound, ..optimizer.metadata(&report) };
    let table = optimizer.into_table();
    let RunReport { work: Work { slices_per_class, sweeps }, steps, .. } = report;
    table.save_with(&arguments.out, &metadata)?;

    if arguments.quiet {
        return Ok(());
    }
    // A reader that has gone away is an error like any other, not a panic.
    let mut out = std::io::stdout().lock();
    let ended = if ended_early { format!("stopped after {steps} steps of ") } else { String::new() };
    writeln!(out, "{seconds:.2} s, {ended}--slices-per-class {slices_per_class} --sweeps {sweeps}")?;
    if let Some(BoundRecord { before, after }) = bound {
        writeln!(
            out,
            "bound {:.5} ± {:.5} → {:.5} ± {:.5}, {:.3} ± {:.3} of white noise",
            before.value,
            before.standard_error,
            after.value,
            after.standard_error,
            after.ratio_to_white_noise,
            after.ratio_standard_error,
        )?;
    }
    writeln!(out, "{}, {}", arguments.out.display(), Metadata::path_beside(&arguments.out).display())?;
    Ok(())
}

/// The bound of the white noise that the run began with, and of what has become of it.
fn bound(optimizer: &Optimizer) -> Result<BoundRecord, Failure> {
    // Enough slices for a standard error of about half a percent of the ratio.
    const SLICES: usize = 16_384;
    let Config { extent, dims, seed, .. } = *optimizer.config();
    let measure = |table| metrics::Bound::measure(&table, optimizer.objective(), seed, SLICES);
    let before = measure(SampleTable::white_noise(extent, dims, seed)?)?.total;
    Ok(BoundRecord { before, after: measure(optimizer.table())?.total })
}

fn until(arguments: &Arguments) -> Until {
    if let Some(seconds) = arguments.seconds {
        return Until::Seconds(seconds);
    }
    let slices_only = arguments.optimizer.is_some() || matches!(arguments.domain, DomainName::Torus);
    // With several samples per pixel, sweeps alone leave those of a pixel unlike what their slices want.
    let (slices, sweeps) = match arguments.spp {
        _ if slices_only => (320, 0),
        1 => (0, 100),
        _ => (128, 64),
    };
    let slices_per_class = arguments.slices_per_class.unwrap_or(slices);
    let alone = arguments.slices_per_class.is_some_and(|slices| slices > 0);
    let sweeps = arguments.sweeps.unwrap_or(if alone { 0 } else { sweeps });
    Until::Work(Work { slices_per_class, sweeps })
}

fn config(arguments: &Arguments) -> Config {
    let Arguments { width, height, frames, spp, dims, sigma, .. } = *arguments;
    let extent = Extent { frames, height, width, spp };
    let temporal = temporal::or_default(arguments.temporal.as_ref(), frames);
    let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px: sigma }, temporal);
    let groups = match &arguments.groups {
        Some(Groups(groups)) => groups.clone(),
        None => DimensionGroup::pairs_and_whole(dims),
    };
    let domain = match arguments.domain {
        DomainName::Interval => Domain::Interval,
        DomainName::Torus => Domain::Torus,
    };
    let descent = match arguments.optimizer {
        None | Some(DescentName::Barycentric) => Descent::barycentric(),
        Some(DescentName::Adam) => Descent::adam(),
        Some(DescentName::Sgd) => Descent::sgd(),
    };
    Config::new(extent, dims)
        .with_domain(domain)
        .with_groups(&groups)
        .with_kernel(kernel)
        .with_descent(descent)
        .with_seed(arguments.seed)
}

fn parse_groups(text: &str) -> Result<Groups, String> {
    text.split(';').map(parse_group).collect::<Result<_, _>>().map(Groups)
}

/// A group such as `0,1`, `0-3:0.5` or `0,2-4:1`.
fn parse_group(text: &str) -> Result<DimensionGroup, String> {
    // Dimensions beyond any table would only make the list long.
    const MOST: usize = 1 << 16;
    let malformed = || format!("'{text}' is no dimension group: write for example 0,1:1 or 0-3:0.5");
    let (list, weight) = text.split_once(':').unwrap_or((text, "1"));
    let weight = weight.trim().parse().map_err(|_| malformed())?;
    let mut dims = Vec::new();
    for item in list.split(',') {
        let (first, last) = item.split_once('-').unwrap_or((item, item));
        let [first, last] =
            [first, last].map(|dim| dim.trim().parse::<usize>().ok().filter(|&dim| dim < MOST));
        match (first, last) {
            (Some(first), Some(last)) if first <= last => dims.extend(first..=last),
            _ => return Err(malformed()),
        }
    }
    Ok(DimensionGroup { dims, weight })
}
