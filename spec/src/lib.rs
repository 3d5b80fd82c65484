//! The law book of sidestep, its executable half.
//!
//! One module per chapter of `spec/*.md`. Each holds two things and nothing else:
//!
//! - the equations in `f64`, exactly as read: `…_printed` is the formula of the paper, `…` is the
//!   reading that is implemented. They are written to be compared with the page, not to be fast,
//!   and share no code with the crate that is being judged;
//! - every invariant once, as a predicate. Proofs, property tests and fuzz targets all call these
//!   predicates; none writes its own copy.
//!
//! Papers: S1 is Budiharto, Santoso, Purwanto, Jazidie, "A New Method of Obstacle Avoidance for
//! Service Robots in Indoor Environments"; S2 is Budiharto, Purwanto, Jazidie, "A
//! robust obstacle avoidance for service robot using Bayesian approach". Lengths of S1 and S2 are in cm and speeds in cm/s here, as printed.

pub mod arcos;
pub mod avoid;
pub mod coverage;
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
