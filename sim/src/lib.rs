//! A simulated world and robot base for `sidestep`, without hardware, threads or a clock of its
//! own.
//!
//! - [`world`]: walls, boxes, discs and [`person`]s in the plane; [`eth`] and [`barn`] read
//!   recorded people and cluttered worlds.
//! - [`sonar`], [`compass`], [`depth_camera`], [`skeleton`], [`base`]: what the robot senses
//!   with, wrongly where asked to, and what it drives with.
//! - [`laser`]: a scanner beside them, not on the serial line.
//! - [`robot`]: the robot's side of the ARCOS protocol, bytes in and bytes out; [`uart`]: what a
//!   line set to the wrong baud rate makes of them; [`link`]: what a bad line makes of packets.
//! - [`corridor`]: planned ways through corridors; [`scenario`]: named situations, and seeded variations of them; [`episode`]: situations made up
//!   from a seed; [`simulation`]: everything advanced together, with a judgement of every contact;
//!   [`truth`]: which assumption of a shield did not hold in it.
//!
//! Lengths are in m, times in s or whole ms, angles in rad, counter-clockwise from +x. Time is
//! always an argument, and every random number comes from a seed: the same calls give the same
//! bytes.
//!
//! ```
//! use sidestep_sim::scenario::{Knobs, Scenario};
//!
//! let scenario = Scenario::named("fig12-head-on", &Knobs::default())?;
//! let mut simulation = scenario.simulate()?;
//! simulation.robot_mut().receive(&[0xFA, 0xFB, 3, 0, 0, 0]); // SYNC0
//! assert_eq!(simulation.robot_mut().transmit(), [0xFA, 0xFB, 3, 0, 0, 0]);
//! // Nobody told the robot to move: the person walks up to it and round it.
//! simulation.advance_to(30_000);
//! assert_eq!(simulation.outcome().contacts_at_rest.people, 0);
//! # Ok::<(), sidestep_sim::Error>(())
//! ```

pub mod barn;
pub mod base;
pub mod compass;
pub mod corridor;
pub mod depth_camera;
pub mod episode;
mod error;
pub mod eth;
pub mod geometry;
pub mod laser;
pub mod link;
pub mod person;
pub mod robot;
pub mod scenario;
pub mod simulation;
pub mod skeleton;
pub mod sonar;
mod table;
pub mod truth;
pub mod uart;
pub mod world;

pub use error::Error;
pub use robot::ArcosRobot;
pub use scenario::Scenario;
pub use simulation::Simulation;
pub use world::World;

/// The fixed step by which everything moves (ms).
pub const STEP_MS: u64 = 10;

/// The same step (s).
pub const STEP: f64 = STEP_MS as f64 / 1000.0;
