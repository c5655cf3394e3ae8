//! The tables in `data/tables` are what `data/README.md` says they are.

use std::fs;
use std::path::{Path, PathBuf};

use fsot::classes::Classes;
use fsot::metrics::{Bias, Bound, FilteredError, Integrands};
use fsot::{Config, Objective, SampleTable};

/// Filtered error, bound and bias, as ratios to white noise.
struct Figures {
    filtered: f64,
    bound: f64,
    bias: f64,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/tables")
}

/// Rows such as ``| `name` | what for | 0.175 | 0.58 | 0.1 |`` of the page beside the tables.
fn recorded() -> Vec<(String, Figures)> {
    let page = fs::read_to_string(folder().with_file_name("README.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `") && line.contains("spp_"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        let figure = |cell: usize| cells[cell].parse().unwrap_or_else(|_| panic!("{row}"));
        (cells[1].to_string(), Figures { filtered: figure(3), bound: figure(4), bias: figure(5) })
    })
    .collect()
}

/// As in the page: the mean over pairs of dimensions, under the kernel that the table was made for.
fn measure(name: &str) -> Figures {
    let (table, metadata) = SampleTable::load_with(folder().join(name).with_extension("npy")).unwrap();
    let config: Config = serde_json::from_value(metadata.configuration).unwrap();
    assert_eq!((table.extent(), table.dims()), (config.extent, config.dims), "{name}");
    let Classes::Lattice { kernel, .. } = &config.terms[0].classes else { panic!("{name}: {config:?}") };
    let integrands = Integrands::random(2, 64, 0).unwrap();
    let pairs: Vec<[usize; 2]> = (0..config.dims / 2).map(|pair| [2 * pair, 2 * pair + 1]).collect();
    let (mut filtered, mut bias) = (0.0, 0.0);
    for pair in &pairs {
        filtered +=
            FilteredError::measure(&table, pair, &integrands, kernel).unwrap().spatio_temporal.mean.mean;
        bias += Bias::measure(&table, pair, &integrands).unwrap().table.mean.mean;
    }
    let objective = Objective::new(&config).unwrap();
    let bound = Bound::measure(&table, &objective, 0, 8192).unwrap().total.ratio_to_white_noise;
    Figures { filtered: filtered / pairs.len() as f64, bound, bias: bias / pairs.len() as f64 }
}

#[test]
fn tables_are_as_recorded() {
    let recorded = recorded();
    let measured: Vec<Figures> = recorded.iter().map(|(name, _)| measure(name)).collect();
    for ((name, _), Figures { filtered, bound, bias }) in recorded.iter().zip(&measured) {
        println!("| `{name}` | {filtered:.3} | {bound:.3} | {bias:.2} |");
    }
    for ((name, expected), Figures { filtered, bound, bias }) in recorded.iter().zip(&measured) {
        // The last digit of the page; the bias also where a platform rounds a table's integrands otherwise.
        assert!((filtered - expected.filtered).abs() < 1e-3, "{name}: {filtered}");
        assert!((bound - expected.bound).abs() < 1e-3, "{name}: {bound}");
        assert!((bias - expected.bias).abs() < 1e-2, "{name}: {bias}");
    }
    let mut listed: Vec<&str> = recorded.iter().map(|(name, _)| name.as_str()).collect();
    listed.sort_unstable();
    let mut found: Vec<String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "npy"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    found.sort_unstable();
    assert_eq!(listed, found, "tables and rows of data/README.md");
}

/// What a checkout has to carry.
#[test]
fn tables_are_small() {
    let size = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().metadata().unwrap().len();
    let bytes: u64 = fs::read_dir(folder()).unwrap().map(size).sum();
    assert!(bytes <= 4 << 20, "{bytes} bytes");
}
