//! Runs that succeed.

use std::f64::consts::PI;
use std::fs;

use fsot::kernel::TemporalKernel;
use fsot::{Config, Extent, SampleTable};
use tempfile::tempdir;

use crate::{names, succeed};

const SMALL: &str = "--width 12 --height 10 --frames 3";

#[test]
fn a_run_writes_a_table_and_how_it_was_made() {
    let home = tempdir().unwrap();
    let (out, _) = succeed(home.path(), "--width 32 --height 24 --frames 1 --slices-per-class 100 --seed 5");
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
    let (table, metadata) = SampleTable::load_with(home.path().join("table.npy")).unwrap();
    let extent = Extent { frames: 1, height: 24, width: 32, spp: 1 };
    assert_eq!((table.extent(), table.dims()), (extent, 2));
    // The configuration reads back as the library's own, and it makes the same table.
    let config: Config = serde_json::from_value(metadata.configuration.clone()).unwrap();
    assert_eq!(config, Config::new(extent, 2).with_seed(5));
    assert_eq!((metadata.seed, metadata.run.slices_per_class), (5, 100));
    let mut optimizer = fsot::Optimizer::new(config).unwrap();
    let report = optimizer.run(fsot::Until::SlicesPerClass(100)).unwrap();
    assert_eq!((optimizer.table(), report.steps), (table, metadata.run.steps));
    // ∫ exp(-r²/σ²) = π σ² = 13.85; taps below a thousandth are dropped, at most their integral of 0.014.
    // The kernel, and the neighbours that go with it.
    assert_eq!(metadata.kernels.len(), 2);
    let sum: f64 = metadata.kernels[0].taps.iter().map(|tap| tap.weight).sum();
    assert!((sum - PI * 2.1 * 2.1).abs() < 0.03, "{sum}");
    let bound = metadata.bound.unwrap();
    let ratios = [bound.before, bound.after].map(|bound| bound.ratio_to_white_noise);
    // The start is one table of white noise, of which a whole-table term knows how good it happens to be.
    assert!((ratios[0] - 1.0).abs() < 0.1 && ratios[1] < 0.7, "{ratios:?}");
    assert!(metadata.run.seconds > 0.0);
    // The summary says the same.
    assert!(out.contains("--slices-per-class 100 --sweeps 0"), "{out}");
    assert!(out.contains(&format!("{:.5} ± ", bound.after.value)), "{out}");
    assert!(out.contains("table.npy, table.json"), "{out}");
    assert_eq!(out.lines().count(), 3, "{out}");
}

#[test]
fn every_flag_reaches_the_configuration() {
    let home = tempdir().unwrap();
    let flags = "--spp 2 --dims 4 --sigma 1.5 --temporal ema:0.2 --groups 0,1:1;2,3:1;0-3:0.5 --domain torus \
                 --optimizer adam --slices-per-class 8 --no-bound --seed 18446744073709551615 \
                 --out other.npy";
    let (out, _) = succeed(home.path(), &format!("{SMALL} {flags}"));
    assert_eq!(names(home.path()), ["other.json", "other.npy"]);
    assert_eq!(out.lines().count(), 2, "{out}");
    let (table, metadata) = SampleTable::load_with(home.path().join("other.npy")).unwrap();
    assert_eq!(table.shape(), [3, 10, 12, 2, 4]);
    assert_eq!(metadata.bound, None);
    let config: Config = serde_json::from_value(metadata.configuration).unwrap();
    assert_eq!(config.seed, u64::MAX);
    assert_eq!(config.domains, vec![fsot::config::Domain::Torus; 4]);
    assert_eq!(config.descent, fsot::config::Descent::adam());
    let kernel = fsot::Kernel::product(
        fsot::kernel::SpatialKernel::Gaussian { sigma_px: 1.5 },
        TemporalKernel::Ema { alpha: 0.2 },
    );
    let group = |dims: &[usize], weight| fsot::config::DimensionGroup { dims: dims.to_vec(), weight };
    let groups = [group(&[0, 1], 1.0), group(&[2, 3], 1.0), group(&[0, 1, 2, 3], 0.5)];
    let form = fsot::classes::FilterForm::LevelSets;
    let kernels = [kernel];
    let mut terms = fsot::config::Term::blue_noise(&kernels, form, &groups, &config.extent);
    assert_eq!(terms.iter().filter(|term| term.role == fsot::config::Role::Descend).count(), 3);
    // The pixel by itself and its neighbours, in a frame and over time, and the kernel in a frame; over time
    // it has more taps than metadata list.
    terms.extend(fsot::config::Term::companions(&kernels, form, &groups, &config.extent));
    assert_eq!(config.terms, terms);
    assert_eq!(metadata.kernels.len(), 3 * 5);
}

#[test]
fn every_temporal_kernel_is_accepted() {
    let home = tempdir().unwrap();
    for (flag, expected) in [
        ("none", TemporalKernel::None),
        ("gaussian:1.5", TemporalKernel::Gaussian { sigma_frames: 1.5 }),
        ("ema:0.1", TemporalKernel::Ema { alpha: 0.1 }),
        ("box:4", TemporalKernel::Box { frames: 4 }),
        ("binomial:5", TemporalKernel::Binomial { frames: 5 }),
        ("perceptual:30", TemporalKernel::Perceptual { fps: 30.0 }),
        ("taps:0.5,0.25,0,1e-2", TemporalKernel::Taps(vec![0.5, 0.25, 0.0, 0.01])),
    ] {
        succeed(home.path(), &format!("{SMALL} --slices-per-class 2 --no-bound --temporal {flag}"));
        let (_, metadata) = SampleTable::load_with(home.path().join("table.npy")).unwrap();
        let config: Config = serde_json::from_value(metadata.configuration).unwrap();
        let fsot::classes::Classes::Lattice { kernel, .. } = &config.terms[0].classes else {
            panic!("{config:?}")
        };
        assert_eq!(kernel.temporal, expected);
    }
}

#[test]
fn quiet_is_silent() {
    let home = tempdir().unwrap();
    let (out, err) = succeed(home.path(), &format!("{SMALL} --slices-per-class 4 --quiet"));
    assert_eq!((out.as_str(), err.as_str()), ("", ""));
    assert_eq!(names(home.path()), ["table.json", "table.npy"]);
}

#[test]
fn threads_give_identical_bytes() {
    let home = tempdir().unwrap();
    let table = |threads| {
        let work = "--slices-per-class 32 --sweeps 2";
        succeed(home.path(), &format!("{SMALL} {work} --no-bound --threads {threads}"));
        fs::read(home.path().join("table.npy")).unwrap()
    };
    let alone = table(1);
    assert!(table(3) == alone);
}

#[test]
fn seconds_and_then_their_work_give_identical_bytes() {
    let home = tempdir().unwrap();
    let (out, _) = succeed(home.path(), &format!("{SMALL} --no-bound --seconds 0.3"));
    let timed = fs::read(home.path().join("table.npy")).unwrap();
    let words: Vec<&str> = out.split_whitespace().collect();
    let flag = words.iter().position(|&word| word == "--frame-sweeps").expect(&out);
    succeed(home.path(), &format!("{SMALL} --no-bound {}", words[flag..flag + 6].join(" ")));
    assert!(fs::read(home.path().join("table.npy")).unwrap() == timed, "{out}");
}

#[test]
fn a_table_is_replaced() {
    let home = tempdir().unwrap();
    fs::write(home.path().join("table.npy"), "what was here before").unwrap();
    succeed(home.path(), "--width 1 --height 1 --frames 1 --quiet");
    assert_eq!(SampleTable::load(home.path().join("table.npy")).unwrap().shape(), [1, 1, 1, 1, 2]);
}
