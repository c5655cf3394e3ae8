//! Files that appear whole or not at all: written under a temporary name, renamed when complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

/// A file that is complete on the disk, but still has a temporary name beside its target.
///
/// Dropping it removes it and leaves the target as it was.
///
/// ```
/// use std::io::Write;
///
/// use fsot::files::WholeFile;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("figures.csv");
/// WholeFile::write(&path, |out| writeln!(out, "bound,bias"))?.commit()?;
/// assert_eq!(std::fs::read_to_string(&path)?, "bound,bias\n");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct WholeFile {
    file: TempPath,
    target: PathBuf,
}

/// What a renamed file has replaced.
#[derive(Debug)]
pub(crate) struct Replaced {
    target: PathBuf,
    previous: Option<Vec<u8>>,
}

impl WholeFile {
    /// Writes the contents beside `path` and waits until they have reached the disk.
    ///
    /// A symbolic link is followed, also where nothing is at its end yet. The permissions of what is there
    /// already are kept.
    ///
    /// # Errors
    /// A path that names a directory, a device or a pipe, or lies in no directory; whatever stands against
    /// writing. Messages name directories, never the temporary file.
    pub fn write(
        path: &Path,
        fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
    ) -> io::Result<Self> {
        let target = target(path)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".fsot-").suffix(".tmp");
        #[cfg(unix)]
        {
            // Temporary files are private by default; a table is an ordinary file, and the umask decides.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        // In the same directory, because a rename does not cross file systems.
        let mut file = builder.tempfile_in(directory(&target)).map_err(|error| {
            let reason = format!("cannot make a file in {}: {}", directory(&target).display(), plain(&error));
            io::Error::new(error.kind(), reason)
        })?;
        let mut writer = BufWriter::new(file.as_file_mut());
        fill(&mut writer)?;
        writer.flush()?;
        drop(writer);
        if let Ok(found) = fs::metadata(&target) {
            file.as_file().set_permissions(found.permissions())?;
        }
        // Without this a power cut may keep the rename and lose the contents.
        file.as_file().sync_all()?;
        Ok(Self { file: file.into_temp_path(), target })
    }

    /// Takes the target's name.
    ///
    /// # Errors
    /// Whatever stands against renaming; the target is as it was then.
    pub fn commit(self) -> io::Result<()> {
        self.file.persist(&self.target).map_err(|failed| plain(&failed.error))
    }

    /// The file that is going to be replaced or made: the path, or where its links end.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Takes the target's name and remembers what was there; for small files.
    pub(crate) fn replace(self) -> io::Result<Replaced> {
        let previous = match fs::read(&self.target) {
            Ok(bytes) => Some(bytes),
            Err(absent) if absent.kind() == io::ErrorKind::NotFound => None,
            Err(other) => return Err(other),
        };
        let target = self.target.clone();
        self.commit()?;
        Ok(Replaced { target, previous })
    }
}

/// Finds out whether a file could be written, as far as that is known without writing.
pub(crate) fn check(path: &Path) -> io::Result<()> {
    let target = target(path)?;
    tempfile::tempfile_in(directory(&target)).map(drop).map_err(|error| {
        let reason = format!("cannot make a file in {}: {}", directory(&target).display(), plain(&error));
        io::Error::new(error.kind(), reason)
    })
}

/// Gives all files their names, in this order, or none: what the first of them have replaced is put back if
/// a later one cannot take its name.
pub(crate) fn commit_all(files: Vec<WholeFile>) -> Result<(), (PathBuf, io::Error)> {
    let mut kept: Vec<(PathBuf, Option<TempPath>)> = Vec::with_capacity(files.len());
    // Before the first takes its name, because this may fail for want of room.
    for file in &files {
        let previous = second_name(&file.target).map_err(|error| (file.target.clone(), error))?;
        kept.push((file.target.clone(), previous));
    }
    for (done, file) in files.into_iter().enumerate() {
        let target = file.target.clone();
        if let Err(error) = file.commit() {
            // The caller is already told why: as far as possible.
            for (target, previous) in kept.drain(..done) {
                _ = match previous {
                    Some(previous) => previous.persist(&target).map_err(|failed| failed.error),
                    None => fs::remove_file(&target),
                };
            }
            return Err((target, error));
        }
    }
    Ok(())
}

/// Another name beside it of a file that is going to be replaced, if it is there.
fn second_name(path: &Path) -> io::Result<Option<TempPath>> {
    if !path.exists() {
        return Ok(None);
    }
    // A name that nobody has; a link cannot take one that somebody has.
    let name = tempfile::Builder::new().prefix(".fsot-").suffix(".tmp").tempfile_in(directory(path))?;
    let name = name.into_temp_path();
    fs::remove_file(&name)?;
    // Not every file system has links.
    fs::hard_link(path, &name).or_else(|_| fs::copy(path, &name).map(drop))?;
    Ok(Some(name))
}

impl Replaced {
    /// Puts back what was there, as far as possible: the caller is already reporting why.
    pub(crate) fn undo(self) {
        let _ = match self.previous {
            None => fs::remove_file(&self.target),
            Some(bytes) => {
                WholeFile::write(&self.target, |out| out.write_all(&bytes)).and_then(WholeFile::commit)
            }
        };
    }
}

/// The system's word alone, without the name of the temporary file.
fn plain(error: &io::Error) -> io::Error {
    let inner = error.get_ref().and_then(|inner| inner.source()).and_then(|inner| inner.downcast_ref());
    match inner.unwrap_or(error).raw_os_error() {
        Some(code) => io::Error::from_raw_os_error(code),
        None => io::Error::from(error.kind()),
    }
}

/// The file that a rename may replace: `path`, or what it links to. Refuses directories and devices.
fn target(path: &Path) -> io::Result<PathBuf> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory, not a file"))
        }
        // A rename onto /dev/null would succeed for root, and there would be no /dev/null.
        Ok(found) if !found.is_file() => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a device or a pipe, not a file"))
        }
        Ok(_) if path.is_symlink() => fs::canonicalize(path),
        Ok(_) => Ok(path.to_path_buf()),
        Err(absent) if absent.kind() == io::ErrorKind::NotFound => {
            let end = end_of_links(path)?;
            let directory = directory(&end);
            if directory.is_dir() {
                return Ok(end);
            }
            let reason = format!("there is no directory {}", directory.display());
            Err(io::Error::new(io::ErrorKind::NotFound, reason))
        }
        Err(other) => Err(other),
    }
}

/// Where symbolic links lead that end in nothing; links in a circle were told of by the system.
fn end_of_links(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut end = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if !end.is_symlink() {
            break;
        }
        let next = fs::read_link(&end)?;
        // Relative to the folder of the link, or absolute.
        end = directory(&end).join(next);
    }
    Ok(end)
}

/// The directory of a file; the current one for a bare name.
fn directory(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pending(path: &Path, text: &str) -> WholeFile {
        WholeFile::write(path, |out| out.write_all(text.as_bytes())).unwrap()
    }

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn nothing_appears_before_the_commit_and_nothing_stays_without_one() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("a");
        fs::write(&path, "old").unwrap();
        drop(pending(&path, "new"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        pending(&path, "new").commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(names(home.path()), ["a"]);
    }

    #[test]
    fn a_failed_fill_or_rename_leaves_nothing() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("a");
        let full = |out: &mut BufWriter<&mut File>| {
            out.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        };
        assert_eq!(WholeFile::write(&path, full).err().unwrap().kind(), io::ErrorKind::StorageFull);
        assert!(names(home.path()).is_empty());

        // The target turns into a directory between the check and the rename.
        let late = pending(&path, "new");
        fs::create_dir(&path).unwrap();
        assert!(late.commit().is_err());
        assert_eq!(names(home.path()), ["a"]);
    }

    #[test]
    fn a_replacement_can_be_undone() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("a");
        pending(&path, "first").replace().unwrap().undo();
        assert!(names(home.path()).is_empty());
        fs::write(&path, "old").unwrap();
        let replaced = pending(&path, "new").replace().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        replaced.undo();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(home.path()), ["a"]);
    }

    /// The second of three cannot take its name: the first has what it had, or is gone.
    #[test]
    fn files_appear_together_or_not_at_all() {
        let home = tempfile::tempdir().unwrap();
        let paths = ["a", "b", "c"].map(|name| home.path().join(name));
        for there_before in [true, false] {
            if there_before {
                fs::write(&paths[0], "old").unwrap();
            } else {
                fs::remove_file(&paths[0]).unwrap();
            }
            let files = paths.each_ref().map(|path| pending(path, "new"));
            fs::remove_file(&files[1].file).unwrap();
            let (path, _) = commit_all(files.into()).unwrap_err();
            assert_eq!(path, paths[1]);
            let left = if there_before { &["a"][..] } else { &[] };
            assert_eq!(names(home.path()), left);
            assert!(!there_before || fs::read_to_string(&paths[0]).unwrap() == "old");
        }
        // A folder that has come in between is found out before any takes its name.
        let files = paths.each_ref().map(|path| pending(path, "new"));
        fs::create_dir(&paths[2]).unwrap();
        assert!(commit_all(files.into()).is_err());
        assert_eq!(names(home.path()), ["c"]);
        fs::remove_dir(&paths[2]).unwrap();
        fs::write(&paths[1], "old").unwrap();
        commit_all(paths.each_ref().map(|path| pending(path, "new")).into()).unwrap();
        assert!(paths.iter().all(|path| fs::read_to_string(path).unwrap() == "new"));
        assert_eq!(names(home.path()).len(), 3);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_written_through_and_a_device_is_refused() {
        let home = tempfile::tempdir().unwrap();
        let (file, link) = (home.path().join("file"), home.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        pending(&link, "new").commit().unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        let refused = WholeFile::write(Path::new("/dev/null"), |_| Ok(())).err().unwrap();
        assert_eq!(refused.kind(), io::ErrorKind::InvalidInput);
    }
}
