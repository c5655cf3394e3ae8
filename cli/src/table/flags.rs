//! The flags of `fsot table`, and what they mean to the library.

use std::path::{Path, PathBuf};

use clap::{Arg, Args, ValueEnum};
use fsot::config::Domain;
use fsot::kernel::TemporalKernel;

use super::reading;
use super::recipe::{DescentName, Recipe};
use super::values::{self, Domains, Groups, KernelSource, Temporal};
use crate::{Failure, Shared, checkpoint, temporal};

const EXAMPLES: &str = "\
Examples:
  fsot table
      64 x 64 pixels and 10 frames, to table.npy and table.json
  fsot table --frames 1 --dims 4 --groups '0,1;2,3' --seconds 5 --out render.npy
      a still table of two independent pairs of numbers, such as a point on a light and one on a lens
  fsot table --frames 16 --temporal ema:0.1 --seed 7
      for temporal antialiasing that keeps nine tenths of its history
  fsot table --kernel denoiser.npy --dry-run
      for a filter of your own weights; what the run would take, without running it
  fsot table --config table.json --out again.npy --log run.csv
      the same bits again, or a TOML file of your own (docs/configuration.md); flags change single things;
      'fsot plot run.csv' draws how it went
  fsot table --spp 16 --checkpoint run.checkpoint --every 30s
      a run that may be killed; then --resume run.checkpoint goes on to the same bits

numpy.load reads the table: float32 in [0, 1), axes [frame, y, x, sample, dim].

A signal (Ctrl-C, SIGTERM, SIGHUP) ends the run with the step that is being taken, and keeps the table as it
is then. A signal while the bound is measured leaves out the bound.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 ended early by a signal, table written.";

/// Optimises a table of random numbers so that a renderer's error is blue noise in space and time.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true, mut_arg("resume", alone))]
pub struct Arguments {
    /// A file that says all this: TOML, or the metadata of a table, whose bits are made again; flags override
    /// what it says.
    #[arg(long, value_name = "TOML|JSON")]
    config: Option<PathBuf>,
    /// Columns of a frame, in pixels [default: 64].
    #[arg(long)]
    width: Option<usize>,
    /// Rows of a frame, in pixels [default: 64].
    #[arg(long)]
    height: Option<usize>,
    /// Frames; the animation wraps [default: 10].
    #[arg(long)]
    frames: Option<usize>,
    /// Samples per pixel [default: 1].
    #[arg(long)]
    spp: Option<usize>,
    /// Dimensions per sample, at most 64 [default: 2].
    #[arg(long)]
    dims: Option<usize>,
    /// Width of the spatial Gaussian exp(-r²/sigma²), in pixels [default: 2.1].
    #[arg(long)]
    sigma: Option<f64>,
    /// Weights of another filter: an array [y, x], or [frame, y, x] with the current frame first, or rows of
    /// numbers; odd sides are centred, even ones reach one pixel further right and down.
    #[arg(long, value_name = "NPY|CSV", conflicts_with = "sigma")]
    kernel: Option<PathBuf>,
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current
    /// frame first [default: perceptual:60; none for a single frame].
    #[arg(long, value_parser = temporal::parse)]
    temporal: Option<TemporalKernel>,
    /// Dimension groups with weights, as in "0,1:1;2,3:1;0-3:0.5" [default: consecutive pairs, and the whole
    /// at half their weight].
    #[arg(long, value_parser = values::groups)]
    groups: Option<Groups>,
    /// A list of terms, for what these flags don't say (docs/configuration.md).
    #[arg(long, value_name = "TOML|JSON", conflicts_with_all = ["sigma", "kernel", "temporal", "groups"])]
    terms: Option<PathBuf>,
    /// Whether a dimension ends or wraps [default: interval].
    #[arg(long, value_enum)]
    domain: Option<DomainName>,
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
    /// Print what the run would take, and don't run: work, terms, memory, and the time that it is expected to
    /// take here.
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Where to write how the run goes, as .csv, while it goes: step, seconds, step size, displacement, loss,
    /// and now and then filtered error and bias.
    #[arg(long, value_name = "CSV")]
    pub(super) log: Option<PathBuf>,
    /// Do not measure the bound before and after.
    #[arg(long)]
    pub(super) no_bound: bool,
    /// Names every random number: the same seed gives the same bits [default: 0].
    #[arg(long)]
    seed: Option<u64>,
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

impl Arguments {
    /// What the table is to be, by all files and flags.
    ///
    /// # Errors
    /// A file that cannot be read or understood; flags that cannot override it.
    pub(super) fn recipe(&self) -> Result<Recipe, Failure> {
        let flags = Recipe {
            width: self.width,
            height: self.height,
            frames: self.frames,
            spp: self.spp,
            dims: self.dims,
            sigma: self.sigma,
            kernel: self.kernel.clone().map(KernelSource::File),
            temporal: self.temporal.clone().map(Temporal),
            groups: self.groups.clone(),
            terms: self.terms.as_deref().map(reading::terms).transpose()?,
            domain: self.domain.map(|domain| match domain {
                DomainName::Interval => Domains::All(Domain::Interval),
                DomainName::Torus => Domains::All(Domain::Torus),
            }),
            optimizer: self.optimizer,
            seed: self.seed,
            seconds: self.seconds,
            slices_per_class: self.slices_per_class,
            sweeps: self.sweeps,
            frame_sweeps: self.frame_sweeps,
            ..Recipe::default()
        };
        match &self.config {
            Some(path) => flags.over(reading::recipe(path)?, path),
            None => Ok(flags),
        }
    }

    /// Files that are read.
    pub(super) fn inputs(&self) -> Vec<&Path> {
        let files = [&self.config, &self.kernel, &self.terms].into_iter().flatten();
        files.map(PathBuf::as_path).chain(self.checkpoint.input()).collect()
    }
}

/// What is resumed has been told all this.
fn alone(resume: Arg) -> Arg {
    resume.conflicts_with_all([
        "config",
        "kernel",
        "terms",
        "dry_run",
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
