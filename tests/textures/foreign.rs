//! Textures as others write them: grey in three channels, palettes, alpha of 1, few bits, interlaced.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use fsot::files::{Axis, ImportOptions, Imported};
use fsot::{Extent, SampleTable};
use image::{ImageBuffer, Luma, LumaA, Rgb, Rgba};
use tempfile::{TempDir, tempdir};

fn path(home: &TempDir) -> PathBuf {
    home.path().join("texture.png")
}

fn import_with(path: &Path, options: &ImportOptions) -> Imported {
    SampleTable::import(path, options).unwrap()
}

fn import(path: &Path) -> Imported {
    import_with(path, &ImportOptions::default())
}

/// Each of 256 levels once.
fn level(x: u32, y: u32) -> u8 {
    ((y * 16 + x) * 77 % 256) as u8
}

/// The level as a table has it.
fn value(x: usize, y: usize) -> f32 {
    (f32::from(level(x as u32, y as u32)) + 0.5) / 256.0
}

/// A table of one number a pixel, which is that level.
fn is_that(imported: &Imported, left_out: &[usize]) {
    assert_eq!(imported.table.shape(), [1, 16, 16, 1, 1]);
    assert_eq!(imported.left_out, left_out);
    let is_kept = |(at, read): (usize, &f32)| *read == value(at % 16, at / 16);
    assert!(imported.table.values().iter().enumerate().all(is_kept));
}

#[test]
fn channels_that_say_nothing_are_left_out() {
    let home = tempdir().unwrap();
    let path = path(&home);
    ImageBuffer::from_fn(16, 16, |x, y| Luma([level(x, y)])).save(&path).unwrap();
    is_that(&import(&path), &[]);
    ImageBuffer::from_fn(16, 16, |x, y| LumaA([level(x, y), 255])).save(&path).unwrap();
    is_that(&import(&path), &[1]);
    ImageBuffer::from_fn(16, 16, |x, y| Rgb([level(x, y); 3])).save(&path).unwrap();
    is_that(&import(&path), &[1, 2]);
    let gray = |x, y| {
        let [r, g, b] = [level(x, y); 3];
        Rgba([r, g, b, 255])
    };
    ImageBuffer::from_fn(16, 16, gray).save(&path).unwrap();
    let imported = import(&path);
    is_that(&imported, &[1, 2, 3]);
    let words = imported.to_string();
    assert!(words.contains("without channel 1, 2, 3, constant or like another"), "{words}");
    // Whoever wants them gets them.
    let options = ImportOptions { dims: Some(4), ..ImportOptions::default() };
    assert_eq!(import_with(&path, &options).table.shape(), [1, 16, 16, 1, 4]);
    let options = ImportOptions { axes: vec![Axis::Y, Axis::X, Axis::Frame], ..ImportOptions::default() };
    assert_eq!(import_with(&path, &options).table.shape(), [4, 16, 16, 1, 1]);
    let options = ImportOptions { spp: Some(2), ..ImportOptions::default() };
    assert_eq!(import_with(&path, &options).table.shape(), [1, 16, 16, 2, 2]);
    // Directions have three channels that say something.
    ImageBuffer::from_fn(16, 16, |x, y| Rgba([level(x, y), level(y, x), level(x, 15 - y), 255]))
        .save(&path)
        .unwrap();
    assert_eq!((import(&path).table.shape(), import(&path).left_out), ([1, 16, 16, 1, 3], vec![3]));
    // A picture of one colour keeps a channel.
    ImageBuffer::from_pixel(4, 4, Rgb([7_u8, 7, 200])).save(&path).unwrap();
    let options = ImportOptions { levels: Some(256), ..ImportOptions::default() };
    assert_eq!(import_with(&path, &options).table.shape(), [1, 4, 4, 1, 1]);
}

#[test]
fn frames_one_below_the_other_are_found() {
    let home = tempdir().unwrap();
    let path = path(&home);
    let deep = |x: u32, y: u32| LumaA([(x * 4099 + y * 257) as u16, (x * 521 + y * 8191) as u16]);
    ImageBuffer::from_fn(8, 64, deep).save(&path).unwrap();
    let imported = import(&path);
    assert_eq!(imported.table.shape(), [8, 8, 8, 1, 2]);
    assert_eq!(imported.table.view()[[3, 5, 2, 0, 1]], (f32::from(deep(2, 29).0[1]) + 0.5) / 65536.0);
    let words = imported.to_string();
    assert!(words.starts_with("PNG of 16 bits of shape [8, 8, 8, 2] as frame, y, x, dim"), "{words}");
    let frames = |frames| ImportOptions { frames: Some(frames), ..ImportOptions::default() };
    assert_eq!(import_with(&path, &frames(1)).table.shape(), [1, 64, 8, 1, 2]);
    assert_eq!(import_with(&path, &frames(4)).table.shape(), [4, 16, 8, 1, 2]);
    ImageBuffer::from_fn(8, 12, deep).save(&path).unwrap();
    assert_eq!(import(&path).table.shape(), [1, 12, 8, 1, 2]);
}

/// Few bits, palettes and interlacing are ways to write the same numbers.
#[test]
fn every_kind_of_png_is_read() {
    let home = tempdir().unwrap();
    let path = path(&home);
    let write = |color, depth, palette: Option<Vec<u8>>, data: &[u8]| {
        let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 4, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if let Some(palette) = palette {
            encoder.set_palette(palette);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
    };
    use png::{BitDepth, ColorType};
    let eighths = [0.5, 1.5, 2.5, 3.5].map(|level| level / 4.0);
    write(ColorType::Grayscale, BitDepth::Two, None, &[0b00_01_10_11, 0b11_10_01_00]);
    let imported = import(&path);
    assert_eq!(
        (imported.table.values(), imported.levels),
        (
            &[eighths, {
                let mut turned = eighths;
                turned.reverse();
                turned
            }]
            .concat()[..],
            Some(4)
        )
    );
    write(ColorType::Grayscale, BitDepth::One, None, &[0b0110_0000, 0b1001_0000]);
    assert_eq!(import(&path).table.values(), [0.25, 0.75, 0.75, 0.25, 0.75, 0.25, 0.25, 0.75]);
    // Colours of a palette, which are grey.
    let palette = [0, 17, 130, 255].iter().flat_map(|&grey| [grey; 3]).collect();
    write(ColorType::Indexed, BitDepth::Two, Some(palette), &[0b00_01_10_11, 0b11_10_01_00]);
    let imported = import(&path);
    assert_eq!(
        (imported.table.values()[..4].to_vec(), imported.left_out.len()),
        ([0.5_f32, 17.5, 130.5, 255.5].map(|level| level / 256.0).to_vec(), 2)
    );
}

/// A gamma that a file speaks of changes no number.
#[test]
fn colours_are_not_managed() {
    let home = tempdir().unwrap();
    let path = path(&home);
    let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 16, 16);
    encoder.set_source_gamma(png::ScaledFloat::new(1.0 / 2.2));
    let levels: Vec<u8> = (0..256).map(|at| level(at % 16, at / 16)).collect();
    encoder.write_header().unwrap().write_image_data(&levels).unwrap();
    is_that(&import(&path), &[]);
}

/// Volumes, and bytes that are said to be colours.
#[test]
fn kinds_of_ktx2_are_read() {
    let home = tempdir().unwrap();
    let path = home.path().join("texture.ktx2");
    let table = SampleTable::white_noise(Extent::animation(3, 4, 5), 2, 1).unwrap();
    let exported = table.export(&path, &fsot::files::ExportOptions::new(fsot::files::Format::Ktx2)).unwrap();
    fs::remove_file(exported.record_path).unwrap();
    let array = import(&path);
    let bytes = fs::read(&path).unwrap();
    let changed = |at: usize, word: u32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    // R8G8_SRGB and R8G8_UINT.
    for format in [22, 20] {
        fs::write(&path, changed(12, format)).unwrap();
        assert_eq!(import(&path).table, array.table);
    }
    // Three slices of a volume instead of three layers.
    let mut volume = changed(28, 3);
    volume[32..36].copy_from_slice(&[0; 4]);
    fs::write(&path, volume).unwrap();
    assert_eq!(import(&path).table, array.table);
    for (at, word, words) in [
        (12, 145, "texels of VkFormat 145"),
        (12, 0, "texels of VkFormat 0"),
        (36, 6, "has 6 faces"),
        (44, 2, "is supercompressed"),
        (20, 6, "its texels take"),
    ] {
        fs::write(&path, changed(at, word)).unwrap();
        let error = SampleTable::import(&path, &ImportOptions::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
