//! Any bytes as the contents of an information packet. See `targets/arcos.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::arcos::information(data));
