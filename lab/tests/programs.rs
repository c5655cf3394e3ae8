//! The programs, run as a person runs them, on the smallest work that they do.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use fsot::{Extent, SampleTable};
use serde::Deserialize;
use tempfile::TempDir;

fn run(program: &str, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).output().unwrap()
}

/// What a program prints that ends well.
fn printed(program: &str, arguments: &[&str]) -> String {
    let output = run(program, arguments);
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{complaints}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    text
}

/// What a program says that gives up.
fn complaint(program: &str, arguments: &[&str]) -> String {
    let output = run(program, arguments);
    assert_eq!(output.status.code(), Some(1));
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert!(complaint.starts_with("error: ") && complaint.lines().count() == 1, "{complaint}");
    complaint
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort_unstable();
    names
}

/// All rows of a CSV file; each has all columns.
fn rows<Row: for<'a> Deserialize<'a>>(path: &Path) -> Vec<Row> {
    csv::Reader::from_path(path).unwrap().deserialize().map(Result::unwrap).collect()
}

/// A row of `lecture.csv`.
#[derive(Deserialize)]
struct Compared {
    stage: String,
    spp: u32,
    scene: String,
    sampler: String,
    ratio_to_white_noise: f64,
    standard_error: Option<f64>,
    realisations: u32,
}

#[test]
fn lecture_has_a_table_figures_and_sheets() {
    let home = TempDir::new().unwrap();
    let out = home.path().join("lecture");
    let text = printed(env!("CARGO_BIN_EXE_lecture"), &["--quick", "--out", out.to_str().unwrap()]);
    for name in [
        "white noise",
        "dither mask",
        "FAST, space",
        "STBN",
        "seed permutation",
        "ours, space + eye",
        "denoised",
    ] {
        assert!(text.contains(name), "{name} is missing in: {text}");
    }
    let figures: Vec<Compared> = rows(&out.join("lecture.csv"));
    // Two pictures with 11 samplers and 2 stages, an animation with 15 and 2, each at two numbers of samples.
    assert_eq!(figures.len(), 2 * (2 * 2 * 11 + 2 * 15));
    assert!(figures.iter().all(|row| row.ratio_to_white_noise.is_finite() && row.realisations == 1));
    assert!(figures.iter().all(|row| row.standard_error.is_none()));
    let quoted = |row: &&Compared| row.sampler == "ours, space + eye" && row.stage == "space + eye's time";
    let quoted: Vec<&Compared> = figures.iter().filter(quoted).collect();
    assert!(quoted.iter().map(|row| row.spp).eq([1, 4]));
    assert!(quoted.iter().all(|row| row.scene == "animated_soft_shadow"));
    for sheet in ["soft_shadow-still-1spp", "glossy-still-4spp", "animated_soft_shadow-animated-4spp"] {
        let page = image::open(out.join(format!("{sheet}.png"))).unwrap();
        assert!(page.width() > 1000 && page.height() > 1000, "{sheet}");
    }
}

#[test]
fn a_place_that_cannot_be_written_to_is_named() {
    let home = TempDir::new().unwrap();
    let file = home.path().join("taken");
    fs::write(&file, "").unwrap();
    let taken = file.to_str().unwrap();
    for program in [
        env!("CARGO_BIN_EXE_lecture"),
        env!("CARGO_BIN_EXE_ablation"),
        env!("CARGO_BIN_EXE_race"),
        env!("CARGO_BIN_EXE_compare"),
    ] {
        let quick: &[&str] = if program.contains("compare") { &[] } else { &["--quick"] };
        let said = complaint(program, &[quick, &["--out", taken]].concat());
        assert!(said.contains("cannot create") && said.contains(taken), "{said}");
    }
    assert!(complaint(env!("CARGO_BIN_EXE_pictures"), &[taken]).contains("cannot create"));
}

#[test]
fn ablation_changes_one_thing_at_a_time() {
    let home = TempDir::new().unwrap();
    let out = home.path().to_str().unwrap();
    let text = printed(env!("CARGO_BIN_EXE_ablation"), &["--quick", "--out", out, "--machine", "a machine"]);
    assert_eq!(
        fs::read_to_string(home.path().join("ablation.md")).unwrap(),
        text.trim_end_matches('\n').to_owned() + "\n"
    );
    assert_eq!(names(home.path()), ["ablation.md"]);
    assert_eq!(text.matches("\n## ").count(), 12, "{text}");
    for words in ["; a machine.", "| defaults |", "| constant 0.3 |", "| independent directions |"] {
        assert!(text.contains(words), "{words} is missing in: {text}");
    }
    let some = printed(env!("CARGO_BIN_EXE_ablation"), &["--quick", "Momentum"]);
    assert_eq!(some.matches("\n## ").count(), 2, "{some}");
}

/// A row of `time_against_error.csv`.
#[derive(Deserialize)]
struct Raced {
    case: String,
    method: String,
    seconds: f64,
    slices: u64,
    filtered: f64,
    bound: f64,
    bias: f64,
}

/// The figures of a way of reading: one frame, one pixel, filtered, all frames.
fn figures_of(text: &str, way: &str) -> Vec<f64> {
    let row = text.lines().find(|line| line.strip_prefix(way).is_some_and(|rest| rest.starts_with("  ")));
    let row = row.unwrap_or_else(|| panic!("{way} is missing in: {text}"));
    row[way.len()..].split_whitespace().map(|figure| figure.parse().unwrap()).collect()
}

#[test]
fn reading_tells_good_ways_from_bad_ones() {
    let tables = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/tables");
    let [table, still] = ["64x64x16_1spp_2d_ema.npy", "64x64x1_1spp_2d.npy"].map(|name| tables.join(name));
    let still = still.to_str().unwrap();
    let quick = ["--frames", "16", "--integrands", "4"];
    let arguments = [&[table.to_str().unwrap(), "--still", still], &quick[..]].concat();
    let text = printed(env!("CARGO_BIN_EXE_reading"), &arguments);
    let filtered = |way| figures_of(&text, way)[2];
    // Four integrands per family leave a spread of a tenth; all these are further apart.
    let (own, elsewhere) = (filtered("as it is"), filtered("a still table, elsewhere in every frame"));
    assert!(own < 0.13 && own < 0.7 * elsewhere, "{text}");
    assert!((0.13..0.25).contains(&elsewhere), "{text}");
    for (way, least) in [
        ("no table: white noise", 0.8),
        ("values shifted per pixel", 0.5),
        ("8 bits, taken for sRGB", 2.0),
        ("bilinear filter between four texels", 2.0),
        ("the first frame again and again", 1.0),
    ] {
        assert!(filtered(way) > least, "{way}: {text}");
    }
    assert!((filtered("8 bits") / own - 1.0).abs() < 0.1, "{text}");

    // Two uses at one place are as one use that counts twice.
    let text = printed(env!("CARGO_BIN_EXE_reading"), &[&[still, "--uses", "2"], &quick[..]].concat());
    let frame = |way| figures_of(&text, way)[0];
    assert!(frame("uses at the same place") > 1.2 * frame("as it is"), "{text}");

    let arguments = [still, "--still", table.to_str().unwrap(), "--dims", "0,7"];
    assert!(complaint(env!("CARGO_BIN_EXE_reading"), &arguments).contains('7'));
}

/// What the guide, docs/choosing.md, has `reading` do, on tables of eight pixels.
#[test]
fn the_guide_reads_as_it_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let guide = fs::read_to_string(root.join("docs/choosing.md")).unwrap();
    let command = "cargo run --release -p fsot-lab --bin reading -- ";
    let shell = guide.split("```").filter_map(|block| block.strip_prefix("sh\n"));
    let lines: Vec<&str> = shell.flat_map(str::lines).filter_map(|line| line.strip_prefix(command)).collect();
    assert!(lines.len() > 5, "{lines:?}");
    let home = TempDir::new().unwrap();
    for line in lines {
        let is_scalar = line.contains("_1d.npy");
        let mut arguments = vec![String::from("--integrands=1")];
        for word in line.split_whitespace() {
            let Some((stem, "")) = word.split_once(".npy") else {
                arguments.push(word.to_owned());
                continue;
            };
            assert!(!stem.starts_with("data/") || root.join(word).exists(), "{word} is not there");
            let frames = if stem.contains("x1_1spp") { 1 } else { 2 };
            let dims = if is_scalar {
                1
            } else if stem.ends_with("_4d") {
                4
            } else {
                2
            };
            let table = SampleTable::white_noise(Extent::animation(frames, 8, 8), dims, 0).unwrap();
            let path = home.path().join(format!("{}.npy", stem.replace('/', "-")));
            table.save(&path).unwrap();
            arguments.push(path.to_str().unwrap().to_owned());
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        assert!(printed(env!("CARGO_BIN_EXE_reading"), &arguments).contains("\nas it is "), "{line}");
    }
}

#[test]
fn demand_has_a_row_per_share() {
    let text = printed(env!("CARGO_BIN_EXE_demand"), &["--quick"]);
    // Three tables, each whole, in one dimension, and in four shares of two kinds.
    assert_eq!(text.matches(" % |\n").count(), 3 * (2 + 4 * 2), "{text}");
    assert_eq!(text.matches("| all | 100.0 % | 100.0 % | 100.0 % |").count(), 3, "{text}");
}

#[test]
fn race_has_curves_and_a_plot() {
    let home = TempDir::new().unwrap();
    let out = home.path().to_str().unwrap();
    let text = printed(env!("CARGO_BIN_EXE_race"), &["--quick", "--out", out]);
    assert_eq!(text.matches("## ").count(), 3, "{text}");
    assert_eq!(names(home.path()), ["time_against_error.csv", "time_against_error.svg"]);
    let points: Vec<Raced> = rows(&home.path().join("time_against_error.csv"));
    let both = points.iter().filter(|point| point.method == "slices, then sweeps");
    assert!(both.clone().count() >= 3 && both.clone().all(|point| point.slices > 0));
    for Raced { case, method, seconds, filtered, bound, bias, .. } in &points {
        assert!(
            *seconds > 0.0 && [filtered, bound, bias].into_iter().all(|value| *value > 0.0),
            "{case} {method}"
        );
    }
    let plot = fs::read_to_string(home.path().join("time_against_error.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.trim_end().ends_with("</svg>"));
    assert!(plot.contains("published loop"));

    let said = complaint(env!("CARGO_BIN_EXE_race"), &["--quick", "--out", out, "moving"]);
    assert!(said.contains("no case has \"moving\" in its name; there are static"), "{said}");
}

/// The figures that the documentation cites.
#[test]
fn stored_figures_can_be_read() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let points: Vec<Raced> = rows(&docs.join("time_against_error.csv"));
    assert!(points.iter().filter(|point| point.method == "slices, then sweeps").count() > 20);
    let figures: Vec<Compared> = rows(&docs.join("lecture.csv"));
    assert!(figures.iter().any(|row| row.sampler == "ours, space + TAA" && row.standard_error.is_some()));
}

#[test]
fn compare_puts_tables_beside_white_noise() {
    let home = TempDir::new().unwrap();
    let inside = |name: &str| home.path().join(name);
    // The last three are one name once blanks are gone, or capitals mean nothing.
    let files = ["small.npy", "white noise.npy", "white_noise.npy", "White_Noise.npy"].map(inside);
    for file in &files {
        let extent = Extent { frames: 1, height: 8, width: 8, spp: 1 };
        SampleTable::white_noise(extent, 2, 1).unwrap().save(file).unwrap();
    }
    let out = inside("sheet");
    let [table, blank, bar, capital] = files.each_ref().map(|path| path.to_str().unwrap());
    let place = out.to_str().unwrap();
    let cache = home.path().join("references");
    let text = printed(
        env!("CARGO_BIN_EXE_compare"),
        &[
            &[
                "--table",
                table,
                table,
                blank,
                bar,
                capital,
                "--out",
                place,
                "--cache",
                cache.to_str().unwrap(),
            ][..],
            &["--resolution", "32", "--reference-spp", "64", "--repeats", "2", "--spp", "2"],
        ]
        .concat(),
    );
    for words in
        ["white noise", "Owen-Sobol'", "small  ", "small #2", "white noise #2", "1 of 2 spp, rest displaced"]
    {
        assert!(text.contains(words), "{words} is missing in: {text}");
    }
    let expected = [
        "soft_shadow-2spp-Owen-Sobol_.exr",
        "soft_shadow-2spp-White_Noise__2-2.exr",
        "soft_shadow-2spp-small.exr",
        "soft_shadow-2spp-small__2.exr",
        "soft_shadow-2spp-white_noise-2.exr",
        "soft_shadow-2spp-white_noise.exr",
        "soft_shadow-2spp-white_noise__2.exr",
        "soft_shadow-2spp.png",
    ];
    assert_eq!(names(&out), expected);
    let page = image::open(out.join("soft_shadow-2spp.png")).unwrap();
    assert!(page.width() > 8 * 384 && page.height() > 4 * 384);

    let said = complaint(env!("CARGO_BIN_EXE_compare"), &["--scene", "attic", "--out", place]);
    assert!(said.contains("there is no scene \"attic\"; choose one of soft_shadow"), "{said}");
}

#[test]
fn the_stored_pictures_are_those_that_are_drawn() {
    let home = TempDir::new().unwrap();
    printed(env!("CARGO_BIN_EXE_pictures"), &[home.path().to_str().unwrap()]);
    assert_eq!(names(home.path()), ["garden.png", "lantern.png"]);
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    for name in names(home.path()) {
        let [drawn, stored] = [home.path(), &data].map(|folder| image::open(folder.join(&name)).unwrap());
        assert_eq!(drawn, stored, "{name}");
    }
}
