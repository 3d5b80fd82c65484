//! Every function of `avoid` and `kinematics`. See `targets/avoid.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::avoid::run(data));
