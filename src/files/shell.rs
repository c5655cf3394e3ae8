//! Words of a command line.

use std::ffi::OsStr;
use std::path::Path;

/// A word as a shell reads it: in quotes unless it means itself without.
///
/// What is not Unicode is shown as well as can be.
///
/// ```
/// use fsot::files::shell;
///
/// assert_eq!(shell::word("--out=a.npy"), "--out=a.npy");
/// assert_eq!(shell::word("it's"), r"'it'\''s'");
/// ```
pub fn word(word: impl AsRef<OsStr>) -> String {
    let word = word.as_ref().to_string_lossy();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:@%,=".contains(c);
    // Some shells put a command's path in the place of a word that begins with `=`.
    if !word.is_empty() && !word.starts_with('=') && word.chars().all(is_plain) {
        word.into_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// A path as a shell and a command read it: one that begins like a flag stands behind its folder.
///
/// ```
/// use fsot::files::shell;
///
/// assert_eq!(shell::path("my table.npy"), "'my table.npy'");
/// assert_eq!(shell::path("-table.npy"), "./-table.npy");
/// ```
pub fn path(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    if path.as_os_str().as_encoded_bytes().starts_with(b"-") {
        word(Path::new(".").join(path))
    } else {
        word(path)
    }
}
