//! The guard, asked anything. See `targets/shield.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::shield::run(data));
