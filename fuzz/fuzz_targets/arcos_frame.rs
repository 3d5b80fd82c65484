//! Any stream of bytes through the codec of the serial protocol. See `targets/arcos.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::arcos::frame(data));
