//! Pictures from files: depth, alpha, tone, inks.

use fsot::Config;
use fsot::targets::{Density, Inks, Picture, PictureError, TargetError, Tone};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma, LumaA, Rgb, RgbImage, Rgba, RgbaImage};

use crate::optimised;

/// Through a PNG file.
fn opened(picture: impl Into<DynamicImage>) -> Result<Picture, PictureError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    picture.into().save(&path).unwrap();
    Picture::open(path)
}

#[test]
fn luminance_is_linear() {
    let picture = opened(GrayImage::from_vec(3, 1, vec![0, 188, 255]).unwrap()).unwrap();
    let dark = Density::from_picture(&picture, Tone::Dark).unwrap();
    // sRGB 188 is half of the light.
    for (value, expected) in dark.values().iter().zip([1.0, 0.5, 0.0]) {
        assert!((value - expected).abs() < 0.005, "{:?}", dark.values());
    }
    let bright = Density::from_picture(&picture, Tone::Bright).unwrap();
    assert!((bright.values()[1] - 0.5).abs() < 0.005 && bright.values()[2] == 1.0);
    let green = opened(RgbImage::from_pixel(1, 1, Rgb([0, 255, 0]))).unwrap();
    assert!((Density::from_picture(&green, Tone::Bright).unwrap().mass() - 0.7152).abs() < 1e-6);
}

#[test]
fn sixteen_bits_alpha_and_floats_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let deep = ImageBuffer::<Luma<u16>, _>::from_fn(1, 5, |_, y| Luma([y as u16 * 0x3fff]));
    deep.save(folder.path().join("deep.png")).unwrap();
    let deep = Density::open(folder.path().join("deep.png"), Tone::Dark).unwrap();
    assert_eq!(deep.size(), [1, 5]);
    assert!(deep.values().is_sorted_by(|a, b| a > b) && deep.values()[0] == 1.0);

    let clear = ImageBuffer::<LumaA<u8>, _>::from_fn(2, 1, |x, _| LumaA([0, if x == 0 { 0 } else { 128 }]));
    clear.save(folder.path().join("clear.png")).unwrap();
    let clear = Density::open(folder.path().join("clear.png"), Tone::Dark).unwrap();
    assert!(clear.values()[0] == 0.0 && (clear.values()[1] - 128.0 / 255.0).abs() < 1e-6);

    let light = ImageBuffer::<Rgb<f32>, _>::from_fn(2, 1, |x, _| Rgb([4.0 * x as f32; 3]));
    light.save(folder.path().join("light.exr")).unwrap();
    let light = Density::open(folder.path().join("light.exr"), Tone::Bright).unwrap();
    assert!(light.values()[0] == 0.0 && (light.values()[1] - 4.0).abs() < 1e-6);

    // Colours in an EXR file are multiplied by alpha: half of a light of 0.8, and half of nothing.
    let veiled =
        ImageBuffer::<Rgba<f32>, _>::from_fn(2, 1, |x, _| Rgba([0.4, 0.4, 0.4, 0.5].map(|v| v * x as f32)));
    veiled.save(folder.path().join("veiled.exr")).unwrap();
    let open = |tone| Density::open(folder.path().join("veiled.exr"), tone).unwrap().values().to_vec();
    let near = |values: Vec<f32>, expected: f32| {
        assert!(values[0] == 0.0 && (values[1] - expected).abs() < 1e-6, "{values:?} {expected}");
    };
    near(open(Tone::Bright), 0.5 * 0.8);
    near(open(Tone::Dark), 0.5 * 0.2);
}

#[test]
fn pictures_without_ink_are_refused() {
    let black = opened(GrayImage::new(3, 2)).unwrap();
    let white = opened(GrayImage::from_pixel(3, 2, Luma([255]))).unwrap();
    let clear = opened(RgbaImage::from_pixel(3, 2, Rgba([0, 0, 0, 0]))).unwrap();
    let none = TargetError::NoDensity { width: 3, height: 2 };
    assert_eq!(Density::from_picture(&black, Tone::Bright), Err(none.clone()));
    assert_eq!(Density::from_picture(&white, Tone::Dark), Err(none.clone()));
    assert_eq!(Density::from_picture(&clear, Tone::Dark), Err(none.clone()));
    assert_eq!(Inks::from_picture(&white), Err(none.clone()));
    assert_eq!(Inks::from_picture(&clear), Err(none));
    let blind = Picture::new(1, 2, vec![[0.5, 0.5, 0.5, f32::NAN]; 2]).unwrap();
    assert!(matches!(Inks::from_picture(&blind), Err(TargetError::BadDensity { x: 0, y: 0, .. })));
    assert!(matches!(Density::from_picture(&blind, Tone::Dark), Err(TargetError::BadDensity { .. })));
    for (width, height) in [(65536, 1), (1, 65536)] {
        let pixels = vec![[0.0, 0.0, 0.0, 1.0]; 65536];
        assert!(matches!(Picture::new(width, height, pixels), Err(TargetError::Range(_))));
        let error = opened(GrayImage::new(width as u32, height as u32)).unwrap_err();
        assert!(error.to_string().contains("picture.png") && error.to_string().contains("65535"), "{error}");
    }
    assert_eq!(Picture::new(0, 1, vec![]), Err(TargetError::Empty { what: "the width of the density" }));
    let few = Picture::new(2, 2, vec![[0.0; 4]; 3]).unwrap_err();
    assert!(matches!(few, TargetError::DensityCount { given: 3, expected: 4, .. }), "{few}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("white.png");
    GrayImage::from_pixel(3, 2, Luma([255])).save(&path).unwrap();
    let error = Density::open(&path, Tone::Dark).unwrap_err();
    assert!(
        matches!(&error, PictureError::Density { problem: TargetError::NoDensity { .. }, .. }),
        "{error}"
    );
}

#[test]
fn inks_make_up_the_colour() {
    let colours = [[255, 0, 0], [0, 0, 255], [128, 128, 128], [255, 255, 255]];
    let picture = RgbImage::from_fn(4, 1, |x, _| Rgb(colours[x as usize]));
    let inks = Inks::from_picture(&opened(picture).unwrap()).unwrap();
    let of = |ink: usize| inks.density(ink).unwrap().values().to_vec();
    assert_eq!(of(0), [0.0, 1.0, 0.0, 0.0]); // cyan takes red away
    assert_eq!(of(1), [1.0, 1.0, 0.0, 0.0]);
    assert_eq!(of(2), [1.0, 0.0, 0.0, 0.0]);
    assert!((of(3)[2] - 0.784).abs() < 0.001 && of(3)[0] == 0.0);
    let counts = inks.counts(1000);
    assert_eq!(counts.iter().sum::<usize>(), 1000);
    assert_eq!(Config::color_stippling(1000, &inks).terms.len(), 15);
    // Grey has one ink, and one class.
    let grey = Inks::from_picture(&opened(RgbImage::from_pixel(2, 2, Rgb([90; 3]))).unwrap()).unwrap();
    assert_eq!((grey.counts(10), grey.density(0)), ([0, 0, 0, 10], None));
    assert_eq!(Config::color_stippling(10, &grey).terms.len(), 1);
}

#[test]
fn dots_of_an_ink_stay_where_it_is() {
    let picture = RgbImage::from_fn(16, 8, |x, _| if x < 8 { Rgb([255, 0, 0]) } else { Rgb([0, 255, 255]) });
    let inks = Inks::from_picture(&opened(picture).unwrap()).unwrap();
    let points = optimised(Config::color_stippling(600, &inks), 500);
    let [cyan, magenta, yellow, _] = inks.counts(600);
    assert_eq!([cyan, magenta, yellow], [200; 3]);
    for (label, dots) in points.chunks_exact(400).enumerate() {
        let right = dots.chunks_exact(2).filter(|dot| dot[0] > 0.5).count();
        let expected = if label == 0 { 200 } else { 0 };
        assert!(right.abs_diff(expected) <= 8, "{label}: {right}");
    }
}
