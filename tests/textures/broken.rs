//! Damaged files are refused in words: no panic, no memory beyond reason.

use std::fs;

use fsot::files::{ExportOptions, Format, ImportOptions, TableError};
use fsot::{Extent, SampleTable};

use crate::{Home, export_as, table};

/// Every cut and, at every place, some other bytes.
#[test]
fn no_damage_is_more_than_a_refusal() {
    let table = table((Extent::animation(2, 3, 4), 2));
    for (format, name) in [
        (Format::Atlas, "mask.png"),
        (Format::Ktx2, "mask.ktx2"),
        (Format::ExrLayers, "mask.exr"),
        (Format::Exr, "mask.exr"),
    ] {
        let Home { exported, home: _home, .. } = export_as(&table, name, &ExportOptions::new(format));
        fs::remove_file(&exported.record_path).unwrap();
        let path = &exported.files[0];
        let bytes = fs::read(path).unwrap();
        let attempt = |bytes: &[u8]| {
            fs::write(path, bytes).unwrap();
            match SampleTable::import(path, &ImportOptions::default()) {
                Ok(imported) => assert!(imported.table.values().iter().all(|v| (0.0..1.0).contains(v))),
                Err(error) => {
                    let text = error.to_string();
                    assert!(!text.contains('\n') && text.len() < 700, "{text}");
                    assert!(!matches!(error, TableError::Extent(_)), "{text}");
                }
            }
        };
        (0..bytes.len()).for_each(|end| attempt(&bytes[..end]));
        for at in 0..bytes.len() {
            for other in [0, 0x7f, 0xff, bytes[at] ^ 1] {
                let mut damaged = bytes.clone();
                damaged[at] = other;
                attempt(&damaged);
            }
        }
    }
}

/// A record is believed as far as the files agree.
#[test]
fn records_that_lie_are_refused() {
    let table = table((Extent::animation(2, 3, 4).with_spp(2), 2));
    let Home { path, exported, home } = export_as(&table, "mask.png", &ExportOptions::new(Format::Atlas));
    let record = fs::read_to_string(&exported.record_path).unwrap();
    let import = || SampleTable::import(&path, &ImportOptions::default());
    import().unwrap();
    for (from, to) in [
        ("mask_s0.png", "../mask_s0.png"),
        ("mask_s0.png", "mask_s1.png"),
        ("mask_s0.png", "mask_s7.png"),
        ("\"bits\": \"8\"", "\"bits\": \"16\""),
        ("\"kind\": \"fsot export 1\"", "\"kind\": \"fsot export 2\""),
        (&exported.record.sha256[..8], "01234567"),
        ("\"shape\"", "\"form\""),
    ] {
        assert!(record.contains(from), "{from}");
        fs::write(&exported.record_path, record.replacen(from, to, 1)).unwrap();
        let error = import().unwrap_err().to_string();
        assert!(!error.contains('\n'), "{from} -> {to}: {error}");
    }
    fs::write(&exported.record_path, &record).unwrap();
    import().unwrap();
    // Another picture of the same size under the same name.
    fs::copy(home.path().join("mask_s1.png"), home.path().join("mask_s0.png")).unwrap();
    let error = import().unwrap_err().to_string();
    assert!(error.contains("other values than were exported"), "{error}");
    // As the words say.
    fs::remove_file(&exported.record_path).unwrap();
    SampleTable::import(home.path().join("mask_s0.png"), &ImportOptions::default()).unwrap();
}
