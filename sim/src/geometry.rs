//! Points, headings and poses in the plane.
//!
//! x points forward (or east), y to the left (or north), angles run counter-clockwise from +x.
//! Trigonometry comes from `libm`, so that a run is the same on every platform.

use core::f64::consts::{PI, TAU};

/// A place in the plane (m).
pub type Point = nalgebra::Point2<f64>;

/// A displacement (m) or velocity (m/s) in the plane.
pub type Vector = nalgebra::Vector2<f64>;

/// The unit vector that points along `heading` (rad).
#[must_use]
pub fn direction(heading: f64) -> Vector {
    let (sin, cos) = libm::sincos(heading);
    Vector::new(cos, sin)
}

/// The heading of `vector`, in (−π, π] (rad); 0 for the zero vector.
#[must_use]
pub fn heading_of(vector: &Vector) -> f64 {
    libm::atan2(vector.y, vector.x)
}

/// `angle` brought into (−π, π] (rad).
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    let turned = libm::remainder(angle, TAU);
    if turned <= -PI { turned + TAU } else { turned }
}

/// A place and the direction faced there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Where (m).
    pub position: Point,
    /// Facing (rad).
    pub heading: f64,
}

impl Pose {
    /// The pose at (`x`, `y`) (m) that faces `heading` (rad).
    #[must_use]
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self {
            position: Point::new(x, y),
            heading,
        }
    }

    /// The world pose of something mounted at `local` on a body at this pose.
    #[must_use]
    pub fn compose(&self, local: &Self) -> Self {
        let forward = direction(self.heading);
        let left = Vector::new(-forward.y, forward.x);
        Self {
            position: self.position + forward * local.position.x + left * local.position.y,
            heading: wrap(self.heading + local.heading),
        }
    }

    /// This pose after driving `distance` (m) along an arc that turns it by `turn` (rad).
    ///
    /// The arc's chord has length `distance · sinc(turn/2)` and points half way through the turn:
    /// exact for constant curvature, and without the division by a vanishing turn.
    #[must_use]
    pub fn along_arc(&self, distance: f64, turn: f64) -> Self {
        let half = turn / 2.0;
        let sinc = if half.abs() < 1e-6 {
            1.0
        } else {
            libm::sin(half) / half
        };
        Self {
            position: self.position + direction(self.heading + half) * (distance * sinc),
            heading: wrap(self.heading + turn),
        }
    }
}
