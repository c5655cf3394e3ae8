//! Mistakes are refused with the values that show them, before any work.

use fsot::config::ExtentError;
use fsot::{Extent, SampleTable};
use fsot_lab::samplers::{
    Cooling, DitherMask, Fast, SamplerError, ScramblingKeys, SeedPermutation, Stbn, histogram_sampling,
};

use crate::common::tile;

fn says(made: Result<SampleTable, SamplerError>, words: &str) {
    let complaint = made.unwrap_err().to_string();
    assert!(complaint.contains(words), "{words} is missing in: {complaint}");
}

#[test]
fn bad_sizes_are_named() {
    let empty = Extent { height: 0, ..tile(1, 8, 1) };
    says(DitherMask::new(empty, 2).table(), "height is 0");
    says(Fast::new(empty, 2).table(), "height is 0");
    says(Stbn::new(empty, 2).table(), "height is 0");
    says(ScramblingKeys::new(empty, 2).table(), "height is 0");
    says(DitherMask::new(tile(1, 8, 2), 2).table(), "spp is 2: give a value of 1");
    says(Fast::new(tile(1, 8, 4), 2).table(), "spp is 4: give a value of 1");
    says(Stbn::new(tile(1, 8, 4), 1).table(), "spp is 4: give a value of 1");
    says(ScramblingKeys::new(tile(1, 8, 9), 2).table(), "spp is 9: give a value that is a power of two");
    says(Fast::new(tile(1, 8, 1), 0).table(), "dims is 0");
    says(Fast::new(tile(1, 8, 1), 65).table(), "dims is 65");
    says(Fast::new(tile(1 << 20, 1 << 20, 1), 2).table(), "values");
}

#[test]
fn bad_parameters_are_named() {
    let extent = tile(1, 8, 1);
    let mask = DitherMask::new(extent, 2);
    let cooled = |start, end, sweeps| DitherMask { cooling: Cooling { start, end, sweeps }, ..mask }.table();
    says(cooled(0.0, 0.0, 1), "the first temperature is 0");
    says(cooled(f64::INFINITY, 1.0, 1), "the first temperature is inf");
    says(cooled(1.0, 2.0, 1), "the last temperature is 2");
    says(cooled(1.0, 1.0, u64::MAX), "sweeps is 1.84467e19");
    says(DitherMask { sigma_px: 0.0, ..mask }.table(), "sigma_px is 0");
    says(DitherMask { sigma_value: -1.0, ..mask }.table(), "sigma_value is -1");
    says(DitherMask { sigma_value: 1e-30, ..mask }.table(), "sigma_value is");
    says(Stbn { deviation_frames: f64::NAN, ..Stbn::new(extent, 1) }.table(), "sigma_frames is NaN");
    says(Fast { kernels: Vec::new(), ..Fast::new(extent, 2) }.table(), "the number of kernels is 0");
    says(ScramblingKeys { integrands: 0, ..ScramblingKeys::new(extent, 2) }.table(), "integrands is 0");
}

#[test]
fn a_picture_that_no_mask_tiles_is_refused() {
    let mask = SampleTable::white_noise(tile(1, 8, 1), 1, 0).unwrap();
    let error = SeedPermutation::new([8, 20], &mask, 0).unwrap_err();
    assert!(
        error.to_string().contains("width is 20: give a value that is a multiple of the mask's"),
        "{error}"
    );
    assert!(matches!(
        SeedPermutation::new([0, 8], &mask, 0),
        Err(SamplerError::Extent(ExtentError::EmptyAxis { axis: "height" }))
    ));
}

#[test]
fn pictures_of_another_size_are_named() {
    let says = |error: SamplerError, text: &str| assert!(error.to_string().contains(text), "{error}");
    says(histogram_sampling(&[], &[0.5]).unwrap_err(), "the number of estimates is 0");
    says(histogram_sampling(&[&[1.0, 2.0]], &[0.5]).unwrap_err(), "the number of pixels of an estimate is 2");
    let mask = SampleTable::white_noise(tile(1, 4, 1), 1, 0).unwrap();
    let mut seeds = SeedPermutation::new([8, 8], &mask, 0).unwrap();
    says(seeds.advance(&[0.0; 63]).unwrap_err(), "the number of values is 63");
}
