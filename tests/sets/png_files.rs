//! What the chunks of a PNG file say about its light.

use std::fs::File;
use std::path::Path;

use fsot::targets::{Density, Inks, Picture, PictureError, PictureOptions, Tone, Transfer};
use moxcms::{ColorProfile, ToneReprCurve};
use png::chunk::ChunkType;
use png::{BitDepth, ColorType, ScaledFloat};

/// One pixel per grey of `levels`, with chunks before the pixels.
fn grey(path: &Path, levels: &[u8], chunks: &[(&[u8; 4], &[u8])]) {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), levels.len() as u32, 1);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    for (name, data) in chunks {
        writer.write_chunk(ChunkType(**name), data).unwrap();
    }
    writer.write_image_data(levels).unwrap();
}

fn bright(path: &Path) -> Vec<f32> {
    Density::open(path, Tone::Bright).unwrap().values().to_vec()
}

fn near(values: &[f32], expected: &[f32]) {
    let close = values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6 + 1e-4 * b);
    assert!(values.len() == expected.len() && close, "{values:?} instead of {expected:?}");
}

#[test]
fn a_gamma_of_one_is_linear() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("linear.png");
    grey(&path, &[128, 255], &[(b"gAMA", &gamma(1.0))]);
    near(&bright(&path), &[128.0 / 255.0, 1.0]);
    grey(&path, &[128, 255], &[(b"gAMA", &gamma(1.0 / 1.8))]);
    near(&bright(&path), &[(128.0_f32 / 255.0).powf(1.8), 1.0]);
}

#[test]
fn code_points_name_the_curve() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("coded.png");
    grey(&path, &[128, 255], &[(b"cICP", &[1, 8, 0, 1])]);
    near(&bright(&path), &[128.0 / 255.0, 1.0]);
    grey(&path, &[148, 255], &[(b"cICP", &[9, 16, 0, 1])]);
    // 203 cd/m², the white of paper, lies at 0.5807 of the PQ scale, 148.07 of 255.
    near(&bright(&path)[1..], &[10000.0 / 203.0]);
    assert!((bright(&path)[0] - 1.0).abs() < 0.01);
}

fn gamma(gamma: f32) -> [u8; 4] {
    ScaledFloat::new(gamma).into_scaled().to_be_bytes()
}

fn options(transfer: Transfer) -> PictureOptions {
    PictureOptions { transfer, ..PictureOptions::default() }
}

const SRGB_128: f32 = 0.215_86;
const LINEAR_128: f32 = 128.0 / 255.0;

#[test]
fn chunks_count_in_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chunks.png");
    let light = |chunks: &[(&[u8; 4], &[u8])]| {
        grey(&path, &[128, 255], chunks);
        bright(&path)[0]
    };
    let close = |light: f32, expected: f32| assert!((light - expected).abs() < 1e-4, "{light} {expected}");
    close(light(&[]), SRGB_128);
    close(light(&[(b"sRGB", &[0]), (b"gAMA", &gamma(1.0))]), SRGB_128);
    close(light(&[(b"cICP", &[1, 8, 0, 1]), (b"sRGB", &[0]), (b"gAMA", &gamma(1.0))]), LINEAR_128);
    close(light(&[(b"cICP", &[1, 13, 0, 1]), (b"gAMA", &gamma(1.0))]), SRGB_128);
    // Unspecified.
    close(light(&[(b"cICP", &[2, 2, 0, 1]), (b"gAMA", &gamma(1.0))]), LINEAR_128);
    // What sRGB's curve is said to be, and what paints nothing.
    close(light(&[(b"gAMA", &gamma(0.45455)), (b"bKGD", &[0, 200]), (b"sBIT", &[5])]), SRGB_128);
    // The curve of BT.709, and a power.
    close(light(&[(b"cICP", &[1, 1, 0, 1])]), ((LINEAR_128 + 0.0993) / 1.0993).powf(1.0 / 0.45));
    close(light(&[(b"cICP", &[1, 4, 0, 1])]), LINEAR_128.powf(2.2));
}

#[test]
fn what_is_not_understood_is_refused_until_it_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.png");
    for (chunk, word) in [
        ((b"cICP", [9, 18, 0, 1]), "HLG"),
        ((b"cICP", [1, 99, 0, 1]), "99"),
        ((b"cICP", [77, 13, 0, 1]), "77"),
        ((b"cICP", [1, 13, 0, 0]), "narrow"),
        ((b"gAMA", gamma(20.0)), "20"),
    ] {
        grey(&path, &[128, 255], &[(chunk.0, &chunk.1)]);
        let error = Density::open(&path, Tone::Bright).unwrap_err();
        assert!(
            matches!(error, PictureError::Encoding { .. }) && error.to_string().contains(word),
            "{error}"
        );
        for (transfer, expected) in [(Transfer::Srgb, SRGB_128), (Transfer::Linear, LINEAR_128)] {
            let said = Density::open_with(&path, Tone::Bright, &options(transfer)).unwrap();
            near(said.values(), &[expected, 1.0]);
        }
    }
}

/// One pixel, with a profile.
fn profiled(path: &Path, color: ColorType, pixel: &[u8], profile: &[u8]) -> Result<f32, PictureError> {
    let mut info = png::Info::with_size(1, 1);
    info.color_type = color;
    info.bit_depth = BitDepth::Eight;
    info.icc_profile = Some(profile.into());
    let encoder = png::Encoder::with_info(File::create(path).unwrap(), info).unwrap();
    encoder.write_header().unwrap().write_image_data(pixel).unwrap();
    Ok(Density::open(path, Tone::Bright)?.values()[0])
}

#[test]
fn profiles_of_curves_and_a_matrix_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("profile.png");
    let srgb = ColorProfile::new_srgb().encode().unwrap();
    let grey = [128; 3];
    assert_eq!(profiled(&path, ColorType::Rgb, &grey, &srgb).unwrap(), {
        image::RgbImage::from_pixel(1, 1, image::Rgb(grey)).save(&path).unwrap();
        bright(&path)[0]
    });
    // As painting programs save linear light.
    let mut linear = ColorProfile::new_srgb();
    let line = Some(ToneReprCurve::Lut(vec![]));
    (linear.red_trc, linear.green_trc, linear.blue_trc) = (line.clone(), line.clone(), line);
    // Code points would say that it is sRGB.
    linear.cicp = None;
    let linear = linear.encode().unwrap();
    near(&[profiled(&path, ColorType::Rgb, &grey, &linear).unwrap()], &[LINEAR_128]);
    // The red of P3 has .2290 of the light of its white.
    let p3 = ColorProfile::new_display_p3().encode().unwrap();
    let red = profiled(&path, ColorType::Rgb, &[255, 0, 0], &p3).unwrap();
    assert!((red - 0.2290).abs() < 5e-4, "{red}");
    let gray = ColorProfile::new_gray_with_gamma(1.8).encode().unwrap();
    let light = profiled(&path, ColorType::Grayscale, &[128], &gray).unwrap();
    assert!((light - LINEAR_128.powf(1.8)).abs() < 0.002, "{light}");
    // A profile of grey for colours, and none at all.
    for profile in [&gray[..], b"no profile"] {
        let error = profiled(&path, ColorType::Rgb, &grey, profile).unwrap_err();
        assert!(matches!(error, PictureError::Encoding { .. }), "{error}");
        assert!(Density::open_with(&path, Tone::Bright, &options(Transfer::Srgb)).is_ok());
    }
}

#[test]
fn chromaticities_are_those_of_the_colours() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.png");
    let save = |chromaticities: png::SourceChromaticities| {
        let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 1, 1);
        encoder.set_color(ColorType::Rgb);
        encoder.set_source_gamma(ScaledFloat::new(1.0));
        encoder.set_source_chromaticities(chromaticities);
        encoder.write_header().unwrap().write_image_data(&[255, 0, 0]).unwrap();
        Density::open(&path, Tone::Bright).map(|density| density.values()[0])
    };
    let [white, red] = [(0.3127, 0.329), (0.708, 0.292)];
    let wide = png::SourceChromaticities::new(white, red, (0.17, 0.797), (0.131, 0.046));
    let light = save(wide).unwrap();
    assert!((light - 0.2627).abs() < 1e-4, "{light}");
    let flat = png::SourceChromaticities::new(white, red, red, (0.131, 0.046));
    assert!(matches!(save(flat), Err(PictureError::Encoding { .. })));
}

/// The directory of an `eXIf` chunk that says how a picture is turned.
fn exif(orientation: u8, is_big: bool) -> Vec<u8> {
    let other = [0x01, 0x0f, 0, 2, 0, 0, 0, 1, 0, 0, 0, 0];
    let entry = [0x01, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0];
    match is_big {
        true => [&b"MM\0*\0\0\0\x08\0\x02"[..], &other, &entry, &[0; 4]].concat(),
        false => {
            let entry = [0x12, 0x01, 3, 0, 1, 0, 0, 0, orientation, 0, 0, 0];
            [&b"II*\0\x08\0\0\0\x01\0"[..], &entry, &[0; 4]].concat()
        }
    }
}

#[test]
fn pictures_are_turned_as_cameras_say() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("turned.png");
    let stored = image::GrayImage::from_fn(3, 2, |x, y| image::Luma([(40 * x + 100 * y) as u8]));
    for orientation in 0..=9_u8 {
        let mut turned = image::DynamicImage::from(stored.clone());
        turned.apply_orientation(
            image::metadata::Orientation::from_exif(orientation)
                .unwrap_or(image::metadata::Orientation::NoTransforms),
        );
        turned.save(&path).unwrap();
        let expected = Picture::open(&path).unwrap();
        for (is_big, is_before) in [(true, true), (false, true), (true, false), (false, false)] {
            let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 3, 2);
            encoder.set_color(ColorType::Grayscale);
            let mut writer = encoder.write_header().unwrap();
            let chunk = || exif(orientation, is_big);
            if is_before {
                writer.write_chunk(ChunkType(*b"eXIf"), &chunk()).unwrap();
            }
            writer.write_image_data(&stored).unwrap();
            if !is_before {
                writer.write_chunk(ChunkType(*b"eXIf"), &chunk()).unwrap();
            }
            drop(writer);
            assert_eq!(Picture::open(&path).unwrap(), expected, "{orientation} {is_big} {is_before}");
        }
    }
    // Damaged ones turn nothing.
    let whole = exif(6, true);
    for length in 0..whole.len() - 4 {
        grey(&path, &[10, 20, 30], &[(b"eXIf", &whole[..length])]);
        let size = Density::open(&path, Tone::Bright).unwrap().size();
        assert!(size == [3, 1] || length >= 34 - 2, "{length}");
    }
}

#[test]
fn pixels_become_square() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.png");
    let size = |x: u32, y: u32| {
        let sides = [x.to_be_bytes(), y.to_be_bytes()].concat();
        grey(&path, &[10, 20, 30], &[(b"pHYs", &[&sides[..], &[0]].concat())]);
        Density::open(&path, Tone::Bright).map(|density| density.size())
    };
    assert_eq!(size(1, 2).unwrap(), [6, 1]);
    assert_eq!(size(4, 1).unwrap(), [3, 4]);
    assert_eq!(size(2835, 2834).unwrap(), [3, 1]);
    assert_eq!(size(0, 7).unwrap(), [3, 1]);
    assert!(matches!(size(1, 65), Err(PictureError::Aspect { .. })));
}

/// zlib without compression.
fn stored(data: &[u8]) -> Vec<u8> {
    let sums = data.iter().fold([1_u32, 0], |[a, b], &byte| {
        let a = (a + u32::from(byte)) % 65521;
        [a, (b + a) % 65521]
    });
    let length = u16::try_from(data.len()).unwrap();
    let head = [&[0x78, 0x01, 0x01][..], &length.to_le_bytes(), &(!length).to_le_bytes()].concat();
    [&head[..], data, &(sums[1] << 16 | sums[0]).to_be_bytes()].concat()
}

#[test]
fn interlaced_files_are_read_as_plain_ones() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, laced] = ["plain.png", "laced.png"].map(|name| folder.path().join(name));
    for [width, height] in [[1, 1], [3, 2], [5, 9], [8, 8], [19, 23], [4, 1], [1, 5]] {
        let at =
            |x: usize, y: usize| [(13 * x + 7 * y) as u8, (x * y) as u8, (x ^ y) as u8, (9 * x) as u8 | 64];
        let picture = image::RgbaImage::from_fn(width as u32, height as u32, |x, y| {
            image::Rgba(at(x as usize, y as usize))
        });
        picture.save(&plain).unwrap();
        // First column and row, steps between columns and rows, as the specification has them.
        let passes = [
            [0, 0, 8, 8],
            [4, 0, 8, 8],
            [0, 4, 4, 8],
            [2, 0, 4, 4],
            [0, 2, 2, 4],
            [1, 0, 2, 2],
            [0, 1, 1, 2],
        ];
        let mut data = Vec::new();
        for [left, top, step, row_step] in passes {
            for y in (top..height).step_by(row_step).filter(|_| left < width) {
                data.push(0);
                (left..width).step_by(step).for_each(|x| data.extend(at(x, y)));
            }
        }
        let mut info = png::Info::with_size(width as u32, height as u32);
        (info.color_type, info.interlaced) = (ColorType::Rgba, true);
        let encoder = png::Encoder::with_info(File::create(&laced).unwrap(), info).unwrap();
        let mut writer = encoder.write_header().unwrap();
        writer.write_chunk(ChunkType(*b"IDAT"), &stored(&data)).unwrap();
        drop(writer);
        assert_eq!(Picture::open(&laced).unwrap(), Picture::open(&plain).unwrap(), "{width} x {height}");
        let options = PictureOptions { most_pixels: Some(20), ..PictureOptions::default() };
        let [one, other] = [&plain, &laced].map(|path| Picture::open_with(path, &options).unwrap());
        let pairs = one.pixels().iter().flatten().zip(other.pixels().iter().flatten());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-6), "{width} x {height}");
    }
}

#[test]
fn animations_show_their_still() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("moving.png");
    for is_separate in [true, false] {
        let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 2, 1);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_animated(2, 0).unwrap();
        encoder.set_sep_def_img(is_separate).unwrap();
        let mut writer = encoder.write_header().unwrap();
        let pictures = [[255, 0], [0, 255], [0, 255]];
        pictures.iter().take(2 + usize::from(is_separate)).for_each(|picture| {
            writer.write_image_data(picture).unwrap();
        });
        writer.finish().unwrap();
        assert_eq!(bright(&path), [1.0, 0.0], "{is_separate}");
    }
}

#[test]
fn large_pictures_are_averaged_mass_for_mass() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.png");
    let at = |x: u32, y: u32| image::Luma([((x * x + 3 * y * y + x * y) % 251) as u8]);
    image::GrayImage::from_fn(300, 170, at).save(&path).unwrap();
    let open = |most_pixels| {
        let options = PictureOptions { most_pixels, ..PictureOptions::default() };
        Density::open_with(&path, Tone::Dark, &options).unwrap()
    };
    let whole = open(None);
    assert_eq!(whole.size(), [300, 170]);
    let mean = |density: &Density| density.mass() / density.values().len() as f64;
    for most in [1, 2, 100, 9000, 50_000] {
        let coarse = open(Some(most));
        let [width, height] = coarse.size();
        assert!(width * height <= most);
        // Sums of 32-bit numbers, over at most 170 rows.
        assert!((mean(&coarse) / mean(&whole) - 1.0).abs() < 1e-5, "{most}");
        // Each coarser pixel has what lies in it, by area.
        for (index, &value) in coarse.values().iter().enumerate() {
            let [column, row] = [index % width, index / width];
            let overlap = |at: usize, fine: usize, part: usize, coarse: usize| {
                let [low, high] = [part, part + 1].map(|end| (end * fine) as f64 / coarse as f64);
                ((at + 1) as f64).min(high) - (at as f64).max(low)
            };
            let near = |fine: usize, part: usize, coarse: usize| {
                part * fine / coarse..((part + 1) * fine).div_ceil(coarse).min(fine)
            };
            let mut sum = 0.0;
            for y in near(170, row, height) {
                for x in near(300, column, width) {
                    let area = overlap(x, 300, column, width) * overlap(y, 170, row, height);
                    sum += area * f64::from(whole.values()[y * 300 + x]);
                }
            }
            let expected = sum * (width * height) as f64 / (300.0 * 170.0);
            assert!((f64::from(value) - expected).abs() < 1e-5, "{value} {expected}");
        }
    }
    // Inks are averaged ink by ink.
    image::RgbImage::from_fn(64, 64, |x, _| image::Rgb([[255, 0, 0], [0, 255, 255]][x as usize % 2]))
        .save(&path)
        .unwrap();
    let options = PictureOptions { most_pixels: Some(64), ..PictureOptions::default() };
    let inks = Inks::open_with(&path, &options).unwrap();
    assert_eq!(inks.counts(300), [100, 100, 100, 0]);
    assert!(inks.density(0).unwrap().values().iter().all(|value| (value - 0.5).abs() < 1e-6));
}

#[test]
fn limits_are_the_callers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.png");
    image::GrayImage::new(300, 200).save(&path).unwrap();
    let open = |limit_pixels| {
        let options = PictureOptions { limit_pixels, ..PictureOptions::default() };
        Density::open_with(&path, Tone::Dark, &options)
    };
    let error = open(59_999).unwrap_err();
    assert!(matches!(error, PictureError::TooLarge { width: 300, height: 200, most: 59_999, .. }), "{error}");
    assert!(error.to_string().contains("`limit_pixels`"), "{error}");
    assert_eq!(open(60_000).unwrap().size(), [300, 200]);
    // Nothing but a header: 22,000 by 22,000 pixels are refused before anything is set aside.
    png::Encoder::new(File::create(&path).unwrap(), 22_000, 22_000).write_header().unwrap();
    let error = Density::open(&path, Tone::Dark).unwrap_err();
    assert!(matches!(error, PictureError::TooLarge { width: 22_000, .. }), "{error}");
    // Allowed, it is read, until there are no pixels.
    assert!(matches!(open(1 << 30), Err(PictureError::Png { .. })));
}
