//! What the fuzz targets do with their bytes.
//!
//! Each function takes any bytes and panics if a predicate of `sidestep-spec` is broken.
//! `fuzz_targets/*.rs` hand them libFuzzer's bytes, `tests/fuzz_corpus.rs` the seed corpus and
//! pseudo-random ones, so that what the fuzzer runs is also an ordinary test.

pub mod arcos;
pub mod avoid;
pub mod bytes;
pub mod controller;
pub mod decide;
pub mod edge;
pub mod gesture;
pub mod interact;
pub mod laser;
pub mod reference;
pub mod settings;
pub mod shield;
pub mod valley;
pub mod watch;
