//! The ARCOS (formerly P2OS) serial protocol of the Pioneer bases, both directions, as a codec.
//!
//! Everything here is a pure function of bytes, or a fixed buffer: no I/O, no clock, no allocation,
//! and no input of any kind can make it panic. The session that opens a port, shakes hands and
//! retries is built on top of it elsewhere.
//!
//! - [`Frame`]: a checked view over the bytes of one frame, [`FrameWriter`] to build one and
//!   [`Receiver`] to find them in a byte stream that may contain anything.
//! - [`HostCommand`]: host to robot. The numbers are in [`command`].
//! - [`StandardInformation`] (the SIP), [`Identity`] and [`Configuration`]: robot to host.
//! - [`Odometry`], [`compass_heading_deg`] and [`BaseParameters`]: what the raw fields mean.
//!
//! Facts and their sources are in the chapter `arcos` of the law book, where each invariant named
//! `arcos.INV-n` is stated. The protocol has no acknowledgement: that a command arrived can only be
//! inferred from the SIPs that follow.

mod base;
pub mod command;
mod configuration;
mod frame;
mod identity;
mod information;
mod odometry;
mod reader;
mod receiver;

pub use crate::stream::Reception;
pub use base::{BaseParameters, P3DX_SONARS, SonarPlacement};
pub use command::{Argument, HostCommand};
pub use configuration::Configuration;
pub use frame::{
    EncodeError, Frame, FrameError, FrameWriter, MAX_COUNT, MAX_FRAME, MIN_COUNT, checksum,
};
pub use identity::Identity;
pub use information::{
    COMPASS_UNCERTAINTY_DEG, MAX_SONARS, NO_ECHO_RANGE, SonarReading, SonarReadings,
    StandardInformation, Tail, compass_heading_deg,
};
pub use odometry::{Odometry, shortest_delta};
pub use reader::PacketError;
pub use receiver::{ArcosFraming, BoundedReceiver, Receiver};
