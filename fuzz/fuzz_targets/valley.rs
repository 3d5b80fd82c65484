//! Every function of `valley`. See `targets/valley.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::valley::run(data));
