//! Any stream of bytes through the codec of the laser scanner. See `targets/lms200.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::lms200::run(data));
