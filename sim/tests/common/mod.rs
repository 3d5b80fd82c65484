//! A host that talks to a simulated robot, and the frames it hears.
#![allow(dead_code)] // Each test uses some of it.

use sidestep::arcos::{HostCommand, MAX_FRAME, Receiver, StandardInformation};
use sidestep_sim::geometry::Pose;
use sidestep_sim::robot::{ArcosRobot, Parameters};
use sidestep_sim::{Simulation, World};

/// The frame of `command`.
pub fn frame(command: &HostCommand<'_>) -> Vec<u8> {
    let mut buffer = [0; MAX_FRAME];
    command.encode(&mut buffer).unwrap().as_bytes().to_vec()
}

pub fn plain(number: u8) -> Vec<u8> {
    frame(&HostCommand::plain(number))
}

pub fn integer(number: u8, value: i32) -> Vec<u8> {
    frame(&HostCommand::with_integer(number, value))
}

/// The frames in `bytes`, which consist of nothing else.
pub fn frames(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut receiver = Receiver::new();
    let mut input = bytes;
    let mut frames = Vec::new();
    while let Some(frame) = receiver.next_frame(&mut input) {
        frames.push(frame.as_bytes().to_vec());
    }
    assert_eq!(frames.concat(), bytes);
    frames
}

/// The SIPs in `bytes`, which consist of nothing else.
pub fn sips(bytes: &[u8]) -> Vec<StandardInformation> {
    let frames = frames(bytes);
    let decoded = frames.iter().map(|bytes| {
        let frame = sidestep::arcos::Frame::new_checked(bytes).unwrap();
        StandardInformation::decode(frame).unwrap()
    });
    decoded.collect()
}

/// A robot at the origin of an empty plane, without a session.
pub fn robot(parameters: Parameters) -> Simulation {
    in_world(World::new(), parameters)
}

/// A robot at the origin of `world`, without a session.
pub fn in_world(world: World, parameters: Parameters) -> Simulation {
    let robot = ArcosRobot::new(parameters, Pose::new(0.0, 0.0, 0.0), 1).unwrap();
    Simulation::new(world, robot)
}

/// Opens a session, and with it motors and sonars.
pub fn open(simulation: &mut Simulation) {
    let robot = simulation.robot_mut();
    for number in [0, 1, 2, 1] {
        robot.receive(&plain(number));
    }
    robot.receive(&frame(&HostCommand::enable_motors(true)));
    robot.receive(&frame(&HostCommand::enable_sonars(true)));
    let _ = robot.transmit();
}

/// Advances to `time_ms` with a `PULSE` twice a second.
pub fn drive_to(simulation: &mut Simulation, time_ms: u64) {
    while simulation.now_ms() < time_ms {
        simulation.robot_mut().receive(&plain(0));
        let next = (simulation.now_ms() + 500).min(time_ms);
        simulation.advance_to(next);
    }
}
