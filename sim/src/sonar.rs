//! A ring of sonars: what each hears, and the ways in which it can be wrong.

use core::f64::consts::FRAC_PI_2;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sidestep::arcos::{NO_ECHO_RANGE, SonarPlacement};

use crate::error::{Error, require};
use crate::geometry::Pose;
use crate::world::{Cone, World};

/// What kind of sonar the ring consists of.
///
/// An echo comes back from the nearest surface in the cone at whatever angle it is struck: smooth
/// walls that mirror the ping away are not modelled, see [`Faults::dropout`] for lost echoes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Half of the cone's opening angle, in [0, π/2) (rad).
    pub half_angle: f64,
    /// Blanking distance: anything nearer gives some reading below it, in [0, 1] (m).
    pub blanking: f64,
    /// Reach, in (0, 5] (m).
    pub range: f64,
    /// Standard deviation of a reading relative to the range, in [0, 1].
    pub noise: f64,
}

impl Default for Parameters {
    /// 15° half angle, 3 cm blanking (S1 L91), 5 m reach, 1 % noise.
    fn default() -> Self {
        Self {
            half_angle: 15_f64.to_radians(),
            blanking: 0.03,
            range: 5.0,
            noise: 0.01,
        }
    }
}

/// What is wrong with a sonar. The default is nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Probability that an echo is lost: the reading says that nothing is there.
    pub dropout: f64,
    /// Probability of an echo out of nowhere, as from another sonar's ping: a random range shorter
    /// than the true one.
    pub false_echo: f64,
    /// Probability of a reading of 0 mm.
    pub zero: f64,
    /// A lasting failure, which overrides all of these.
    pub failure: Option<Failure>,
}

/// How a sonar is broken for good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Never reported.
    Silent,
    /// Reported, and hears nothing.
    Deaf,
    /// Always the same reading (mm).
    Stuck(u16),
}

impl Faults {
    fn check(&self) -> Result<(), Error> {
        for (field, probability) in [
            ("sonar.dropout", self.dropout),
            ("sonar.false_echo", self.false_echo),
            ("sonar.zero", self.zero),
        ] {
            require(field, probability, "0..=1", |p| (0.0..=1.0).contains(&p))?;
        }
        Ok(())
    }
}

/// One sonar, with random numbers of its own: a fault of one does not change what the others read.
#[derive(Debug, Clone)]
struct Sonar {
    placement: Pose,
    faults: Faults,
    rng: ChaCha8Rng,
}

/// The sonars of a robot, by index.
#[derive(Debug, Clone)]
pub struct Ring {
    parameters: Parameters,
    sonars: Vec<Sonar>,
}

impl Ring {
    /// A ring without faults, with a sonar at each of `placements` and noise that follows from
    /// `seed`.
    pub fn new(
        placements: &[SonarPlacement],
        parameters: Parameters,
        seed: u64,
    ) -> Result<Self, Error> {
        require(
            "sonar.half_angle",
            parameters.half_angle,
            "0..π/2 rad",
            |h| (0.0..FRAC_PI_2).contains(&h),
        )?;
        require("sonar.blanking", parameters.blanking, "0..=1 m", |b| {
            (0.0..=1.0).contains(&b)
        })?;
        require("sonar.range", parameters.range, "> blanking, <= 5 m", |r| {
            r > parameters.blanking && r <= millimetres(NO_ECHO_RANGE)
        })?;
        require("sonar.noise", parameters.noise, "0..=1", |n| {
            (0.0..=1.0).contains(&n)
        })?;
        let sonars = placements.iter().zip(0..).map(|(placement, stream)| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(stream);
            Sonar {
                placement: Pose::new(
                    f64::from(placement.x_mm) / 1000.0,
                    f64::from(placement.y_mm) / 1000.0,
                    f64::from(placement.heading_deg).to_radians(),
                ),
                faults: Faults::default(),
                rng,
            }
        });
        Ok(Self {
            parameters,
            sonars: sonars.collect(),
        })
    }

    /// Number of sonars.
    #[must_use]
    pub fn len(&self) -> usize {
        self.sonars.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sonars.is_empty()
    }

    /// Gives every sonar these faults.
    pub fn set_faults(&mut self, faults: Faults) -> Result<(), Error> {
        faults.check()?;
        for sonar in &mut self.sonars {
            sonar.faults = faults;
        }
        Ok(())
    }

    /// Gives the sonar `index` these faults.
    pub fn set_faults_of(&mut self, index: usize, faults: Faults) -> Result<(), Error> {
        faults.check()?;
        match self.sonars.get_mut(index) {
            Some(sonar) => {
                sonar.faults = faults;
                Ok(())
            }
            None => Err(Error::OutOfRange {
                field: "sonar.index",
                value: index as f64,
                allowed: "below the number of sonars",
            }),
        }
    }

    /// The sonars that are broken for good, by index.
    pub fn broken(&self) -> impl Iterator<Item = usize> {
        let sonars = self.sonars.iter().enumerate();
        sonars.filter_map(|(index, sonar)| sonar.faults.failure.map(|_| index))
    }

    /// What sonar `index` listens to on a robot at `robot`, if there is such a sonar.
    #[must_use]
    pub fn cone(&self, index: usize, robot: &Pose) -> Option<Cone> {
        self.sonars.get(index).map(|sonar| Cone {
            apex: robot.compose(&sonar.placement),
            half_angle: self.parameters.half_angle,
            range: self.parameters.range,
        })
    }

    /// Pings sonar `index` of a robot at `robot`: the reading (mm), [`NO_ECHO_RANGE`] if nothing
    /// answers, `None` if the sonar is silent or absent.
    pub fn measure(&mut self, index: usize, world: &World, robot: &Pose) -> Option<u16> {
        let cone = self.cone(index, robot)?;
        let sonar = self.sonars.get_mut(index)?;
        match sonar.faults.failure {
            Some(Failure::Silent) => return None,
            Some(Failure::Deaf) => return Some(NO_ECHO_RANGE),
            Some(Failure::Stuck(reading)) => return Some(reading),
            None => {}
        }
        let echo = world.nearest_in_cone(&cone).map(|echo| echo.distance);
        let Parameters {
            blanking,
            range,
            noise,
            ..
        } = self.parameters;
        let Faults {
            dropout,
            false_echo,
            zero,
            ..
        } = sonar.faults;
        let rng = &mut sonar.rng;
        // One draw each, needed or not, so that a fault leaves the rest of the sequence as it was.
        let [lost, nowhere, nothing, part] = [(); 4].map(|()| rng.random::<f64>());
        let deviate: f64 = StandardNormal.sample(rng);

        let reading = if nothing < zero {
            0.0
        } else if nowhere < false_echo {
            part * echo.unwrap_or(range)
        } else if lost < dropout {
            return Some(NO_ECHO_RANGE);
        } else {
            match echo {
                None => return Some(NO_ECHO_RANGE),
                Some(distance) if distance < blanking => part * blanking,
                Some(distance) => distance * (1.0 + noise * deviate),
            }
        };
        // Beyond the reach an echo is none; the conversion saturates at 0.
        Some(if reading > range {
            NO_ECHO_RANGE
        } else {
            (reading * 1000.0).round() as u16
        })
    }
}

fn millimetres(reading: u16) -> f64 {
    f64::from(reading) / 1000.0
}
