//! Binds sidestep to a robot controller on a serial line or a TCP connection.
//!
//! [`pilot`] is the control loop without I/O: [`session`] speaks the ARCOS protocol, [`base`]
//! makes observations of its packets, the core decides, [`log`] records. [`drive`] runs it in
//! real time over a [`transport`]. [`episodes`] and [`faults`] run it in virtual time by the
//! thousand, to see whether anything is ever touched. The rest is the program `sidestep`.

pub mod announce;
pub mod base;
pub mod config;
pub mod coverage;
pub mod decide;
pub mod demo;
pub mod draw;
pub mod drive;
pub mod edge;
pub mod emulate;
pub mod encounter;
pub mod episodes;
pub mod faults;
pub mod gestures;
pub mod laser;
pub mod log;
pub mod meet;
pub mod pilot;
pub mod replay;
pub mod session;
pub mod skeletons;
pub mod transport;
