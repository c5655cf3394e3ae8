//! Several files that are one table, without a record: as other people's textures come.

use std::fs;

use fsot::files::{ExportOptions, Format, ImportError, ImportOptions, Rounding, TableError};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{Home, export_as, import, table};

fn refusal(path: &std::path::Path) -> ImportError {
    let error = SampleTable::import(path, &ImportOptions::default()).unwrap_err();
    let text = error.to_string();
    assert!(!text.contains('\n') && text.len() < 500, "{text}");
    match error {
        TableError::Import { problem, .. } => problem,
        other => panic!("{other}"),
    }
}

#[test]
fn a_pattern_reads_what_a_pattern_wrote() {
    let table = table((Extent::animation(12, 5, 5).with_spp(2), 8));
    let name = "noise-{sample}_{dims}.{frame}";
    for format in [Format::Slices, Format::Exr] {
        let options = ExportOptions { name: Some(name.into()), ..ExportOptions::new(format) };
        let extension = if format == Format::Slices { "png" } else { "exr" };
        let Home { home, exported, .. } = export_as(&table, &format!("noise.{extension}"), &options);
        fs::remove_file(&exported.record_path).unwrap();
        let pattern = home.path().join(format!("{name}.{extension}"));
        let imported = import(&pattern);
        // Twelve frames: 10 comes after 9, and not after 1.
        assert_eq!(imported.table, table.quantized(options.depth(), Rounding::Floor), "{format}");
        assert!(imported.dtype.starts_with("48 files, "), "{}", imported.dtype);

        let gone = home.path().join(format!("noise-1_4-7.3.{extension}"));
        let bytes = fs::read(&gone).unwrap();
        fs::remove_file(&gone).unwrap();
        assert_eq!(refusal(&pattern), ImportError::MissingFile { frame: 3, sample: 1, dim: 4 });
        fs::write(&gone, &bytes).unwrap();
        import(&pattern);
    }
}

#[test]
fn what_is_no_set_is_refused() {
    let home = tempdir().unwrap();
    let pattern = home.path().join("noise{frame}.dat");
    assert_eq!(refusal(&pattern), ImportError::NoFiles);
    let write = |name: &str, text: &str| fs::write(home.path().join(name), text).unwrap();
    write("noise0.dat", "0.5 0.25\n0.125 0\n");
    write("noise2.dat", "0.5 0.25\n0.125 0.75\n");
    write("noise.dat", "is none");
    write("noise1.dat.bak", "is none");
    assert_eq!(refusal(&pattern), ImportError::Gap { place: "{frame}", before: 0, after: 2 });
    write("noise1.dat", "0.5 0.25 0.5\n0.125 0.75 0.5\n0.5 0.5 0.5\n");
    assert!(matches!(refusal(&pattern), ImportError::UnlikeShapes { .. }));
    write("noise1.dat", "0.5 0.125\n0.125 0.75\n");
    let imported = import(&pattern);
    assert_eq!(imported.table.shape(), [3, 2, 2, 1, 1]);
    assert_eq!(imported.table.values()[..8], [0.5, 0.25, 0.125, 0.0, 0.5, 0.125, 0.125, 0.75]);
    write("noise01.dat", "0.5 0.125\n0.125 0.75\n");
    assert!(matches!(refusal(&pattern), ImportError::SameNumber { .. }));
}
