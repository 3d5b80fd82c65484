//! A depth camera that follows people: where they are and what they show, with noise and dropouts.

use std::collections::VecDeque;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sidestep::gesture::{Gesture, PEOPLE_MAX};
use sidestep::interact::{LateralAxis, People, Someone};
use sidestep::quantity::Instant;

use crate::error::{Error, require};
use crate::geometry::{Pose, Vector, direction};
use crate::world::World;

/// What the camera can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Time between two pictures (ms).
    pub period_ms: u64,
    /// Time until a picture is there (ms).
    pub delay_ms: u64,
    /// Half the angle of view (rad).
    pub half_angle: f64,
    /// Nobody nearer than this is seen (m).
    pub range_min: f64,
    /// Nobody farther than this is seen (m).
    pub range_max: f64,
    /// Standard deviation of a place (m).
    pub noise: f64,
    /// Share of the pictures in which somebody in view is not found, in [0, 1].
    pub dropout: f64,
    /// Share of the pictures in which somebody is taken to show another gesture, in [0, 1].
    pub wrong_gesture: f64,
    /// Which way its lateral coordinate counts.
    pub lateral_axis: LateralAxis,
}

impl Default for Parameters {
    /// A Kinect v2 at ten pictures a second: 70°, 0.5 to 4.5 m, 2 cm, a person lost in 5 % of them.
    fn default() -> Self {
        Self {
            period_ms: 100,
            delay_ms: 60,
            half_angle: 35_f64.to_radians(),
            range_min: 0.5,
            range_max: 4.5,
            noise: 0.02,
            dropout: 0.05,
            wrong_gesture: 0.0,
            lateral_axis: LateralAxis::Left,
        }
    }
}

/// Somebody out of sight for longer than this is another person to the camera (ms).
const FORGOTTEN_MS: u64 = 1000;

/// The camera, in the middle of the robot and looking straight ahead.
#[derive(Debug, Clone)]
pub struct DepthCamera {
    parameters: Parameters,
    rng: ChaCha8Rng,
    next_ms: u64,
    under_way: VecDeque<(u64, People)>,
    /// The number of each person and when they were last seen, by index in the world.
    numbers: Vec<Option<(u64, u64)>>,
    /// Numbers given so far.
    given: u64,
}

impl DepthCamera {
    /// A camera whose noise and dropouts follow from `seed`.
    pub fn new(parameters: Parameters, seed: u64) -> Result<Self, Error> {
        for (field, share) in [
            ("camera.dropout", parameters.dropout),
            ("camera.wrong_gesture", parameters.wrong_gesture),
        ] {
            require(field, share, "0 to 1", |share| (0.0..=1.0).contains(&share))?;
        }
        require("camera.noise", parameters.noise, "0 to 1 m", |noise| {
            (0.0..=1.0).contains(&noise)
        })?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(u64::MAX - 3);
        Ok(Self {
            parameters,
            rng,
            next_ms: 0,
            under_way: VecDeque::new(),
            numbers: Vec::new(),
            given: 0,
        })
    }

    /// Takes a picture of `world` from `pose` if it is time to; `gesture` says what a person, by
    /// index, shows.
    pub fn look(
        &mut self,
        now_ms: u64,
        world: &World,
        pose: &Pose,
        gesture: impl Fn(usize) -> Option<Gesture>,
    ) {
        if now_ms < self.next_ms {
            return;
        }
        self.next_ms = now_ms + self.parameters.period_ms;
        let places = self.in_view(world, pose);
        let mut people = [None; PEOPLE_MAX];
        let mut count = 0;
        for (person, depth, lateral, hidden) in places {
            let lost = self.rng.random_bool(self.parameters.dropout);
            if hidden || lost || count == PEOPLE_MAX {
                continue;
            }
            let shown = if self.rng.random_bool(self.parameters.wrong_gesture) {
                Some(Gesture::ALL[self.rng.random_range(0..Gesture::ALL.len() as u32) as usize])
            } else {
                gesture(person)
            };
            let [aside, ahead] = [lateral, depth].map(|x| x + self.scatter());
            people[count] = Some(Someone {
                id: self.number(person, now_ms),
                lateral: match self.parameters.lateral_axis {
                    LateralAxis::Left => aside as f32,
                    LateralAxis::Right => -aside as f32,
                },
                depth: ahead as f32,
                radius: None,
                gesture: shown,
            });
            count += 1;
        }
        let taken_at = Instant(now_ms);
        let due = now_ms + self.parameters.delay_ms;
        self.under_way.push_back((due, People { taken_at, people }));
    }

    /// Everybody in view, nearest first: who, by index in the world, how far ahead, how far to the
    /// left (m), and whether somebody nearer hides them.
    pub(crate) fn in_view(&self, world: &World, pose: &Pose) -> Vec<(usize, f64, f64, bool)> {
        let ahead = direction(pose.heading);
        let left = Vector::new(-ahead.y, ahead.x);
        let mut places: Vec<(usize, f64, f64, f64)> = Vec::new();
        for (person, body) in world.people().iter().enumerate() {
            let Some(place) = body.position() else {
                continue;
            };
            let offset = place - pose.position;
            let (depth, lateral) = (offset.dot(&ahead), offset.dot(&left));
            let p = &self.parameters;
            let range = offset.norm();
            if depth > 0.0
                && (p.range_min..=p.range_max).contains(&range)
                && lateral.abs() <= depth * p.half_angle.tan()
            {
                places.push((person, depth, lateral, body.radius()));
            }
        }
        places.sort_by(|one, other| one.1.total_cmp(&other.1));
        let hidden = |i: usize| {
            let (_, depth, lateral, _) = places[i];
            // Half hidden is hidden.
            places[..i].iter().any(|&(_, nearer, aside, radius)| {
                let along = nearer / depth;
                (lateral * along - aside).abs() < radius
            })
        };
        (0..places.len())
            .map(|i| (places[i].0, places[i].1, places[i].2, hidden(i)))
            .collect()
    }

    /// The next picture that is there by now, if any is.
    pub fn arrival(&mut self, now_ms: u64) -> Option<People> {
        let there = |(due, _): &mut (u64, People)| *due <= now_ms;
        self.under_way.pop_front_if(there).map(|(_, people)| people)
    }

    /// The number under which the camera follows a person.
    #[must_use]
    pub fn number_of(&self, person: usize) -> Option<u64> {
        let (number, _) = (*self.numbers.get(person)?)?;
        Some(number)
    }

    pub(crate) fn number(&mut self, person: usize, now_ms: u64) -> u64 {
        if self.numbers.len() <= person {
            self.numbers.resize(person + 1, None);
        }
        let number = match self.numbers[person] {
            Some((number, seen)) if now_ms <= seen + FORGOTTEN_MS => number,
            _ => {
                self.given += 1;
                self.given
            }
        };
        self.numbers[person] = Some((number, now_ms));
        number
    }

    fn scatter(&mut self) -> f64 {
        let deviate: f64 = StandardNormal.sample(&mut self.rng);
        deviate * self.parameters.noise
    }
}
