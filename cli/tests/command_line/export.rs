//! `fsot export`: textures and what they cost, in words, in JSON and in files.

use std::fs;
use std::path::Path;

use fsot::files::{Depth, Rounding};
use fsot::{Extent, SampleTable};
use tempfile::{TempDir, tempdir};

use crate::{command, names, run, texts};

/// A finished table with metadata, of 4 frames.
fn home() -> TempDir {
    let home = tempdir().unwrap();
    let arguments =
        "table --width 16 --height 16 --frames 4 --sweeps 4 --no-bound --quiet --temporal ema:0.2";
    run(home.path(), arguments);
    home
}

fn load(home: &Path, name: &str) -> SampleTable {
    SampleTable::load(home.join(name)).unwrap()
}

#[test]
fn a_table_goes_out_and_comes_back() {
    let home = home();
    for (arguments, depth, rounding) in [
        ("--to atlas --out mask.png", Depth::U8, Rounding::Floor),
        ("--to atlas --out mask.png --bits 16", Depth::U16, Rounding::Floor),
        ("--to slices --out mask.png --rounding diffuse", Depth::U8, Rounding::Diffuse),
        ("--to slices --out mask.png --name {frame}", Depth::U8, Rounding::Floor),
        ("--to ktx2 --out mask.ktx2 --bits half", Depth::Half, Rounding::Floor),
        ("--to exr --out mask.exr", Depth::F32, Rounding::Floor),
        ("--to exr-layers --out mask.exr --bits half", Depth::Half, Rounding::Floor),
        ("--to raw --out mask.raw", Depth::F32, Rounding::Floor),
        ("--to raw --out mask.raw --bits half", Depth::Half, Rounding::Floor),
        ("--to raw --out mask.raw --bits 8 --rounding diffuse", Depth::U8, Rounding::Diffuse),
        ("--to fast --out mask.bin", Depth::F32, Rounding::Floor),
        ("--to pbrt --out mask.cpp", Depth::U16, Rounding::Floor),
        ("--to c --out mask.h --bits 8", Depth::U8, Rounding::Floor),
        ("--to csv --out mask.csv", Depth::F32, Rounding::Floor),
        ("--to dat --out mask.dat", Depth::F32, Rounding::Floor),
    ] {
        run(home.path(), &format!("export table.npy --no-loss {arguments}"));
        let path = arguments.split(' ').find(|word| word.starts_with("mask.")).unwrap();
        run(home.path(), &format!("import {path} --out back.npy"));
        let expected = load(home.path(), "table.npy").quantized(depth, rounding);
        assert_eq!(load(home.path(), "back.npy"), expected, "{arguments}");
    }
}

#[test]
fn what_levels_cost_is_one_line_a_figure() {
    let home = home();
    let (out, err) = run(home.path(), "export table.npy --to slices --out stbn.png");
    assert_eq!(err, "");
    let lines: Vec<&str> = out.lines().collect();
    let [files, record, error, bias, evenness] = lines[..] else { panic!("{out}") };
    let expected = "4 files, stbn_vec2_2Dx1D_16x16x4_0.png to stbn_vec2_2Dx1D_16x16x4_3.png: slices \
                    of [frame, y, x, sample, dim] = [4, 16, 16, 1, 2], 8 bits, k stands for (k + 0.5) / 256";
    assert_eq!((files, record), (expected, "stbn.png.json: how to read it"));
    assert!(error.starts_with("filtered error under its own kernel: 0."), "{error}");
    assert!(bias.starts_with("bias: 0."), "{bias}");
    // 1024 samples in 256 levels.
    let even = "evenness: the emptiest and the fullest of 256 levels have 1.000 and 1.000 of the mean (in \
                the table 1.000 and 1.000)";
    assert_eq!(evenness, even);

    // Another table's metadata say nothing of this one's kernel.
    let noise = SampleTable::white_noise(Extent::animation(4, 16, 16), 2, 1).unwrap();
    noise.save(home.path().join("table.npy")).unwrap();
    let (out, _) = run(home.path(), "export table.npy --to slices --out stbn.png");
    assert!(out.contains("filtered error under the eye's kernel: "), "{out}");

    let (out, _) = run(home.path(), "export table.npy --to slices --out stbn.png --no-loss");
    assert_eq!(out.lines().count(), 2, "{out}");
    let (out, _) = run(home.path(), "export table.npy --to exr --out stbn.exr");
    assert_eq!(out.lines().count(), 2, "values as they are cost nothing: {out}");
    let (out, _) = run(home.path(), "export table.npy --to slices --out stbn.png --quiet");
    assert_eq!(out, "");
    let (json, _) = run(home.path(), "export table.npy --to slices --out stbn.png --json");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["export"]["files"].as_array().unwrap().len(), 4);
    assert_eq!(json["export"]["record"]["decode"], "(k + 0.5) / 256");
    let [before, after] =
        ["before", "after"].map(|when| json["loss"][when]["filtered_error"].as_f64().unwrap());
    assert!((after / before - 1.0).abs() < 0.02, "{before} {after}");
}

/// One number a pixel over many frames under a filter of many frames: the share of numbers below a threshold
/// is a multiple of 1/256, which is more than such a table errs.
#[test]
fn eight_bits_that_cost_much_are_told_of() {
    let home = tempdir().unwrap();
    let arguments = "--width 32 --height 32 --frames 32 --dims 1 --temporal ema:0.05 --sweeps 6";
    run(home.path(), &format!("table {arguments} --no-bound --quiet"));
    let (out, _) = run(home.path(), "export table.npy --to atlas --out mask.png");
    assert!(
        out.ends_with("8 bits cost this table more than 2 %: where that matters, give --bits 16\n"),
        "{out}"
    );
    let (out, _) = run(home.path(), "export table.npy --to atlas --out mask.png --bits 16");
    assert!(out.contains("in the files (+0.") || out.contains("in the files (-0."), "{out}");
    assert!(!out.contains("give --bits"), "{out}");
}

#[test]
fn what_cannot_be_exported_is_refused_in_a_sentence() {
    let home = home();
    fs::create_dir(home.path().join("folder.png")).unwrap();
    for (arguments, code, words) in [
        ("export table.npy --to atlas --out mask.png --bits 32", 1, "give --bits 8 or 16"),
        ("export table.npy --to exr --out mask.exr --bits 8", 1, "give --bits 32 or half"),
        ("export table.npy --to atlas --out mask.exr", 1, "give a name in UTF-8 that ends in .png"),
        ("export table.npy --to slices --out mask.png --name x", 1, "put {frame} into it"),
        ("export table.npy --to slices --out mask.png --name {z}", 1, "has no meaning for {z}"),
        ("export table.npy --to atlas --out folder.png", 1, "it is a directory"),
        ("export table.npy --to atlas --out missing/mask.png", 1, "there is no directory missing"),
        ("export nothing.npy --to atlas --out mask.png", 1, "cannot read nothing.npy"),
        ("export table.npy --to tiff --out mask.png", 2, "give one of atlas, slices, ktx2"),
        ("export table.npy --to atlas --out mask.png --bits 7", 2, "give one of 8, 16, half, 32"),
        ("export table.npy --to atlas --out mask.png --rounding up", 2, "give one of floor, diffuse"),
        ("export table.npy --to atlas", 2, "--out"),
    ] {
        let before = names(home.path());
        let output = command(home.path(), arguments).output().unwrap();
        let (out, err) = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(code), ""), "{arguments}: {err}");
        assert!(err.contains(words), "{arguments}: {err}");
        assert!(code == 2 || err.lines().count() == 1, "{arguments}: {err}");
        assert_eq!(names(home.path()), before, "{arguments}");
    }
}

/// A set of somebody else's by a pattern, and a file that is no picture.
#[test]
fn sets_are_imported_by_a_pattern() {
    let home = home();
    run(home.path(), "export table.npy --to slices --out stbn.png --no-loss");
    fs::remove_file(home.path().join("stbn.png.json")).unwrap();
    let (out, _) = run(home.path(), "import stbn_vec2_2Dx1D_16x16x4_{frame}.png --out back.npy");
    let expected = "stbn_vec2_2Dx1D_16x16x4_{frame}.png: 4 files, PNG of 8 bits of shape [4, 16, 16, 1, 2] \
                    as frame, y, x, sample, dim, 256 levels as (v + 1/2) / 256\n";
    assert!(out.starts_with(expected), "{out}");
    let expected = load(home.path(), "table.npy").quantized(Depth::U8, Rounding::Floor);
    assert_eq!(load(home.path(), "back.npy"), expected);
    fs::write(
        home.path().join("cut.png"),
        &fs::read(home.path().join("stbn_vec2_2Dx1D_16x16x4_0.png")).unwrap()[..99],
    )
    .unwrap();
    let output = command(home.path(), "import cut.png --out other.npy").output().unwrap();
    let (_, err) = texts(&output);
    assert!(output.status.code() == Some(1) && err.contains("the PNG cannot be read"), "{err}");
    assert!(!home.path().join("other.npy").exists());
}

/// The files alone, without the record, by what they say themselves or by flags.
#[test]
fn files_without_a_record_are_read_by_flags() {
    let home = home();
    let table = load(home.path(), "table.npy");
    for (to, flags) in [
        ("raw --out a.raw", ""),
        ("c --out a.h", ""),
        ("csv --out a.csv", "--frames 4"),
        ("dat --out a.dat", "--frames 4"),
        ("fast --out a.bin", "--dtype <f4 --channels 4 --dims 2 --frames 4"),
    ] {
        let (out, _) = run(home.path(), &format!("export table.npy --to {to}"));
        let path = to.split(' ').next_back().unwrap();
        assert!(out.contains(&format!("{path}.json: how to read it")), "{out}");
        fs::remove_file(home.path().join(format!("{path}.json"))).unwrap();
        run(home.path(), &format!("import {path} {flags} --out back.npy"));
        assert_eq!(load(home.path(), "back.npy"), table, "{to}");
    }
    // Which of two arrays.
    let header = fs::read_to_string(home.path().join("a.h")).unwrap();
    fs::write(home.path().join("a.h"), format!("static const int sizes[2] = {{16, 16}};\n{header}")).unwrap();
    let (_, err) = texts(&command(home.path(), "import a.h --out back.npy").output().unwrap());
    assert!(err.contains("sizes, fsot_a_values: name one, --array NAME"), "{err}");
    run(home.path(), "import a.h --array fsot_a_values --out back.npy");
    assert_eq!(load(home.path(), "back.npy"), table);
}
