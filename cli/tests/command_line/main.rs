//! `fsot table` as a user meets it: files, words, exit codes.

mod mistakes;
mod runs;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A run of `fsot table` in this directory; arguments are separated by spaces.
fn command(home: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fsot"));
    command.current_dir(home).arg("table").args(arguments.split_whitespace());
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
