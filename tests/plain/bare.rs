//! `raw` and `fast`.

use std::fs;

use fsot::files::{Axis, Depth, Format, ImportOptions};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{ALL, assert_kept, export, import, kept, lengths, small_shapes, table};

#[test]
fn raw_numbers_lie_where_the_text_says() {
    for table in small_shapes() {
        let [_, height, width, spp, dims] = table.shape();
        for depth in [Depth::U8, Depth::U16, Depth::F32] {
            let home = export(&table, "mask.raw", Format::Raw, depth);
            let bytes = fs::read(&home.path).unwrap();
            let text_path = home.home.path().join("mask.raw.txt");
            assert_eq!(home.exported.files, [home.path.clone(), text_path.clone()]);
            let text = fs::read_to_string(text_path).unwrap();
            let index =
                format!("[(((frame * {height} + y) * {width} + x) * {spp} + sample) * {dims} + dim]\n");
            assert!(text.contains(&index), "{text}");
            assert_eq!(bytes.len(), table.values().len() * depth.bytes());
            for ((frame, y, x, sample, dim), value) in table.view().indexed_iter() {
                let at = (((frame * height + y) * width + x) * spp + sample) * dims + dim;
                let number = &bytes[at * depth.bytes()..][..depth.bytes()];
                let read = match *number {
                    [level] => (f32::from(level) + 0.5) / 256.0,
                    [low, high] => (f32::from(low) + 256.0 * f32::from(high) + 0.5) / 65536.0,
                    _ => f32::from_le_bytes(number.try_into().unwrap()),
                };
                assert_eq!(read, kept(*value, depth));
            }
        }
    }
}

#[test]
fn raw_numbers_are_read_by_their_text_and_by_options() {
    for table in small_shapes() {
        for depth in [Depth::U8, Depth::U16, Depth::F32] {
            let home = export(&table, "mask.raw", Format::Raw, depth).without_record();
            let by_text = home.import(&ImportOptions::default());
            assert_kept(&by_text.table, &table, depth, "by the text");
            assert_eq!(by_text.axes, Axis::ALL);
            fs::remove_file(home.home.path().join("mask.raw.txt")).unwrap();
            let dtype = ["u1", "<u2", "", "<f4"][depth as usize].parse().ok();
            let levels = depth.levels().map(u64::from);
            let by_options = home.import(&ImportOptions { dtype, levels, ..lengths(&table) });
            assert_kept(&by_options.table, &table, depth, "by options");
        }
    }
}

#[test]
fn halves_are_the_nearest_below_one() {
    let table = table((Extent::animation(2, 8, 8), 3));
    let home = export(&table, "mask.raw", Format::Raw, Depth::Half);
    let read = home.import(&ImportOptions::default()).table;
    // Eleven bits: half a unit of the last one at most, and 1 - 2^-11 at the end.
    for (read, value) in read.values().iter().zip(table.values()) {
        let unit = 2.0_f32.powi((value.log2().floor() as i32).max(-14) - 10);
        assert!((read - value).abs() <= 0.5 * unit || *read == 1.0 - 1.0 / 2048.0, "{value}: {read}");
    }
    let home = home.without_record();
    assert_eq!(home.import(&ImportOptions::default()).table, read);
}

/// Other people's bytes: another byte order, other axes, a description by hand.
#[test]
fn a_description_by_hand_is_read() {
    let home = tempdir().unwrap();
    let path = home.path().join("noise.bin");
    let bytes: Vec<u8> = (0..24_u16).flat_map(|level| (level * 2000).to_be_bytes()).collect();
    fs::write(&path, bytes).unwrap();
    let describe = |text: &str| fs::write(home.path().join("noise.bin.txt"), text).unwrap();
    describe("from a camera\nDtype: '>u2'\nshape: [2, 3, 4]\naxes: dim, y, x\nlevels: 65536\n");
    let imported = import(&path, &ImportOptions::default());
    assert_eq!(imported.table.shape(), [1, 3, 4, 1, 2]);
    assert_eq!(imported.table.view()[[0, 2, 1, 0, 1]], (2000.0 * 21.0 + 0.5) / 65536.0);
    assert_eq!(
        imported.to_string(),
        ">u2 of shape [1, 3, 4, 1, 2] as frame, y, x, sample, dim, 65536 levels as (v + 1/2) / 65536"
    );
    // In Fortran order, and without names.
    describe("dtype: >u2\nshape: 4 3 2\norder: Fortran\n");
    let imported = import(&path, &ImportOptions::default());
    assert_eq!(imported.table.shape(), [1, 4, 3, 1, 2]);
    assert_eq!(imported.table.view()[[0, 1, 2, 0, 1]], (2000.0 * 21.0 + 0.5) / 65536.0);
}

#[test]
fn fast_has_four_floats_a_texel() {
    for table in small_shapes() {
        let [frames, height, width, spp, dims] = table.shape();
        let home = export(&table, "init.bin", Format::Fast, Depth::F32);
        assert_eq!(home.exported.files.len(), spp);
        for (sample, path) in home.exported.files.iter().enumerate() {
            let bytes = fs::read(path).unwrap();
            assert_eq!(bytes.len(), frames * height * width * 16);
            let floats: Vec<f32> =
                bytes.chunks_exact(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
            for (z, y, x) in
                (0..frames).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| (z, y, x))))
            {
                let texel = &floats[4 * (z * width * height + y * width + x)..][..4];
                let expected: Vec<f32> = (0..dims).map(|dim| table.view()[[z, y, x, sample, dim]]).collect();
                assert_eq!(texel, [&expected, &[0.0, 0.0, 0.0, 1.0][dims..]].concat());
            }
        }
        // By options, as somebody reads it who has the file alone.
        if spp == 1 {
            let home = home.without_record();
            let dtype = "<f4".parse().ok();
            let options = ImportOptions { dtype, channels: Some(4), ..lengths(&table) };
            assert_eq!(home.import(&options).table, table);
        }
    }
}

/// All formats in one folder, each with its own record.
#[test]
fn every_format_can_be_told_from_the_others() {
    let table = table((Extent::still(16, 16), 1));
    let home = tempdir().unwrap();
    for (format, name, depths) in ALL {
        let options = fsot::files::ExportOptions::new(format);
        table.export(home.path().join(name), &options).unwrap();
        let imported = SampleTable::import(home.path().join(name), &ImportOptions::default()).unwrap();
        assert_kept(&imported.table, &table, depths[0], name);
    }
}
