//! Every function of `edge`, and S4's law. See `targets/edge.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::edge::run(data));
