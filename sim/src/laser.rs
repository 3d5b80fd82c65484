//! A laser range finder on the robot: one scan of the world as it is now.

use core::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::{Error, require};
use crate::geometry::Pose;
use crate::world::{Cone, World};

/// What kind of scanner it is, and where it sits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Where it sits on the robot, and where the middle of its field of view looks.
    pub placement: Pose,
    /// Angle from the first beam to the last, in (0, 2π] (rad).
    pub field: f64,
    /// Angle from beam to beam, in [0.0001, 0.1] (rad).
    pub step: f64,
    /// Reach, in [0.5, 100] (m).
    pub reach: f64,
    /// Standard deviation of a range, in [0, 1] (m).
    pub noise: f64,
}

impl Default for Parameters {
    /// A SICK LMS 200 as its data sheet has it, set to 180° in steps of 0.5° and millimetres: 8 m, 5
    /// mm standard deviation. Where it sits on a P3-DX is an assumption: over the axle.
    fn default() -> Self {
        Self {
            placement: Pose::new(0.02, 0.0, 0.0),
            field: 180_f64.to_radians(),
            step: 0.5_f64.to_radians(),
            reach: 8.0,
            noise: 0.005,
        }
    }
}

/// A scanner, with random numbers of its own.
#[derive(Debug, Clone)]
pub struct Laser {
    parameters: Parameters,
    rng: ChaCha8Rng,
}

impl Laser {
    /// A scanner whose noise follows from `seed`.
    pub fn new(parameters: Parameters, seed: u64) -> Result<Self, Error> {
        require("laser.field", parameters.field, "> 0, <= 2π rad", |f| {
            f > 0.0 && f <= TAU
        })?;
        require("laser.step", parameters.step, "0.0001..=0.1 rad", |s| {
            (1e-4..=0.1).contains(&s)
        })?;
        require("laser.reach", parameters.reach, "0.5..=100 m", |r| {
            (0.5..=100.0).contains(&r)
        })?;
        require("laser.noise", parameters.noise, "0..=1 m", |n| {
            (0.0..=1.0).contains(&n)
        })?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // Streams from 0 up belong to the sonars, those from the top down to scenarios.
        rng.set_stream(1 << 32);
        Ok(Self { parameters, rng })
    }

    /// What kind of scanner it is.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Direction of the first beam in the scanner's frame (rad).
    #[must_use]
    pub fn first_angle(&self) -> f64 {
        -0.5 * self.parameters.field
    }

    /// Scans the world from a robot at `robot`: ranges (m) from the first beam to the last,
    /// counter-clockwise, infinite where nothing is within reach.
    pub fn scan(&mut self, world: &World, robot: &Pose) -> Vec<f32> {
        let Parameters {
            placement,
            field,
            step,
            reach,
            noise,
        } = self.parameters;
        let at = robot.compose(&placement);
        let beams = (field / step).round() as u32 + 1;
        let first = self.first_angle();
        (0..beams)
            .map(|beam| {
                let heading = at.heading + first + f64::from(beam) * step;
                let ray = Cone {
                    apex: Pose { heading, ..at },
                    half_angle: 0.0,
                    range: reach,
                };
                // One draw each, so that what is seen does not change the rest of the sequence.
                let deviate: f64 = StandardNormal.sample(&mut self.rng);
                match world.nearest_in_cone(&ray) {
                    Some(hit) => (hit.distance + noise * deviate).max(0.0) as f32,
                    None => f32::INFINITY,
                }
            })
            .collect()
    }
}
