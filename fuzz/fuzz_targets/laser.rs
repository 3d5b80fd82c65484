//! Any stream of bytes through the codec of the laser scanner. See `targets/laser.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::laser::run(data));
