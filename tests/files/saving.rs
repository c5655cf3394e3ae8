//! Files appear whole or not at all.

use std::fs;
use std::path::Path;

use fsot::SampleTable;
use fsot::files::{Metadata, TableError};
use tempfile::tempdir;

use crate::{EXTENT, metadata, names, saved, table};

#[test]
fn a_table_cannot_have_the_name_of_its_metadata() {
    let home = tempdir().unwrap();
    let table = table(2);
    for name in ["table.json", "table.JSON", ".."] {
        let path = home.path().join(name);
        for error in [
            table.save(&path).unwrap_err(),
            table.save_with(&path, &metadata(&table)).unwrap_err(),
            SampleTable::load(&path).unwrap_err(),
            Metadata::load(&path).unwrap_err(),
        ] {
            let text = error.to_string();
            assert!(text.contains(name) && text.contains("ends in .npy"), "{text}");
            assert!(matches!(error, TableError::FileName { .. }), "{error:?}");
        }
    }
    assert!(matches!(table.save("").unwrap_err(), TableError::FileName { .. }));
    assert!(names(home.path()).is_empty());
}

#[test]
fn a_failed_save_leaves_everything_as_it_was() {
    let (home, old, bytes) = saved();
    let new = SampleTable::white_noise(EXTENT, 2, 8).unwrap();
    let refused = |path: &Path, word: &str| {
        for error in [new.save(path).unwrap_err(), new.save_with(path, &metadata(&new)).unwrap_err()] {
            let text = error.to_string();
            assert!(text.contains(word) && text.contains("check the path"), "{text}");
            assert!(matches!(error, TableError::Io { verb: "write", .. }), "{error:?}");
        }
    };
    refused(&home.path().join("absent/table.npy"), "there is no directory");
    // A file where a directory should be.
    refused(&home.path().join("table.npy/table.npy"), "cannot write");
    // A directory where the table should be.
    fs::create_dir(home.path().join("folder.npy")).unwrap();
    refused(&home.path().join("folder.npy"), "it is a directory");
    assert_eq!(names(home.path()), ["folder.npy", "table.json", "table.npy"]);
    fs::remove_dir(home.path().join("folder.npy")).unwrap();

    // A directory where the metadata should be: neither file is touched.
    fs::remove_file(home.path().join("table.json")).unwrap();
    fs::create_dir(home.path().join("table.json")).unwrap();
    let path = home.path().join("table.npy");
    let error = new.save_with(&path, &metadata(&new)).unwrap_err();
    assert!(error.to_string().contains("table.json: it is a directory"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), bytes[0]);
    assert_eq!(SampleTable::load(&path).unwrap(), old);
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
    assert!(names(&home.path().join("table.json")).is_empty());
}

#[cfg(unix)]
#[test]
fn saved_files_have_the_permissions_of_ordinary_files() {
    use std::os::unix::fs::PermissionsExt;
    let (home, ..) = saved();
    fs::write(home.path().join("ordinary"), "").unwrap();
    let mode = |name| fs::metadata(home.path().join(name)).unwrap().permissions().mode();
    assert_eq!([mode("table.npy"), mode("table.json")], [mode("ordinary"); 2]);
}

#[test]
fn saving_replaces_both_files() {
    let (home, ..) = saved();
    let path = home.path().join("table.npy");
    let new = table(5);
    new.save_with(&path, &metadata(&new)).unwrap();
    let (table, read) = SampleTable::load_with(&path).unwrap();
    assert_eq!((table, Metadata { sha256: None, ..read }), (new.clone(), metadata(&new)));
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
}

/// A link to a file that is not there yet, over two more links, one of them relative.
#[cfg(unix)]
#[test]
fn a_dangling_link_is_followed() {
    use std::os::unix::fs::symlink;
    let home = tempdir().unwrap();
    let inside = |name: &str| home.path().join(name);
    fs::create_dir(inside("tables")).unwrap();
    symlink("second.npy", inside("table.npy")).unwrap();
    symlink(inside("third.npy"), inside("second.npy")).unwrap();
    symlink("tables/goal.npy", inside("third.npy")).unwrap();
    let table = table(2);
    table.save(inside("table.npy")).unwrap();
    assert_eq!(fs::read_link(inside("table.npy")).unwrap(), Path::new("second.npy"));
    assert_eq!(names(&inside("tables")), ["goal.npy"]);
    assert_eq!(SampleTable::load(inside("table.npy")).unwrap(), table);
    table.save(inside("table.npy")).unwrap();
    assert_eq!(names(&inside("tables")), ["goal.npy"]);

    // Where it leads nowhere, or round in a circle, the link is named.
    symlink("missing/goal.npy", inside("lost.npy")).unwrap();
    symlink("circle.npy", inside("circle.npy")).unwrap();
    let before = names(home.path());
    for (name, word) in [("lost.npy", "missing"), ("circle.npy", "symbolic links")] {
        let text = table.save(inside(name)).unwrap_err().to_string();
        assert!(text.contains(name) && text.contains(word), "{text}");
    }
    assert_eq!(names(home.path()), before);
}

/// No message names the temporary file, which nobody has asked for.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_file_is_named() {
    let text = table(2).save("/proc/self/table.npy").unwrap_err().to_string();
    assert!(text.contains("/proc/self/table.npy") && !text.contains(".fsot-"), "{text}");
}

/// What only its owner could read stays so.
#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    fs::write(&path, "").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
    table(2).save(&path).unwrap();
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
}
