//! The tables in `data/tables` are what `data/README.md` says they are.

use std::fs;
use std::path::{Path, PathBuf};

use fsot::classes::Classes;
use fsot::metrics::{Bias, Bound, FaceDensity, FilteredError, Integrands, Marginal};
use fsot::{Config, Extent, Objective, SampleTable, Site};

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
    assert!(metadata.sha256.is_some(), "{name}: the metadata do not say of which values they are");
    let config: Config = serde_json::from_value(metadata.configuration).unwrap();
    assert_eq!((table.extent(), table.dims()), (config.extent, config.dims), "{name}");
    let Classes::Lattice { kernel, .. } = &config.terms[0].classes else { panic!("{name}: {config:?}") };
    let dims: Vec<usize> = (0..config.dims).collect();
    let pairs: Vec<&[usize]> = dims.chunks(2).collect();
    // Large tables take long enough with fewer, and scatter less.
    let per_family = if table.values().len() > 1 << 20 { 8 } else { 64 };
    let integrands = Integrands::random(pairs[0].len(), per_family, 0).unwrap();
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
    let files = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap());
    let tables = files.filter(|entry| entry.path().extension().is_some_and(|extension| extension == "npy"));
    let bytes: u64 = tables.map(|entry| entry.metadata().unwrap().len()).sum();
    assert!(bytes <= 16 << 20, "{bytes} bytes");
}

/// Every coordinate has the values of a regular grid, up to the faces; no direction is preferred.
#[test]
fn tables_are_even() {
    for (name, _) in recorded() {
        let table = SampleTable::load(folder().join(&name).with_extension("npy")).unwrap();
        let samples = (table.values().len() / table.dims()) as f64;
        for dim in 0..table.dims() {
            let marginal = Marginal::measure(&table, dim, 64).unwrap();
            let [least, most] = marginal.extremes();
            assert!(
                least > 1.0 - 65.0 / samples && most < 1.0 + 65.0 / samples && marginal.zeros == 0,
                "{name}"
            );
            let is_even = |face: &FaceDensity| (face.density - 1.0).abs() < 1.0 / (face.within * samples);
            assert!(marginal.faces.iter().all(is_even), "{name}: {:?}", marginal.faces);
        }
    }
}

/// How far samples of a frame are correlated with those some pixels away, as the README and
/// `Extent::displacement` say: neighbours most, displaced uses hardly.
#[test]
fn displaced_uses_are_hardly_correlated() {
    for (name, _) in recorded() {
        let table = SampleTable::load(folder().join(&name).with_extension("npy")).unwrap();
        let Extent { height, width, spp, .. } = table.extent();
        let frame = Extent { frames: 1, ..table.extent() };
        let correlation = |dy: usize, dx: usize| {
            let product = |index: usize| -> f64 {
                let site = frame.site(index / spp);
                let there = Site { y: site.y + dy, x: site.x + dx, ..site };
                let pairs = table.sample(site, index % spp).iter().zip(table.sample(there, index % spp));
                pairs.map(|(here, there)| (f64::from(*here) - 0.5) * (f64::from(*there) - 0.5)).sum()
            };
            let products = frame.samples() * table.dims();
            12.0 * (0..frame.samples()).map(product).sum::<f64>() / products as f64
        };
        let seven = (0..=height / 2)
            .flat_map(|y| (0..width).map(move |x| (y, x)))
            .filter(|&(y, x)| (6.5..7.5).contains(&(y as f64).hypot(x.min(width - x) as f64)));
        let at_seven = seven.map(|(y, x)| correlation(y, x).abs()).fold(0.0, f64::max);
        let uses = (1..36).map(|index| table.extent().displacement(index));
        let displaced: Vec<f64> = uses.map(|by| correlation(by.y, by.x)).collect();
        let largest = displaced.iter().map(|value| value.abs()).fold(0.0, f64::max);
        let rms = (displaced.iter().map(|value| value * value).sum::<f64>() / 35.0).sqrt();
        let beside = correlation(0, 1);
        println!(
            "{name}: {beside:.2} beside, {at_seven:.2} at 7 pixels; displaced {largest:.3}, rms {rms:.3}"
        );
        assert!(largest < 0.08 && rms < 0.05, "{name}");
        // Several samples share the work of one.
        assert!(spp > 1 || beside < -0.1 && largest < beside.abs(), "{name}");
    }
}
