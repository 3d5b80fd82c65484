//! Where the sonars are and which way they look.

use crate::config::Config;
use crate::math;
use crate::quantity::{Angle, OutOfRange, in_range};
use nalgebra::Vector2;

/// Where one sonar sits in the robot's frame: x forward, y left, heading counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Metres forward of the centre of rotation.
    pub x: f32,
    /// Metres left of the centre of rotation.
    pub y: f32,
    /// Direction of the axis in radians.
    pub heading: f32,
}

impl Placement {
    /// A placement from millimetres and degrees, as robot parameter files give them.
    #[must_use]
    pub fn from_mm_deg(x: i16, y: i16, heading: i16) -> Self {
        Self {
            x: f32::from(x) / 1000.0,
            y: f32::from(y) / 1000.0,
            heading: f32::from(heading).to_radians(),
        }
    }
}

/// One sonar of a [`Ring`], with what follows from its placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sonar {
    /// Position of the face in the robot's frame, metres.
    pub position: Vector2<f32>,
    /// Unit vector along the axis.
    pub axis: Vector2<f32>,
    /// Direction of the axis.
    pub heading: Angle,
    /// Range in millimetres at which something anywhere in the cone may touch the robot, rounded
    /// up: the contact distance R_c of S1 E4 in the reading chosen. Clearance of the hull is the
    /// range less this.
    pub contact_range: i32,
    /// The axis points within 60° of straight ahead.
    pub forward: bool,
}

/// The sonars of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring<const N: usize> {
    sonars: [Sonar; N],
}

impl<const N: usize> Ring<N> {
    /// A ring from placements within 2 m of the centre.
    ///
    /// # Errors
    /// [`OutOfRange`] if a placement is out of range, or if no sonar looks forward: a robot that
    /// cannot see ahead must not move ahead.
    pub fn new(placements: &[Placement; N], config: &Config) -> Result<Self, OutOfRange> {
        let mut sonars = [Sonar {
            position: Vector2::new(0.0, 0.0),
            axis: Vector2::new(1.0, 0.0),
            heading: Angle::ZERO,
            contact_range: 0,
            forward: false,
        }; N];
        let mut forward = 0.0;
        for (sonar, placement) in sonars.iter_mut().zip(placements) {
            *sonar = Sonar::new(placement, config)?;
            if sonar.forward {
                forward += 1.0;
            }
        }
        in_range("sonars that look forward", forward, 1.0, N as f32, "sonars")?;
        Ok(Self { sonars })
    }

    /// The sonars.
    #[must_use]
    pub const fn sonars(&self) -> &[Sonar; N] {
        &self.sonars
    }
}

impl Sonar {
    fn new(placement: &Placement, config: &Config) -> Result<Self, OutOfRange> {
        let position = Vector2::new(
            in_range("sonar x", placement.x, -2.0, 2.0, "m")?,
            in_range("sonar y", placement.y, -2.0, 2.0, "m")?,
        );
        let heading = Angle::radians(placement.heading)?;
        let direction = |angle: f32| Vector2::new(math::cos(angle), math::sin(angle));
        let axis = direction(heading.get());
        // A point at range r in direction u from the face s is at least r + s·u from the centre,
        // because |s + r u| ≥ u·(s + r u). The least s·u over the cone is at one of its edges,
        // unless the sonar looks across the robot: then −|s| is the bound.
        let inset = if position.dot(&axis) >= 0.0 {
            let left = position.dot(&direction(heading.get() + config.sonar_half_angle));
            let right = position.dot(&direction(heading.get() - config.sonar_half_angle));
            left.min(right)
        } else {
            -math::norm(position)
        };
        // One millimetre more than the truncated value is at least the exact one; the bound is
        // within ±4 m, far inside an i32.
        let contact_range = ((config.robot_radius - inset) * 1000.0) as i32 + 1;
        Ok(Self {
            position,
            axis,
            heading,
            contact_range,
            forward: heading.get().abs() <= core::f32::consts::FRAC_PI_3,
        })
    }
}
