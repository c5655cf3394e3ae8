//! Tables on the disk: what is written is what is read, and a file that is not a table is told what it lacks.

mod damage;
mod dialects;
mod import;
mod metadata;
mod round_trip;
mod saving;

use std::fs;
use std::path::Path;

use fsot::files::{
    BoundEstimate, BoundRecord, FormatError, KernelTaps, Metadata, RunRecord, RunStart, TableError,
};
use fsot::kernel::Tap;
use fsot::{Extent, SampleTable};
use tempfile::{TempDir, tempdir};

const EXTENT: Extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };

fn table(dims: usize) -> SampleTable {
    SampleTable::white_noise(EXTENT, dims, 7).unwrap()
}

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn bits(table: &SampleTable) -> Vec<u32> {
    table.values().iter().map(|value| value.to_bits()).collect()
}

/// A `.npy` file of version 1.0, padded as numpy pads it.
fn npy(dictionary: &str, values: &[u8]) -> Vec<u8> {
    let header = (10 + dictionary.len() + 1).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header as u16).to_le_bytes());
    file.extend(dictionary.bytes());
    file.resize(10 + header - 1, b' ');
    file.push(b'\n');
    file.extend(values);
    file
}

fn f32s(shape: &str, values: &[f32]) -> Vec<u8> {
    let dictionary = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    npy(&dictionary, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
}

fn load_bytes(bytes: &[u8]) -> Result<SampleTable, TableError> {
    let home = tempdir().unwrap();
    let path = home.path().join("table.npy");
    fs::write(&path, bytes).unwrap();
    SampleTable::load(&path)
}

/// The problem with a file of these bytes; its message must name the file and contain all of `words`.
fn problem(bytes: &[u8], words: &[&str]) -> FormatError {
    problem_of(load_bytes(bytes).unwrap_err(), "table.npy", words)
}

fn problem_of(error: TableError, file: &str, words: &[&str]) -> FormatError {
    let text = error.to_string();
    for word in [file].iter().chain(words) {
        assert!(text.contains(word), "{word:?} is missing in: {text}");
    }
    assert!(!text.contains('\n') && text.len() < 600, "{text}");
    match error {
        TableError::Format { problem, .. } => problem,
        other => panic!("{other:?}"),
    }
}

fn metadata(table: &SampleTable) -> Metadata {
    let estimate = BoundEstimate {
        value: 0.1 + 0.2,
        standard_error: f64::INFINITY,
        ratio_to_white_noise: 1.0 / 3.0,
        ratio_standard_error: 5e-324,
    };
    let configuration = serde_json::json!({ "steps": 3, "terms": [{ "sigma": 2.1 }], "none": null });
    Metadata {
        kernels: vec![KernelTaps {
            term: 1,
            taps: vec![
                Tap { dt: 0, dy: 0, dx: 0, weight: 1.0 },
                Tap { dt: -2, dy: 1, dx: -1, weight: 0.0395582850655909 },
            ],
        }],
        bound: Some(BoundRecord { before: estimate, after: estimate }),
        run: RunRecord {
            frame_sweeps: 2,
            slices_per_class: 64,
            sweeps: 3,
            ended_early: true,
            steps: 4096,
            seconds: 12.75,
            next_step: Some(65),
            next_sweep: None,
            start: Some(RunStart::Elsewhere),
        },
        ..Metadata::new(table.extent(), table.dims(), u64::MAX - 1, configuration)
    }
}

/// A directory with a table and its metadata, and their bytes.
fn saved() -> (TempDir, SampleTable, [Vec<u8>; 2]) {
    let home = tempdir().unwrap();
    let table = table(2);
    table.save_with(home.path().join("table.npy"), &metadata(&table)).unwrap();
    let bytes = ["table.npy", "table.json"].map(|name| fs::read(home.path().join(name)).unwrap());
    (home, table, bytes)
}
