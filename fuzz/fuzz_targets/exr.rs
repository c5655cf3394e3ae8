//! `Picture::open` of EXR files: a picture, or a refusal.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fsot_fuzz::picture(&fsot_fuzz::file("picture.exr", bytes)));
