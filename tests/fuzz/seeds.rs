//! Sound files, small ones, which are then damaged.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use exr::prelude::*;
use fsot::config::{Descent, Work};
use fsot::files::{BoundEstimate, BoundRecord, Depth, ExportOptions, Format, KernelTaps, Metadata};
use fsot::kernel::Tap;
use fsot::optimizer::StepReport;
use fsot::{Config, Extent, Optimizer, SampleTable, Until};
use png::{BitDepth, ColorType};

/// A `.npy` file with this dictionary, whose length need not be right.
pub fn npy(version: u8, dictionary: &str, values: &[u8]) -> Vec<u8> {
    let length = dictionary.len() as u32;
    let length = match version {
        1 => (length as u16).to_le_bytes().to_vec(),
        _ => length.to_le_bytes().to_vec(),
    };
    [b"\x93NUMPY", &[version, 0][..], &length, dictionary.as_bytes(), values].concat()
}

/// Of a frame, of slices with moments and of sweeps, all of one run; and what it optimises.
pub fn checkpoints() -> (Config, Vec<Vec<u8>>) {
    let config = Config::new(Extent::animation(2, 4, 4), 2).with_descent(Descent::sgd());
    let mut optimizer = Optimizer::new(config.clone()).unwrap();
    let mut seeds = Vec::new();
    let work = Work { frame_sweeps: 2, slices_per_class: 32, sweeps: 1 };
    let observe = |step: &StepReport| {
        let mut bytes = Vec::new();
        step.checkpoint().write(&mut bytes).unwrap();
        seeds.push(bytes);
        ControlFlow::Continue(())
    };
    optimizer.run_observed(Until::Work(work), observe).unwrap();
    (config, seeds)
}

/// Arrays of all types, orders and numbers of axes.
pub fn arrays() -> Vec<Vec<u8>> {
    let extent = Extent { frames: 2, height: 2, width: 3, spp: 1 };
    let values = SampleTable::white_noise(extent, 2, 1).unwrap().into_values();
    let f4: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let f8: Vec<u8> = values.iter().flat_map(|value| f64::from(*value).to_be_bytes()).collect();
    let ranks: Vec<u8> = (0..24_u16).flat_map(|rank| (rank * 7 % 24).to_le_bytes()).collect();
    let bytes: Vec<u8> = (0..24).map(|i| i * 10).collect();
    [
        (1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3, 1, 2), }   \n", &f4),
        (1, "{'descr': '<f4', 'fortran_order': False, 'shape': (1L, 4L, 6L, 1L, 1L), }\n", &f4),
        (3, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3, 1, 2), }\n", &f4),
        (2, "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2, 3, 1, 2), }\n", &f4),
        (1, "{'shape': (24,), 'descr': '>f8', 'fortran_order': False}", &f8),
        (1, "{'descr': '<u2', 'fortran_order': False, 'shape': (4, 6)}", &ranks),
        (1, "{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3, 4)}", &bytes),
        (1, "{'descr': [('x', '<f4'), ('y', '<f4')], 'fortran_order': False, 'shape': (12,)}", &f4),
    ]
    .map(|(version, dictionary, values)| npy(version, dictionary, values))
    .to_vec()
}

pub fn texts() -> Vec<Vec<u8>> {
    let numbers = |count: usize| (0..count).map(|i| format!("0.{i:03}")).collect::<Vec<_>>();
    [
        numbers(16).join("\n"),
        numbers(32).chunks(2).map(|line| line.join(" ") + "\n").collect(),
        format!("x,y\n# words\n{}\n", numbers(18).join(",0.5\r\n") + ",0.25"),
        (0..16).map(|rank| format!("{};", rank * 5 % 16)).collect(),
        "0 255 17 3\n".repeat(4),
    ]
    .map(String::into_bytes)
    .to_vec()
}

/// C and C++, ours and others'.
pub fn sources() -> Vec<Vec<u8>> {
    let home = tempfile::tempdir().unwrap();
    let table = SampleTable::white_noise(Extent::animation(2, 3, 4), 2, 1).unwrap();
    let written = |format: Format, name: &str, depth: Depth| {
        let options = ExportOptions { depth: Some(depth), ..ExportOptions::new(format) };
        table.export(home.path().join(name), &options).unwrap();
        fs::read(home.path().join(name)).unwrap()
    };
    let list = (0..16).map(|rank| format!("{},", rank * 5 % 16)).collect::<String>();
    vec![
        written(Format::C, "a.h", Depth::F32),
        written(Format::C, "b.h", Depth::U8),
        written(Format::Pbrt, "c.cpp", Depth::U16),
        format!("// ranks\nstatic const unsigned char mask[4][4] = {{{list}}};\n").into_bytes(),
        b"int a[2] = {4, 4}; const float mask[] = {{0.25f, 1e-3f}, {0x1p-1f, .5F}};".to_vec(),
    ]
}

/// Bare numbers with the text beside them, and with the record of their export.
pub fn exported(folder: &Path) -> [Vec<u8>; 2] {
    let table = SampleTable::white_noise(Extent::animation(2, 3, 4).with_spp(2), 5, 1).unwrap();
    for (format, name) in [(Format::Raw, "alone.raw"), (Format::Fast, "mask.bin")] {
        table.export(folder.join(name), &ExportOptions::new(format)).unwrap();
    }
    fs::remove_file(folder.join("alone.raw.json")).unwrap();
    ["alone.raw.txt", "mask.bin.json"].map(|name| fs::read(folder.join(name)).unwrap())
}

/// A table, and its metadata with everything in them.
pub fn metadata(folder: &Path) -> (SampleTable, Vec<u8>) {
    let extent = Extent::still(4, 4);
    let table = SampleTable::white_noise(extent, 2, 1).unwrap();
    let estimate = BoundEstimate {
        value: 0.25,
        standard_error: f64::NAN,
        ratio_to_white_noise: 0.5,
        ratio_standard_error: 1e-3,
    };
    let config = serde_json::to_value(Config::new(extent, 2)).unwrap();
    let metadata = Metadata {
        kernels: vec![KernelTaps { term: 0, taps: vec![Tap { dt: 0, dy: -1, dx: 1, weight: 0.5 }] }],
        bound: Some(BoundRecord { before: estimate, after: estimate }),
        ..Metadata::new(extent, 2, u64::MAX, config)
    };
    let path = folder.join("seed.npy");
    table.save_with(&path, &metadata).unwrap();
    (table, fs::read(path.with_extension("json")).unwrap())
}

pub fn pngs() -> Vec<Vec<u8>> {
    let kinds = [
        (ColorType::Grayscale, BitDepth::One),
        (ColorType::Grayscale, BitDepth::Eight),
        (ColorType::GrayscaleAlpha, BitDepth::Sixteen),
        (ColorType::Indexed, BitDepth::Four),
        (ColorType::Rgb, BitDepth::Eight),
        (ColorType::Rgba, BitDepth::Sixteen),
    ];
    let encode = |(color, depth): (ColorType, BitDepth)| {
        let mut file = Vec::new();
        let (width, height) = (7_usize, 5);
        let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette((0..48).map(|i| 5 * i).collect::<Vec<u8>>());
            encoder.set_trns(vec![0, 128, 255]);
        }
        encoder.set_source_gamma(png::ScaledFloat::new(0.45455));
        let row = (width * color.samples() * depth as usize).div_ceil(8);
        let data: Vec<u8> = (0..row * height).map(|i| (i * 31) as u8).collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
        file
    };
    kinds.map(encode).to_vec()
}

pub fn exrs() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    for compression in [Compression::Uncompressed, Compression::RLE, Compression::ZIP16, Compression::PIZ] {
        for alpha in [false, true] {
            let value = |at: Vec2<usize>| (at.0 * 5 + at.1) as f32 / 20.0;
            let encoding = Encoding { compression, ..Encoding::UNCOMPRESSED };
            let mut file = std::io::Cursor::new(Vec::new());
            if alpha {
                let channels =
                    SpecificChannels::rgba(move |at| (value(at), 0.5_f32, 1.5_f32, f16::from_f32(0.5)));
                let layer = Layer::new((5, 4), LayerAttributes::named("layer"), encoding, channels);
                Image::from_layer(layer).write().non_parallel().to_buffered(&mut file).unwrap();
            } else {
                let channels = SpecificChannels::rgb(move |at| (value(at), 0.5_f32, 1.5_f32));
                let layer = Layer::new((5, 4), LayerAttributes::default(), encoding, channels);
                Image::from_layer(layer).write().non_parallel().to_buffered(&mut file).unwrap();
            }
            files.push(file.into_inner());
        }
    }
    files
}
