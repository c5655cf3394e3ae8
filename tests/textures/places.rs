//! Every number lies where `docs/formats.md` says: by decoders that are not ours, texel by texel.

use std::fs;

use fsot::files::{Depth, Format, RecordedFile};
use fsot::{Extent, SampleTable};
use image::DynamicImage;
use ktx2::dfd;

use crate::{ALL, Home, export, number, open_exr, shapes};

/// What of a table a file holds, by the record.
fn held(file: &RecordedFile) -> [[usize; 2]; 3] {
    [file.frames, file.samples, file.dims]
}

/// All texels of a file are asked for by `[frame of the file, y, x, channel]`.
fn check(table: &SampleTable, file: &RecordedFile, depth: Depth, at: impl Fn([usize; 4]) -> u32) {
    let [frames, samples, dims] = held(file);
    assert_eq!(samples[1] - samples[0], 1, "a texture has one sample");
    let [_, height, width, ..] = table.shape();
    for frame in frames[0]..frames[1] {
        for y in 0..height {
            for x in 0..width {
                for dim in dims[0]..dims[1] {
                    let value = table.view()[[frame, y, x, samples[0], dim]];
                    let found = at([frame - frames[0], y, x, dim - dims[0]]);
                    assert_eq!(found, number(value, depth), "{} {frame} {y} {x} {dim}", file.name);
                }
            }
        }
    }
}

/// Width, height, channels and levels, row by row.
fn png(path: &std::path::Path) -> (usize, usize, usize, Vec<u32>) {
    let picture = image::open(path).unwrap();
    let [width, height] = [picture.width() as usize, picture.height() as usize];
    let channels = picture.color().channel_count().into();
    let bytes = |bytes: &[u8]| bytes.iter().copied().map(u32::from).collect();
    let words = |words: &[u16]| words.iter().copied().map(u32::from).collect();
    let levels = match &picture {
        DynamicImage::ImageLuma8(picture) => bytes(picture),
        DynamicImage::ImageLumaA8(picture) => bytes(picture),
        DynamicImage::ImageRgb8(picture) => bytes(picture),
        DynamicImage::ImageRgba8(picture) => bytes(picture),
        DynamicImage::ImageLuma16(picture) => words(picture),
        DynamicImage::ImageLumaA16(picture) => words(picture),
        DynamicImage::ImageRgb16(picture) => words(picture),
        DynamicImage::ImageRgba16(picture) => words(picture),
        other => panic!("{other:?}"),
    };
    (width, height, channels, levels)
}

#[test]
fn texels_of_png_are_where_the_documents_say() {
    for table in shapes() {
        let [_, rows, columns, ..] = table.shape();
        for (format, name, depths) in &ALL[..2] {
            for &depth in *depths {
                let Home { home, exported, .. } = export(&table, name, *format, depth);
                for file in &exported.record.files {
                    let (width, height, channels, levels) = png(&home.path().join(&file.name));
                    let [frames, _, dims] = held(file);
                    let expected = [columns, rows * (frames[1] - frames[0]), dims[1] - dims[0]];
                    assert_eq!([width, height, channels], expected);
                    // Frame t begins at row t * H.
                    check(&table, file, depth, |[frame, y, x, channel]| {
                        levels[((frame * rows + y) * width + x) * channels + channel]
                    });
                }
            }
        }
    }
}

/// Nothing in a PNG makes a reader change its numbers.
#[test]
fn png_says_nothing_of_colours() {
    let [_, _, oblong, ..] = shapes();
    for depth in [Depth::U8, Depth::U16] {
        let Home { path, home: _home, .. } = export(&oblong, "mask.png", Format::Atlas, depth);
        let bytes = fs::read(path).unwrap();
        let mut kinds = Vec::new();
        let mut rest = &bytes[8..];
        while let Some((length, after)) = rest.split_first_chunk() {
            kinds.push(String::from_utf8_lossy(&after[..4]).into_owned());
            rest = &after[4 + u32::from_be_bytes(*length) as usize + 4..];
        }
        kinds.dedup();
        assert_eq!(kinds, ["IHDR", "IDAT", "IEND"]);
    }
}

/// Noise cannot be packed: what tries makes it larger.
#[test]
fn png_is_hardly_larger_than_its_numbers() {
    let noise = SampleTable::white_noise(Extent::animation(2, 128, 128), 2, 5).unwrap();
    for depth in [Depth::U8, Depth::U16] {
        let Home { path, home: _home, .. } = export(&noise, "mask.png", Format::Atlas, depth);
        let bytes = fs::metadata(path).unwrap().len() as usize;
        let numbers = noise.values().len() * depth.bytes();
        assert!(bytes < numbers + numbers / 50, "{bytes} for {numbers}");
    }
}

#[test]
fn texels_of_ktx2_are_where_the_documents_say() {
    for table in shapes() {
        let [frames, rows, columns, _, _] = table.shape();
        for depth in Depth::ALL {
            let Home { home, exported, .. } = export(&table, "mask.ktx2", Format::Ktx2, depth);
            for file in &exported.record.files {
                let reader = ktx2::Reader::new(fs::read(home.path().join(&file.name)).unwrap()).unwrap();
                let [_, _, [first, end]] = held(file);
                // Three dimensions take four channels.
                let channels = [1, 2, 4, 4][end - first - 1];
                check_header(&reader, depth, channels);
                let header = reader.header();
                let sides = [header.pixel_width, header.pixel_height, header.pixel_depth];
                assert_eq!(sides, [columns as u32, rows as u32, 0]);
                assert_eq!(header.layer_count, if frames > 1 { frames as u32 } else { 0 });
                let size = depth.bytes();
                let level = reader.levels().next().unwrap().data;
                assert_eq!(level.len(), frames * rows * columns * channels * size);
                let at = |[frame, y, x, channel]: [usize; 4]| {
                    let number = ((frame * rows + y) * columns + x) * channels + channel;
                    let mut bytes = [0; 4];
                    bytes[..size].copy_from_slice(&level[number * size..][..size]);
                    u32::from_le_bytes(bytes)
                };
                check(&table, file, depth, at);
                if end - first == 3 {
                    let one = [0xff, 0xffff, 0x3c00, 0x3f80_0000][depth as usize];
                    assert!((0..columns).all(|x| at([0, 0, x, 3]) == one));
                }
                let swizzle = reader.key_value_data().find(|(key, _)| *key == "KTXswizzle");
                assert_eq!(swizzle.map(|(_, value)| value), (end - first == 3).then_some(&b"rgb1\0"[..]));
            }
        }
    }
}

/// The format of texels and its descriptor say the same.
fn check_header(reader: &ktx2::Reader<Vec<u8>>, depth: Depth, channels: usize) {
    use ktx2::Format;
    let formats = match depth {
        Depth::U8 => [Format::R8_UNORM, Format::R8G8_UNORM, Format::R8G8B8A8_UNORM],
        Depth::U16 => [Format::R16_UNORM, Format::R16G16_UNORM, Format::R16G16B16A16_UNORM],
        Depth::Half => [Format::R16_SFLOAT, Format::R16G16_SFLOAT, Format::R16G16B16A16_SFLOAT],
        Depth::F32 => [Format::R32_SFLOAT, Format::R32G32_SFLOAT, Format::R32G32B32A32_SFLOAT],
    };
    let header = reader.header();
    assert_eq!(header.format, Some(formats[channels.ilog2() as usize]));
    assert_eq!(header.type_size as usize, depth.bytes());
    assert_eq!([header.face_count, header.level_count], [1, 1]);
    assert_eq!(header.supercompression_scheme, None);
    let [dfd::Block::Basic(basic)] = reader.dfd_blocks() else { panic!() };
    assert_eq!(basic.color_model, Some(ktx2::ColorModel::RGBSDA));
    assert_eq!(basic.transfer_function, Some(ktx2::TransferFunction::Linear));
    assert!(!basic.flags.contains(dfd::DataFormatFlags::ALPHA_PREMULTIPLIED));
    assert_eq!(usize::from(basic.bytes_planes[0]), channels * depth.bytes());
    assert_eq!(basic.sample_information.len(), channels);
    let bits = 8 * depth.bytes();
    let is_float = depth.levels().is_none();
    for (channel, sample) in basic.sample_information.iter().enumerate() {
        assert_eq!(usize::from(sample.bit_offset), channel * bits);
        assert_eq!(usize::from(sample.bit_length.get()), bits);
        assert_eq!(usize::from(sample.channel_type), if channel == 3 { 15 } else { channel });
        let float = dfd::ChannelTypeQualifiers::FLOAT | dfd::ChannelTypeQualifiers::SIGNED;
        let expected = if is_float { float } else { dfd::ChannelTypeQualifiers::empty() };
        assert_eq!(sample.channel_type_qualifiers, expected);
        let one = if is_float { 1.0_f32.to_bits() } else { (1_u32 << bits) - 1 };
        let zero = if is_float { (-1.0_f32).to_bits() } else { 0 };
        assert_eq!([sample.lower, sample.upper], [zero, one]);
    }
}

#[test]
fn pixels_of_exr_are_where_the_documents_say() {
    for table in shapes() {
        let [_, rows, columns, ..] = table.shape();
        for (format, name, depths) in &ALL[3..] {
            for &depth in *depths {
                let Home { home, exported, .. } = export(&table, name, *format, depth);
                for file in &exported.record.files {
                    let parts = open_exr::read(&fs::read(home.path().join(&file.name)).unwrap());
                    let [[first, end], _, dims] = held(file);
                    assert_eq!(parts.len(), end - first);
                    let names = if dims[1] - dims[0] == 1 { ["Y", "", "", ""] } else { ["R", "G", "B", "A"] };
                    for (at, part) in parts.iter().enumerate() {
                        assert_eq!([part.width, part.height], [columns, rows]);
                        assert_eq!(part.name, format!("frame_{}", first + at));
                        assert_eq!(part.channels.len(), dims[1] - dims[0]);
                    }
                    check(&table, file, depth, |[frame, y, x, channel]| {
                        parts[frame].channels[names[channel]][y * columns + x]
                    });
                }
            }
        }
    }
}
