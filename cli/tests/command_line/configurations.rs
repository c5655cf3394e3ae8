//! `--config` and `--terms`: files that people write, and those that the program has written.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use fsot::classes::Demand;
use fsot::config::{DimensionGroup, Domain, Schedule, Term, Work};
use fsot::files::Metadata;
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::{Config, Extent, Kernel, Optimizer, RunReport, Until};
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::{command, names, output, succeed, texts};

fn config_of(home: &Path, table: &str) -> (Config, Metadata) {
    let metadata = Metadata::load(home.join(table)).unwrap();
    (serde_json::from_value(metadata.configuration.clone()).unwrap(), metadata)
}

/// The sentence that refuses this file.
fn refusal(home: &Path, name: &str, text: &str, flags: &str) -> String {
    fs::write(home.join(name), text).unwrap();
    let before = names(home);
    let output = output(home, &format!("--config {name} --dry-run {flags}"));
    let (out, err) = texts(&output);
    assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{text}: {err}");
    assert!(err.starts_with("error: ") && err.lines().count() == 1, "{text}: {err}");
    assert_eq!(names(home), before);
    err.trim_end().to_owned()
}

#[test]
fn metadata_make_the_same_bits_again() {
    let home = tempdir().unwrap();
    for flags in [
        "--width 12 --height 10 --frames 3 --sweeps 3",
        "--width 12 --height 10 --frames 3 --dims 3 --seconds 0.05 --seed 18446744073709551615",
        "--width 9 --height 9 --frames 1 --spp 2 --slices-per-class 20 --sweeps 1 --sigma 1.3",
        "--width 8 --height 8 --frames 4 --temporal ema:0.3 --sweeps 2 --frame-sweeps 0",
        "--width 8 --height 8 --frames 1 --dims 4 --groups 0,1;2,3:0.3 --domain torus --slices-per-class 8",
        "--width 8 --height 8 --frames 1 --optimizer adam --slices-per-class 8",
        "--width 8 --height 8 --frames 1 --optimizer sgd --temporal taps:1,0.1",
    ] {
        succeed(home.path(), &format!("{flags} --no-bound"));
        succeed(home.path(), "--config table.json --no-bound --out again.npy");
        let bytes = |name: &str| fs::read(home.path().join(name)).unwrap();
        assert!(bytes("table.npy") == bytes("again.npy"), "{flags}");
        let (config, of_table) = config_of(home.path(), "table.npy");
        let (again, of_again) = config_of(home.path(), "again.npy");
        assert_eq!(config, again, "{flags}");
        assert_eq!(of_table.run.steps, of_again.run.steps, "{flags}");
        // The configuration alone says all but how long.
        fs::write(home.path().join("bare.json"), serde_json::to_vec(&config).unwrap()).unwrap();
        fs::write(home.path().join("bare.toml"), toml::to_string(&config).unwrap()).unwrap();
        for bare in ["bare.json", "bare.toml"] {
            let work = "--slices-per-class 2 --no-bound --out of_bare.npy";
            succeed(home.path(), &format!("--config {bare} {work}"));
            assert_eq!(config_of(home.path(), "of_bare.npy").0, config, "{flags} {bare}");
        }
    }
}

/// What flags cannot say either.
#[test]
fn any_configuration_is_followed() {
    let home = tempdir().unwrap();
    let extent = Extent { frames: 2, height: 6, width: 8, spp: 1 };
    let new = || Config::new(extent, 3).with_seed(5);
    let pairs = [DimensionGroup::new([0, 2]), DimensionGroup::new([1]).with_weight(0.7)];
    let kernels = Kernel::separate(
        SpatialKernel::Box { size_px: 3 },
        TemporalKernel::Gaussian { sigma_frames: 0.1 + 0.2 },
    );
    let mut rest = new();
    rest.terms.retain(|term| term.role == fsot::config::Role::Descend);
    rest.terms[0].weight = 1.0 / 3.0;
    let sweeps = fsot::config::Sweeps { softening: 0.1, ..Default::default() };
    let slicing = fsot::config::Slicing { batch_slices: Some(100), ..Default::default() };
    for (index, config) in [
        new(),
        new().with_companions(false),
        new().with_kernels(&kernels),
        new().with_kernels(&kernels).with_companions(false).with_groups(&pairs),
        new().with_form(fsot::classes::FilterForm::Weighted).with_groups(&pairs),
        new().with_kernel(Kernel { truncation: 0.1, ..Kernel::gaussian(1.0 / 3.0) }),
        new().with_domains(vec![Domain::Torus, Domain::Interval, Domain::Torus]),
        new().with_balance(Schedule::cosine(1.0, 0.5)).with_sweeps(sweeps).with_slicing(slicing),
        new().with_terms(Term::blue_noise(&kernels, Default::default(), &pairs, &extent)),
        rest,
    ]
    .into_iter()
    .enumerate()
    {
        let work = Work { slices_per_class: 3, ..Work::default() };
        let table = config.clone().optimize(Until::Work(work)).unwrap();
        fs::write(home.path().join("any.toml"), toml::to_string(&config).unwrap()).unwrap();
        succeed(home.path(), "--config any.toml --slices-per-class 3 --sweeps 0 --no-bound");
        assert_eq!(config_of(home.path(), "table.npy").0, config, "{index}");
        assert_eq!(fsot::SampleTable::load(home.path().join("table.npy")).unwrap(), table, "{index}");
    }
}

/// A run that ended early is taken to the very step.
#[test]
fn a_run_that_ended_early_ends_there_again() {
    let home = tempdir().unwrap();
    let config = Config::new(Extent::animation(3, 12, 10), 2).with_seed(3);
    for (last, until) in [
        (2, Until::Work(Work { frame_sweeps: 4, slices_per_class: 32, sweeps: 3 })),
        (5, Until::Work(Work { frame_sweeps: 4, slices_per_class: 32, sweeps: 3 })),
        (12, Until::Work(Work { frame_sweeps: 2, slices_per_class: 0, sweeps: 3 })),
        (40, Until::SlicesPerClass(1000)),
    ] {
        let mut optimizer = Optimizer::new(config.clone()).unwrap();
        let ends = |step: &fsot::optimizer::StepReport| match step.step == last {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let report = optimizer.run_observed(until, ends).unwrap();
        let metadata = optimizer.metadata(&report);
        assert!(metadata.run.ended_early);
        let path = home.path().join("early.npy");
        optimizer.table().save_with(&path, &metadata).unwrap();
        // Nothing was cut short of what was asked for: exit code 0.
        let (out, _) = succeed(home.path(), "--config early.json --no-bound --out again.npy");
        assert!(out.contains(&format!("stopped after {last} steps")), "{out}");
        let bytes = |name: &str| fs::read(home.path().join(name)).unwrap();
        assert!(bytes("early.npy") == bytes("again.npy"), "{until:?}");
        // Another table is another run.
        let (out, _) = succeed(home.path(), "--config early.json --no-bound --seed 4 --out other.npy");
        assert!(!out.contains("stopped"), "{out}");
    }
}

#[test]
fn flags_change_single_things() {
    let home = tempdir().unwrap();
    let text = "width = 8\nheight = 6\nframes = 4\ndims = 4\nspp = 2\nsigma = 1.5\ntemporal = \"ema:0.2\"\n\
                groups = [\"0,1\", \"2,3:0.5\"]\nseed = 9\nsweeps = 2\n";
    fs::write(home.path().join("a.toml"), text).unwrap();
    let made = |file: &str, flags: &str| {
        succeed(home.path(), &format!("--config {file} --no-bound {flags}"));
        config_of(home.path(), "table.npy")
    };
    let extent = Extent { frames: 4, height: 6, width: 8, spp: 2 };
    let ema = TemporalKernel::Ema { alpha: 0.2 };
    let groups = [DimensionGroup::new([0, 1]), DimensionGroup::new([2, 3]).with_weight(0.5)];
    let of = |extent: Extent, dims: usize, kernel: Kernel, groups: &[DimensionGroup]| {
        Config::new(extent, dims).with_kernel(kernel).with_groups(groups).with_seed(9)
    };
    let kernel = || Kernel::gaussian(1.5).with_temporal(ema.clone());
    let (config, metadata) = made("a.toml", "");
    assert_eq!(config, of(extent, 4, kernel(), &groups));
    assert_eq!(metadata.run.sweeps, 2);
    // The metadata are as good a file as that which they came from.
    fs::copy(home.path().join("table.json"), home.path().join("b.json")).unwrap();
    for file in ["a.toml", "b.json"] {
        let config = |flags: &str| made(file, flags).0;
        assert_eq!(config("--seed 1"), of(extent, 4, kernel(), &groups).with_seed(1));
        assert_eq!(config("--width 5"), of(Extent { width: 5, ..extent }, 4, kernel(), &groups));
        assert_eq!(config("--spp 1"), of(Extent { spp: 1, ..extent }, 4, kernel(), &groups));
        assert_eq!(config("--frames 1"), of(Extent { frames: 1, ..extent }, 4, kernel(), &groups));
        let narrow = Kernel::gaussian(0.7).with_temporal(ema.clone());
        assert_eq!(config("--sigma 0.7"), of(extent, 4, narrow, &groups));
        let boxed = Kernel::gaussian(1.5).with_temporal(TemporalKernel::Box { frames: 2 });
        assert_eq!(config("--temporal box:2"), of(extent, 4, boxed, &groups));
        let one = [DimensionGroup::new([0, 1, 2, 3])];
        assert_eq!(config("--groups 0-3"), of(extent, 4, kernel(), &one));
        let torus = config("--domain torus --slices-per-class 1 --sweeps 0");
        assert_eq!(torus, of(extent, 4, kernel(), &groups).with_domain(Domain::Torus));
        let adam = config("--optimizer adam --slices-per-class 1");
        assert_eq!(adam.descent, fsot::config::Descent::adam());
        // How long a run is, is one thing.
        let run = made(file, "--slices-per-class 3").1.run;
        assert_eq!((run.frame_sweeps, run.slices_per_class, run.sweeps), (0, 3, 0));
        let run = made(file, "--seconds 0.02").1.run;
        assert_eq!(run.slices_per_class, 0);
    }
    // What was as usual follows what is usual elsewhere.
    succeed(home.path(), "--frames 1 --width 8 --height 8 --sweeps 1 --no-bound --out still.npy");
    let (config, _) = made("still.json", "--frames 4 --dims 4");
    assert_eq!(config, Config::new(Extent::animation(4, 8, 8), 4));
}

#[test]
fn what_a_flag_cannot_change_is_said() {
    let home = tempdir().unwrap();
    let terms = "width = 4\nheight = 4\n[[terms]]\nclasses = \"whole_table\"\ndims = [0]\n";
    for flag in ["--sigma 1", "--temporal none", "--groups 0"] {
        let words = refusal(home.path(), "a.toml", terms, flag);
        assert!(words.contains("for the usual terms, but a.toml lists others: change them there"), "{words}");
    }
    let kernels = "kernels = [{ spatial = { gaussian = { sigma_px = 1 } } }]";
    let words = refusal(home.path(), "a.toml", kernels, "--sigma 1");
    assert!(words.contains("--sigma is for one kernel, but a.toml has several"), "{words}");
    let words = refusal(home.path(), "a.toml", "dims = 2\ndomain = [\"torus\", \"interval\"]", "--dims 3");
    assert!(words.contains("2 domains for 3 dimensions"), "{words}");
}

#[test]
fn slips_are_located_and_the_name_that_was_meant_is_told() {
    let home = tempdir().unwrap();
    for (text, words) in [
        ("# mine\nwidht = 4", "a.toml, line 2: unknown key 'widht': did you mean 'width'?"),
        (
            "\n\nslices-per-class = 4",
            "line 3: unknown key 'slices-per-class': did you mean 'slices_per_class'?",
        ),
        ("seed = 1\n[sweeping]\nsoftness = 1", "line 3: unknown key 'softness': did you mean 'softening'?"),
        (
            "kernel = { gausian = { sigma_px = 2 } }",
            "line 1: unknown name 'gausian': did you mean 'gaussian'?",
        ),
        ("kernel = { gaussian = { sigma = 2 } }", "line 1: unknown key 'sigma': did you mean 'sigma_px'?"),
        ("dims = 2\ndomain = \"tours\"", "line 2: unknown name 'tours': did you mean 'torus'?"),
        ("temporal = \"ema\"", "line 1: '' is no number: write ema:NUMBER"),
        ("groups = [\"0,x\"]", "line 1: '0,x' is no dimension group: write for example"),
        ("groups = 3", "line 1: invalid type: the whole number `3`, expected dimension groups such as"),
        ("width = -4", "line 1: invalid value: integer `-4`, expected a whole number of at least 0"),
        ("width = \"4\"", "line 1: invalid type: string \"4\", expected a whole number of at least 0"),
        ("width = 4\nwidth = 5", "line 2: duplicate key"),
        ("width = ", "line 1: "),
        ("seed = 18446744073709551616", "line 1: "),
        ("balance = { shape = \"constant\", value = 1, quux = 2 }", "line 1: unknown key 'quux'"),
        ("[[terms]]\nclasses = \"whole_tabel\"\ndims = [0]", "unknown name 'whole_tabel': did you mean"),
        ("[[terms]]\nclasses = \"whole_table\"", "missing field `dims`: correct that line"),
        ("sigma = 1\nkernel = [[1]]", "sigma and kernel say the same thing twice: leave out one of them"),
        ("seconds = 1\nsweeps = 4", "seconds and sweeps say the same thing twice"),
        ("frame_sweeps = 4", "frame_sweeps begin a run of sweeps: say how many sweeps, too"),
        ("{ \"widht\": 4 }", "line 1: unknown key 'widht': did you mean 'width'?"),
        ("{\n \"width\": 4,\n}", "line 3: trailing comma"),
        ("{ \"format\": \"fsot point set 1\" }", "format is \"fsot point set 1\": give the .json of a table"),
    ] {
        let found = refusal(home.path(), "a.toml", text, "");
        assert!(found.contains(words), "{text}: {found}");
    }
    fs::create_dir(home.path().join("folder")).unwrap();
    for (name, words) in [
        ("folder", "folder is no configuration: give a file of TOML or JSON"),
        ("missing.toml", "cannot read missing.toml"),
        ("binary", "binary is no text"),
    ] {
        fs::write(home.path().join("binary"), [0xff, 0xfe, 0]).unwrap();
        let (_, err) = texts(&output(home.path(), &format!("--config {name}")));
        assert!(err.starts_with("error: ") && err.contains(words), "{err}");
    }
    // What is read is not written over.
    fs::write(home.path().join("table.json"), "{}").unwrap();
    let (_, err) = texts(&output(home.path(), "--config table.json --out table.npy"));
    assert!(err.contains("table.json would overwrite what is read: choose another --out"), "{err}");
}

/// As they lie in data/tables, and as they were before some fields were known.
#[test]
fn released_metadata_are_configurations() {
    let home = tempdir().unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/tables");
    let mut read = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let mut metadata: Value = serde_json::from_str(&text).unwrap();
        let of = |metadata: &Value| -> Value {
            fs::write(home.path().join("released.json"), metadata.to_string()).unwrap();
            let (out, _) = succeed(home.path(), "--config released.json --dry-run --json");
            serde_json::from_str(&out).unwrap()
        };
        let plan = of(&metadata);
        assert_eq!((&plan["shape"], &plan["seed"]), (&metadata["shape"], &metadata["seed"]), "{path:?}");
        for work in ["frame_sweeps", "slices_per_class", "sweeps", "steps"] {
            assert_eq!(plan[work], metadata["run"][work], "{path:?}");
        }
        let configuration = metadata["configuration"].as_object_mut().unwrap();
        configuration.remove("companions");
        configuration["sweeps"].as_object_mut().unwrap().remove("softening");
        metadata["run"].as_object_mut().unwrap().remove("frame_sweeps");
        metadata.as_object_mut().unwrap().remove("sha256");
        assert_eq!(of(&metadata)["frame_sweeps"], json!(0), "{path:?}");
        read += 1;
    }
    assert!(read >= 10, "{read}");
}

#[test]
fn terms_come_from_a_file() {
    let home = tempdir().unwrap();
    let toml = "[[terms]]\ndims = [0, 1]\n[terms.classes.lattice.kernel.spatial.gaussian]\nsigma_px = 1.5\n\
                [[terms]]\nclasses = \"whole_table\"\ndims = [1]\nrole = \"balance\"\nweight = 0.5\n";
    let lattice = json!({ "lattice": { "kernel": { "spatial": { "gaussian": { "sigma_px": 1.5 } } } } });
    let whole = json!({ "classes": "whole_table", "dims": [1], "role": "balance", "weight": 0.5 });
    let list = json!([{ "classes": lattice, "dims": [0, 1] }, whole]);
    let mut tables = Vec::new();
    for (name, text) in [
        ("a.toml", toml.to_owned()),
        ("a.json", json!({ "terms": list }).to_string()),
        ("b.json", format!("\n{list}")),
    ] {
        fs::write(home.path().join(name), text).unwrap();
        let flags = "--width 8 --height 8 --frames 1 --sweeps 2 --no-bound";
        succeed(home.path(), &format!("--terms {name} {flags}"));
        let (config, _) = config_of(home.path(), "table.npy");
        assert_eq!((config.terms.len(), config.companions), (2, false));
        assert_eq!(config.terms[1].weight, 0.5);
        tables.push(fs::read(home.path().join("table.npy")).unwrap());
        // They are written down, so that the file of terms is not needed again.
        succeed(home.path(), "--config table.json --no-bound --out again.npy");
        assert!(fs::read(home.path().join("again.npy")).unwrap() == tables[0]);
    }
    assert!(tables[0] == tables[1] && tables[0] == tables[2]);
    let output = command(home.path(), "table --terms a.toml --sigma 2").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    fs::write(home.path().join("c.json"), "[{ \"classes\": \"whole_table\", \"dim\": [0] }]").unwrap();
    let (_, err) = texts(&self::output(home.path(), "--terms c.json"));
    assert!(err.contains("c.json, line 1: unknown key 'dim': did you mean 'dims'?"), "{err}");
}

/// Every file of the documentation does what its text says, as far as a plan shows.
#[test]
fn the_examples_of_the_documentation_work() {
    let home = tempdir().unwrap();
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/configuration.md");
    let docs = fs::read_to_string(docs).unwrap();
    fs::write(home.path().join("denoiser.csv"), "1,2,1\n2,4,2\n1,2,1\n").unwrap();
    let blocks = docs.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let mut read = 0;
    for block in blocks {
        fs::write(home.path().join("example.toml"), block).unwrap();
        let (out, _) = succeed(home.path(), "--config example.toml --dry-run --json");
        let plan: Value = serde_json::from_str(&out).unwrap();
        for (line, place) in [("width", 2), ("height", 1), ("frames", 0), ("spp", 3), ("dims", 4)] {
            let said = block.lines().find_map(|text| text.strip_prefix(line)?.trim().strip_prefix('='));
            // Those of terms are lists.
            let said = said.and_then(|text| text.split('#').next()?.trim().parse::<u64>().ok());
            assert!(said.is_none_or(|said| plan["shape"][place] == said), "{block}: {plan}");
        }
        read += 1;
    }
    assert!(read >= 5, "{read}");
    // All keys are there.
    fs::write(home.path().join("unknown.toml"), "zzzzzzzz = 1").unwrap();
    let (_, err) = texts(&output(home.path(), "--config unknown.toml"));
    let (_, keys) = err.trim().split_once("write one of ").unwrap();
    for key in keys.split(", ") {
        assert!(docs.contains(&format!("`{key}`")), "docs/configuration.md says nothing of {key}");
    }
}

/// Tables that no run from white noise makes: the command refuses them, and its advice is followed.
#[test]
fn metadata_of_what_went_on_are_refused() {
    let home = tempdir().unwrap();
    let config = Config::new(Extent::still(8, 8), 2);
    let path = home.path().join("table.npy");
    let refused = |words: &str| {
        let (_, err) = texts(&output(home.path(), "--config table.json --no-bound --out again.npy"));
        assert!(err.contains(words) && err.contains("--sweeps 100"), "{err}");
        assert!(!home.path().join("again.npy").exists());
        texts(&output(home.path(), "--config table.json --no-bound --seed 3 --out again.npy"));
        assert!(!home.path().join("again.npy").exists());
        succeed(home.path(), "--config table.json --no-bound --sweeps 100 --out other.npy");
        let (other, of_other) = config_of(home.path(), "other.npy");
        assert_eq!((other, of_other.run.sweeps), (config.clone(), 100));
    };
    let save = |optimizer: &Optimizer, report: &RunReport| {
        optimizer.table().save_with(&path, &optimizer.metadata(report)).unwrap();
    };
    // What was made by another run before.
    let mut optimizer = Optimizer::new(config.clone()).unwrap();
    optimizer.run(Until::Sweeps(2)).unwrap();
    let report = optimizer.run(Until::Sweeps(2)).unwrap();
    save(&optimizer, &report);
    refused("did not begin with the white noise");
    // A part of the table.
    let wants = (0..64).map(|site| site % 8 < 4).collect();
    let demand = Demand::new([1, 8, 8], wants, vec![vec![0, 1]]).unwrap();
    let mut optimizer = Optimizer::for_demand(config.clone(), &demand).unwrap();
    let report = optimizer.run(Until::Sweeps(2)).unwrap();
    save(&optimizer, &report);
    refused("optimised for a demand");
    // An older file, whose numbers show it.
    let mut optimizer = Optimizer::new(config.clone()).unwrap();
    let report = optimizer.run(Until::Sweeps(2)).unwrap();
    let mut metadata = optimizer.metadata(&report);
    (metadata.run.start, metadata.run.next_sweep) = (None, Some(8002));
    optimizer.table().save_with(&path, &metadata).unwrap();
    refused("did not begin with the white noise");
}
