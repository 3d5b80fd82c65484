//! Parameter sets for known robots.

use crate::config::Parameters;
use core::f32::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// The robot of S1 (2012), Table 1. Values that the paper does not give (body, dynamics, turn
/// rate) are ours, for a small service robot, and to be measured on the robot at hand. Its three
/// sonars leave up to 60° between them unseen (ER-S1-21), which `blind_angle_max` allows for here:
/// fit more sonars, and lower it.
pub const SRIKANDI_II_2012: Parameters = Parameters {
    safe_distance: 1.2,
    near_distance: 0.8,
    min_distance: 0.4,
    turn_distance: 0.6,
    speed_max: 0.4,
    cruise_speed: 0.2,
    obstacle_speed_max: 0.8,
    stop_time: 1.0,
    view_half_angle: FRAC_PI_6,
    corridor_margin: 0.15,
    hold_time: 1.0,
    confirm_samples: 3.0,
    appear_samples: 1.0,
    heading_gain: 2.0,
    turn_rate_max: FRAC_PI_2,
    alignment: 0.1,
    goal_tolerance: 0.15,
    robot_radius: 0.25,
    acceleration: 0.3,
    braking: 1.0,
    braking_share: 1.0,
    reverse_speed_max: 0.0,
    turn_acceleration: PI,
    reaction_time: 0.32,
    still_speed_max: 0.5,
    still_speed_max_turning: 0.8,
    still_samples: 10.0,
    still_tolerance: 0.05,
    range_error: 0.02,
    speed_error: 0.05,
    blind_angle_max: 1.1,
    latch_time: 5.0,
    resume_clearance: 0.1,
    resume_samples: 3.0,
    sonar_age_max: 0.5,
    odometry_age_max: 0.5,
    sonar_half_angle: FRAC_PI_6 / 2.0,
    sonar_range_min: 0.03,
    sonar_range_max: 5.0,
};

/// The robot of S2 (2011), Table 1: slower, and turning back later (d_n = 90 cm).
pub const SRIKANDI_II_2011: Parameters = Parameters {
    near_distance: 0.9,
    speed_max: 0.3,
    cruise_speed: 0.15,
    obstacle_speed_max: 0.3,
    still_speed_max: 0.2,
    still_speed_max_turning: 0.3,
    ..SRIKANDI_II_2012
};

/// A Pioneer P3-DX with its sonar ring, driven by S1's law. The base is set to accelerate at
/// 0.3 m/s² and to brake at 1 m/s²; ticks come with its information packets, every 100 ms. The radius
/// reaches to the rear, 301 mm from the centre of rotation, so that the robot may turn in place.
pub const PIONEER_3DX: Parameters = Parameters {
    corridor_margin: 0.25,
    resume_clearance: 0.05,
    robot_radius: 0.301,
    reaction_time: 0.22,
    reverse_speed_max: 0.1,
    blind_angle_max: 0.2,
    ..SRIKANDI_II_2012
};

/// A small round base with the front sonars of a P3-DX, for S4's corridors: 0.2 m of radius leave
/// room in a safe path of 600 mm, into which the circle of a P3-DX, 602 mm across, does not fit. What
/// stands in a corridor is promised to move no faster than 0.05 m/s once it has been seen to stand
/// still; S1's least distance is not S4's, which looks at echoes from as near as 140 mm.
pub const CORRIDOR_BASE: Parameters = Parameters {
    min_distance: 0.05,
    turn_distance: 0.1,
    robot_radius: 0.2,
    still_speed_max: 0.05,
    still_speed_max_turning: 0.05,
    range_error: 0.01,
    reverse_speed_max: 0.0,
    resume_clearance: 0.02,
    ..PIONEER_3DX
};
