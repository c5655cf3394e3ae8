//! What a format cannot hold is said in words, and nothing is written; following the words succeeds.

use std::fs;
use std::path::Path;

use fsot::files::{Depth, ExportError, ExportOptions, Format};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{ALL, names, table};

fn options(format: Format, depth: Option<Depth>, name: Option<&str>) -> ExportOptions {
    ExportOptions { depth, name: name.map(String::from), ..ExportOptions::new(format) }
}

/// The refusal, which is one line; nothing new is in the folder.
fn refusal(table: &SampleTable, path: &Path, options: &ExportOptions) -> ExportError {
    let before = names(path.parent().unwrap());
    let error = table.export(path, options).unwrap_err();
    let text = error.to_string();
    assert!(!text.contains('\n') && text.len() < 400, "{text}");
    assert_eq!(names(path.parent().unwrap()), before, "{text}");
    let planned = options.files(path, table.extent(), table.dims());
    let is_of_the_system = matches!(error, ExportError::Io { .. });
    assert!(is_of_the_system || planned.unwrap_err().to_string() == text);
    error
}

#[test]
fn numbers_that_a_format_has_not_are_refused() {
    let table = table((Extent::animation(2, 4, 4), 2));
    let home = tempdir().unwrap();
    for (format, name, depths) in ALL {
        for depth in Depth::ALL.into_iter().filter(|depth| !depths.contains(depth)) {
            let path = home.path().join(name);
            let error = refusal(&table, &path, &options(format, Some(depth), None));
            let ExportError::Depth { holds, given, .. } = &error else { panic!("{error}") };
            assert_eq!(*given, depth.name());
            for advised in holds.split(" or ") {
                let advised = options(format, Some(advised.parse().unwrap()), None);
                table.export(home.path().join(name), &advised).unwrap();
            }
            names(home.path()).iter().for_each(|name| fs::remove_file(home.path().join(name)).unwrap());
        }
    }
}

#[test]
fn names_that_are_none_are_refused() {
    let table = table((Extent::animation(2, 4, 4).with_spp(2), 5));
    let home = tempdir().unwrap();
    for (format, name, _) in ALL {
        for bad in ["mask", "mask.npy", ".png", "mask.png.txt"] {
            let error = refusal(&table, &home.path().join(bad), &options(format, None, None));
            let ExportError::FileName { extension, .. } = error else { panic!("{error}") };
            assert!(name.ends_with(extension));
        }
    }
    let path = home.path().join("mask.png");
    for pattern in ["{frame", "frame}", "{}", "{colour}", "{frame}{{", "a/{frame}", "", "{name}/../x"] {
        let error = refusal(&table, &path, &options(Format::Slices, None, Some(pattern)));
        assert!(matches!(error, ExportError::Pattern { .. }), "{pattern}: {error}");
    }
    // Each refusal names a place that is missing; at the end none is.
    let mut pattern = String::from("noise");
    let mut asked = Vec::new();
    while let Err(error) = table.export(&path, &options(Format::Slices, None, Some(&pattern))) {
        let ExportError::SameName { place, .. } = error else { panic!("{error}") };
        asked.push(place);
        pattern = format!("{pattern}-{place}");
    }
    asked.sort_unstable();
    assert_eq!(asked, ["{dims}", "{frame}", "{sample}"]);
    assert_eq!(names(home.path()).len(), 2 * 2 * 2 + 1);
}

/// A folder where one of the files should be: none of the others is there, and what was there is untouched.
#[test]
fn all_files_appear_or_none() {
    let table = table((Extent::animation(3, 4, 4), 2));
    for (format, name, taken) in [
        (Format::Slices, "mask.png", "mask_vec2_2Dx1D_4x4x3_1.png"),
        (Format::Exr, "mask.exr", "mask_vec2_2Dx1D_4x4x3_2.exr"),
        (Format::Atlas, "mask.png", "mask.png"),
        (Format::Ktx2, "mask.ktx2", "mask.ktx2.json"),
    ] {
        let home = tempdir().unwrap();
        let path = home.path().join(name);
        fs::create_dir(home.path().join(taken)).unwrap();
        let first = format!("mask_vec2_2Dx1D_4x4x3_0.{}", &name[5..]);
        fs::write(home.path().join(&first), "old").unwrap();
        let error = refusal(&table, &path, &options(format, None, None));
        assert!(error.to_string().contains(&format!("{taken}: it is a directory")), "{error}");
        assert_eq!(fs::read_to_string(home.path().join(&first)).unwrap(), "old");
        // Out of the way, all of them are there.
        fs::remove_dir(home.path().join(taken)).unwrap();
        let exported = table.export(&path, &options(format, None, None)).unwrap();
        assert!(exported.files.iter().all(|file| file.is_file()) && exported.record_path.is_file());
    }
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let table = table((Extent::still(4, 4), 2));
    let home = tempdir().unwrap();
    let path = home.path().join("nowhere").join("mask.png");
    let error = table.export(&path, &options(Format::Atlas, None, None)).unwrap_err();
    assert!(error.to_string().contains("there is no directory"), "{error}");
    fs::create_dir(home.path().join("nowhere")).unwrap();
    table.export(&path, &options(Format::Atlas, None, None)).unwrap();
}
