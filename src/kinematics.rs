//! Differential-drive kinematics, S2 E1 to E5, with the yaw relation the paper leaves out.

use crate::math;
use crate::quantity::{Angle, OutOfRange, in_range, within};
use nalgebra::Vector2;

/// Forward speed and turn rate of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Forward speed v in m/s.
    pub speed: f32,
    /// Turn rate ω in rad/s, counter-clockwise positive.
    pub turn_rate: f32,
}

/// Turn rates of the two driven wheels, S2 E4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelRates {
    /// Right wheel ω_r in rad/s.
    pub right: f32,
    /// Left wheel ω_l in rad/s.
    pub left: f32,
}

/// A differential drive: wheel radius R and wheel base L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferentialDrive {
    wheel_radius: f32,
    wheel_base: f32,
}

/// Velocity in the plane from forward speed (m/s) and heading (S2 E1 to E3; the third is the turn
/// rate itself).
///
/// $$\dot x = v \cos \theta \qquad \dot y = v \sin \theta \qquad \dot\theta = \omega$$
#[must_use]
pub fn velocity(speed: f32, heading: Angle) -> Vector2<f32> {
    Vector2::new(math::cos(heading.get()), math::sin(heading.get())) * speed
}

impl DifferentialDrive {
    /// A drive with wheel radius (0.005 to 1 m) and wheel base (0.02 to 3 m).
    ///
    /// # Errors
    /// [`OutOfRange`] naming the one that is not.
    pub fn new(wheel_radius: f32, wheel_base: f32) -> Result<Self, OutOfRange> {
        Ok(Self {
            wheel_radius: in_range("wheel_radius", wheel_radius, 0.005, 1.0, "m")?,
            wheel_base: in_range("wheel_base", wheel_base, 0.02, 3.0, "m")?,
        })
    }

    /// Motion of the robot from the rates of its wheels:
    /// v = R(ω_r + ω_l)/2 (S2 E5) and ω = R(ω_r − ω_l)/L (missing in the paper).
    ///
    /// # Errors
    /// [`OutOfRange`] if a wheel rate is not within ±1000 rad/s.
    //= kinematics.INV-1
    //= kinematics.INV-2
    //= kinematics.INV-5
    pub fn twist(&self, wheels: WheelRates) -> Result<Twist, OutOfRange> {
        let right = in_range("right wheel rate", wheels.right, -1e3, 1e3, "rad/s")?;
        let left = in_range("left wheel rate", wheels.left, -1e3, 1e3, "rad/s")?;
        Ok(Twist {
            speed: self.wheel_radius * (right + left) / 2.0,
            turn_rate: self.wheel_radius * (right - left) / self.wheel_base,
        })
    }

    /// Rates of the wheels for a motion of the robot.
    ///
    /// $$\omega_{r,l} = \frac{v \pm \omega L/2}{R}$$
    ///
    /// # Errors
    /// [`OutOfRange`] if the speed is not within ±10 m/s or the turn rate not within ±20 rad/s.
    //= kinematics.INV-1
    //= kinematics.INV-5
    pub fn wheel_rates(&self, twist: Twist) -> Result<WheelRates, OutOfRange> {
        let speed = in_range("speed", twist.speed, -10.0, 10.0, "m/s")?;
        let turn_rate = in_range("turn rate", twist.turn_rate, -20.0, 20.0, "rad/s")?;
        let difference = turn_rate * self.wheel_base / 2.0;
        Ok(WheelRates {
            right: (speed + difference) / self.wheel_radius,
            left: (speed - difference) / self.wheel_radius,
        })
    }
}

impl WheelRates {
    /// Scales both wheels by the same factor so that neither exceeds `limit` (rad/s): the path
    /// keeps its curvature. Rates within the limit are returned as they are.
    ///
    /// # Errors
    /// [`OutOfRange`] if a rate is not within ±10⁶ rad/s or the limit not in 0 to 1000 rad/s.
    //= kinematics.INV-3
    //= kinematics.INV-4
    pub fn limited(self, limit: f32) -> Result<Self, OutOfRange> {
        let limit = in_range("wheel rate limit", limit, 0.0, 1e3, "rad/s")?;
        let right = in_range("right wheel rate", self.right, -1e6, 1e6, "rad/s")?;
        let left = in_range("left wheel rate", self.left, -1e6, 1e6, "rad/s")?;
        let fastest = right.abs().max(left.abs());
        if fastest <= limit {
            return Ok(Self { right, left });
        }
        let factor = limit / fastest;
        // The product can round above the limit.
        let scale = |rate: f32| within(rate * factor, limit);
        Ok(Self {
            right: scale(right),
            left: scale(left),
        })
    }
}
