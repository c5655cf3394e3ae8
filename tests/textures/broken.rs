//! Damaged files are refused in words: no panic, no memory beyond reason.

use std::fs;

use fsot::files::{ExportOptions, Format, ImportOptions, TableError};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

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

/// A picture that its bytes cannot hold is refused before memory is asked for it.
#[test]
fn a_png_that_claims_too_much_is_told_of_by_its_size() {
    let home = tempdir().unwrap();
    let path = home.path().join("huge.png");
    let mut header = b"IHDR".to_vec();
    header.extend(60_000_u32.to_be_bytes());
    header.extend(60_000_u32.to_be_bytes());
    header.extend([16, 6, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for chunk in [&header[..], b"IDAT\x78\x01\x01"] {
        bytes.extend((chunk.len() as u32 - 4).to_be_bytes());
        bytes.extend(chunk);
        bytes.extend(crc32(chunk).to_be_bytes());
    }
    fs::write(&path, &bytes).unwrap();
    let error = SampleTable::import(&path, &ImportOptions::default()).unwrap_err().to_string();
    let words = format!("60000 x 60000 pixels are more than its {} bytes can hold", bytes.len());
    assert!(error.contains(&words), "{error}");
    assert!(error.ends_with("write it anew, or give another file"), "{error}");
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(
            crc ^ u32::from(byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
        )
    })
}
