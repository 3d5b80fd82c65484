//! The machine M2 and S3's law. See `targets/interact.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::interact::run(data));
