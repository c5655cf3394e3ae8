//! `fsot import`: makes a sample table of somebody else's file, and says what it took for what.

use std::path::PathBuf;

use clap::Args;
use fsot::files::{Axis, Dtype, ImportOptions, Imported, Metadata};
use fsot::{Extent, SampleTable};
use serde_json::json;

use crate::console::Console;
use crate::inspect::shape;
use crate::interrupt::Interrupt;
use crate::output::{self, Output};
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot import mask.npy --out table.npy
      an array of floats or integers of any size, byte order and memory order, or text
  fsot import fast.npy --axes dim,frame,y,x --out table.npy
      with axes in another order than is usual
  fsot import ten_bits.npy --levels 1024 --out table.npy
      whole numbers from 0 to 1023, each as (v + 1/2) / 1024
  fsot import mask.png --out table.npy
      a texture: PNG, KTX 2 or EXR; of channels those that say something, of a picture that is several times
      as high as wide the frames
  fsot import 'stbn_vec2_2Dx1D_128x128x64_{frame}.png' --out table.npy
      a file for each frame; {sample} and {dims} stand for what else tells files apart
  fsot import samples.dat --frames 10 --out table.npy
      one sample a line, in the order [frame, y, x, sample, dim]
  fsot import bluenoise.cpp --out table.npy
      an array in C or C++; --array says which, where there are several
  fsot import noise.bin --dtype '<f4' --channels 4 --dims 2 --frames 64 --out table.npy
      bare numbers, of which each pixel has four and two count

What fsot export wrote is read by the .json beside it, unless lengths, axes or levels are given.
Fractions are taken as they are; 1 becomes the largest number below. Whole numbers are ranks if each from 0 or
1 to the greatest is there equally often; else 8, 16 and 32 bits without sign have 256, 65536 and 2^32 levels
if a value is in their upper half; else --levels says how many there are.
Lengths are for lists of samples: one of them may be missing, or width and height of a square picture.
Exit codes: 0 done, 1 refused or failed, 2 bad command line.";

/// Makes a sample table of an array, a texture or a text of somebody else's.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// A .npy file, a PNG, KTX 2 or EXR texture, text with numbers between blanks or commas, or what was
    /// given to fsot export as --out.
    path: PathBuf,
    /// Where to write the table, as .npy.
    #[arg(long, value_name = "NPY")]
    out: PathBuf,
    /// The axes of the file, slowest first: some of frame, y, x, sample and dim [default: by their number and
    /// lengths, as is then said].
    #[arg(
        long,
        value_delimiter = ',',
        conflicts_with_all = ["frames", "height", "width", "spp", "dims", "channels"],
    )]
    axes: Vec<Axis>,
    /// Levels of whole numbers [default: found, as above].
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    levels: Option<u64>,
    /// Frames of a list.
    #[arg(long, value_parser = crate::flags::count())]
    frames: Option<usize>,
    /// Rows of a frame of a list.
    #[arg(long, value_parser = crate::flags::count())]
    height: Option<usize>,
    /// Columns of a frame of a list.
    #[arg(long, value_parser = crate::flags::count())]
    width: Option<usize>,
    /// Samples per pixel of a list.
    #[arg(long, value_parser = crate::flags::count())]
    spp: Option<usize>,
    /// Dimensions of a sample of a list [default: numbers on a line, up to 16].
    #[arg(long, value_parser = crate::flags::count())]
    dims: Option<usize>,
    /// Numbers that a sample takes in a list, of which the first --dims are read, such as 4 of RGBA.
    #[arg(long, value_parser = crate::flags::count())]
    channels: Option<usize>,
    /// Type of the numbers of a file without a header, as numpy calls it: <f4, <u2, |u1 and so on.
    #[arg(long)]
    dtype: Option<Dtype>,
    /// Which array of a C or C++ source text.
    #[arg(long, value_name = "NAME")]
    array: Option<String>,
    #[command(flatten)]
    shared: Shared,
}

/// Imports the file.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { path, out, levels, frames, height, width, spp, dims, channels, shared, .. } = arguments;
    output::check(&[Output { flag: "--out", path: out, endings: &["npy"] }], &[path])?;
    let (axes, levels) = (arguments.axes.clone(), *levels);
    let [frames, height, width, spp, dims] = [*frames, *height, *width, *spp, *dims];
    let (channels, dtype, array) = (*channels, arguments.dtype, arguments.array.clone());
    let options = ImportOptions { axes, levels, frames, height, width, spp, dims, channels, dtype, array };
    let imported = SampleTable::import(path, &options)?;
    let Imported { table, dtype, shape: of_file, axes, levels, first_level, ones, left_out, record, .. } =
        &imported;
    // A signal from now on finds a table that is nearly there: it is completed.
    Interrupt::listen()?;
    table.save(out)?;

    let mut console = Console::new(shared);
    let beside = Metadata::path_beside(out);
    console.say(|words| {
        writeln!(words, "{}: {imported}", path.display())?;
        writeln!(words, "{}: {}", out.display(), shape(table))?;
        if beside.exists() {
            writeln!(words, "{} is of another table", beside.display())?;
        }
        Ok(())
    });
    let Extent { frames, height, width, spp } = table.extent();
    console.figures(&json!({
        "table": out.display().to_string(),
        "shape": [frames, height, width, spp, table.dims()],
        "dtype_of_file": dtype,
        "shape_of_file": of_file,
        "axes_of_file": axes.iter().map(|axis| axis.name()).collect::<Vec<_>>(),
        "levels": levels,
        "first_level": first_level,
        "ones": ones,
        "channels_left_out": left_out,
        "record": record.as_ref().map(|record| record.display().to_string()),
    }));
    console.end(Ended::Done)
}
