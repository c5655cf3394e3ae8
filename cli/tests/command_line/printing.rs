//! What is printed, and to whom.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use serde_json::Value;
use tempfile::tempdir;

use crate::{command, names, run, texts};

/// Short runs of all verbs; `picture.png` and `table.npy` are there.
const SHORT: [&str; 7] = [
    "table --width 8 --height 8 --frames 2 --sweeps 2 --out made.npy",
    "inspect table.npy --integrands 2 --bound-slices 64",
    "points two-class --counts 8,8 --slices 4",
    "points progressive --count 16 --slices 4 --integrands 2",
    "points stipple --picture picture.png --count 32 --slices 4",
    "points color-stipple --picture picture.png --count 32 --slices 4",
    "report table.npy --integrands 2 --bound-slices 64",
];

fn home() -> tempfile::TempDir {
    let home = tempdir().unwrap();
    image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([8 * x as u8, 9 * y as u8, 40]))
        .save(home.path().join("picture.png"))
        .unwrap();
    run(home.path(), "table --width 8 --height 8 --frames 2 --sweeps 2");
    home
}

/// The only line that was printed.
fn json(home: &Path, arguments: &str) -> Value {
    let (out, err) = run(home, &format!("{arguments} --json"));
    assert!(err.is_empty() && out.ends_with("}\n") && out.lines().count() == 1, "{arguments}: {out}{err}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn json_is_one_line_of_every_verb_even_if_quiet() {
    let home = home();
    for verb in SHORT {
        assert!(json(home.path(), verb).is_object());
        json(home.path(), &format!("{verb} --quiet"));
    }
}

#[test]
fn json_holds_the_figures() {
    let home = home();
    let table = json(home.path(), SHORT[0]);
    assert_eq!((&table["sweeps"], &table["slices_per_class"]), (&2.into(), &0.into()));
    // 16 of each sweep, and one of each sweep of the frame that the two begin with.
    assert_eq!((&table["frame_sweeps"], &table["steps"]), (&2.into(), &34.into()));
    assert_eq!(&table["ended_early"], &false);
    assert!(table["seconds"].as_f64() > Some(0.0));
    let ratio = |when: &str| table["bound"][when]["ratio_to_white_noise"].as_f64().unwrap();
    assert!(ratio("after") < ratio("before"), "{table}");
    assert!(json(home.path(), &format!("{} --no-bound", SHORT[0]))["bound"].is_null());

    let inspected = json(home.path(), SHORT[1]);
    assert_eq!(inspected["shape"], serde_json::json!([2, 8, 8, 1, 2]));
    assert_eq!(inspected["groups"][0]["dims"], serde_json::json!([0, 1]));
    let group = &inspected["groups"][0];
    for figure in ["unfiltered", "spatial", "spatio_temporal"] {
        assert!(group["error"][figure]["mean"]["ratio"].as_f64() > Some(0.0), "{group}");
    }
    // The same figures as in words.
    let (words, _) = run(home.path(), SHORT[1]);
    let bound = format!("{:.5} ± ", inspected["bound"]["value"].as_f64().unwrap());
    let spatial = format!("{:.4}", group["error"]["spatial"]["mean"]["ratio"].as_f64().unwrap());
    assert!(words.contains(&bound) && words.contains(&spatial), "{words}");
    assert_eq!(inspected["metadata"]["run"]["sweeps"], 2);
    // All frames and samples of so small a table are measured for a page, too: the same figures.
    let reported = json(home.path(), SHORT[6]);
    assert_eq!((&reported["page"], &reported["png"]), (&"report.html".into(), &Value::Null));
    for figure in ["shape", "kernel", "metadata", "bound"] {
        assert_eq!(reported["tables"][0][figure], inspected[figure], "{figure}");
    }
    for figure in ["error", "bias", "histogram", "marginals", "squared_l2_discrepancy"] {
        assert_eq!(reported["tables"][0]["groups"][0][figure], group[figure], "{figure}");
    }

    let classes = json(home.path(), SHORT[2]);
    let class = &classes["figures"]["classes"][2];
    assert_eq!(
        (&classes["points"], &class["points"], &class["labels"]),
        (&16.into(), &16.into(), &serde_json::json!([0, 1]))
    );
    assert!(class["sliced_w2"].as_f64() > Some(0.0) && class["of_alone"].as_f64() > Some(0.0));
    let prefixes = &json(home.path(), SHORT[3])["figures"]["prefixes"];
    assert_eq!(prefixes.as_array().unwrap().len(), 5);
    assert!(prefixes[4]["sobol"].as_f64() > Some(0.0));
    let stipples = json(home.path(), SHORT[4]);
    assert!(stipples["figures"]["correlation"].is_f64() && stipples["seconds"].is_f64());
    assert!(
        stipples["figures"]["worst"]["deviation"].is_f64() && stipples["figures"]["worst"]["side"].is_u64()
    );
    let inks = json(home.path(), SHORT[5]);
    assert!(inks["figures"]["inks"].as_array().unwrap().iter().all(|ink| ink["correlation"].is_f64()));
}

#[test]
fn quiet_is_silent_and_no_bar_is_drawn_into_a_file() {
    let home = home();
    for verb in SHORT {
        assert_eq!(run(home.path(), &format!("{verb} --quiet")), (String::new(), String::new()), "{verb}");
        let (out, err) = run(home.path(), verb);
        assert!(!out.is_empty() && err.is_empty(), "{verb}: {err}");
    }
}

#[test]
fn inspecting_writes_nothing() {
    let home = home();
    let (out, _) = run(home.path(), SHORT[1]);
    assert!(out.contains("bound "), "{out}");
    assert_eq!(names(home.path()), ["picture.png", "table.json", "table.npy"]);
}

/// As `| head -1` does, or without reading anything at all.
#[test]
fn a_reader_who_goes_away_is_no_failure() {
    for lines in [0, 1] {
        let home = home();
        for verb in SHORT {
            let mut run = command(home.path(), verb);
            let mut child = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
            let mut reader = BufReader::new(child.stdout.take().unwrap());
            for _ in 0..lines {
                reader.read_line(&mut String::new()).unwrap();
            }
            drop(reader);
            let output = child.wait_with_output().unwrap();
            assert_eq!((output.status.code(), texts(&output).1.as_str()), (Some(0), ""), "{verb}");
        }
        let made = [
            "color_stippling.png",
            "made.json",
            "made.npy",
            "picture.png",
            "progressive.png",
            "report.html",
            "stippling.png",
            "table.json",
            "table.npy",
            "two_class.png",
        ];
        assert_eq!(names(home.path()), made);
    }
}

/// Nothing is lost but the words, and the exit code says so.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_a_failure_with_files() {
    let home = home();
    for verb in SHORT {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command(home.path(), verb).stdout(full).output().unwrap();
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{verb}");
        assert!(err.contains("cannot write to standard output") && err.lines().count() == 1, "{verb}: {err}");
    }
    assert_eq!(names(home.path()).len(), 10);
}

/// Neither an error nor what is said of it needs a place to be written.
#[cfg(unix)]
#[test]
fn nobody_has_to_listen() {
    let home = home();
    let shell = |line: &str| {
        let fsot = env!("CARGO_BIN_EXE_fsot");
        let line = line.replace("fsot", fsot);
        std::process::Command::new("sh").current_dir(home.path()).args(["-c", &line]).status().unwrap().code()
    };
    assert_eq!(shell("fsot table --width 0 2>&-"), Some(1));
    assert_eq!(shell("fsot table --width 0 2>/dev/full"), Some(1));
    assert_eq!(shell("fsot table --width 8 --height 8 --sweeps 1 >&- 2>&-"), Some(0));
}

const VERBS: [&str; 11] = [
    "table",
    "export",
    "import",
    "plot",
    "inspect",
    "report",
    "points",
    "points two-class",
    "points progressive",
    "points stipple",
    "points color-stipple",
];

#[test]
fn help_has_examples_and_exit_codes_everywhere() {
    let home = tempdir().unwrap();
    for verb in VERBS {
        let (out, _) = run(home.path(), &format!("{verb} --help"));
        let (_, examples) = out.split_once("Examples:\n").expect(verb);
        let lines = examples.lines().filter(|line| line.starts_with(&format!("  fsot {verb}"))).count();
        assert!((2..=8).contains(&lines), "{verb}: {lines}");
        assert!(examples.contains("Exit codes: 0 done, 1 "), "{verb}");
        assert!(examples.lines().all(|line| line.chars().count() <= 110), "{verb}");
    }
    let (out, _) = run(home.path(), "--help");
    for line in ["A tour:", "  0  done", "  1  refused", "  2  the command line", "  3  a signal"] {
        assert!(out.contains(line), "{line}");
    }
}

/// All files of the examples are looked for in a folder that is not there, which ends them before the work.
#[test]
fn examples_are_understood() {
    let home = tempdir().unwrap();
    for verb in [""].into_iter().chain(VERBS) {
        let (out, _) = run(home.path(), &format!("{verb} --help"));
        let examples = out.lines().filter_map(|line| line.strip_prefix("  fsot ")).collect::<Vec<_>>();
        assert!(!examples.is_empty(), "{verb}");
        for example in examples {
            let (example, _) = example.split_once(" |").unwrap_or((example, ""));
            let example = example.replace('\'', "");
            let words = example.split_whitespace().map(|word| {
                let file = [".npy", ".csv", ".png", ".svg"].iter().any(|ending| word.ends_with(ending));
                if file { format!("missing/{word}") } else { word.to_owned() }
            });
            let mut words: Vec<String> = words.collect();
            if !words.iter().any(|word| ["--out", "--points", "--png", "inspect"].contains(&word.as_str())) {
                words.extend(["--out".into(), "missing/x".into()]);
            }
            let output = command(home.path(), &words.join(" ")).output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{example}: {}", texts(&output).1);
        }
    }
}
