//! `fsot export`: writes a sample table in a format that engines read, and says what its numbers cost.

mod loss;

use std::path::{Path, PathBuf};

use clap::Args;
use fsot::SampleTable;
use fsot::files::{Depth, ExportError, ExportOptions, Format, Metadata, Rounding};
use serde_json::json;

use self::loss::Loss;
use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot export table.npy --to atlas --out mask.png
      one PNG of 8 bits, frames one below the other
  fsot export table.npy --to slices --out stbn.png
      stbn_vec2_2Dx1D_128x128x64_0.png and so on, one PNG a frame
  fsot export table.npy --to slices --name 'noise_{frame}' --bits 16 --out noise.png
      by other names, of 16 bits
  fsot export table.npy --to ktx2 --bits half --out mask.ktx2
      a texture with a layer for each frame
  fsot export table.npy --to c --bits 16 --out mask.h
      a header for C99 and C++ with an array and a function that reads it
  fsot export table.npy --to raw --bits 8 --out mask.raw
      bare numbers, and mask.raw.txt, which says what they are; large tables are no headers
  fsot import mask.ktx2 --out table.npy
      and back, as from every format

A texture holds one sample of a pixel and up to four dimensions; more samples go to files _s0, _s1 and so on,
more dimensions to _d0-3, _d4-7 and so on. How to read the files lies beside them, under the name that is
given and .json. docs/formats.md says which number is where in which format, and who reads it.
A level k of 8 bits stands for (k + 1/2) / 256, one of 16 bits for (k + 1/2) / 65536.
Files appear all or none: a signal (Ctrl-C) before all are complete leaves everything as it was, with code 1;
a later one only ends the measurement of what the numbers cost.
Exit codes: 0 done, 1 refused or failed, 2 bad command line, 3 done, but a signal ended the measurement.";

/// Writes a sample table as textures, or in another format that engines read.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The table: a .npy file with axes [frame, y, x, sample, dim].
    path: PathBuf,
    /// The format.
    #[arg(long, value_name = "FORMAT", help = format!("One of {}", Format::names()))]
    to: Format,
    /// Where to write it; if it makes several files, their names begin like this one.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// The numbers in the files: 8 or 16 for levels, half or 32 for floating point [default: what is usual in
    /// the format].
    #[arg(long)]
    bits: Option<Depth>,
    /// How values become levels.
    #[arg(long, default_value_t, help = format!("How values become levels: {}", Rounding::names()))]
    rounding: Rounding,
    /// Names of the files, without folder and ending; with {name}, {kind} (scalar, vec2, …), {width},
    /// {height}, {frames}, {frame}, {sample} and {dims} where these shall stand.
    #[arg(long, value_name = "PATTERN")]
    name: Option<String>,
    /// Do not measure what the numbers cost.
    #[arg(long)]
    no_loss: bool,
    #[command(flatten)]
    shared: Shared,
}

/// Exports the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { path, to, out, bits, rounding, name, no_loss, shared } = arguments;
    let table = SampleTable::load(path)?;
    let beside = Metadata::path_beside(path);
    let options =
        ExportOptions { depth: *bits, rounding: *rounding, name: name.clone(), ..ExportOptions::new(*to) };
    for file in options.files(out, table.extent(), table.dims())? {
        if [path, &beside].into_iter().any(|input| is_same(input, &file)) {
            let complaint =
                format!("--out {} would overwrite what is read: choose another --out", out.display());
            return Err(complaint.into());
        }
    }
    shared.start_threads()?;
    let interrupt = Interrupt::listen()?;
    let exported = table.export_observed(out, &options, |_| interrupt.flow()).map_err(said)?;
    let mut console = Console::new(shared);
    console.say(|words| {
        writeln!(words, "{exported}")?;
        writeln!(words, "{}: how to read it", exported.record_path.display())
    });
    // Numbers that are the values themselves cost nothing.
    let measured = !no_loss && options.depth() != Depth::F32;
    let path = path.clone();
    let loss = match measured {
        true => interrupt.unless_it_comes(move || Loss::measure(&path, table, &options)).transpose()?,
        false => None,
    };
    let stopped = measured && loss.is_none();
    console.say(|words| match &loss {
        Some(loss) => loss.words(words),
        None if stopped => writeln!(words, "what the numbers cost: not measured, since a signal came"),
        None => Ok(()),
    });
    console.figures(&json!({ "export": exported, "loss": loss }));
    console.end(Ended::stopped_if(stopped))
}

/// Nothing breaks an export off but a signal.
fn said(error: ExportError) -> Failure {
    match error {
        ExportError::Stopped => "a signal came before all files were complete: nothing is written".into(),
        other => other.into(),
    }
}

/// Whether both are the same file, which is there.
fn is_same(input: &Path, output: &Path) -> bool {
    matches!((input.canonicalize(), output.canonicalize()), (Ok(input), Ok(output)) if input == output)
}
