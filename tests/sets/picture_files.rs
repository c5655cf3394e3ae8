//! Files of pictures: every kind of PNG, EXR with windows and halves, and what is no picture.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use exr::image::write::channels::WritableChannels;
use exr::prelude::*;
use fsot::config::RangeError;
use fsot::targets::{Picture, PictureError, TargetError};
use image::DynamicImage;
use png::{BitDepth, ColorType};

const WIDTH: usize = 13;
const HEIGHT: usize = 7;

fn srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn bits(pixels: impl IntoIterator<Item = [f32; 4]>) -> Vec<[u32; 4]> {
    pixels.into_iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// What the crate `image` reads, as this library did until it read files itself.
fn other(path: &Path) -> Vec<[f32; 4]> {
    let picture = image::open(path).unwrap();
    let is_linear = matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let light = |[red, green, blue, alpha]: [f32; 4]| match is_linear {
        true => [red, green, blue, alpha],
        false => [srgb(red) * alpha, srgb(green) * alpha, srgb(blue) * alpha, alpha],
    };
    picture.to_rgba32f().pixels().map(|pixel| light(pixel.0)).collect()
}

/// Bytes that look like noise.
fn noise(count: usize) -> Vec<u8> {
    (1..=count as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
}

/// One colour per index of a palette, and alpha of the first few.
fn palette(colors: usize) -> (Vec<u8>, Vec<u8>) {
    (noise(3 * colors), noise(colors / 2 + 1))
}

/// The samples of noise packed into rows, as PNG stores them.
fn samples(bytes: &[u8], per_row: usize, depth: usize) -> Vec<u16> {
    let row_bytes = (per_row * depth).div_ceil(8);
    let sample = |row: &[u8], i: usize| match depth {
        16 => u16::from_be_bytes([row[2 * i], row[2 * i + 1]]),
        _ => u16::from(row[i * depth / 8] >> (8 - depth - i * depth % 8)) & ((1 << depth) - 1),
    };
    bytes.chunks_exact(row_bytes).flat_map(|row| (0..per_row).map(move |i| sample(row, i))).collect()
}

#[test]
fn every_kind_of_png_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let low = [BitDepth::One, BitDepth::Two, BitDepth::Four];
    let high = [BitDepth::Eight, BitDepth::Sixteen];
    let grey = low.into_iter().chain(high).map(|depth| (ColorType::Grayscale, depth));
    let indexed = low.into_iter().chain([BitDepth::Eight]).map(|depth| (ColorType::Indexed, depth));
    let others = [ColorType::Rgb, ColorType::Rgba, ColorType::GrayscaleAlpha];
    let deep = others.into_iter().flat_map(|color| high.map(|depth| (color, depth)));
    for (color, depth) in grey.chain(indexed).chain(deep) {
        let (channels, depth_bits) = (color.samples(), depth as usize);
        let data = noise((WIDTH * channels * depth_bits).div_ceil(8) * HEIGHT);
        let samples = samples(&data, WIDTH * channels, depth_bits);
        let (colors, alphas) = palette(1 << depth_bits.min(8));
        // The colour of the first pixel is the one that is clear, where there is no alpha otherwise.
        let key = &samples[..channels];
        for keyed in [false, true] {
            let may_be_keyed = !matches!(color, ColorType::Rgba | ColorType::GrayscaleAlpha);
            let mut encoder = png::Encoder::new(File::create(&path).unwrap(), WIDTH as u32, HEIGHT as u32);
            encoder.set_color(color);
            encoder.set_depth(depth);
            if color == ColorType::Indexed {
                encoder.set_palette(colors.clone());
            }
            if keyed && may_be_keyed {
                let key = key.iter().flat_map(|sample| sample.to_be_bytes()).collect();
                encoder.set_trns(if color == ColorType::Indexed { alphas.clone() } else { key });
            }
            encoder.write_header().unwrap().write_image_data(&data).unwrap();

            // Fewer bits than 8 become 8; grey is multiplied, colours are divided.
            let most = (1_u32 << depth_bits.max(8)) - 1;
            let scale = (most / ((1 << depth_bits) - 1)) as u16;
            let is_grey = channels < 3;
            let expected = samples.chunks_exact(channels).map(|pixel| {
                let share = |sample: u16| match is_grey {
                    true => f32::from(sample * scale) * (most as f32).recip(),
                    false => f32::from(sample * scale) / most as f32,
                };
                let light = |sample: u16| srgb(share(sample));
                let clear = keyed && pixel == key;
                let opaque = if clear { 0.0 } else { 1.0 };
                match *pixel {
                    [index] if color == ColorType::Indexed => {
                        let index = usize::from(index);
                        let [red, green, blue] =
                            [0, 1, 2].map(|i| srgb(f32::from(colors[3 * index + i]) / 255.0));
                        let alpha = alphas.get(index).filter(|_| keyed).copied().unwrap_or(255);
                        [red, green, blue, f32::from(alpha) / 255.0]
                    }
                    [grey] => [light(grey), light(grey), light(grey), opaque],
                    [grey, alpha] => [light(grey), light(grey), light(grey), share(alpha)],
                    [red, green, blue] => [light(red), light(green), light(blue), opaque],
                    [red, green, blue, alpha] => [light(red), light(green), light(blue), share(alpha)],
                    _ => unreachable!(),
                }
            });
            let expected = expected
                .map(|[red, green, blue, alpha]: [f32; 4]| [red * alpha, green * alpha, blue * alpha, alpha]);
            let picture = Picture::open(&path).unwrap();
            assert_eq!([picture.width(), picture.height()], [WIDTH, HEIGHT]);
            let name = format!("{color:?} {depth:?} {keyed}");
            assert_eq!(bits(picture.pixels().iter().copied()), bits(expected), "{name}");
            assert_eq!(bits(picture.pixels().iter().copied()), bits(other(&path)), "{name}");
        }
    }
}

/// Writes an EXR file whose data lie at `position` of a display window of 5 × 4 pixels.
fn exr_file(path: &Path, position: [i32; 2], channels: impl for<'a> WritableChannels<'a>) {
    let layer_position = Vec2(position[0], position[1]);
    let attributes = LayerAttributes { layer_position, ..LayerAttributes::default() };
    let layer = Layer::new((WIDTH, HEIGHT), attributes, Encoding::SMALL_LOSSLESS, channels);
    let window = IntegerBounds::from_dimensions((5, 4));
    Image::new(ImageAttributes::new(window), layer).write().non_parallel().to_file(path).unwrap();
}

#[test]
fn exr_is_read_as_another_decoder_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.exr");
    let value = |at: Vec2<usize>, channel: usize| ((at.0 * 31 + at.1 * 17 + channel * 7) % 23) as f32 / 11.0;
    let check = |name: &str| {
        let picture = Picture::open(&path).unwrap();
        assert_eq!([picture.width(), picture.height()], [5, 4]);
        assert_eq!(bits(picture.pixels().iter().copied()), bits(other(&path)), "{name}");
        picture
    };
    // The data cover the window, lie in its lower right corner, or outside.
    for position in [[0, 0], [-3, -2], [2, 3], [40, 40]] {
        let rgb = SpecificChannels::rgb(move |at| (value(at, 0), value(at, 1), value(at, 2)));
        exr_file(&path, position, rgb);
        check(&format!("rgb {position:?}"));
        let rgba = SpecificChannels::rgba(move |at| {
            (value(at, 0), value(at, 1), value(at, 2), value(at, 3).min(1.0))
        });
        exr_file(&path, position, rgba);
        let picture = check(&format!("rgba {position:?}"));
        let first = picture.pixels()[0];
        match position {
            // 0 of the light, 7/11 and 14/11 of it, each over 21/11 or full cover.
            [0, 0] => assert_eq!(first, [0.0, 7.0 / 11.0, 14.0 / 11.0, 1.0]),
            [-3, -2] => assert!(first[3] > 0.0),
            _ => assert_eq!(first, [0.0; 4]),
        }
        let half = SpecificChannels::build().with_channel("R").with_channel("G").with_channel("B");
        let half = half.with_pixel_fn(move |at: Vec2<usize>| {
            (f16::from_f32(value(at, 0)), f16::from_f32(value(at, 1)), f16::from_f32(value(at, 2)))
        });
        exr_file(&path, position, half);
        check(&format!("half {position:?}"));
    }
}

#[test]
fn what_is_no_picture_is_named_with_advice() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let refused = |path: &Path| {
        let error = Picture::open(path).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(path.to_str().unwrap()) && text.lines().count() == 1, "{text}");
        let is_about_size = matches!(error, PictureError::TooLarge { .. } | PictureError::Density { .. });
        assert!(is_about_size || text.ends_with("PNG or EXR file"), "{text}");
        error
    };
    assert!(matches!(refused(&folder.path().join("missing.png")), PictureError::Read { .. }));
    assert!(matches!(refused(folder.path()), PictureError::Read { .. }));
    let note = refused(&file("note.png", b"no picture"));
    assert!(matches!(&note, PictureError::Format { start, .. } if start == b"no pictu"), "{note}");
    let jpeg = refused(&file("photo.png", b"\xff\xd8\xff\xe0"));
    assert!(jpeg.to_string().contains(r"\xff\xd8"), "{jpeg}");
    assert!(matches!(refused(&file("empty.png", b"")), PictureError::Format { .. }));

    // Cut off anywhere.
    let path = folder.path().join("whole");
    image::RgbImage::new(9, 9).save_with_format(&path, image::ImageFormat::Png).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in 8..whole.len() - 12 {
        assert!(matches!(refused(&file("cut.png", &whole[..length])), PictureError::Png { .. }), "{length}");
    }
    let zeros = SpecificChannels::rgb(|_| (0.0_f32, 0.0_f32, 0.0_f32));
    exr_file(&path, [0, 0], zeros);
    let whole = fs::read(&path).unwrap();
    for length in 4..whole.len() {
        assert!(matches!(refused(&file("cut.exr", &whole[..length])), PictureError::Exr { .. }), "{length}");
    }
    let depth = SpecificChannels::build().with_channel("Z").with_pixel_fn(|_| (0.0_f32,));
    exr_file(&path, [0, 0], depth);
    let error = refused(&path);
    assert!(error.to_string().contains("R, G and B"), "{error}");

    // Sizes are refused before memory is set aside.
    let header = |width, height| {
        png::Encoder::new(File::create(&path).unwrap(), width, height).write_header().unwrap();
        refused(&path)
    };
    assert!(matches!(header(65535, 65535), PictureError::TooLarge { width: 65535, height: 65535, .. }));
    let problem = header(65536, 1);
    assert!(
        matches!(
            &problem,
            PictureError::Density { problem: TargetError::Range(RangeError { value: 65536.0, .. }), .. }
        ),
        "{problem}"
    );
}
