#![cfg_attr(not(test), no_std)]
//! sidestep: collision avoidance for small indoor robots, specified, proved, and drivable.
//!
//! ```text
//! Observation ──► View ──► Law ──advice──► Shield ──► Command
//! (raw, untrusted) (judged,   (any law,      (integers,
//!                  with memory) may be wrong)  proved for any advice)
//! ```
//!
//! [`controller::Controller`] runs one tick of that line. [`avoid::Avoid`] is the law of the
//! paper S1; a law of your own is one [`law::Law`] away from the same shield. `spec/` says what
//! every equation means and must keep; `proofs/` shows that it does.
//!
//! Nothing here allocates, panics or does I/O.

// Harnesses in proofs/ name the crate as its users do, so that ordinary tests can run them too.
#[cfg(kani)]
extern crate self as sidestep;

pub mod arcos;
pub mod avoid;
pub mod config;
pub mod controller;
pub mod decide;
pub mod edge;
pub mod escape;
pub mod failsafe;
pub mod gesture;
pub mod interact;
pub mod kinematics;
pub mod laser;
pub mod law;
pub mod math;
pub mod monitor;
pub mod observation;
pub mod preset;
pub mod quantity;
pub mod ring;
pub mod shield;
pub mod stream;
pub mod track;
pub mod valley;
pub mod view;
pub mod wall;

#[cfg(kani)]
#[path = "../proofs/mod.rs"]
mod proofs;

/// The program text of the guides compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../docs/your-own-law.md")]
struct YourOwnLaw;
