//! Whole lives of a robot under the shield. See `targets/controller.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::controller::run(data));
