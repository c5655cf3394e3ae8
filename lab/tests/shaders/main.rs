//! The shaders among the examples: they compile, and run on a machine of ours they read what the table holds.

mod machine;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use fsot::{Extent, SampleTable, Site};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, ShaderStage, front};

use self::machine::Machine;
use self::machine::Scalar::{F, U};

/// Where pixels and frames lie on 2 x 2 groups, so that tiles of these sizes repeat.
const GROUPS: [u32; 3] = [2, 2, 1];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/shaders")
}

fn source(language: &str) -> String {
    fs::read_to_string(folder().join(format!("fsot.{language}"))).unwrap()
}

/// The source for a table of this shape, as a reader changes it.
fn shaped(source: &str, table: &SampleTable, levels: u32) -> String {
    let [frames, height, width, spp, dims] = table.shape();
    let shape = [("WIDTH", width), ("HEIGHT", height), ("FRAMES", frames), ("SPP", spp), ("DIMS", dims)];
    let mut text = String::new();
    let mut changed = 0;
    for line in source.lines() {
        let constant = line.strip_suffix(';').and_then(|line| line.split_once(" = "));
        let constant = constant.filter(|(name, _)| name.contains("const ") && name.contains("FSOT_"));
        let new = constant.map(|(name, _)| match shape.iter().find(|(axis, _)| name.ends_with(axis)) {
            Some((_, len)) => format!("{name} = {len}u;"),
            None => format!("{name} = {levels}.0;"),
        });
        changed += usize::from(new.is_some());
        text += new.as_deref().unwrap_or(line);
        text.push('\n');
    }
    assert_eq!(changed, 6, "constants of the shape");
    text
}

fn validated(module: Module, text: &str) -> Module {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    if let Err(error) = validator.validate(&module) {
        panic!("{}", error.emit_to_string(text));
    }
    module
}

fn glsl(text: &str) -> Module {
    let options = front::glsl::Options::from(ShaderStage::Compute);
    match front::glsl::Frontend::default().parse(&options, text) {
        Ok(module) => validated(module, text),
        Err(error) => panic!("{}", error.emit_to_string(text)),
    }
}

fn wgsl(text: &str) -> Module {
    match front::wgsl::parse_str(text) {
        Ok(module) => validated(module, text),
        Err(error) => panic!("{}", error.emit_to_string(text)),
    }
}

/// What is to be pasted of the shader in HLSL, in the words of GLSL: naga does not read HLSL, but that part
/// of the languages is one but for the names of types.
fn hlsl_functions(text: &str) -> Module {
    let (functions, _) = text.split_once("// EXAMPLE").unwrap();
    let names = [
        ("static const", "const"),
        ("uint2", "uvec2"),
        ("int3", "ivec3"),
        ("int4", "ivec4"),
        ("float4", "vec4"),
    ];
    let text = names.iter().fold(functions.to_owned(), |text, (from, to)| text.replace(from, to));
    glsl(&format!("#version 450\n{text}\nlayout(local_size_x = 1) in;\nvoid main() {{}}\n"))
}

/// What is to be pasted, for this table.
fn functions(language: &str, table: &SampleTable) -> Module {
    let text = shaped(&source(language), table, 256);
    match language {
        "glsl" => glsl(&text),
        "wgsl" => wgsl(&text),
        _ => hlsl_functions(&text),
    }
}

/// A table whose numbers all differ, in tiles that are no powers of two.
fn odd() -> SampleTable {
    SampleTable::white_noise(Extent::animation(3, 5, 7).with_spp(2), 3, 1).unwrap()
}

fn even() -> SampleTable {
    SampleTable::white_noise(Extent::animation(2, 8, 4), 2, 2).unwrap()
}

/// Where the README says that use `k` is read.
fn site(table: &SampleTable, [x, y, frame]: [u32; 3], k: u32) -> Site {
    let Extent { frames, height, width, .. } = table.extent();
    let by = table.extent().displacement(u64::from(k));
    let [x, y, frame] = [x, y, frame].map(|at| at as usize);
    Site { frame: frame % frames, y: (y + by.y) % height, x: (x + by.x) % width }
}

/// Level of a number in a texture of so many levels, as exports quantise.
fn level(number: f32, levels: u32) -> f32 {
    (number * levels as f32).floor()
}

/// What a UNORM texture of the table gives.
fn texel(table: &SampleTable, levels: u32, site: Site) -> [f32; 4] {
    let mut texel = [0.0, 0.0, 0.0, 1.0];
    for (channel, &number) in texel.iter_mut().zip(table.sample(site, 0)) {
        *channel = level(number, levels) / (levels - 1) as f32;
    }
    texel
}

/// Runs the example of a shader, and compares all that it reads with the table.
fn example_reads(module: &Module, table: &SampleTable, levels: u32) {
    let Extent { frames, height, .. } = table.extent();
    let uses = 3;
    let fetch = |binding: u32, [x, y, layer]: [usize; 3]| match binding {
        0 => texel(table, levels, Site { frame: y / height, y: y % height, x }),
        1 => texel(table, levels, Site { frame: layer, y, x }),
        other => panic!("no texture is bound to {other}"),
    };
    let side = [8 * GROUPS[0], 8 * GROUPS[1], uses * frames as u32];
    let invocations: u32 = side.iter().product();
    let buffers = HashMap::from([
        (3, table.values().iter().copied().map(F).collect()),
        (4, vec![F(f32::NAN); 8 * invocations as usize]),
        (5, GROUPS.map(U).to_vec()),
    ]);
    let mut machine = Machine::new(module, buffers, Box::new(fetch));
    for index in 0..invocations {
        machine.invoke([index % side[0], index / side[0] % side[1], index / side[0] / side[1]], GROUPS);
    }
    let numbers: Vec<f32> = machine.buffer(4).iter().map(|scalar| scalar.float()).collect();
    for (index, read) in (0..).zip(numbers.chunks_exact(8)) {
        let id = [index % side[0], index / side[0] % side[1], index / side[0] / side[1]];
        let expected = &table.sample(site(table, id, id[2] / frames as u32), 0)[..2];
        let decoded: Vec<f32> =
            expected.iter().map(|&number| (level(number, levels) + 0.5) / levels as f32).collect();
        // Bit for bit: all these are fractions with a power of two below.
        assert_eq!((&read[..2], &read[2..4], &read[4..6]), (&*decoded, &*decoded, expected), "{id:?}");
    }
}

#[test]
fn what_is_pasted_finds_the_table_in_every_language() {
    for table in [odd(), even()] {
        let [frames, height, width, spp, dims] = table.shape();
        for language in ["glsl", "wgsl", "hlsl"] {
            let module = functions(language, &table);
            let mut machine = Machine::new(&module, HashMap::new(), Box::new(|_, _| [0.0; 4]));
            let [width, height, frames] = [width, height, frames].map(|len| len as u32);
            for frame in [0, 1, frames - 1, frames, 5 * frames + 1] {
                for (y, x) in (0..2 * height).flat_map(|y| (0..2 * width).map(move |x| (y, x))) {
                    let here = site(&table, [x, y, frame], 0);
                    let (pixel, frame) = ([U(x), U(y)], [U(frame)]);
                    let at = machine.call("fsot_atlas", &[&pixel, &frame]);
                    let down = here.frame * table.extent().height + here.y;
                    assert_eq!([at[0].index(), at[1].index()], [here.x, down], "{language}");
                    let at = machine.call("fsot_layer", &[&pixel, &frame]);
                    let at = [at[0].index(), at[1].index(), at[2].index()];
                    assert_eq!(at, [here.x, here.y, here.frame], "{language}");
                    for (s, d) in (0..spp).flat_map(|s| (0..dims).map(move |d| (s, d))) {
                        let (later, d) = ([U((s + spp) as u32)], [U(d as u32)]);
                        let index = machine.call("fsot_index", &[&pixel, &frame, &later, &d]);
                        let number = table.values()[index[0].index()];
                        assert_eq!(number, table.sample(here, s)[d[0].index()], "{language}");
                    }
                }
            }
            // No level decodes to 0 or 1.
            for level in 0..256 {
                let decoded = machine.call("fsot_decode", &[&[F(level as f32 / 255.0); 4]]);
                assert_eq!(decoded, [F((level as f32 + 0.5) / 256.0); 4], "{language}");
            }
        }
    }
}

#[test]
fn displacements_are_those_of_the_library() {
    for (side, exact) in [([64, 64], true), ([128, 128], true), ([48, 20], false)] {
        let table = SampleTable::white_noise(Extent::still(side[0], side[1]), 1, 0).unwrap();
        for language in ["glsl", "wgsl", "hlsl"] {
            let module = functions(language, &table);
            let mut machine = Machine::new(&module, HashMap::new(), Box::new(|_, _| [0.0; 4]));
            for k in 0..1000 {
                let by = machine.call("fsot_displacement", &[&[U(k)]]);
                let found = [by[0].index(), by[1].index()];
                let expected = table.extent().displacement(u64::from(k));
                // Sixteen bits of the sequence: beside powers of two they may end a pixel earlier.
                let less = [expected.x - found[0], expected.y - found[1]];
                assert!(less == [0; 2] || !exact && less.iter().all(|&less| less < 2), "{k}: {less:?}");
            }
        }
    }
}

#[test]
fn the_example_in_glsl_reads_the_table() {
    for (table, levels) in [(odd(), 256), (even(), 1 << 16)] {
        example_reads(&glsl(&shaped(&source("glsl"), &table, levels)), &table, levels);
    }
}

#[test]
fn the_example_in_wgsl_reads_the_table() {
    for (table, levels) in [(odd(), 256), (even(), 1 << 16)] {
        example_reads(&wgsl(&shaped(&source("wgsl"), &table, levels)), &table, levels);
    }
}

/// The lines of the guide's table for a language: where the table is, and how it is read.
fn lines_of_the_guide(language: &str) -> Vec<(String, String)> {
    let guide = fs::read_to_string(folder().join("../../docs/choosing.md")).unwrap();
    let rows = guide.lines().filter_map(|line| line.strip_prefix(&format!("| {language}, ")));
    let cells = rows.filter_map(|row| row.strip_suffix("` |")?.split_once(" | `"));
    cells.map(|(place, line)| (place.to_owned(), line.to_owned())).collect()
}

#[test]
fn the_lines_of_the_guide_compile() {
    let table = even();
    for language in ["GLSL", "WGSL"] {
        let text = shaped(&source(&language.to_lowercase()), &table, 256);
        let (functions, _) = text.split_once("// EXAMPLE").unwrap();
        let lines = lines_of_the_guide(language);
        assert_eq!(lines.len(), 2, "{lines:?}");
        for (place, line) in lines {
            if language == "WGSL" {
                let kind = if place == "array" { "texture_2d_array<f32>" } else { "texture_2d<f32>" };
                wgsl(&format!(
                    "{functions}\n@group(0) @binding(0) var table: {kind};\n\
                     fn read(pixel: vec2<u32>, frame: u32) -> vec2<f32> {{ {line} return u; }}\n"
                ));
            } else {
                let kind = if place == "array" { "2DArray" } else { "2D" };
                // naga has textures and samplers apart.
                let line =
                    line.replace("texelFetch(table,", &format!("texelFetch(sampler{kind}(table, nearest),"));
                glsl(&format!(
                    "{functions}\nlayout(set = 0, binding = 0) uniform texture{kind} table;\n\
                     layout(set = 0, binding = 1) uniform sampler nearest;\n\
                     vec2 read(uvec2 pixel, uint frame) {{ {line} return u; }}\n\
                     layout(local_size_x = 1) in;\nvoid main() {{}}\n"
                ));
            }
        }
    }
}

/// Where there is glslang, which knows HLSL (Debian's package `glslang-tools`).
#[test]
fn the_example_in_hlsl_reads_the_table() {
    let home = tempfile::tempdir().unwrap();
    let [text, binary] = ["fsot.hlsl", "fsot.spv"].map(|name| home.path().join(name));
    for (table, levels) in [(odd(), 256), (even(), 1 << 16)] {
        fs::write(&text, shaped(&source("hlsl"), &table, levels)).unwrap();
        let compiler = Command::new("glslangValidator")
            .args(["-D", "-V", "-e", "main", "-S", "comp", "-o"])
            .args([&binary, &text])
            .output();
        let Ok(compiled) = compiler else {
            println!("no glslangValidator here: left out");
            return;
        };
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stdout));
        let options = front::spv::Options::default();
        let module = front::spv::parse_u8_slice(&fs::read(&binary).unwrap(), &options).unwrap();
        example_reads(&validated(module, ""), &table, levels);
    }
}
