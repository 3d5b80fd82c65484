//! A magnetic compass as the base reports it: one byte, in steps of 2°.

use core::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::{Error, require};

/// What kind of compass is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Standard deviation of a reading, ≥ 0 (rad).
    pub noise: f64,
    /// Reading of the robot that faces +x; readings increase counter-clockwise (rad).
    pub offset: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            noise: 0.02,
            offset: 0.0,
        }
    }
}

/// A compass with its own random numbers.
#[derive(Debug, Clone)]
pub struct Compass {
    parameters: Parameters,
    rng: ChaCha8Rng,
}

/// What a robot without a compass reports.
pub const ABSENT: u8 = 0;

impl Compass {
    /// A compass whose noise follows from `seed`.
    pub fn new(parameters: Parameters, seed: u64) -> Result<Self, Error> {
        require("compass.noise", parameters.noise, ">= 0 rad", |n| n >= 0.0)?;
        require("compass.offset", parameters.offset, "finite rad", |_| true)?;
        Ok(Self {
            parameters,
            rng: ChaCha8Rng::seed_from_u64(seed),
        })
    }

    /// The byte reported by a robot that faces `heading` (rad): 1 to 180, where `b` stands for the
    /// two degrees from 2(b − 1)° to 2b°.
    pub fn measure(&mut self, heading: f64) -> u8 {
        let deviate: f64 = StandardNormal.sample(&mut self.rng);
        let reading = heading + self.parameters.offset + self.parameters.noise * deviate;
        let turns = (reading / TAU).rem_euclid(1.0);
        ((turns * 180.0) as u8).min(179) + 1
    }
}
