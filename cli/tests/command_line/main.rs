//! `fsot` as a user meets it: files, words, exit codes.

mod configurations;
mod export;
mod import;
mod kernels;
mod logs;
mod mistakes;
mod outputs;
mod pictures;
mod plans;
mod points;
mod printing;
mod resuming;
mod runs;
#[cfg(unix)]
mod signals;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// `fsot` in this directory; arguments are separated by spaces.
fn command(home: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fsot"));
    command.current_dir(home).args(arguments.split_whitespace());
    command
}

/// What comes of `fsot table`.
fn output(home: &Path, arguments: &str) -> Output {
    command(home, &format!("table {arguments}")).output().unwrap()
}

/// Runs `fsot table` and returns what was printed; anything but success fails.
fn succeed(home: &Path, arguments: &str) -> (String, String) {
    run(home, &format!("table {arguments}"))
}

/// Runs and returns what was printed; anything but success fails.
fn run(home: &Path, arguments: &str) -> (String, String) {
    let output = command(home, arguments).output().unwrap();
    let (out, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{arguments}: {err}");
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
