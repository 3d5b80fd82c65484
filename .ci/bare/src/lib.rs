//! The core on bare metal. This crate defines the panic handler itself: if anything it depends on
//! linked std, there would be two, and it would not compile.
#![no_std]

use nalgebra::Vector2;
use sidestep::avoid::Avoid;
use sidestep::config::Config;
use sidestep::controller::Controller;
use sidestep::observation::Observation;
use sidestep::preset;
use sidestep::ring::{Placement, Ring};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// One tick of S1's law with three sonars, as a firmware would call it. Returns the speed in mm/s.
#[unsafe(no_mangle)]
pub extern "C" fn sidestep_tick(observation: &Observation<3>) -> i32 {
    let Ok(config) = Config::new(preset::SRIKANDI_II_2012) else {
        return 0;
    };
    let at = |heading| Placement {
        x: 0.2,
        y: 0.0,
        heading,
    };
    let Ok(ring) = Ring::new(&[at(0.5), at(0.0), at(-0.5)], &config) else {
        return 0;
    };
    let goal = Vector2::new(3.0, 0.0);
    match Controller::new(config, ring, Avoid::new(config), goal) {
        Ok(mut controller) => controller.tick(observation).command.speed(),
        Err(_) => 0,
    }
}
