//! What was truly so, beside what the robot's shield assumes: which assumption was broken.

use std::fmt;

use crate::robot::ArcosRobot;
use crate::world::World;

/// What a shield counts on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assumptions {
    /// Nobody is faster (m/s).
    pub person_speed: f64,
    /// The base brakes at least as hard (m/s²).
    pub braking: f64,
    /// The base speeds up no harder (m/s²).
    pub acceleration: f64,
    /// From what the sensors describe to the effect of the next command it takes no longer (ms).
    pub reaction_ms: u64,
}

/// The extremes of a simulation so far, as they truly were.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// The fastest that anyone moved (m/s).
    pub fastest_person: f64,
    /// The weakest braking of a robot that was to slow down (m/s²); infinite if it never was.
    pub weakest_braking: f64,
    /// The hardest that the robot sped up (m/s²).
    pub hardest_acceleration: f64,
    /// The oldest that what the sensors had described became while a command to move that rested on
    /// it was in force (ms). Only whoever carries the packets knows it: see
    /// [`Truth::note_reaction`].
    pub longest_reaction_ms: u64,
    /// The sonars that were broken for good, by index.
    pub broken_sonars: Vec<usize>,
}

impl Default for Truth {
    fn default() -> Self {
        Self {
            fastest_person: 0.0,
            weakest_braking: f64::INFINITY,
            hardest_acceleration: 0.0,
            longest_reaction_ms: 0,
            broken_sonars: Vec::new(),
        }
    }
}

/// An assumption that did not hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Broken {
    /// Someone was faster than anyone was to be (m/s).
    PersonSpeed {
        /// As fast as this.
        was: f64,
        /// The bound.
        bound: f64,
    },
    /// The base braked less than it was to (m/s²).
    Braking {
        /// As hard as this.
        was: f64,
        /// The bound.
        bound: f64,
    },
    /// The base sped up harder than it was to (m/s²).
    Acceleration {
        /// As hard as this.
        was: f64,
        /// The bound.
        bound: f64,
    },
    /// It took longer to react than it was to (ms).
    Reaction {
        /// As long as this.
        was: u64,
        /// The bound.
        bound: u64,
    },
    /// What was seen to stand still was faster than that is to be (m/s). Only whoever knows what the
    /// shield believes can tell.
    StillSpeed {
        /// As fast as this.
        was: f64,
        /// The bound.
        bound: f64,
    },
    /// These sonars were broken for good.
    Sonars(Vec<usize>),
}

impl Broken {
    /// The assumption in a few words.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::PersonSpeed { .. } => "people's speed",
            Self::Braking { .. } => "braking",
            Self::Acceleration { .. } => "acceleration",
            Self::Reaction { .. } => "reaction time",
            Self::StillSpeed { .. } => "still things' speed",
            Self::Sonars(_) => "sonars in order",
        }
    }
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        match self {
            Self::PersonSpeed { was, bound } | Self::StillSpeed { was, bound } => {
                write!(f, "{name}: {was:.2} m/s, assumed at most {bound:.2}")
            }
            Self::Braking { was, bound } => {
                write!(f, "{name}: {was:.2} m/s², assumed at least {bound:.2}")
            }
            Self::Acceleration { was, bound } => {
                write!(f, "{name}: {was:.2} m/s², assumed at most {bound:.2}")
            }
            Self::Reaction { was, bound } => {
                write!(f, "{name}: {was} ms, assumed at most {bound}")
            }
            Self::Sonars(sonars) if sonars.len() > 4 => {
                write!(f, "{name}: {} are broken", sonars.len())
            }
            Self::Sonars(sonars) => write!(f, "{name}: broken {sonars:?}"),
        }
    }
}

/// Bounds that come from single precision are kept to this part of them.
const ROUNDING: f64 = 1e-4;

impl Truth {
    /// The assumptions that did not hold.
    #[must_use]
    pub fn broken(&self, assumed: &Assumptions) -> Vec<Broken> {
        let more = |was: f64, bound: f64| was > bound * (1.0 + ROUNDING);
        let Assumptions {
            person_speed,
            braking,
            acceleration,
            reaction_ms,
        } = *assumed;
        let mut broken = Vec::new();
        if more(self.fastest_person, person_speed) {
            broken.push(Broken::PersonSpeed {
                was: self.fastest_person,
                bound: person_speed,
            });
        }
        if more(braking, self.weakest_braking) {
            broken.push(Broken::Braking {
                was: self.weakest_braking,
                bound: braking,
            });
        }
        if more(self.hardest_acceleration, acceleration) {
            broken.push(Broken::Acceleration {
                was: self.hardest_acceleration,
                bound: acceleration,
            });
        }
        if self.longest_reaction_ms > reaction_ms {
            broken.push(Broken::Reaction {
                was: self.longest_reaction_ms,
                bound: reaction_ms,
            });
        }
        if !self.broken_sonars.is_empty() {
            broken.push(Broken::Sonars(self.broken_sonars.clone()));
        }
        broken
    }

    /// Notes that a command to move was in force when what it rests on was this old (ms).
    pub fn note_reaction(&mut self, age_ms: u64) {
        self.longest_reaction_ms = self.longest_reaction_ms.max(age_ms);
    }

    /// Takes in what the last step was like.
    pub(crate) fn note(&mut self, world: &World, robot: &ArcosRobot) {
        for person in world.people() {
            self.fastest_person = self.fastest_person.max(person.speed());
        }
        let effort = robot.base().effort();
        if let Some(braking) = effort.braking {
            self.weakest_braking = self.weakest_braking.min(braking);
        }
        if let Some(accelerating) = effort.accelerating {
            self.hardest_acceleration = self.hardest_acceleration.max(accelerating);
        }
        for sonar in robot.ring().broken() {
            if !self.broken_sonars.contains(&sonar) {
                self.broken_sonars.push(sonar);
            }
        }
    }
}
