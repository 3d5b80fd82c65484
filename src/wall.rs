//! A wall beside the robot, told from two sonars that look straight across.
//!
//! A wall that the robot drives along slides through the cone of a slanted sonar: its range stays
//! the same, although the robot drives towards what it hears. By itself that looks like somebody
//! who walks ahead. Beside two sonars that look straight across and hear the same wall it does not.

use crate::config::Config;
use crate::math;
use crate::observation::SonarReading;
use crate::ring::{Ring, Sonar};
use nalgebra::Vector2;

/// A straight wall in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Unit vector from the robot to the wall.
    normal: Vector2<f32>,
    /// Distance from the centre of rotation, metres.
    distance: f32,
}

/// A sonar looks straight across if the cosine between its axis and straight ahead is less: 15°.
pub(crate) const ACROSS: f32 = 0.26;

/// Two faces at least this far apart along the robot, in metres, tell how a wall runs.
const BASELINE: f32 = 0.15;

/// A sonar whose axis is within 45° of a wall's normal tells something of the wall.
const SQUARE_ON: f32 = 0.7;

impl Wall {
    /// The wall that two sonars hear at ranges in metres, each at the foot of the perpendicular from
    /// its face. `None` if the faces are too near each other, or if the perpendicular is not in the
    /// cones.
    #[must_use]
    pub fn through(sonars: [&Sonar; 2], ranges: [f32; 2], config: &Config) -> Option<Self> {
        let [one, other] = sonars;
        let baseline = one.position.x - other.position.x;
        if baseline.abs() < BASELINE {
            return None;
        }
        // normal·(face + range·normal) is the same at both.
        let aside = one.position.y - other.position.y;
        let left = one.axis.y > 0.0;
        let across = if left { 1.0 } else { -1.0 };
        let along = (ranges[1] - ranges[0] - across * aside) / baseline;
        if along.abs() > math::sin(config.sonar_half_angle) {
            return None;
        }
        let normal = Vector2::new(along, across * math::sqrt(1.0 - along * along));
        Some(Self {
            normal,
            distance: normal.dot(&one.position) + ranges[0],
        })
    }

    /// The walls to the left and to the right of the robot, as far as the readings of those sonars
    /// tell that agree with the robot's own motion.
    #[must_use]
    pub fn beside<const N: usize>(
        readings: &[SonarReading; N],
        agrees: &[bool; N],
        ring: &Ring<N>,
        config: &Config,
    ) -> [Option<Self>; 2] {
        let mut walls = [None; 2];
        let mut heard: [Option<(usize, f32)>; 2] = [None; 2];
        for (i, reading) in readings.iter().enumerate() {
            let at = &ring.sonars()[i];
            let SonarReading::Echo(range) = *reading else {
                continue;
            };
            if !agrees[i] || at.axis.x.abs() >= ACROSS {
                continue;
            }
            let side = usize::from(at.axis.y < 0.0);
            match heard[side] {
                None => heard[side] = Some((i, range.get())),
                Some((first, other)) => {
                    let sonars = [&ring.sonars()[first], at];
                    walls[side] = Self::through(sonars, [other, range.get()], config);
                }
            }
        }
        walls
    }

    /// What this sonar hears at `range` metres is this wall: between where the edge of the cone
    /// meets it and where the axis does, give or take `still_tolerance`. Never for a sonar that
    /// looks straight across: it would be its own witness.
    #[must_use]
    pub fn explains(&self, range: f32, sonar: &Sonar, config: &Config) -> bool {
        let off = self.distance - self.normal.dot(&sonar.position);
        let cosine = self.normal.dot(&sonar.axis).min(1.0);
        if off <= 0.0 || cosine < SQUARE_ON || sonar.axis.x.abs() < ACROSS {
            return false;
        }
        let half = config.sonar_half_angle;
        let sine = math::sqrt(1.0 - cosine * cosine);
        // Within the cone the perpendicular is nearest, else the edge on its side.
        let nearest = if cosine >= math::cos(half) {
            1.0
        } else {
            cosine * math::cos(half) + sine * math::sin(half)
        };
        let tolerance = config.still_tolerance;
        range * nearest >= off - tolerance && range * cosine <= off + tolerance
    }
}
