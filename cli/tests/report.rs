//! `fsot report`, run as a person runs it: what is on the page, of which tables, and what makes them again.

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fsot::files::Metadata;
use fsot::{Config, Extent, Optimizer, SampleTable, Until};
use serde_json::Value;
use tempfile::tempdir;

/// Enough to see that it works.
const FEW: [&str; 4] = ["--integrands", "3", "--bound-slices", "64"];

fn fsot(home: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fsot")).current_dir(home).args(arguments).output().unwrap()
}

/// Runs `fsot report`; the exit code is 0 and nothing is complained of.
fn report(home: &Path, arguments: &[&str]) -> String {
    let output = fsot(home, &[&["report"], arguments].concat());
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && complaints.is_empty(), "{arguments:?}: {complaints}");
    String::from_utf8(output.stdout).unwrap()
}

/// What `--json` prints.
fn json(home: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&report(home, &[arguments, &FEW, &["--json"]].concat())).unwrap()
}

fn white_noise(home: &Path, name: &str, [frames, height, width, spp]: [usize; 4], dims: usize) {
    let extent = Extent { frames, height, width, spp };
    SampleTable::white_noise(extent, dims, 5).unwrap().save(home.join(name)).unwrap();
}

/// The page, checked: tags close in order, nothing is fetched or runs, pictures are pictures and have words.
fn page(path: &Path) -> String {
    let html = fs::read_to_string(path).unwrap();
    assert!(html.starts_with("<!DOCTYPE html>") && html.ends_with("</html>"), "it is whole");
    // What is open behind the style.
    let mut open = vec!["html", "head"];
    let body = html.split_once("</style>").unwrap().1;
    let tags = body.split('<').skip(1).map(|tag| tag.split_once('>').expect("a tag ends").0);
    for tag in tags {
        let name = tag.split([' ', '/']).find(|part| !part.is_empty()).unwrap();
        match (tag.starts_with('/'), ["img", "br", "wbr"].contains(&name)) {
            (true, _) => assert_eq!(open.pop(), Some(name), "</{name}>"),
            (false, true) => {}
            (false, false) => open.push(name),
        }
        if name == "img" {
            let alt = tag.split_once("alt=\"").expect("words for a picture").1;
            assert!(alt.split_once('"').unwrap().0.len() > 10, "{tag}");
            let png = tag.split_once("src=\"data:image/png;base64,").unwrap().1.split_once('"').unwrap().0;
            image::load_from_memory(&STANDARD.decode(png).unwrap()).unwrap();
        }
    }
    assert_eq!(open, Vec::<&str>::new(), "all is closed");
    for word in ["http:", "https:", "<script", "url(", "NaN", "inf<", "inf "] {
        assert!(!html.contains(word), "{word}");
    }
    html
}

/// Text, as it stands on the page.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[test]
fn awkward_shapes_have_a_page() {
    let shapes = [
        ([1, 1, 1, 1], 1),
        ([1, 1, 1, 16], 2),
        ([3, 1, 1, 2], 2),
        ([1, 2, 2, 1], 2),
        ([1, 5, 7, 3], 1),
        ([1, 3, 500, 1], 2),
        ([2, 400, 2, 1], 3),
        ([5, 7, 5, 16], 9),
        ([40, 8, 8, 1], 2),
    ];
    for (shape, dims) in shapes {
        let home = tempdir().unwrap();
        white_noise(home.path(), "table.npy", shape, dims);
        let words = report(home.path(), &[&["table.npy"], &FEW[..]].concat());
        assert!(words.contains("report.html: "), "{words}");
        let html = page(&home.path().join("report.html"));
        let groups = dims.div_ceil(2) + usize::from(dims > 2);
        assert_eq!(html.matches("half-space</a>").count(), groups, "{shape:?} {dims}");
        assert_eq!(html.contains("Over time: x and t"), shape[0] > 1, "{shape:?} {dims}");
        assert!(html.contains("No metadata lie beside the table"), "{shape:?} {dims}");
    }
}

#[test]
fn names_are_text_whatever_they_are() {
    let home = tempdir().unwrap();
    let name = "<b>&\"'.npy";
    white_noise(home.path(), name, [1, 8, 8, 1], 2);
    let values = SampleTable::load(home.path().join(name)).unwrap();
    let metadata = Metadata::new(values.extent(), 2, 1, serde_json::json!({ "</pre><i>": "</details>" }));
    values.save_with(home.path().join(name), &metadata).unwrap();
    report(home.path(), &[&[name], &FEW[..]].concat());
    let html = page(&home.path().join("report.html"));
    assert!(html.contains(&escaped(name)) && !html.contains("<b>") && !html.contains("<i>"), "{html}");
    assert!(html.contains("&lt;/pre&gt;&lt;i&gt;"), "{html}");
}

#[test]
fn tables_stand_side_by_side() {
    let home = tempdir().unwrap();
    fs::create_dir(home.path().join("other")).unwrap();
    white_noise(home.path(), "a.npy", [1, 16, 16, 1], 2);
    white_noise(home.path(), "other/a.npy", [4, 16, 16, 1], 2);
    white_noise(home.path(), "b.npy", [1, 16, 16, 4], 1);
    let tables = ["a.npy", "other/a.npy", "b.npy"];
    let out = ["--out", "page.html", "--png", "sheet.png"];
    let figures = json(home.path(), &[&tables[..], &out].concat());
    let labels: Vec<&Value> =
        figures["tables"].as_array().unwrap().iter().map(|table| &table["label"]).collect();
    assert_eq!(labels, tables);
    let html = page(&home.path().join("page.html"));
    for name in tables {
        assert!(html.contains(&format!("<th class=\"number\" scope=\"col\">{name}</th>")), "{name}");
    }
    // White noise and three tables: textures, edges before and after, spectra; one has frames, and white
    // noise is of the first table's shape; cells of three squares.
    assert_eq!(html.matches("<img ").count(), 4 * 4 + 1 + 3);
    assert_eq!(html.matches("class=\"dots\"").count(), 4 * 2);
    let sheet = image::open(home.path().join("sheet.png")).unwrap();
    assert_eq!([sheet.width(), sheet.height()], [12 + 7 * 268, 12 + 4 * 268]);
}

/// A sheet alone is no page; pictures are enlarged by whole numbers.
#[test]
fn a_sheet_has_the_pictures_alone() {
    let home = tempdir().unwrap();
    white_noise(home.path(), "table.npy", [1, 32, 32, 1], 2);
    report(home.path(), &[&["table.npy", "--png", "sheet.png"], &FEW[..]].concat());
    assert!(!home.path().join("report.html").exists());
    let sheet = image::open(home.path().join("sheet.png")).unwrap().into_rgb8();
    assert_eq!([sheet.width(), sheet.height()], [12 + 6 * 268, 12 + 2 * 268]);
    let table = SampleTable::load(home.path().join("table.npy")).unwrap();
    for (i, value) in table.values().iter().step_by(2).enumerate() {
        // The second row, the first column; 8 pixels of the sheet for one of the table.
        let [x, y] = [12 + i % 32 * 8, 12 + 268 + i / 32 * 8];
        let level = (f64::from(*value) * 255.0).round() as u8;
        for (dx, dy) in [(0, 0), (7, 7)] {
            assert_eq!(sheet.get_pixel((x + dx) as u32, (y + dy) as u32).0, [level; 3], "pixel {i}");
        }
    }
}

/// The line as a person types it into a shell.
fn shell(home: &Path, line: &str) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_fsot")).parent().unwrap();
    let path = format!("{}:{}", program.display(), env::var("PATH").unwrap());
    Command::new("sh").args(["-c", line]).current_dir(home).env("PATH", path).output().unwrap()
}

#[cfg(unix)]
#[test]
fn the_command_on_the_page_makes_the_table_again() {
    for (name, how) in [
        ("table.npy", "--width 8 --height 6 --frames 3 --sweeps 3"),
        ("it's a <table>.npy", "--width 8 --height 8 --frames 1 --dims 4 --groups 0,1:1;2,3:0.5 --seed 9"),
        ("-x.npy", "--width 8 --height 8 --frames 2 --domain torus --slices-per-class 20"),
        ("a.npy", "--width 8 --height 8 --spp 2 --frames 2 --optimizer adam --temporal ema:0.2"),
        ("s.npy", "--width 8 --height 8 --frames 1 --seconds 0.05 --sigma 1.5"),
    ] {
        let home = tempdir().unwrap();
        let path = format!("./{name}");
        let flags: Vec<&str> = how.split(' ').collect();
        let made = fsot(home.path(), &[&["table", "--no-bound", "--out", &path][..], &flags].concat());
        assert!(made.status.success(), "{how}: {}", String::from_utf8_lossy(&made.stderr));
        let figures = json(home.path(), &[&path]);
        let command = figures["tables"][0]["made_again_by"].as_str().unwrap();
        let html = page(&home.path().join("report.html"));
        assert!(html.contains(&format!("<pre><code>{}</code></pre>", escaped(command))), "{command}");
        let again = shell(home.path(), command);
        assert!(again.status.success(), "{command}: {}", String::from_utf8_lossy(&again.stderr));
        let [first, second] = [name, "again.npy"].map(|name| fs::read(home.path().join(name)).unwrap());
        assert!(first == second, "{how}: {command}");
        // Without a folder in front of it.
        if !name.starts_with('-') {
            let figures = json(home.path(), &[name]);
            let command = figures["tables"][0]["made_again_by"].as_str().unwrap();
            assert!(shell(home.path(), command).status.success(), "{command}");
        }
    }
}

#[test]
fn metadata_of_others_make_nothing_again() {
    let home = tempdir().unwrap();
    white_noise(home.path(), "table.npy", [1, 4, 4, 1], 2);
    let path = home.path().join("table.npy");
    let values = SampleTable::load(&path).unwrap();
    let says = |words: &str| {
        let figures = json(home.path(), &["table.npy"]);
        assert_eq!(figures["tables"][0]["made_again_by"], Value::Null, "{words}");
        let html = page(&home.path().join("report.html"));
        assert!(html.contains(words), "{words}");
    };
    values.save_with(&path, &Metadata::new(values.extent(), 2, 7, "void and cluster".into())).unwrap();
    says("Their configuration is none of fsot table");
    SampleTable::white_noise(values.extent(), 2, 9).unwrap().save(&path).unwrap();
    says("The metadata beside it are not of this table");
    fs::write(home.path().join("table.json"), "{\"format\": ").unwrap();
    says("The metadata beside it cannot be used");
    // A run that has gone on from another table.
    let mut optimizer = Optimizer::from_table(Config::new(values.extent(), 2), values.clone()).unwrap();
    let run = optimizer.run(Until::SlicesPerClass(4)).unwrap();
    optimizer.table().save_with(&path, &optimizer.metadata(&run)).unwrap();
    says("No command makes it again: its run did not begin with the white noise");
    // A configuration of a megabyte is not copied.
    let long = Value::String("x".repeat(1 << 20));
    values.save_with(&path, &Metadata::new(values.extent(), 2, 7, long)).unwrap();
    says("The configuration is long");
    assert!(fs::metadata(home.path().join("report.html")).unwrap().len() < 1 << 18);
}

#[test]
fn a_filter_of_its_own_is_pointed_at() {
    let home = tempdir().unwrap();
    let how = "table --width 8 --height 8 --frames 4 --sweeps 2 --no-bound --temporal ema:0.25 --sigma 1.5";
    assert!(fsot(home.path(), &how.split(' ').collect::<Vec<_>>()).status.success());
    let advice = "give --sigma 1.5 --temporal ema:0.25";
    report(home.path(), &[&["table.npy"], &FEW[..]].concat());
    assert!(page(&home.path().join("report.html")).contains(advice));
    report(home.path(), &[&["table.npy", "--sigma", "1.5", "--temporal", "ema:0.25"], &FEW[..]].concat());
    assert!(!page(&home.path().join("report.html")).contains("another filter"));
}

/// Nothing lies within 0.015 of a face, which a histogram of 16 cells hides.
#[test]
fn empty_faces_are_shown() {
    let home = tempdir().unwrap();
    let values = (0..2048).map(|i| 0.015 + 0.97 * (i as f32 * 0.618_034).fract()).collect();
    SampleTable::new(Extent::still(32, 32), 2, values).unwrap().save(home.path().join("table.npy")).unwrap();
    report(home.path(), &[&["table.npy"], &FEW[..]].concat());
    let html = page(&home.path().join("report.html"));
    for dim in 0..2 {
        let words = format!("Density of dimension {dim} of table.npy; within 0.01 of the faces 0.00");
        assert!(html.contains(&words), "{words}");
    }
}

#[test]
fn the_same_page_whatever_the_threads() {
    let home = tempdir().unwrap();
    white_noise(home.path(), "table.npy", [8, 16, 16, 2], 3);
    let pages = ["1", "2", "5"].map(|threads| {
        report(home.path(), &[&["table.npy", "--threads", threads], &FEW[..]].concat());
        let html = page(&home.path().join("report.html"));
        // The command of the page is below.
        html.split_once("<footer>").unwrap().0.to_owned()
    });
    assert!(pages[0] == pages[1] && pages[0] == pages[2]);
}

/// The size that engines ship: three megabytes at most.
#[test]
fn large_tables_have_small_pages() {
    let home = tempdir().unwrap();
    white_noise(home.path(), "large.npy", [64, 128, 128, 1], 2);
    white_noise(home.path(), "wide.npy", [1, 1024, 1024, 1], 1);
    for name in ["large.npy", "wide.npy"] {
        let figures = report(home.path(), &[name, "--json"]);
        let figures: Value = serde_json::from_str(&figures).unwrap();
        let bytes = page(&home.path().join("report.html")).len();
        println!("{name}: {bytes} bytes, {} integrands", figures["tables"][0]["integrands"]);
        assert!(bytes < 3_000_000, "{name}: {bytes}");
        // White noise, of which some frames are measured: within four of its standard errors, which
        // thousands of independent pixels leave well below 0.1.
        let error = &figures["tables"][0]["groups"][0]["error"];
        for stage in
            ["unfiltered", "spatial", "spatio_temporal"].iter().filter(|stage| !error[**stage].is_null())
        {
            let ratio = error[*stage]["mean"]["ratio"].as_f64().unwrap();
            assert!((ratio - 1.0).abs() < 0.1, "{name} {stage}: {ratio}");
        }
    }
}

#[test]
fn what_cannot_be_done_is_one_sentence_and_no_file() {
    let home = tempdir().unwrap();
    white_noise(home.path(), "table.npy", [1, 4, 4, 1], 2);
    fs::write(home.path().join("text.npy"), "once upon a time").unwrap();
    fs::create_dir(home.path().join("folder.html")).unwrap();
    let names = || fs::read_dir(home.path()).unwrap().count();
    for (arguments, words) in [
        (&["absent.npy"][..], &["absent.npy", "cannot read"][..]),
        (&["table.npy", "text.npy"], &["text.npy", "NUMPY"]),
        (&["table.npy", "--out", "page.png"], &["--out", ".html"]),
        (&["table.npy", "--out", "missing/page.html"], &["there is no directory missing", "--out"]),
        (&["table.npy", "--out", "folder.html"], &["it is a directory"]),
        (&["table.npy", "--png", "sheet.jpg"], &["--png", ".png"]),
        (&["table.npy", "--sigma=-1"], &["sigma_px"]),
        (&["table.npy", "--temporal", "box:0"], &["box"]),
    ] {
        let output = fsot(home.path(), &[&["report"], arguments].concat());
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {complaint}");
        assert!(complaint.starts_with("error: ") && complaint.lines().count() == 1, "{complaint}");
        assert!(words.iter().all(|word| complaint.contains(word)), "{words:?}: {complaint}");
        assert_eq!(names(), 3, "{arguments:?}");
    }
    for arguments in
        [&["report"][..], &["report", "table.npy", "--integrands", "0"], &["inspect", "--no-page"]]
    {
        assert_eq!(fsot(home.path(), arguments).status.code(), Some(2), "{arguments:?}");
    }
}
