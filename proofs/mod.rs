//! Proof harnesses, one file per chapter of `spec/`.
//!
//! `cargo kani` at the root of the repository verifies all of them. They use the library as its
//! users do, so `tests/proofs.rs` compiles the same files without Kani and runs every harness on
//! random inputs: a harness that no longer fits the code fails an ordinary test.
//!
//! Each harness says which invariants it shows, on which domain, and what stands in for what.
//! Solver and unwinding are chosen per harness; none takes a minute.

#![allow(
    clippy::needless_range_loop,
    reason = "plain indexed loops are what closes in the solver"
)]
#![allow(
    dead_code,
    reason = "stand-ins are named only in attributes, which Kani alone reads"
)]

#[cfg(not(kani))]
use crate::kani;

pub mod arcos;
pub mod avoid;
pub mod decide;
pub mod edge;
pub mod failsafe;
pub mod gesture;
pub mod interact;
pub mod kinematics;
pub mod laser;
pub mod math;
pub mod monitor;
pub mod shield;
pub mod valley;
pub mod view;
