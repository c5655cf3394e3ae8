//! `c` and `pbrt`, compiled where there is a compiler, and read by what it makes of them.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use fsot::files::{Depth, Format};
use fsot::{Extent, SampleTable};

use crate::{export, kept, small_shapes, table};

const C: [&str; 6] = ["cc", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"];
const CPP: [&str; 6] = ["c++", "-std=c++17", "-pedantic", "-Wall", "-Wextra", "-Werror"];

/// Compiles the files, and runs what comes of them; `None` where there is no compiler.
fn run(home: &Path, compiler: &[&str], arguments: &[&str]) -> Option<Vec<u8>> {
    let compiled = Command::new(compiler[0])
        .args(&compiler[1..])
        .args(arguments)
        .args(["-o", "program"])
        .current_dir(home)
        .output();
    let Ok(compiled) = compiled else {
        println!("no {} here: left out", compiler[0]);
        return None;
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let output = Command::new(home.join("program")).current_dir(home).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    Some(output.stdout)
}

/// All values in the order of the table, as the program has written them: bare `float`, native.
fn assert_read(bytes: &[u8], table: &SampleTable, depth: Depth, what: &str) {
    assert_eq!(bytes.len(), 4 * table.values().len(), "{what}");
    let read = bytes.chunks_exact(4).map(|bytes| f32::from_ne_bytes(bytes.try_into().unwrap()));
    let differs = read.zip(table.values()).position(|(read, value)| read != kept(*value, depth));
    assert_eq!(differs, None, "{what}");
}

/// Loops over all samples around a statement.
fn loops(table: &SampleTable, statement: &str) -> String {
    let mut text = String::new();
    for (name, length) in ["frame", "y", "x", "sample", "dim"].iter().zip(table.shape()) {
        let _ = write!(text, "for (size_t {name} = 0; {name} < {length}; ++{name}) ");
    }
    format!("{text}{{ {statement} }}")
}

/// Included twice, in two translation units, and read in both by the index formula of the documents, by our
/// index and by our function.
#[test]
fn headers_are_c_and_cpp() {
    for table in small_shapes() {
        let [_, height, width, spp, dims] = table.shape();
        for depth in [Depth::F32, Depth::U16, Depth::U8] {
            let home = export(&table, "mask.h", Format::C, depth);
            let decode = ["(k + 0.5f) / 256.0f", "(k + 0.5f) / 65536.0f", "", "k"][depth as usize];
            let read = format!(
                "size_t at = (((frame * {height} + y) * {width} + x) * {spp} + sample) * {dims} + dim;\n\
                 float k = (float)fsot_mask_values[at], u = {decode};\n\
                 size_t far = frame + FSOT_MASK_FRAMES, down = y + FSOT_MASK_HEIGHT;\n\
                 size_t right = x + FSOT_MASK_WIDTH;\n\
                 if (fwrite(&u, sizeof u, 1, stdout) != 1) return 1;\n\
                 if (other(frame, y, x, sample, dim) != u) return 2;\n\
                 if (fsot_mask_sample(far, down, right, sample + FSOT_MASK_SPP, dim + FSOT_MASK_DIMS) != u)\n\
                 return 3;"
            );
            let main = format!(
                "#include \"mask.h\"\n#include \"mask.h\"\n#include <stdio.h>\n\
                 float other(size_t frame, size_t y, size_t x, size_t sample, size_t dim);\n\
                 int main(void) {{ {} return 0; }}\n",
                loops(&table, &read),
            );
            let other = "#include \"mask.h\"\n\
                 float other(size_t frame, size_t y, size_t x, size_t sample, size_t dim);\n\
                 float other(size_t frame, size_t y, size_t x, size_t sample, size_t dim) {\n\
                 return fsot_mask_sample(frame, y, x, sample, dim); }\n";
            for (compiler, ending) in [(&C, "c"), (&CPP, "cpp")] {
                let names = ["main", "other"].map(|name| format!("{name}.{ending}"));
                fs::write(home.home.path().join(&names[0]), &main).unwrap();
                fs::write(home.home.path().join(&names[1]), other).unwrap();
                let Some(bytes) = run(home.home.path(), compiler, &[&names[0], &names[1]]) else { continue };
                assert_read(&bytes, &table, depth, &format!("{ending} {depth} {:?}", table.shape()));
            }
        }
    }
}

/// Nobody is warned of a header of which nothing is used, nor of two together.
#[test]
fn headers_can_lie_idle_beside_others() {
    let table = table((Extent::still(4, 4), 2));
    let home = export(&table, "3-å.h", Format::C, Depth::U8);
    for (name, depth) in [("int.h", Depth::F32), ("__x--Y__.h", Depth::U16), ("ß.h", Depth::U8)] {
        let options =
            fsot::files::ExportOptions { depth: Some(depth), ..fsot::files::ExportOptions::new(Format::C) };
        table.export(home.home.path().join(name), &options).unwrap();
    }
    let main = "#include \"3-\u{e5}.h\"\n#include \"int.h\"\n#include \"__x--Y__.h\"\n#include \"\u{df}.h\"\n\
                #include <limits.h>\n#include <stdio.h>\n\
                int main(void) { return fwrite(fsot_3_values, 1, sizeof fsot_3_values, stdout) != 32 \
                || fsot_int_sample(0, 0, 0, 0, 1) != fsot_int_values[1] || fsot_x_y_values[0] != 0 \
                || fsot_table_values[0] != 0; }\n";
    for (compiler, name) in [(&C, "main.c"), (&CPP, "main.cpp")] {
        fs::write(home.home.path().join(name), main).unwrap();
        let Some(bytes) = run(home.home.path(), compiler, &[name]) else { continue };
        assert!(bytes.iter().zip(table.values()).all(|(byte, value)| *byte == (value * 256.0) as u8));
    }
}

/// Two tables whose names become the same: never one in the place of the other.
#[test]
fn headers_of_one_name_do_not_hide_each_other() {
    let home = export(&table((Extent::still(4, 4), 2)), "a-b.h", Format::C, Depth::U8);
    let again = SampleTable::white_noise(Extent::still(4, 4), 2, 9).unwrap();
    again.export(home.home.path().join("a_b.h"), &fsot::files::ExportOptions::new(Format::C)).unwrap();
    let path = home.home.path().join("main.c");
    fs::write(&path, "#include \"a-b.h\"\n#include \"a_b.h\"\nint main(void) { return 0; }\n").unwrap();
    let Ok(output) = Command::new("cc").arg(&path).current_dir(home.home.path()).output() else {
        println!("no cc here: left out");
        return;
    };
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && words.contains("fsot_a_b_values"), "{words}");
}

/// As in pbrt-v4, whose `bluenoise.h` declares the array and divides by 65535.
#[test]
fn textures_of_pbrt_lie_x_first() {
    for table in small_shapes() {
        let [frames, height, width, spp, dims] = table.shape();
        let home = export(&table, "bluenoise.cpp", Format::Pbrt, Depth::U16);
        let read = format!(
            "size_t texture = (frame * {spp} + sample) * {dims} + dim;\n\
             float u = (BlueNoiseTextures[texture][x][y] + 0.5f) / 65536.0f;\n\
             if (fwrite(&u, sizeof u, 1, stdout) != 1) return 1;"
        );
        let read = loops(&table, &read);
        let main = format!(
            "#include \"bluenoise.cpp\"\n#include <cstdio>\nusing namespace pbrt;\n\
                            int main() {{ {read} }}\n"
        );
        fs::write(home.home.path().join("main.cpp"), main).unwrap();
        if let Some(bytes) = run(home.home.path(), &CPP, &["-DFSOT_STANDALONE", "main.cpp"]) {
            assert_read(&bytes, &table, Depth::U16, &format!("alone {:?}", table.shape()));
        }
        // In the place of pbrt's own, below a header that declares it.
        fs::create_dir_all(home.home.path().join("pbrt/util")).unwrap();
        let declare = |textures: usize| {
            let header = format!(
                "#include <cstdint>\n#define PBRT_CONST const\nnamespace pbrt {{\n\
                 static constexpr int BlueNoiseResolution = {width};\n\
                 static constexpr int NumBlueNoiseTextures = {textures};\n\
                 extern PBRT_CONST uint16_t BlueNoiseTextures\
                 [NumBlueNoiseTextures][BlueNoiseResolution][BlueNoiseResolution];\n}}\n"
            );
            fs::write(home.home.path().join("pbrt/util/bluenoise.h"), header).unwrap();
        };
        declare(frames * spp * dims);
        let main = format!(
            "#include <pbrt/util/bluenoise.h>\n#include <cstdio>\nusing namespace pbrt;\n\
                            int main() {{ {read} }}\n"
        );
        fs::write(home.home.path().join("main.cpp"), main).unwrap();
        if width == height {
            if let Some(bytes) = run(home.home.path(), &CPP, &["-I.", "main.cpp", "bluenoise.cpp"]) {
                assert_read(&bytes, &table, Depth::U16, "in pbrt");
            }
            declare(48);
        }
        // Other lengths than the header's are no program, and the compiler says which it should have.
        let output =
            Command::new("c++").args(["-I.", "-c", "bluenoise.cpp"]).current_dir(home.home.path()).output();
        if let Ok(output) = output {
            let words = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(!output.status.success() && words.contains("set it in bluenoise.h"), "{words}");
        }
    }
}

/// Bare numbers within a program, without a source text of them: as the documents show it.
#[cfg(target_os = "linux")]
#[test]
fn bare_numbers_are_assembled_into_a_program() {
    let docs = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/formats.md")).unwrap();
    let snippet = docs.split("```c\n").find(|part| part.starts_with("/* mask.raw in the program")).unwrap();
    let snippet = snippet.split("```").next().unwrap();
    let table = table((Extent::still(6, 5), 2));
    let home = export(&table, "mask.raw", Format::Raw, Depth::U16);
    let main = format!(
        "#include <stdio.h>\n{snippet}\nint main(void) {{\n\
         for (int at = 0; at < 60; ++at) {{ float u = (mask[at] + 0.5f) / 65536.0f;\n\
         if (fwrite(&u, sizeof u, 1, stdout) != 1) return 1; }}\nreturn 0; }}\n"
    );
    fs::write(home.home.path().join("main.c"), main).unwrap();
    let Some(bytes) = run(home.home.path(), &["cc", "-Wall", "-Wextra", "-Werror"], &["main.c"]) else {
        return;
    };
    assert_read(&bytes, &table, Depth::U16, "assembled");
}
