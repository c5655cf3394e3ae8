//! What the programs share: how they begin, how they fail, and what they write.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use fsot::files::WholeFile;
pub use fsot_cli::Failure;

/// Runs a program with the arguments of this process; what goes wrong is told in one sentence.
pub fn main<Arguments: Parser>(run: impl FnOnce(&Arguments) -> Result<(), Failure>) -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
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
