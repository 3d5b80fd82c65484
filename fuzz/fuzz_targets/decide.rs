//! S2's filter, losses and law. See `targets/decide.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::decide::run(data));
