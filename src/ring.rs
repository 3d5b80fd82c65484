//! Where the sonars are and which way they look.

use crate::config::Config;
use crate::math;
use crate::quantity::{Angle, OutOfRange, in_range};
use crate::shield::{Limits, millimetres_up};
use core::f32::consts::{FRAC_PI_2, FRAC_PI_3, PI};
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
    /// Distance of the face from the centre of rotation, mm, rounded up.
    pub lever: i32,
    /// How directly the robot may close on what this sonar sees.
    pub closing: Closing,
}

/// Cosines, in thousandths, between straight ahead and the direction of things in a cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Closing {
    /// Greatest for a robot that drives forward: the direction is that from its centre, rounded up.
    pub ahead: i32,
    /// Greatest for a robot that drives backward.
    pub back: i32,
    /// Least and greatest as seen from the sonar's face, rounded outward.
    pub face: [i32; 2],
}

/// The sonars of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring<const N: usize> {
    sonars: [Sonar; N],
    looks_back: bool,
}

impl<const N: usize> Ring<N> {
    /// A ring from placements within 2 m of the centre.
    ///
    /// # Errors
    /// [`OutOfRange`] if a placement is out of range; if a gap between cones in the half circle
    /// ahead is wider than `blind_angle_max`, as a robot that cannot see ahead must not move
    /// ahead; or if the shield would stop the robot, at cruise speed, before `safe_distance` lets
    /// the law avoid anything.
    pub fn new(placements: &[Placement; N], config: &Config) -> Result<Self, OutOfRange> {
        let mut sonars = [Sonar {
            position: Vector2::new(0.0, 0.0),
            axis: Vector2::new(1.0, 0.0),
            heading: Angle::ZERO,
            contact_range: 0,
            forward: false,
            lever: 0,
            closing: Closing {
                ahead: 1000,
                back: 1000,
                face: [-1000, 1000],
            },
        }; N];
        for (sonar, placement) in sonars.iter_mut().zip(placements) {
            *sonar = Sonar::new(placement, config)?;
        }
        let gap_max = config.blind_angle_max;
        let gap = widest_gap(&sonars, Angle::ZERO, config);
        in_range("gap between sonars ahead", gap, 0.0, gap_max, "rad")?;
        let cruise = Limits::new(config).required_clearance(millimetres_up(config.cruise_speed))
            + millimetres_up(config.range_error);
        for sonar in sonars.iter().filter(|sonar| sonar.forward) {
            let stop = (cruise + sonar.contact_range) as f32 / 1000.0;
            let (safe, most) = (config.safe_distance, config.sonar_range_max);
            in_range("safe_distance", safe, stop, most, "m")?;
        }
        let looks_back = widest_gap(&sonars, Angle::HALF_TURN, config) <= gap_max;
        Ok(Self { sonars, looks_back })
    }

    /// The half circle behind the robot is seen as well as the one ahead must be.
    #[must_use]
    pub const fn looks_back(&self) -> bool {
        self.looks_back
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
        let (mut least, mut most) = cosines(heading, config.sonar_half_angle);
        let face = [floor_thousandths(least), -floor_thousandths(-most)];
        // Seen from the centre, a thing in the cone lies between the direction of the face and that
        // of the cone, unless the sonar looks across the robot.
        let offset = math::norm(position);
        if position.dot(&axis) < 0.0 {
            (least, most) = (-1.0, 1.0);
        } else if offset > 0.0 {
            let across = (position.x / offset).clamp(-1.0, 1.0);
            (least, most) = (least.min(across), most.max(across));
            let face = Angle::radians(math::atan2(position.y, position.x))?;
            if lies_between(Angle::ZERO, face, heading, config.sonar_half_angle) {
                most = 1.0;
            }
            if lies_between(Angle::HALF_TURN, face, heading, config.sonar_half_angle) {
                least = -1.0;
            }
        }
        let closing = Closing {
            ahead: -floor_thousandths(-most),
            back: -floor_thousandths(least),
            face,
        };
        Ok(Self {
            position,
            axis,
            heading,
            contact_range,
            forward: heading.get().abs() <= FRAC_PI_3,
            lever: millimetres_up(offset),
            closing,
        })
    }
}

/// A direction lies between that of a sonar's face and those of its cone.
fn lies_between(direction: Angle, face: Angle, heading: Angle, half_angle: f32) -> bool {
    let to_direction = direction.minus(face).get();
    let to_axis = heading.minus(face).get();
    to_direction >= (to_axis - half_angle).min(0.0)
        && to_direction <= (to_axis + half_angle).max(0.0)
}

/// Least and greatest cosine of the directions within `half_angle` of `heading`.
fn cosines(heading: Angle, half_angle: f32) -> (f32, f32) {
    let off_axis = heading.get().abs();
    let most = if off_axis <= half_angle {
        1.0
    } else {
        math::cos(off_axis - half_angle)
    };
    let least = if off_axis + half_angle >= PI {
        -1.0
    } else {
        math::cos(off_axis + half_angle)
    };
    (least, most)
}

/// A cosine in whole thousandths, rounded down, and by one more for what floats round.
fn floor_thousandths(cosine: f32) -> i32 {
    // The cast truncates towards zero: one less is at most the exact value.
    ((cosine * 1000.0) as i32 - 1).max(-1000)
}

/// The widest gap (rad) between the cones that look into the half circle about `direction`; π if
/// none does.
fn widest_gap<const N: usize>(sonars: &[Sonar; N], direction: Angle, config: &Config) -> f32 {
    let half = config.sonar_half_angle;
    let mut widest: f32 = 0.0;
    // From the right edge of the half circle to its left one, cone after cone.
    let mut seen = -FRAC_PI_2;
    // Every cone is jumped to once and passed once, at most.
    for _ in 0..2 * N {
        let mut next = PI;
        let mut reach = seen;
        for sonar in sonars {
            let bearing = sonar.heading.minus(direction).get();
            if bearing + half > seen {
                next = next.min(bearing - half);
            }
            if bearing - half <= seen {
                reach = reach.max(bearing + half);
            }
        }
        if reach > seen {
            seen = reach;
        } else if next < FRAC_PI_2 {
            widest = widest.max(next - seen);
            seen = next;
        }
    }
    widest.max(FRAC_PI_2 - seen)
}
