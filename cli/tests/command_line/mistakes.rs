//! Runs that are refused: one clear sentence, a failing exit code, no panic, no file.

use std::path::Path;

use tempfile::tempdir;

use crate::{names, output, texts};

/// The sentence after `error: `.
fn refused(home: &Path, arguments: &str) -> String {
    let before = names(home);
    let output = output(home, arguments);
    let (out, err) = texts(&output);
    // A code, so it was not killed by a signal, as an abort for lack of memory is.
    assert!(output.status.code().is_some_and(|code| code != 0), "{arguments}: {:?} {err}", output.status);
    assert_eq!(out, "", "{arguments}");
    assert!(!err.contains("panicked"), "{arguments}: {err}");
    assert_eq!(names(home), before, "{arguments}");
    let sentence = err.lines().next().and_then(|line| line.strip_prefix("error: "));
    sentence.unwrap_or_else(|| panic!("{arguments}: {err}")).to_string()
}

/// All are refused, in sentences that contain these words.
fn all_refused(cases: &[(&str, &str)]) {
    let home = tempdir().unwrap();
    for (arguments, words) in cases {
        let sentence = refused(home.path(), arguments);
        assert!(sentence.contains(words), "{arguments}: {sentence}");
    }
}

#[test]
fn flags() {
    all_refused(&[
        ("--wrong", "unexpected argument '--wrong'"),
        ("--width many", "invalid value 'many' for '--width <WIDTH>'"),
        ("--width -4", "invalid value '-4' for '--width <WIDTH>'"),
        ("--width 1.5", "invalid value '1.5'"),
        ("--optimizer newton", "invalid value 'newton'"),
        ("--domain sphere", "invalid value 'sphere'"),
        ("--seed -1", "invalid value '-1' for '--seed <SEED>'"),
        ("--seconds 1 --slices-per-class 5", "cannot be used with"),
        ("--sigma -1", "sigma_px is -1: give a value above 0"),
        ("stray", "unexpected argument 'stray'"),
    ]);
}

#[test]
fn sizes() {
    all_refused(&[
        ("--width 0", "width is 0: give at least 1"),
        ("--height 0", "height is 0: give at least 1"),
        ("--frames 0", "frames is 0: give at least 1"),
        ("--spp 0", "spp is 0: give at least 1"),
        ("--dims 0", "dims is 0: give at least 1"),
        ("--width 4000000000", "stay at or below 2147483647"),
        ("--frames 18446744073709551615", "stay at or below 2147483647"),
        ("--frames 99999999999999999999", "too large"),
        ("--dims 18446744073709551615", "give a value of at most 64"),
        ("--dims 65", "dims is 65: give a value of at most 64"),
    ]);
}

#[test]
fn numbers() {
    all_refused(&[
        ("--sigma NaN", "sigma_px is NaN: give a value above 0, at most 1e6"),
        ("--sigma 0", "sigma_px is 0: give"),
        ("--sigma=-2", "sigma_px is -2: give"),
        ("--sigma inf", "sigma_px is inf: give"),
        ("--no-bound --seconds=-1", "the number of seconds is -1: give"),
        ("--no-bound --seconds NaN", "the number of seconds is NaN: give"),
        ("--no-bound --seconds 0", "the number of seconds is 0: give"),
        ("--no-bound --seconds inf", "the number of seconds is inf: give"),
    ]);
}

#[test]
fn groups() {
    all_refused(&[
        (
            "--groups 0,9",
            "the dimension group names dimension 9, but the table has 2: name dimensions from 0 to 1",
        ),
        ("--groups 0,0", "the dimension group names dimension 0 twice: name each dimension once"),
        ("--groups=", "'' is no dimension group: write for example 0,1:1 or 0-3:0.5"),
        ("--groups 0,1;", "'' is no dimension group"),
        ("--groups 3-1", "'3-1' is no dimension group"),
        ("--groups 0-99999999999", "is no dimension group"),
        ("--groups 0,1:x", "'0,1:x' is no dimension group"),
        ("--groups 0,1:-1", "the weight of a term is -"),
        ("--groups 0,1:NaN", "the weight of a term is NaN"),
        ("--groups 0,1:0", "the weight of a term is 0"),
        ("--groups a", "'a' is no dimension group"),
    ]);
}

#[test]
fn temporal_kernels() {
    all_refused(&[
        ("--temporal ema:2", "alpha is 2: give a value from 1e-6 to 1"),
        ("--temporal ema", "'' is no number: write ema:NUMBER"),
        ("--temporal box:0", "frames of the box is 0: give"),
        ("--temporal box:-3", "'-3' is no count: write box:FRAMES"),
        ("--temporal binomial:1.5", "'1.5' is no count"),
        ("--temporal gaussian:NaN", "sigma_frames is NaN: give"),
        ("--temporal perceptual:0", "fps is 0: give"),
        ("--temporal taps:", "'' is no list of numbers: write taps:0.5,0.3,0.2"),
        ("--temporal taps:-1,2", "the temporal kernel has weight -1 at tap 0: weights must be"),
        ("--temporal taps:0,0", "the temporal kernel has no positive weight: give at least one tap above 0"),
        ("--temporal taps:1,inf", "weight inf at tap 1"),
        ("--temporal none:3", "'none:3' is no temporal kernel: write none, gaussian:SIGMA"),
        ("--temporal foo", "'foo' is no temporal kernel"),
    ]);
}

/// Whoever has typed a flag knows no field of the library.
#[test]
fn the_flags_that_help_are_named() {
    all_refused(&[
        ("--width 0", "(--width)"),
        ("--dims 65", "(--dims)"),
        ("--width 4000000000", "(--width, --height, --frames, --spp, --dims)"),
        ("--sigma 1e300", "sigma_px is 1e300: give a value above 0, at most 1e6 (--sigma)"),
        ("--sigma=-0.1234567890123", "sigma_px is -0.123457: give"),
        ("--groups 0,1:0", "(--groups)"),
        ("--groups 0,9", "(--groups)"),
        ("--temporal ema:2", "(--temporal)"),
        ("--temporal taps:0,0", "(--temporal)"),
        ("--no-bound --seconds 0", "(--seconds)"),
        ("--sweeps 18446744073709551615", "(--sweeps)"),
        ("--slices-per-class 18446744073709551615", "(--slices-per-class)"),
        ("--domain torus --sweeps 1", "(--slices-per-class instead of --sweeps)"),
    ]);
}

/// What the library refuses takes one line, without usage and hints.
#[test]
fn one_sentence_is_enough() {
    let home = tempdir().unwrap();
    for arguments in ["--width 0", "--sigma NaN", "--groups 0,9", "--out missing/table.npy", "--out t.json"] {
        let (_, err) = texts(&output(home.path(), arguments));
        assert_eq!(err.lines().count(), 1, "{err}");
    }
}
