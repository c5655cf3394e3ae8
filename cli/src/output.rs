//! Files that a verb is going to write: what stands against them is found out before the work.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use fsot::files::WholeFile;

use crate::Failure;

/// Any ending will do.
pub const ANY: &[&str] = &[];

/// A path and the flag that has named it.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// As it is written on the command line.
    pub flag: &'static str,
    /// The file.
    pub path: &'a Path,
    /// Endings of its name that say what can be written; none if any will do.
    pub endings: &'static [&'static str],
}

/// Refuses files that could not be written after the work, or that would replace one of the `inputs` or each
/// other. Leaves nothing behind.
///
/// The ending must be among those that are known; the folder must exist, and a new file must find its place
/// there; what stands at the path already must be an ordinary file.
///
/// # Errors
/// What stands against a file, in one sentence with its flag.
pub fn check(outputs: &[Output], inputs: &[&Path]) -> Result<(), Failure> {
    let mut places: Vec<PathBuf> = Vec::new();
    for &Output { flag, path, endings } in outputs {
        let name = path.display();
        if !endings.is_empty() && !endings.iter().any(|ending| has_ending(path, ending)) {
            let known: Vec<String> = endings.iter().map(|ending| format!(".{ending}")).collect();
            let known = known.join(" or ");
            return Err(format!("{flag} {name}: give a file name that ends in {known}").into());
        }
        let file = WholeFile::write(path, |_| Ok(())).map_err(|error| cannot_write(flag, path, &error))?;
        let place = place(file.target());
        if inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == place)) {
            let complaint = format!("{flag} {name} would overwrite what is read: choose another {flag}");
            return Err(complaint.into());
        }
        if let Some(other) = places.iter().position(|other| *other == place) {
            let Output { flag: other_flag, path: other_path, .. } = outputs[other];
            let complaint = format!(
                "{flag} {name} and {other_flag} {} are the same file: choose another",
                other_path.display()
            );
            return Err(complaint.into());
        }
        places.push(place);
    }
    Ok(())
}

/// Writes a file, which appears whole or not at all.
///
/// # Errors
/// The path cannot be written; in the same words as by [`check`].
pub fn write(
    flag: &str,
    path: &Path,
    fill: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let file = WholeFile::write(path, |out| fill(out));
    file.and_then(WholeFile::commit).map_err(|error| cannot_write(flag, path, &error))
}

/// Whether the file's name ends like this, in any case.
pub fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// That a file cannot be written, in one sentence.
pub(crate) fn cannot_write(flag: &str, path: &Path, error: &io::Error) -> Failure {
    format!("cannot write {}: {error}; choose another {flag}", path.display()).into()
}

/// Where the file lies or is going to lie, whatever links its folders are reached by.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        folder.join(path.file_name().unwrap_or(OsStr::new("")))
    })
}
