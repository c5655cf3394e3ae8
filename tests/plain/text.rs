//! `csv`, `dat`, and what is read of C and C++ that nobody here wrote.

use std::fs;

use fsot::files::{Depth, Format, ImportOptions};
use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{assert_kept, export, import, lengths, small_shapes};

#[test]
fn a_line_is_a_sample_in_the_order_of_the_table() {
    for table in small_shapes() {
        let dims = table.dims();
        let read = |name: &str, format, between: &str, skipped: usize| {
            let home = export(&table, name, format, Depth::F32);
            let text = fs::read_to_string(&home.path).unwrap();
            assert!(text.ends_with('\n'));
            let numbers = |line: &str| -> Vec<f32> {
                let numbers: Vec<f32> = line.split(between).map(|number| number.parse().unwrap()).collect();
                assert_eq!(numbers.len(), dims, "{line}");
                numbers
            };
            let read: Vec<f32> = text.lines().skip(skipped).flat_map(numbers).collect();
            assert!(
                read.iter().map(|v| v.to_bits()).eq(table.values().iter().map(|v| v.to_bits())),
                "{name}"
            );
            // Without the record, lengths say what the lines are.
            let home = home.without_record();
            assert_eq!(home.import(&lengths(&table)).table, table, "{name}");
            text.lines().next().unwrap().to_string()
        };
        let names = read("table.csv", Format::Csv, ",", 1);
        let dim_names: Vec<String> = (0..dims).map(|dim| format!("dim{dim}")).collect();
        assert_eq!(names, dim_names.join(","));
        read("table.dat", Format::Dat, " ", 0);
    }
}

/// The shortest digits that tell a number from its neighbours.
#[test]
fn numbers_are_short() {
    let table = SampleTable::new(Extent::still(1, 3), 2, vec![0.0, 0.5, 0.1, 1e-7, 0.3, 1.0_f32.next_down()])
        .unwrap();
    let home = export(&table, "table.dat", Format::Dat, Depth::F32);
    assert_eq!(fs::read_to_string(&home.path).unwrap(), "0.0 0.5\n0.1 1e-7\n0.3 0.99999994\n");
}

/// Headers say their lengths themselves, wherever they go.
#[test]
fn sources_are_read_without_a_record() {
    for table in small_shapes() {
        for (name, format, depth) in [
            ("a.h", Format::C, Depth::F32),
            ("b.h", Format::C, Depth::U16),
            ("c.h", Format::C, Depth::U8),
            ("d.cpp", Format::Pbrt, Depth::U16),
        ] {
            let home = export(&table, name, format, depth).without_record();
            let imported = home.import(&ImportOptions::default());
            assert_kept(&imported.table, &table, depth, name);
            // Under a name that says nothing, and by lengths alone.
            let other = home.home.path().join("noise");
            fs::rename(&home.path, &other).unwrap();
            assert_kept(&import(&other, &ImportOptions::default()).table, &table, depth, name);
            let levels = depth.levels().map(u64::from);
            let imported = import(&other, &ImportOptions { levels, ..lengths(&table) });
            assert_kept(&imported.table, &table, depth, name);
        }
    }
}

#[test]
fn sources_of_others_are_read() {
    let home = tempdir().unwrap();
    let path = home.path().join("blue_noise.h");
    let write = |declaration: &str, numbers: &dyn Fn(usize) -> String| {
        let list: Vec<String> = (0..64).map(numbers).collect();
        fs::write(&path, format!("{declaration} = {{ {} }};", list.join(", "))).unwrap();
    };
    let levels: Vec<f32> = (0..64).map(|i| ((i * 37 % 64 * 4 + i % 2) as f32 + 0.5) / 256.0).collect();
    let imported = |options: &ImportOptions| import(&path, options);
    // A mask of bytes, in base 16.
    write("const unsigned char mask[64]", &|i| format!("0x{:02X}", i * 37 % 64 * 4 + i % 2));
    let found = imported(&ImportOptions::default());
    assert_eq!((found.table.shape(), found.levels), ([1, 8, 8, 1, 1], Some(256)));
    assert_eq!(found.table.values(), levels);
    assert!(found.to_string().starts_with("C unsigned char of shape [64] as a list"), "{found}");
    // Pairs of floats.
    write("float2 mask[8][8]", &|i| format!("{{{i}.0f / 64, 0.5f}}"));
    assert!(SampleTable::import(&path, &ImportOptions::default()).is_err());
    write("float2 mask[]", &|i| format!("{{{}f, .5f}}", i as f32 / 64.0));
    let found = imported(&ImportOptions::default());
    assert_eq!((found.table.shape(), found.table.values()[2]), ([1, 8, 8, 1, 2], 1.0 / 64.0));
    // Two arrays.
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, format!("static int sizes[2] = {{8, 8}};\n{text}")).unwrap();
    let error = SampleTable::import(&path, &ImportOptions::default()).unwrap_err().to_string();
    assert!(error.ends_with("it has several arrays, sizes, mask: name one, --array NAME"), "{error}");
    let array = Some("mask".into());
    assert_eq!(imported(&ImportOptions { array, ..ImportOptions::default() }).table, found.table);
}

/// Textures of pbrt of which nobody says what they are: dimensions.
#[test]
fn textures_of_pbrt_are_dimensions_unless_lengths_say_otherwise() {
    let home = tempdir().unwrap();
    let path = home.path().join("bluenoise.cpp");
    let row = |t: usize, x: usize| {
        (0..4).map(|y| format!("{}", 40_000 + 1000 * t + 100 * x + y)).collect::<Vec<_>>().join(",")
    };
    let texture = |t| (0..4).map(|x| format!("{{{}}}", row(t, x))).collect::<Vec<_>>().join(",");
    let textures: Vec<String> = (0..6).map(|t| format!("{{{}}}", texture(t))).collect();
    let text = format!(
        "#include <pbrt/util/bluenoise.h>\nnamespace pbrt {{\nPBRT_CONST uint16_t BlueNoiseTextures\
         [NumBlueNoiseTextures][BlueNoiseResolution][BlueNoiseResolution] = {{{}}};\n}}\n",
        textures.join(",\n")
    );
    fs::write(&path, text).unwrap();
    let found = import(&path, &ImportOptions::default());
    assert_eq!(found.table.shape(), [1, 4, 4, 1, 6]);
    assert_eq!(found.table.view()[[0, 3, 1, 0, 5]], (45_103.0 + 0.5) / 65536.0);
    for (options, shape) in [
        (ImportOptions { frames: Some(6), ..ImportOptions::default() }, [6, 4, 4, 1, 1]),
        (ImportOptions { frames: Some(3), ..ImportOptions::default() }, [3, 4, 4, 1, 2]),
        (ImportOptions { dims: Some(2), ..ImportOptions::default() }, [3, 4, 4, 1, 2]),
        (ImportOptions { dims: Some(1), spp: Some(2), ..ImportOptions::default() }, [3, 4, 4, 2, 1]),
        (ImportOptions { dims: Some(3), frames: Some(1), ..ImportOptions::default() }, [1, 4, 4, 2, 3]),
    ] {
        let found = import(&path, &options).table;
        assert_eq!(found.shape(), shape);
        let [_, _, _, spp, dims] = shape;
        for ((frame, y, x, sample, dim), value) in found.view().indexed_iter() {
            let texture = (frame * spp + sample) * dims + dim;
            assert_eq!(*value, ((40_000 + 1000 * texture + 100 * x + y) as f32 + 0.5) / 65536.0);
        }
    }
}
