//! The flags of `fsot table`, and what they mean to the library.

use std::path::PathBuf;

use clap::{Arg, Args, ValueEnum};
use fsot::config::{Descent, DimensionGroup, Domain, Work};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Config, Extent, Kernel, Until};

use crate::{Shared, checkpoint, temporal};

const EXAMPLES: &str = "\
Examples:
  fsot table
      64 x 64 pixels and 10 frames, to table.npy and table.json
  fsot table --frames 1 --dims 4 --groups '0,1;2,3' --seconds 5 --out render.npy
      a still table of two independent pairs of numbers, such as a point on a light and one on a lens
  fsot table --frames 16 --temporal ema:0.1 --seed 7
      for temporal antialiasing that keeps nine tenths of its history
  fsot table --spp 16 --checkpoint run.checkpoint --every 30s --out table.npy
  fsot table --resume run.checkpoint --out table.npy
      the same bits, also if the first was killed; what the checkpoint holds can't be given again

numpy.load reads the table: float32 in [0, 1), axes [frame, y, x, sample, dim].

A signal (Ctrl-C, SIGTERM, SIGHUP) ends the run with the step that is being taken, and keeps the table as it
is then. A signal while the bound is measured leaves out the bound.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, table written.";

/// Optimises a table of random numbers so that a renderer's error is blue noise in space and time.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true, mut_arg("resume", alone))]
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
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current
    /// frame first [default: perceptual:60; none for a single frame].
    #[arg(long, value_parser = temporal::parse)]
    temporal: Option<TemporalKernel>,
    /// Dimension groups with weights, as in "0,1:1;2,3:1;0-3:0.5" [default: consecutive pairs, and the whole
    /// at half their weight].
    #[arg(long, value_parser = parse_groups)]
    groups: Option<Groups>,
    /// Whether a dimension ends or wraps.
    #[arg(long, value_enum, default_value_t = DomainName::Interval)]
    domain: DomainName,
    /// How slices move the samples [default: barycentric].
    #[arg(long, value_enum)]
    optimizer: Option<DescentName>,
    /// Slices drawn per pixel and frame [default: 320 with --domain torus or --optimizer, else 0].
    #[arg(long, conflicts_with = "seconds")]
    slices_per_class: Option<u64>,
    /// Sweeps over all samples, after the slices; not with --domain torus [default: some ten seconds' work of
    /// a core, from 3 to 1000, or to 10000 for scalars; 0 with --slices-per-class above 0, --domain torus or
    /// --optimizer].
    #[arg(long, conflicts_with = "seconds")]
    sweeps: Option<u64>,
    /// Sweeps of the frame that an animation begins with, of which --sweeps is the rest [default: as many as
    /// take a fifth of the time; 0 with --slices-per-class].
    #[arg(long, conflicts_with = "seconds", requires = "sweeps")]
    frame_sweeps: Option<u64>,
    /// Time for the optimisation alone, instead of an amount of work.
    #[arg(long)]
    seconds: Option<f64>,
    /// Do not measure the bound before and after.
    #[arg(long)]
    pub(super) no_bound: bool,
    /// Names every random number: the same seed gives the same bits.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where to write the table, as .npy; its metadata goes beside it, as .json.
    #[arg(long, default_value = "table.npy", value_name = "NPY")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    pub(super) checkpoint: checkpoint::Arguments,
    #[command(flatten)]
    pub(super) shared: Shared,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DomainName {
    Interval,
    Torus,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DescentName {
    Barycentric,
    Adam,
    Sgd,
}

#[derive(Clone, Debug)]
struct Groups(Vec<DimensionGroup>);

impl Arguments {
    /// How long the run is.
    pub(super) fn until(&self) -> Until {
        if let Some(seconds) = self.seconds {
            return Until::Seconds(seconds);
        }
        let slices_only = self.optimizer.is_some() || matches!(self.domain, DomainName::Torus);
        let slices = if slices_only { Some(320) } else { None };
        match (self.slices_per_class.or(slices), self.sweeps, self.frame_sweeps) {
            (None | Some(0), None, _) => Until::Usual,
            (None, Some(sweeps), None) => Until::Sweeps(sweeps),
            (slices, sweeps, frame_sweeps) => Until::Work(Work {
                frame_sweeps: frame_sweeps.unwrap_or(0),
                slices_per_class: slices.unwrap_or(0),
                sweeps: sweeps.unwrap_or(0),
            }),
        }
    }

    /// What is optimised.
    pub(super) fn config(&self) -> Config {
        let Arguments { width, height, frames, spp, dims, sigma, .. } = *self;
        let extent = Extent { frames, height, width, spp };
        let temporal = temporal::or_default(self.temporal.as_ref(), frames);
        let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px: sigma }, temporal);
        let groups = match &self.groups {
            Some(Groups(groups)) => groups.clone(),
            None => DimensionGroup::pairs_and_whole(dims),
        };
        let domain = match self.domain {
            DomainName::Interval => Domain::Interval,
            DomainName::Torus => Domain::Torus,
        };
        let descent = match self.optimizer {
            None | Some(DescentName::Barycentric) => Descent::barycentric(),
            Some(DescentName::Adam) => Descent::adam(),
            Some(DescentName::Sgd) => Descent::sgd(),
        };
        Config::new(extent, dims)
            .with_domain(domain)
            .with_groups(&groups)
            .with_kernel(kernel)
            .with_descent(descent)
            .with_seed(self.seed)
    }
}

/// What is resumed has been told all this.
fn alone(resume: Arg) -> Arg {
    resume.conflicts_with_all([
        "width",
        "height",
        "frames",
        "spp",
        "dims",
        "sigma",
        "temporal",
        "groups",
        "domain",
        "optimizer",
        "slices_per_class",
        "sweeps",
        "frame_sweeps",
        "seconds",
        "seed",
    ])
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
