//! Skeletons, scores and people over time. See `targets/gesture.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::gesture::run(data));
