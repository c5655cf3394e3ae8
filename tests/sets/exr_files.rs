//! What an EXR file may be: light without cover, layers, windows, tiles, parts, odd numbers.

use std::fs;
use std::path::Path;

use exr::prelude::*;
use fsot::targets::{Density, Inks, Picture, PictureError, PictureOptions, TargetError, Tone, Transfer};

type Channel<'a> = (&'a str, FlatSamples);

fn floats(value: impl Fn(usize) -> f32, size: [usize; 2]) -> FlatSamples {
    FlatSamples::F32((0..size[0] * size[1]).map(value).collect())
}

fn part(
    name: &str,
    size: [usize; 2],
    encoding: Encoding,
    channels: Vec<Channel>,
) -> Layer<AnyChannels<FlatSamples>> {
    let list = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples));
    let attributes = match name {
        "" => LayerAttributes::default(),
        _ => LayerAttributes::named(name),
    };
    Layer::new((size[0], size[1]), attributes, encoding, AnyChannels::sort(list.collect()))
}

fn write(path: &Path, layer: Layer<AnyChannels<FlatSamples>>) {
    Image::from_layer(layer).write().non_parallel().to_file(path).unwrap();
}

fn density(path: &Path, tone: Tone) -> Density {
    Density::open(path, tone).unwrap()
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-5 * expected.abs().max(1.0), "{value} instead of {expected}");
}

/// 40 × 40 pixels of a wall, with a flame of light 30 in the middle 10 × 10, whose cover is `alpha`.
fn flame(path: &Path, alpha: f32) {
    let size = [40, 40];
    let burns = |i: usize| (15..25).contains(&(i % 40)) && (15..25).contains(&(i / 40));
    let light = || floats(|i| if burns(i) { 30.0 } else { 0.075 }, size);
    let cover = floats(|i| if burns(i) { alpha } else { 1.0 }, size);
    let channels = vec![("R", light()), ("G", light()), ("B", light()), ("A", cover)];
    write(path, part("", size, Encoding::SMALL_LOSSLESS, channels));
}

#[test]
fn light_without_cover_is_light() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flame.exr");
    // 1500 pixels of wall, 100 of fire; a denormal cover too.
    for alpha in [0.0, 1e-3, f32::from_bits(1), 1e-40, 1.0] {
        flame(&path, alpha);
        near(density(&path, Tone::Bright).mass(), 112.5 + 3000.0);
        // Over white paper the wall is dark, and the flame is not.
        let dark = density(&path, Tone::Dark);
        near(dark.mass(), 1500.0 * 0.925);
        assert_eq!(dark.at([0.5, 0.5]), 0.0, "{alpha}");
        near(Inks::open(&path).unwrap().density(3).unwrap().mass(), 1500.0 * 0.925);
        let picture = Picture::open(&path).unwrap();
        assert!(picture.pixels().iter().flatten().all(|value| value.is_finite()), "{alpha}");
    }
}

#[test]
fn luminance_alone_is_grey() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grey.exr");
    let size = [3, 1];
    let ramp = || floats(|i| 0.25 * i as f32, size);
    write(&path, part("", size, Encoding::SMALL_LOSSLESS, vec![("Y", ramp())]));
    assert_eq!(density(&path, Tone::Bright).values(), [0.0, 0.25, 0.5]);
    let half = floats(|_| 0.5, size);
    write(&path, part("", size, Encoding::SMALL_LOSSLESS, vec![("Y", ramp()), ("A", half), ("Z", ramp())]));
    assert_eq!(density(&path, Tone::Dark).values(), [0.5, 0.25, 0.0]);
}

#[test]
fn a_lone_layer_is_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("blender.exr");
    let size = [2, 1];
    let light = |value: f32| floats(move |i| value * i as f32, size);
    // What Blender calls its layers; normals have a Y, which is no luminance.
    let combined = |values: [f32; 3]| {
        let names = ["ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"];
        let colors = names.into_iter().zip(values).map(|(name, value)| (name, light(value)));
        colors.chain([("ViewLayer.Combined.A", floats(|_| 1.0, size))]).collect::<Vec<_>>()
    };
    let mut channels = combined([0.5, 1.0, 2.0]);
    channels.extend(["X", "Y", "Z"].map(|axis| match axis {
        "X" => ("ViewLayer.Normal.X", light(9.0)),
        "Y" => ("ViewLayer.Normal.Y", light(9.0)),
        _ => ("ViewLayer.Normal.Z", light(9.0)),
    }));
    channels.push(("ViewLayer.Depth.Z", light(100.0)));
    write(&path, part("", size, Encoding::SMALL_LOSSLESS, channels.clone()));
    assert_eq!(Picture::open(&path).unwrap().pixels()[1], [0.5, 1.0, 2.0, 1.0]);
}

#[test]
fn layers_are_chosen_by_name_or_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.exr");
    let size = [2, 1];
    let names = ["R", "G", "B"];
    let layer = |prefix: &str, value: f32| {
        let named = names.map(|name| format!("{prefix}.{name}"));
        named.map(|name| (name, floats(move |i| value * i as f32, size)))
    };
    let save = |layers: &[(&str, f32)]| {
        let channels: Vec<_> = layers.iter().flat_map(|&(prefix, value)| layer(prefix, value)).collect();
        let channels = channels.iter().map(|(name, samples)| (name.as_str(), samples.clone())).collect();
        write(&path, part("", size, Encoding::SMALL_LOSSLESS, channels));
    };
    let open = |layer: Option<&str>| {
        let layer = layer.map(String::from);
        Density::open_with(&path, Tone::Bright, &PictureOptions { layer, ..PictureOptions::default() })
    };
    let value = |layer: Option<&str>| open(layer).unwrap().values()[1];

    save(&[("diffuse", 1.0), ("glossy", 2.0)]);
    let error = open(None).unwrap_err();
    assert!(
        matches!(&error, PictureError::Layers { found, .. } if *found == ["diffuse", "glossy"]),
        "{error}"
    );
    assert_eq!((value(Some("diffuse")), value(Some("glossy"))), (1.0, 2.0));
    let error = open(Some("shiny")).unwrap_err();
    assert!(error.to_string().contains("diffuse and glossy"), "{error}");
    // What is finished is the picture, unless it is so twice.
    save(&[("ViewLayer.Combined", 3.0), ("ViewLayer.DiffDir", 1.0), ("ViewLayer.Emit", 2.0)]);
    assert_eq!((value(None), value(Some("ViewLayer.Emit"))), (3.0, 2.0));
    save(&[("Front.Combined", 3.0), ("Back.Combined", 1.0)]);
    assert!(matches!(open(None), Err(PictureError::Layers { .. })));

    // Parts: the first with colours, or one by its name.
    let lit = |name: &str, value: f32| {
        let channels = names.map(|name| (name, floats(move |i| value * i as f32, size)));
        part(name, size, Encoding::SMALL_LOSSLESS, channels.into())
    };
    let depth = part("depth", size, Encoding::UNCOMPRESSED, vec![("Z", floats(|_| 9.0, size))]);
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((2, 1)));
    let layers = SmallVec::from_vec(vec![depth, lit("left", 4.0), lit("right", 5.0)]);
    Image::from_layers(attributes, layers).write().non_parallel().to_file(&path).unwrap();
    assert_eq!([None, Some("left"), Some("right")].map(value), [4.0, 4.0, 5.0]);
    let error = open(Some("depth")).unwrap_err();
    assert!(matches!(&error, PictureError::NoLayer { found, .. } if *found == ["left", "right"]), "{error}");

    // No colours at all.
    let xyz = ["X", "Y", "Z"].map(|name| (name, floats(|_| 1.0, size)));
    write(&path, part("", size, Encoding::SMALL_LOSSLESS, xyz.into()));
    let error = open(None).unwrap_err();
    assert!(error.to_string().contains("but X, Y, Z: save"), "{error}");
}

/// A smooth picture without symmetry, of 37 columns.
fn ramp(i: usize) -> f32 {
    (i % 37 + 2 * (i / 37)) as f32 / 128.0
}

#[test]
fn blocks_of_every_kind_are_put_together() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("blocks.exr");
    let size = [37, 41];
    let expected: Vec<f32> = (0..37 * 41).map(ramp).collect();
    let tiles =
        |compression| Encoding { compression, blocks: Blocks::Tiles(Vec2(8, 5)), ..Encoding::UNCOMPRESSED };
    let lines = |compression| Encoding { compression, blocks: Blocks::ScanLines, ..Encoding::UNCOMPRESSED };
    let all = [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::ZIP16];
    let all =
        all.into_iter().chain([Compression::PIZ, Compression::PXR24, Compression::B44, Compression::B44A]);
    for encoding in all.flat_map(|compression| [tiles(compression), lines(compression)]) {
        for line_order in [LineOrder::Increasing, LineOrder::Decreasing] {
            let halves = FlatSamples::F16((0..37 * 41).map(|i| f16::from_f32(ramp(i))).collect());
            let whole = FlatSamples::U32(vec![1; 37 * 41]);
            let channels = vec![("R", floats(ramp, size)), ("G", halves), ("B", whole)];
            let encoding = Encoding { line_order, ..encoding };
            write(&path, part("", size, encoding, channels));
            let picture = Picture::open(&path).unwrap();
            for (pixel, &light) in picture.pixels().iter().zip(&expected) {
                // B44 is lossy for halves.
                let near = (pixel[1] - light).abs() < 0.03;
                assert!(pixel[0] == light && near && pixel[2] == 1.0, "{pixel:?} {light} {encoding:?}");
            }
        }
    }

    // Smaller copies are left out.
    let copies = [[37, 41], [18, 20], [9, 10], [4, 5], [2, 2], [1, 1]];
    let maps = copies.map(|size| floats(|i| if size[0] == 37 { ramp(i) } else { 50.0 }, size));
    let levels = || Levels::Mip { rounding_mode: exr::math::RoundingMode::Down, level_data: maps.to_vec() };
    let channels = ["R", "G", "B"].map(|name| AnyChannel::new(name, levels()));
    let attributes = LayerAttributes::default();
    let encoding = tiles(Compression::ZIP16);
    let layer = Layer::new((37, 41), attributes, encoding, AnyChannels::sort(channels.into_iter().collect()));
    Image::from_layer(layer).write().non_parallel().to_file(&path).unwrap();
    let picture = Picture::open(&path).unwrap();
    assert!(picture.pixels().iter().zip(&expected).all(|(pixel, &light)| pixel[0] == light));
}

/// An EXR file of luminance and of these attributes.
fn with_attributes(path: &Path, size: [usize; 2], attributes: ImageAttributes) {
    let layer = part("", size, Encoding::UNCOMPRESSED, vec![("Y", floats(|i| i as f32 / 8.0, size))]);
    Image::new(attributes, layer).write().non_parallel().to_file(path).unwrap();
}

#[test]
fn pixels_become_square_and_colours_rec_709() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shape.exr");
    let window = IntegerBounds::from_dimensions((4, 2));
    let shaped = |pixel_aspect: f32| {
        with_attributes(&path, [4, 2], ImageAttributes { pixel_aspect, ..ImageAttributes::new(window) });
        Density::open(&path, Tone::Bright)
    };
    let wide = shaped(2.0).unwrap();
    assert_eq!(wide.size(), [8, 2]);
    assert_eq!(wide.values()[..6], [0.0, 0.0, 0.125, 0.125, 0.25, 0.25]);
    let high = shaped(0.75).unwrap();
    assert_eq!((high.size(), high.values()[4]), ([4, 3], 0.25));
    near(high.mass() / 12.0, 0.4375);
    assert_eq!(shaped(1.001).unwrap().size(), [4, 2]);
    for aspect in [0.0, -1.0, f32::NAN, f32::INFINITY, 65.0] {
        // Written in place of 1.
        shaped(1.0).unwrap();
        let mut bytes = fs::read(&path).unwrap();
        let name = b"pixelAspectRatio\0float\0\x04\0\0\0";
        let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
        bytes[at..at + 4].copy_from_slice(&aspect.to_le_bytes());
        fs::write(&path, bytes).unwrap();
        let error = Density::open(&path, Tone::Bright).unwrap_err();
        assert!(matches!(error, PictureError::Aspect { .. }), "{aspect}: {error}");
    }

    // The red of BT.2020 has .2627 of the light of its white.
    let wide_gamut = attribute::Chromaticities {
        red: Vec2(0.708, 0.292),
        green: Vec2(0.17, 0.797),
        blue: Vec2(0.131, 0.046),
        white: Vec2(0.3127, 0.329),
    };
    let colored = |chromaticities, transfer| {
        let attributes =
            ImageAttributes { chromaticities: Some(chromaticities), ..ImageAttributes::new(window) };
        let channels = ["R", "G", "B"].map(|name| (name, floats(|_| f32::from(name == "R"), [4, 2])));
        let layer = part("", [4, 2], Encoding::UNCOMPRESSED, channels.into());
        Image::new(attributes, layer).write().non_parallel().to_file(&path).unwrap();
        let options = PictureOptions { transfer, ..PictureOptions::default() };
        Density::open_with(&path, Tone::Bright, &options)
    };
    let light = |transfer| colored(wide_gamut, transfer).unwrap().values()[0];
    assert!((light(Transfer::FromFile) - 0.2627).abs() < 1e-4);
    assert_eq!(light(Transfer::Linear), 0.2126);
    let flat = attribute::Chromaticities { red: wide_gamut.green, ..wide_gamut };
    let error = colored(flat, Transfer::FromFile).unwrap_err();
    assert!(matches!(error, PictureError::Encoding { .. }), "{error}");
    assert!(colored(flat, Transfer::Linear).is_ok());
}

#[test]
fn numbers_that_are_no_light_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.exr");
    let size = [20, 10];
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.25] {
        let odd = || floats(|i| if i == 65 { value } else { 0.5 }, size);
        write(&path, part("", size, Encoding::SMALL_LOSSLESS, vec![("Y", odd()), ("A", odd())]));
        for most_pixels in [None, Some(12)] {
            let options = PictureOptions { most_pixels, ..PictureOptions::default() };
            let error = Density::open_with(&path, Tone::Bright, &options).unwrap_err();
            let PictureError::Density { problem: TargetError::BadDensity { x: 5, y: 3, .. }, .. } = error
            else {
                panic!("{value} {most_pixels:?}: {error}");
            };
        }
    }
}

#[test]
fn what_is_not_read_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.exr");
    let size = [4, 4];
    let channels =
        || vec![("BY", floats(|_| 0.0, size)), ("RY", floats(|_| 0.0, size)), ("Y", floats(ramp, size))];
    write(&path, part("", size, Encoding::UNCOMPRESSED, channels()));
    let whole = fs::read(&path).unwrap();
    // Luminance and chroma: the chroma of two by two pixels together. Sampling rates end a channel's entry.
    let mut bytes = whole.clone();
    for name in [b"BY\0", b"RY\0"] {
        let at = bytes.windows(3).position(|window| window == name).unwrap() + 3 + 8;
        bytes[at..at + 8].copy_from_slice(&[2, 0, 0, 0, 2, 0, 0, 0]);
    }
    fs::write(&path, bytes).unwrap();
    let error = Picture::open(&path).unwrap_err().to_string();
    assert!(error.contains("(BY, RY)"), "{error}");
    // The same at full size is no grey.
    fs::write(&path, &whole).unwrap();
    assert!(matches!(Picture::open(&path), Err(PictureError::Channels { .. })));

    // Deep pixels.
    write(&path, part("", size, Encoding::UNCOMPRESSED, vec![("Y", floats(ramp, size))]));
    let whole = fs::read(&path).unwrap();
    let kind = b"\x0d\0\0\0scanlineimage";
    let at = whole.windows(kind.len()).position(|window| window == kind).unwrap();
    let mut bytes = whole.clone();
    bytes.splice(at..at + kind.len(), *b"\x0c\0\0\0deepscanline");
    fs::write(&path, bytes).unwrap();
    let error = Picture::open(&path).unwrap_err().to_string();
    assert!(error.contains("deep"), "{error}");

    // A block twice, another never: offsets stand before the first block.
    let start = (0..whole.len() - 8)
        .find(|&at| u64::from_le_bytes(whole[at..at + 8].try_into().unwrap()) == at as u64 + 32)
        .unwrap();
    let mut bytes = whole.clone();
    bytes.copy_within(start..start + 8, start + 8);
    fs::write(&path, bytes).unwrap();
    assert!(matches!(Picture::open(&path), Err(PictureError::Exr { .. })));
}

#[test]
fn windows_are_cropped_filled_and_limited() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.exr");
    // Eight pixels of data, of which a window of any place shows a part.
    let shown = |position: [i32; 2], size: (usize, usize)| {
        let window = IntegerBounds::new((position[0], position[1]), size);
        with_attributes(&path, [4, 2], ImageAttributes::new(window));
        // Weights of luminance add up to 1, but for the last bit.
        let rounded = |value: &f32| (1000.0 * value).round() / 1000.0;
        Density::open(&path, Tone::Bright)
            .map(|density| density.values().iter().map(rounded).collect::<Vec<_>>())
    };
    assert_eq!(shown([1, 0], (2, 2)).unwrap(), [0.125, 0.25, 0.625, 0.75]);
    assert_eq!(shown([3, -1], (2, 3)).unwrap(), [0.0, 0.0, 0.375, 0.0, 0.875, 0.0]);
    assert_eq!(shown([-2, 1], (4, 1)).unwrap(), [0.0, 0.0, 0.5, 0.625]);
    let empty = shown([400, 0], (2, 1)).unwrap_err();
    assert!(empty.to_string().contains("needs some ink"), "{empty}");
    let large = shown([0, 0], (65535, 65535)).unwrap_err();
    assert!(matches!(large, PictureError::TooLarge { width: 65535, .. }), "{large}");
}
