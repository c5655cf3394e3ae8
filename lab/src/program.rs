//! What the programs share: how they begin, how they fail, and what they write.

use std::fmt;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use fsot::files::WholeFile;
pub use fsot_cli::Failure;

/// Runs a program with the arguments of this process; what goes wrong is told in one sentence.
pub fn main<Arguments: Parser>(run: impl FnOnce(&Arguments) -> Result<(), Failure>) -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // Who reads no more has read enough.
        Err(error) if is_of_a_gone_reader(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn is_of_a_gone_reader(error: &Failure) -> bool {
    error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}

/// Makes the folder that a person has given as `--out`, unless it is there.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path)
        .map_err(|error| format!("cannot create {}: {error}; choose another --out", path.display()).into())
}

/// Writes a file into that folder; it appears whole or not at all.
///
/// # Errors
/// It cannot be written.
pub fn save(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    WholeFile::write(path, |out| out.write_all(contents))
        .and_then(WholeFile::commit)
        .map_err(|error| format!("cannot write {}: {error}; choose another --out", path.display()).into())
}

/// Prints words, at once. Not as `print` does, which panics when the reader has gone away, as `head` does:
/// [`main`] ends quietly on this error. Files are written before it is passed on.
///
/// # Errors
/// Those of standard output.
pub fn print(words: fmt::Arguments) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_fmt(words).and_then(|()| out.flush())
}

/// Prints a line, by [`program::print`](crate::program::print()).
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => { $crate::program::print(format_args!("{}\n", format_args!($($words)*))) };
}
