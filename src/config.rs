//! The configuration: one table of parameters, checked once.
//!
//! [`Parameters`] are plain numbers that anyone may write; a [`Config`] is parameters that were
//! found good, and is the only thing the rest of the crate accepts. [`FIELDS`] describes every
//! parameter, so that a program can read, explain and refuse them by name without a second list.

use crate::quantity::{OutOfRange, in_range};

/// What is known of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Name, as in [`Parameters`].
    pub name: &'static str,
    /// Unit of the value: `m`, `m/s`, `m/s^2`, `s`, `rad`, `rad/s`, `rad/s^2`, `1/s`, `samples`
    /// (whole numbers) or `share` (of one).
    pub unit: &'static str,
    /// Least allowed value.
    pub min: f32,
    /// Greatest allowed value.
    pub max: f32,
    /// It is a count.
    pub whole: bool,
    /// What it means and where it comes from.
    pub meaning: &'static str,
}

/// The unit is that of a count.
pub(crate) const fn is_count(unit: &str) -> bool {
    // Strings cannot be compared in a constant: no other unit begins like this one.
    matches!(unit.as_bytes(), [b's', b'a', ..])
}

macro_rules! parameters {
    ($($name:ident: $unit:literal, $min:literal, $max:literal, $meaning:literal;)+) => {
        /// Every parameter, in SI units.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Parameters {
            $(#[doc = $meaning] #[doc = ""] #[doc = concat!("Unit ", $unit, ", ", $min, " to ", $max, ".")]
            pub $name: f32,)+
        }

        /// The description of every parameter, in the order of [`Parameters::values`].
        pub const FIELDS: [Field; [$(stringify!($name)),+].len()] = [
            $(Field { name: stringify!($name), unit: $unit, min: $min, max: $max, whole: is_count($unit), meaning: $meaning },)+
        ];

        impl Parameters {
            /// The values in the order of [`FIELDS`].
            #[must_use]
            pub const fn values(&self) -> [f32; FIELDS.len()] {
                [$(self.$name),+]
            }

            /// Parameters from values in the order of [`FIELDS`].
            #[must_use]
            pub fn from_values(values: [f32; FIELDS.len()]) -> Self {
                let [$($name),+] = values;
                Self { $($name),+ }
            }
        }
    };
}

pub(crate) use parameters;

parameters! {
    safe_distance: "m", 0.1, 10.0,
        "Distance of an obstacle below which the maneuver begins: d_safe, S1 Table 1.";
    near_distance: "m", 0.05, 10.0,
        "Distance of a receding obstacle above which the robot turns back to its goal: d_n, S1 Table 1.";
    min_distance: "m", 0.03, 5.0,
        "Reading of a forward sonar at or under which the robot stops: min_distance, S1 Table 1.";
    turn_distance: "m", 0.01, 5.0,
        "Distance at which the maneuver turns by a quarter turn: k_theta, S1 E5. Twice the least distance at most, so that no turn exceeds half a turn.";
    speed_max: "m/s", 0.02, 2.0,
        "Greatest speed: v_max, S1 E7.";
    cruise_speed: "m/s", 0.01, 2.0,
        "Speed towards the goal when nothing is near, S1 section 4.";
    obstacle_speed_max: "m/s", 0.0, 3.0,
        "The promise holds for obstacles no faster than this: v_o,max, S1 E3.";
    stop_time: "s", 0.0, 5.0,
        "The robot stops when contact is possible within this time: T, S1 Table 1.";
    view_half_angle: "rad", 0.05, 1.5,
        "Half the angle ahead in which an echo is an obstacle to the law: theta_Cam, S1 Table 1.";
    corridor_margin: "m", 0.0, 1.0,
        "Clearance wanted on either side of the path ahead; echoes inside it are obstacles to the law.";
    hold_time: "s", 0.1, 10.0,
        "How long an obstacle that is no longer seen is still believed to be there.";
    confirm_samples: "samples", 2.0, 20.0,
        "Readings in a row that it takes to believe that an obstacle recedes or has gone.";
    appear_samples: "samples", 1.0, 2.0,
        "Readings in a row that it takes to believe in an echo from nearer than anything can have come since the last one: 1 believes at once, 2 bears false echoes and promises no more than for what is heard twice.";
    heading_gain: "1/s", 0.1, 5.0,
        "Turn rate per radian of heading error.";
    turn_rate_max: "rad/s", 0.05, 4.0,
        "Greatest turn rate.";
    alignment: "rad", 0.01, 1.0,
        "Heading error under which the robot counts as turned to its goal.";
    goal_tolerance: "m", 0.02, 2.0,
        "Distance from the goal at which it is reached.";
    robot_radius: "m", 0.05, 1.0,
        "Radius of a circle round the centre of rotation that contains the robot.";
    acceleration: "m/s^2", 0.05, 5.0,
        "The base accelerates no harder than this.";
    braking: "m/s^2", 0.1, 10.0,
        "The base brakes at least as hard as this, on this floor, with this load.";
    braking_share: "share", 0.1, 1.0,
        "The share of `braking` that is left when the brakes are at their worst; the shield counts on no more.";
    reverse_speed_max: "m/s", 0.0, 0.5,
        "Greatest speed backward; 0 is never. The robot backs off only where sonars look backward.";
    turn_acceleration: "rad/s^2", 0.1, 20.0,
        "The base stops turning at least this hard; it is not asked to start turning harder.";
    reaction_time: "s", 0.02, 2.0,
        "From the moment the sensors describe to the moment the command of the next tick takes effect, at the longest: the way of a reading to here, the time between two ticks, the way of a command, and the base's own delay.";
    still_speed_max: "m/s", 0.0, 3.0,
        "What has been seen to stand still moves no faster than this while the robot passes it.";
    still_speed_max_turning: "m/s", 0.0, 3.0,
        "While the robot turns on the spot, what has been seen to stand still sets off no faster than this.";
    still_samples: "samples", 2.0, 100.0,
        "Readings in a row that must agree with the robot's own motion before a thing counts as still.";
    still_tolerance: "m", 0.005, 0.5,
        "Readings of a still thing scatter by no more than this.";
    range_error: "m", 0.0, 0.5,
        "A sonar's range is too long by no more than this.";
    speed_error: "m/s", 0.0, 0.5,
        "The measured speed is too low by no more than this.";
    blind_angle_max: "rad", 0.0, 3.15,
        "Directions of travel in which no sonar looks are allowed for as long as the gap between two cones is no wider than this.";
    latch_time: "s", 0.1, 600.0,
        "A stop because something is overdue holds until it is reset once it has lasted this long.";
    resume_clearance: "m", 0.0, 1.0,
        "Clearance beyond what a stop demands before the robot moves again.";
    resume_samples: "samples", 1.0, 50.0,
        "Clear ticks in a row before the robot moves again after a stop.";
    sonar_age_max: "s", 0.02, 5.0,
        "A sonar reading older than this is stale.";
    odometry_age_max: "s", 0.02, 5.0,
        "Odometry older than this is stale.";
    sonar_half_angle: "rad", 0.02, 0.8,
        "Half the opening angle of a sonar's cone.";
    sonar_range_min: "m", 0.0, 0.5,
        "Readings below this are a contact: blanking distance, S1 section 3.";
    sonar_range_max: "m", 0.5, 20.0,
        "Readings from here on mean that no echo came back.";
}

/// Goes on only with what is in range.
macro_rules! check {
    ($checked:expr) => {
        if let Err(error) = $checked {
            return Err(error);
        }
    };
}

/// Parameters that were checked. See [`Config::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    parameters: Parameters,
}

impl core::ops::Deref for Config {
    type Target = Parameters;

    fn deref(&self) -> &Parameters {
        &self.parameters
    }
}

impl Config {
    /// Checks every parameter against its range and against the others.
    ///
    /// # Errors
    /// The first parameter that is out of range; where the range depends on another parameter
    /// (d_min < d_n < d_safe, for example) the range given is the one that follows from it.
    pub const fn new(parameters: Parameters) -> Result<Self, OutOfRange> {
        let values = parameters.values();
        let mut i = 0;
        while i < FIELDS.len() {
            let field = &FIELDS[i];
            let value = values[i];
            check!(in_range(
                field.name, value, field.min, field.max, field.unit
            ));
            // A count is whole: the range of a count starts at 1, so the cast is exact.
            if field.whole && value != (value as u16) as f32 {
                return Err(OutOfRange {
                    field: field.name,
                    value,
                    min: field.min,
                    max: field.max,
                    unit: "samples (whole)",
                });
            }
            i += 1;
        }
        let p = parameters;
        // Δθ = (π/2)·k/d must stay within half a turn wherever the shield lets the robot move.
        check!(in_range(
            "turn_distance",
            p.turn_distance,
            0.01,
            2.0 * p.min_distance,
            "m",
        ));
        check!(in_range(
            "near_distance",
            p.near_distance,
            p.min_distance,
            p.safe_distance,
            "m",
        ));
        check!(in_range(
            "safe_distance",
            p.safe_distance,
            p.near_distance,
            p.sonar_range_max,
            "m",
        ));
        check!(in_range(
            "cruise_speed",
            p.cruise_speed,
            0.01,
            p.speed_max,
            "m/s"
        ));
        // However weak the brakes, the sums of the shield stay inside their integers.
        check!(in_range(
            "braking_share",
            p.braking_share,
            0.1 / p.braking,
            1.0,
            "share"
        ));
        // What is still is not faster than what may be anything.
        check!(in_range(
            "still_speed_max",
            p.still_speed_max,
            0.0,
            p.obstacle_speed_max,
            "m/s",
        ));
        check!(in_range(
            "still_speed_max_turning",
            p.still_speed_max_turning,
            p.still_speed_max,
            p.obstacle_speed_max,
            "m/s",
        ));
        check!(in_range(
            "min_distance",
            p.min_distance,
            p.sonar_range_min,
            p.near_distance,
            "m",
        ));
        Ok(Self { parameters })
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }
}
