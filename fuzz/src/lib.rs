//! What the targets share.

#![forbid(unsafe_code)]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use fsot::SampleTable;
use tempfile::TempDir;

/// A file of this name with these bytes, in a folder of this process.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    static HOME: OnceLock<TempDir> = OnceLock::new();
    let home = HOME.get_or_init(|| tempfile::tempdir().expect("a folder for the input"));
    let path = home.path().join(name);
    // Not emptied, after which some file systems wait for the disk.
    let _ = fs::remove_file(&path);
    fs::write(&path, bytes).expect("the input");
    path
}

/// What a table promises.
pub fn check(table: &SampleTable) {
    assert!(table.values().iter().all(|value| (0.0..1.0).contains(value)));
    assert_eq!(table.values().len(), table.shape().iter().product::<usize>());
}

/// A picture is read, or refused; small ones are made densities of.
pub fn picture(path: &Path) {
    use fsot::targets::{Density, Picture, Tone};
    let Ok(picture) = Picture::open(path) else { return };
    assert_eq!(picture.pixels().len(), picture.width() * picture.height());
    if picture.pixels().len() < 1 << 14 {
        for tone in [Tone::Dark, Tone::Bright] {
            let _ = Density::from_picture(&picture, tone);
        }
    }
}
