//! A differential drive with finite accelerations, a delay, and odometry that may drift.

use std::collections::VecDeque;

use crate::error::{Error, require};
use crate::geometry::{Pose, wrap};
use crate::world::{Footprint, World, check_place, check_size};
use crate::{STEP, STEP_MS};

/// A base slower than this counts as standing (m/s).
pub const STILL_SPEED: f64 = 1e-3;

/// A standing base that turns slower than this counts as still (rad/s).
pub const STILL_TURN_RATE: f64 = 1e-2;

/// Speed, turn rate and their changes: the largest that a drive can do, or that it is set to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Speed (m/s).
    pub speed: f64,
    /// Turn rate (rad/s).
    pub turn_rate: f64,
    /// Acceleration (m/s²).
    pub acceleration: f64,
    /// Deceleration (m/s²).
    pub deceleration: f64,
    /// Acceleration of the turn rate (rad/s²).
    pub turn_acceleration: f64,
    /// Deceleration of the turn rate (rad/s²).
    pub turn_deceleration: f64,
}

impl Limits {
    fn check(&self) -> Result<(), Error> {
        for (field, value, allowed) in [
            ("base.speed", self.speed, "> 0 m/s"),
            ("base.turn_rate", self.turn_rate, "> 0 rad/s"),
            ("base.acceleration", self.acceleration, "> 0 m/s²"),
            ("base.deceleration", self.deceleration, "> 0 m/s²"),
            (
                "base.turn_acceleration",
                self.turn_acceleration,
                "> 0 rad/s²",
            ),
            (
                "base.turn_deceleration",
                self.turn_deceleration,
                "> 0 rad/s²",
            ),
        ] {
            require(field, value, allowed, |v| v > 0.0)?;
        }
        Ok(())
    }

    /// These limits, none above those of `top`.
    #[must_use]
    pub fn within(&self, top: &Self) -> Self {
        Self {
            speed: self.speed.min(top.speed),
            turn_rate: self.turn_rate.min(top.turn_rate),
            acceleration: self.acceleration.min(top.acceleration),
            deceleration: self.deceleration.min(top.deceleration),
            turn_acceleration: self.turn_acceleration.min(top.turn_acceleration),
            turn_deceleration: self.turn_deceleration.min(top.turn_deceleration),
        }
    }
}

/// What kind of base it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Radius of the circle about the middle of the wheel axle that contains the hull (m).
    pub radius: f64,
    /// The most the motors can do; an emergency stop brakes with this.
    pub top: Limits,
    /// What the base is set to at first; no more than `top` is used.
    pub limits: Limits,
    /// Time from an order to its effect, in whole steps (ms).
    pub delay_ms: u64,
    /// Distance measured by the odometry per distance driven, in [0.5, 2].
    pub odometry_scale: f64,
    /// Turn measured by the odometry per turn made, in [0.5, 2].
    pub odometry_turn_scale: f64,
}

impl Default for Parameters {
    /// A Pioneer P3-DX as delivered: hull within 0.301 m of the axle (its rear), 0.3 m/s² and 100
    /// °/s².
    ///
    /// The top values are in the range that such bases report of themselves, not measured; the
    /// delay of 50 ms is an assumption.
    fn default() -> Self {
        let top = Limits {
            speed: 1.5,
            turn_rate: 300_f64.to_radians(),
            acceleration: 2.0,
            deceleration: 2.0,
            turn_acceleration: 300_f64.to_radians(),
            turn_deceleration: 300_f64.to_radians(),
        };
        Self {
            radius: 0.301,
            top,
            limits: Limits {
                speed: 1.0,
                turn_rate: 100_f64.to_radians(),
                acceleration: 0.3,
                deceleration: 0.3,
                turn_acceleration: 100_f64.to_radians(),
                turn_deceleration: 100_f64.to_radians(),
            },
            delay_ms: 50,
            odometry_scale: 1.0,
            odometry_turn_scale: 1.0,
        }
    }
}

/// What the base is told to do. Driving and turning are told, and done, independently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Drive at this speed, forward positive (m/s).
    Speed(f64),
    /// Drive this far and stop, forward positive (m).
    Distance(f64),
    /// Turn at this rate, counter-clockwise positive (rad/s).
    TurnRate(f64),
    /// Turn by the shorter way to this heading of the odometry (rad).
    Heading(f64),
    /// Turn from the heading at that moment by this much, by the shorter way (rad).
    Turn(f64),
    /// Brake to a standstill as limited.
    Stop,
    /// Brake to a standstill as hard as the motors can.
    EmergencyStop,
}

/// What the translational drive is after.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Travel {
    Speed(f64),
    /// Distance still to go (m).
    Distance(f64),
}

/// What the rotational drive is after.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Turn {
    Rate(f64),
    Heading(f64),
}

/// What the base did in its last step.
///
/// Turning in place is apart from standing and driving because the hull is a disc: it sweeps no new
/// space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Activity {
    /// It stood still.
    Resting,
    /// It turned in place: slower than [`STILL_SPEED`], faster than [`STILL_TURN_RATE`].
    Turning,
    /// It moved over ground.
    Driving,
}

/// What is wrong with a drive. The default is nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Faults {
    /// Share of the deceleration it is set to with which it truly brakes, in (0, 10]: worn brakes, a
    /// slippery floor, a load.
    pub braking_share: f64,
    /// Share of the acceleration it is set to with which it truly speeds up, in (0, 10].
    pub acceleration_share: f64,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            braking_share: 1.0,
            acceleration_share: 1.0,
        }
    }
}

/// What the drive put into its last step, as it truly is (m/s²).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effort {
    /// The deceleration available, if it was slowing down.
    pub braking: Option<f64>,
    /// The acceleration available, if it was speeding up.
    pub accelerating: Option<f64>,
}

/// A base in the world.
#[derive(Debug, Clone)]
pub struct Base {
    parameters: Parameters,
    faults: Faults,
    effort: Effort,
    limits: Limits,
    pose: Pose,
    odometry: Pose,
    speed: f64,
    turn_rate: f64,
    travel: Travel,
    turn: Turn,
    /// Orders on their way, with the time at which they take effect (ms).
    pending: VecDeque<(u64, Order)>,
    now_ms: u64,
    emergency: bool,
    stalled: bool,
    activity: Activity,
    travelled: f64,
}

impl Base {
    /// A base at rest at `pose`, which is the origin of its odometry.
    pub fn new(parameters: Parameters, pose: Pose) -> Result<Self, Error> {
        check_size("base.radius", parameters.radius)?;
        parameters.top.check()?;
        parameters.limits.check()?;
        for (field, scale) in [
            ("base.odometry_scale", parameters.odometry_scale),
            ("base.odometry_turn_scale", parameters.odometry_turn_scale),
        ] {
            require(field, scale, "0.5..=2", |s| (0.5..=2.0).contains(&s))?;
        }
        check_place("base.position", &pose.position)?;
        require("base.heading", pose.heading, "finite rad", |_| true)?;
        Ok(Self {
            limits: parameters.limits.within(&parameters.top),
            parameters,
            faults: Faults::default(),
            effort: Effort::default(),
            pose,
            odometry: Pose::new(0.0, 0.0, 0.0),
            speed: 0.0,
            turn_rate: 0.0,
            travel: Travel::Speed(0.0),
            turn: Turn::Rate(0.0),
            pending: VecDeque::new(),
            now_ms: 0,
            emergency: false,
            stalled: false,
            activity: Activity::Resting,
            travelled: 0.0,
        })
    }

    /// What kind of base it is.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// What it is set to.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Sets what it may do, up to what it can do.
    pub fn set_limits(&mut self, limits: Limits) -> Result<(), Error> {
        limits.check()?;
        self.limits = limits.within(&self.parameters.top);
        Ok(())
    }

    /// Makes the drive stronger or weaker than it is set to be.
    pub fn set_faults(&mut self, faults: Faults) -> Result<(), Error> {
        for (field, share) in [
            ("base.braking_share", faults.braking_share),
            ("base.acceleration_share", faults.acceleration_share),
        ] {
            require(field, share, "> 0, <= 10", |s| s > 0.0 && s <= 10.0)?;
        }
        self.faults = faults;
        Ok(())
    }

    /// What the drive put into its last step.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// The speed it is after, forward positive (m/s).
    #[must_use]
    pub fn speed_setpoint(&self) -> f64 {
        self.wanted_speed()
    }

    /// The turn rate it is after, counter-clockwise positive (rad/s).
    #[must_use]
    pub fn turn_rate_setpoint(&self) -> f64 {
        self.wanted_turn_rate()
    }

    /// Gives an order, which takes effect after the delay. An order that is not finite is ignored.
    pub fn order(&mut self, order: Order) {
        let finite = match order {
            Order::Speed(x)
            | Order::Distance(x)
            | Order::TurnRate(x)
            | Order::Heading(x)
            | Order::Turn(x) => x.is_finite(),
            Order::Stop | Order::EmergencyStop => true,
        };
        if finite {
            let due = self.now_ms + self.parameters.delay_ms;
            self.pending.push_back((due, order));
        }
    }

    /// Takes the power from the motors: orders on their way are lost, and the base brakes as
    /// limited.
    pub fn cut_power(&mut self) {
        self.pending.clear();
        self.obey(Order::Stop);
    }

    /// Makes the present pose the origin of the odometry. A turn under way ends where it would
    /// have.
    pub fn reset_odometry(&mut self) {
        if let Turn::Heading(heading) = &mut self.turn {
            *heading = wrap(*heading - self.odometry.heading);
        }
        self.odometry = Pose::new(0.0, 0.0, 0.0);
    }

    /// The true pose.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The pose as the wheels have counted it, from where the odometry was last reset.
    #[must_use]
    pub fn odometry(&self) -> Pose {
        self.odometry
    }

    /// Speed, forward positive (m/s).
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Turn rate, counter-clockwise positive (rad/s).
    #[must_use]
    pub fn turn_rate(&self) -> f64 {
        self.turn_rate
    }

    /// The heading of the odometry it turns to, or has (rad).
    #[must_use]
    pub fn heading_setpoint(&self) -> f64 {
        match self.turn {
            Turn::Heading(heading) => heading,
            Turn::Rate(_) => self.odometry.heading,
        }
    }

    /// Whether the hull is pressed against something and the wheels are blocked.
    #[must_use]
    pub fn stalled(&self) -> bool {
        self.stalled
    }

    /// What it did in the last step.
    #[must_use]
    pub fn activity(&self) -> Activity {
        self.activity
    }

    /// Length of the way driven, forward and backward (m).
    #[must_use]
    pub fn travelled(&self) -> f64 {
        self.travelled
    }

    /// The base as the people around it see it.
    #[must_use]
    pub fn footprint(&self) -> Footprint {
        Footprint {
            centre: self.pose.position,
            radius: self.parameters.radius,
            still: self.activity != Activity::Driving,
        }
    }

    /// Moves on by one step of [`STEP`].
    ///
    /// A hull that touches something does not go deeper: the wheels stall.
    pub fn step(&mut self, world: &World) {
        self.now_ms += STEP_MS;
        while let Some((_, order)) = self.pending.pop_front_if(|(due, _)| *due < self.now_ms) {
            self.obey(order);
        }
        let Limits {
            acceleration,
            deceleration,
            turn_acceleration,
            turn_deceleration,
            ..
        } = if self.emergency {
            self.parameters.top
        } else {
            self.limits
        };
        let acceleration = acceleration * self.faults.acceleration_share;
        let deceleration = deceleration * self.faults.braking_share;
        let before = (self.speed, self.turn_rate);
        let wanted = self.wanted_speed();
        let slower = wanted.abs() < self.speed.abs() || wanted * self.speed < 0.0;
        let faster = wanted.abs() > self.speed.abs() && !slower;
        self.effort = Effort {
            braking: slower.then_some(deceleration),
            accelerating: faster.then_some(acceleration),
        };
        let (speed, distance) = ramp(self.speed, wanted, acceleration, deceleration);
        let (turn_rate, turn) = ramp(
            self.turn_rate,
            self.wanted_turn_rate(),
            turn_acceleration,
            turn_deceleration,
        );
        self.turn_rate = turn_rate;

        let next = self.pose.along_arc(distance, turn);
        let radius = self.parameters.radius;
        let clearance = world.clearance(self.pose.position, radius);
        self.stalled = clearance <= 0.0 && world.clearance(next.position, radius) < clearance;
        let distance = if self.stalled {
            self.speed = 0.0;
            self.pose.heading = next.heading;
            0.0
        } else {
            self.speed = speed;
            self.pose = next;
            distance
        };
        self.travelled += distance.abs();
        self.odometry = self.odometry.along_arc(
            distance * self.parameters.odometry_scale,
            turn * self.parameters.odometry_turn_scale,
        );
        if let Travel::Distance(rest) = &mut self.travel {
            *rest -= distance;
        }
        self.activity = if before.0.abs().max(self.speed.abs()) > STILL_SPEED {
            Activity::Driving
        } else if before.1.abs().max(self.turn_rate.abs()) > STILL_TURN_RATE {
            Activity::Turning
        } else {
            Activity::Resting
        };
    }

    fn obey(&mut self, order: Order) {
        self.emergency = matches!(order, Order::EmergencyStop);
        match order {
            Order::Speed(speed) => self.travel = Travel::Speed(speed),
            Order::Distance(distance) => self.travel = Travel::Distance(distance),
            Order::TurnRate(rate) => self.turn = Turn::Rate(rate),
            Order::Heading(heading) => self.turn = Turn::Heading(wrap(heading)),
            Order::Turn(angle) => self.turn = Turn::Heading(wrap(self.odometry.heading + angle)),
            Order::Stop | Order::EmergencyStop => {
                self.travel = Travel::Speed(0.0);
                self.turn = Turn::Rate(0.0);
            }
        }
    }

    fn wanted_speed(&self) -> f64 {
        let limit = self.limits.speed;
        match self.travel {
            Travel::Speed(speed) => speed.clamp(-limit, limit),
            Travel::Distance(rest) => approach(rest, limit, self.limits.deceleration),
        }
    }

    fn wanted_turn_rate(&self) -> f64 {
        let limit = self.limits.turn_rate;
        match self.turn {
            Turn::Rate(rate) => rate.clamp(-limit, limit),
            Turn::Heading(heading) => approach(
                wrap(heading - self.odometry.heading),
                limit,
                self.limits.turn_deceleration,
            ),
        }
    }
}

/// The speed to aim at, up to `limit`, for braking with `deceleration` to end no farther than
/// `rest`: the speed from which that is possible, taken one step of braking early. It stops short
/// by b·dt²/2 at most.
fn approach(rest: f64, limit: f64, deceleration: f64) -> f64 {
    let braking = (2.0 * deceleration * rest.abs()).sqrt() - deceleration * STEP;
    braking.clamp(0.0, limit).copysign(rest)
}

/// The speed after one step towards `target`, and the distance covered on the way, exact for
/// constant accelerations.
///
/// Slowing down and reversing use `deceleration`, speeding up uses `acceleration`.
fn ramp(speed: f64, target: f64, acceleration: f64, deceleration: f64) -> (f64, f64) {
    let slowest = if speed * target < 0.0 {
        0.0
    } else if target.abs() < speed.abs() {
        target
    } else {
        speed
    };
    let braking = ((speed - slowest).abs() / deceleration).min(STEP);
    let slowed = toward(speed, slowest, deceleration * braking);
    let speeding = ((target - slowed).abs() / acceleration).min(STEP - braking);
    let reached = toward(slowed, target, acceleration * speeding);
    let rest = STEP - braking - speeding;
    let distance =
        (speed + slowed) / 2.0 * braking + (slowed + reached) / 2.0 * speeding + reached * rest;
    (reached, distance)
}

/// `from` moved by at most `by` towards `to`.
fn toward(from: f64, to: f64, by: f64) -> f64 {
    from + (to - from).clamp(-by, by)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_covers_what_a_trapezoid_covers() {
        // 0.1 m/s down to 0 at 20 m/s²: 5 ms and v²/2b = 0.25 mm, then rest.
        let (speed, distance) = ramp(0.1, 0.0, 1.0, 20.0);
        assert_eq!(speed, 0.0);
        assert!((distance - 0.000_25).abs() < 1e-15);
        // 0.1 to −0.05 m/s: braked in 5 ms, then 5 ms at 4 m/s² backwards.
        let (speed, distance) = ramp(0.1, -0.05, 4.0, 20.0);
        assert!((speed + 0.02).abs() < 1e-15);
        assert!((distance - (0.000_25 - 0.000_05)).abs() < 1e-15);
        // Holding a speed.
        assert_eq!(ramp(0.3, 0.3, 1.0, 1.0), (0.3, 0.3 * STEP));
    }
}
