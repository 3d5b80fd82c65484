//! The core on bare metal, as a firmware would call it. This crate defines the panic handler itself:
//! if anything it depends on linked std, there would be two, and it would not compile.
#![no_std]

use core::mem::MaybeUninit;
use nalgebra::Vector2;
use sidestep::avoid::Avoid;
use sidestep::config::Config;
use sidestep::controller::Controller;
use sidestep::decide::Decide;
use sidestep::edge::{Edge, PlannedEdge};
use sidestep::escape::Escape;
use sidestep::interact::Interact;
use sidestep::law::Law;
use sidestep::observation::Observation;
use sidestep::preset;
use sidestep::ring::{Placement, Ring};

/// S1's law under the shield, with the three sonars of S1's robot.
pub type Base = Controller<Avoid, 3>;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// Makes a controller where the firmware has room for one. False if it could not; nothing is written
/// then.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_start(controller: &mut MaybeUninit<Base>) -> bool {
    let Ok(config) = Config::new(preset::SRIKANDI_II_2012) else {
        return false;
    };
    let at = |heading| Placement {
        x: 0.2,
        y: 0.0,
        heading,
    };
    let Ok(ring) = Ring::new(&[at(0.5), at(0.0), at(-0.5)], &config) else {
        return false;
    };
    let goal = Vector2::new(3.0, 0.0);
    match Controller::new(config, ring, Avoid::new(config), goal) {
        Ok(made) => {
            controller.write(made);
            true
        }
        Err(_) => false,
    }
}

/// One tick. Writes the turn rate in mrad/s, and returns the speed in mm/s.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_tick(
    controller: &mut Base,
    observation: &Observation<3>,
    turn_rate: &mut i32,
) -> i32 {
    let command = controller.tick(observation).command;
    *turn_rate = command.turn_rate();
    command.speed()
}

/// A tick of any law under the shield.
fn tick<L: Law<3>>(controller: &mut Controller<L, 3>, observation: &Observation<3>) -> i32 {
    controller.tick(observation).command.speed()
}

/// The same for S2's decision round S1's law. Returns the speed in mm/s.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_tick_decide(
    controller: &mut Controller<Decide<Avoid, 3>, 3>,
    observation: &Observation<3>,
) -> i32 {
    tick(controller, observation)
}

/// The same for S4's law on a route of four edges.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_tick_edge(
    controller: &mut Controller<Edge<[PlannedEdge; 4], 3>, 3>,
    observation: &Observation<3>,
) -> i32 {
    tick(controller, observation)
}

/// The same for S3's law.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_tick_interact(
    controller: &mut Controller<Interact, 3>,
    observation: &Observation<3>,
) -> i32 {
    tick(controller, observation)
}

/// The same for a law with a way out of where it is stuck.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_tick_escape(
    controller: &mut Controller<Escape<Avoid, 3>, 3>,
    observation: &Observation<3>,
) -> i32 {
    tick(controller, observation)
}
