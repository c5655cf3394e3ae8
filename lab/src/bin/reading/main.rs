//! What a table is worth by how it is read: as it is meant, by what is simpler, and by mistakes.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin reading -- data/tables/64x64x16_1spp_2d_ema.npy \
//!     --temporal ema:0.1 --still data/tables/64x64x1_1spp_2d.npy
//! ```
//!
//! Every way of reading gives so many frames of numbers; printed are their errors as ratios to white noise.

mod ways;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::metrics::{FilteredError, Integrands};
use fsot::{Extent, Kernel, SampleTable};
use fsot_lab::program::{self, Failure};
use fsot_lab::say;

use crate::ways::{Source, Way};

/// What a table is worth by how it is read.
#[derive(Parser)]
struct Arguments {
    /// The table: a .npy file with axes [frame, y, x, sample, dim].
    path: PathBuf,
    /// A table of one frame, for what reads one elsewhere in every frame [default: the table's first frame].
    #[arg(long, value_name = "NPY")]
    still: Option<PathBuf>,
    /// none, gaussian:SIGMA, ema:ALPHA, box:N, binomial:N, perceptual:FPS or taps:a,b,… with the current
    /// frame first.
    #[arg(long, default_value = "ema:0.1", value_parser = fsot_cli::temporal::parse)]
    temporal: TemporalKernel,
    /// Frames that are rendered.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1024))]
    frames: u32,
    /// Uses of the table in a frame, as by so many bounces; errors are those of all their numbers together.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    uses: u32,
    /// Dimensions that are looked at together, as in 0,1 [default: all, of all uses].
    #[arg(long, value_delimiter = ',')]
    dims: Option<Vec<usize>>,
    /// Only ways that begin like this, as in "as it is".
    #[arg(long, default_value = "")]
    way: String,
    /// Test integrands per family.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=4096))]
    integrands: u32,
}

fn main() -> ExitCode {
    program::main(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let table = SampleTable::load(&arguments.path)?;
    let still = match &arguments.still {
        Some(path) => SampleTable::load(path)?,
        None => first_frame(&table)?,
    };
    let of = |table: &SampleTable| (table.extent().spp, table.dims());
    if of(&still) != of(&table) {
        let [(spp, dims), (other_spp, other_dims)] = [of(&table), of(&still)];
        return Err(format!(
            "the table has {spp} samples of {dims} numbers a pixel, the still one {other_spp} of \
             {other_dims}: give a --still of the same"
        )
        .into());
    }
    let uses = arguments.uses as usize;
    let Extent { height, width, spp, .. } = table.extent();
    let extent = Extent { frames: arguments.frames as usize, height, width, spp };
    let all = || (0..uses * table.dims()).collect();
    let dims = arguments.dims.clone().unwrap_or_else(all);
    let measure = Measure::new(dims, arguments)?;
    let source = Source { table: &table, still: &still };
    let ways = Way::all(&source, extent.frames, uses).into_iter();
    let ways: Vec<Way> = ways.filter(|way| way.name.starts_with(&arguments.way)).collect();
    if ways.is_empty() {
        return Err(format!("no way begins with {:?}: leave out --way to see all", arguments.way).into());
    }

    say!(
        "frames {}, uses {uses}, dimensions {}, samples per pixel {spp}; ratios to white noise",
        extent.frames,
        table.dims()
    )?;
    say!("{:48} {:>9} {:>9} {:>9} {:>9}", "read", "one frame", "one pixel", "filtered", "all")?;
    for way in ways {
        let read = way.read(&source, extent, uses)?;
        let [frame, pixel, both, all] = measure.errors(&read)?;
        say!("{:48} {frame:9.3} {pixel:9.3} {both:9.3} {all:9.3}", way.name)?;
    }
    say!("one frame: after exp(-r^2/2.1^2); one pixel: after the temporal kernel; filtered: after both")?;
    say!("all: after exp(-r^2/2.1^2) and the mean of all frames")?;
    Ok(())
}

fn first_frame(table: &SampleTable) -> Result<SampleTable, Failure> {
    let extent = Extent { frames: 1, ..table.extent() };
    let values = table.values()[..extent.samples() * table.dims()].to_vec();
    Ok(SampleTable::new(extent, table.dims(), values)?)
}

/// By what readings are judged.
struct Measure {
    dims: Vec<usize>,
    integrands: Integrands,
    /// The pixel alone, and both, and the mean of all frames.
    kernels: [Kernel; 3],
}

impl Measure {
    fn new(dims: Vec<usize>, arguments: &Arguments) -> Result<Self, Failure> {
        let eye = SpatialKernel::Gaussian { sigma_px: 2.1 };
        let pixel = SpatialKernel::Box { size_px: 1 };
        let history = &arguments.temporal;
        let mean = TemporalKernel::Box { frames: arguments.frames as usize };
        Ok(Self {
            integrands: Integrands::random(dims.len(), arguments.integrands as usize, 0)?,
            dims,
            kernels: [(pixel, history.clone()), (eye.clone(), history.clone()), (eye, mean)]
                .map(|(space, time)| Kernel::product(space, time)),
        })
    }

    /// One frame, one pixel, both, all frames.
    fn errors(&self, read: &SampleTable) -> Result<[f64; 4], Failure> {
        let of = |kernel| FilteredError::measure(read, &self.dims, &self.integrands, kernel);
        let [pixel, both, all] = &self.kernels;
        let both = of(both)?;
        let after = |error: FilteredError| error.spatio_temporal.mean.mean;
        Ok([both.spatial.mean.mean, after(of(pixel)?), after(both.clone()), after(of(all)?)])
    }
}
