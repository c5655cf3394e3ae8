//! The example `spatiotemporal_table` as a user meets it: files, words, exit codes.

mod mistakes;
mod runs;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Beside the tests, where `cargo test` builds the examples too.
fn program() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let built = test.parent().and_then(Path::parent).unwrap();
    let name = format!("spatiotemporal_table{}", std::env::consts::EXE_SUFFIX);
    let path = built.join("examples").join(name);
    assert!(
        path.is_file(),
        "{} is missing: run `cargo test --release`, or build it with `cargo build --release --examples`",
        path.display()
    );
    path
}

/// A run in this directory; arguments are separated by spaces.
fn command(home: &Path, arguments: &str) -> Command {
    let mut command = Command::new(program());
    command.current_dir(home).args(arguments.split_whitespace());
    command
}

fn output(home: &Path, arguments: &str) -> Output {
    command(home, arguments).output().unwrap()
}

/// Runs and returns what was printed; anything but success fails.
fn succeed(home: &Path, arguments: &str) -> (String, String) {
    let output = output(home, arguments);
    let (out, err) = texts(&output);
    assert!(output.status.success(), "{arguments}: {err}");
    (out, err)
}

fn texts(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr))
}

/// Names of the files in a directory, sorted.
fn names(home: &Path) -> Vec<String> {
    let entries = fs::read_dir(home).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
