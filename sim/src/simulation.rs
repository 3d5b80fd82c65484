//! World and robot advanced together, recorded and judged.

use std::collections::BTreeMap;

use crate::STEP_MS;
use crate::base::Activity;
use crate::geometry::{Point, Pose, heading_of, wrap};
use crate::person::Person;
use crate::robot::ArcosRobot;
use crate::truth::Truth;
use crate::world::{Body, World};

/// Time between two samples of the trace (ms).
pub const SAMPLE_MS: u64 = 100;

/// Where everyone was at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// When (ms).
    pub time_ms: u64,
    /// The robot's true pose.
    pub pose: Pose,
    /// Its speed, forward positive (m/s).
    pub speed: f64,
    /// Its turn rate, counter-clockwise positive (rad/s).
    pub turn_rate: f64,
    /// The people who were there, by their index in the world (m).
    pub people: Vec<(usize, Point)>,
    /// From the robot's hull to the nearest body, negative where they overlap (m).
    pub clearance: f64,
}

/// One value for people and one for still obstacles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ByKind<T> {
    /// For people.
    pub people: T,
    /// For walls, boxes and discs.
    pub obstacles: T,
}

impl<T> ByKind<T> {
    fn of(&mut self, body: Body) -> &mut T {
        match body {
            Body::Person(_) => &mut self.people,
            Body::Obstacle(_) => &mut self.obstacles,
        }
    }
}

/// What became of a simulation so far.
///
/// A contact lasts from touching a body to being clear of it. It counts once, under the most active
/// thing that the robot did meanwhile: a robot that was touched at rest and then drove on while
/// still in contact drove in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Simulated time (ms).
    pub duration_ms: u64,
    /// Length of the robot's way (m).
    pub travelled: f64,
    /// Least distance from the hull while driving (m): negative in contact, infinite if there was
    /// nothing to hit.
    pub minimum_clearance_while_driving: ByKind<f64>,
    /// Contacts in which the robot drove: what passive safety promises never to happen.
    pub contacts_while_driving: ByKind<u32>,
    /// Contacts in which it did no more than turn in place.
    pub contacts_while_turning: ByKind<u32>,
    /// Contacts in which it stood still.
    pub contacts_at_rest: ByKind<u32>,
}

/// The moment at which a contact became one that was never to happen: a body was touched by a robot
/// that moved, or a robot moved that was being touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingContact {
    /// When (ms).
    pub time_ms: u64,
    /// What was touched.
    pub body: Body,
    /// What the robot did.
    pub activity: Activity,
    /// Direction of the body's nearest point, or of the middle of a person, from the robot's heading
    /// (rad).
    pub bearing: f64,
    /// The robot's speed, forward positive (m/s).
    pub speed: f64,
    /// The person's speed (m/s); 0 for an obstacle.
    pub body_speed: f64,
    /// Whether they had been in touch before, with the robot at rest.
    pub touched_before: bool,
}

/// A world with a robot in it.
#[derive(Clone)]
pub struct Simulation {
    world: World,
    robot: ArcosRobot,
    now_ms: u64,
    trace: Vec<Sample>,
    minimum_clearance: ByKind<f64>,
    /// Bodies in contact, with the most active thing the robot did meanwhile.
    touching: BTreeMap<Body, Activity>,
    /// Contacts that have ended.
    ended: BTreeMap<Activity, ByKind<u32>>,
    moving_contacts: Vec<MovingContact>,
    truth: Truth,
}

impl Simulation {
    /// `robot` in `world`, at time 0.
    #[must_use]
    pub fn new(world: World, robot: ArcosRobot) -> Self {
        let mut simulation = Self {
            world,
            robot,
            now_ms: 0,
            trace: Vec::new(),
            minimum_clearance: ByKind {
                people: f64::INFINITY,
                obstacles: f64::INFINITY,
            },
            touching: BTreeMap::new(),
            ended: BTreeMap::new(),
            moving_contacts: Vec::new(),
            truth: Truth::default(),
        };
        simulation.judge();
        simulation.sample();
        simulation
    }

    /// Moves everything on, in whole steps of [`STEP_MS`], up to `time_ms` since the beginning.
    pub fn advance_to(&mut self, time_ms: u64) {
        while self.now_ms + STEP_MS <= time_ms {
            self.now_ms += STEP_MS;
            self.world.step(&self.robot.base().footprint());
            self.robot.step(&self.world);
            self.truth.note(&self.world, &self.robot);
            self.judge();
            if self.now_ms.is_multiple_of(SAMPLE_MS) {
                self.sample();
            }
        }
    }

    /// Simulated time, a multiple of [`STEP_MS`] (ms).
    #[must_use]
    pub fn now_ms(&self) -> u64 {
        self.now_ms
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &ArcosRobot {
        &self.robot
    }

    /// The robot, to talk to it or to break it.
    pub fn robot_mut(&mut self) -> &mut ArcosRobot {
        &mut self.robot
    }

    /// From the robot's hull to the nearest body, negative where they overlap, infinite in an empty
    /// world (m).
    #[must_use]
    pub fn clearance(&self) -> f64 {
        let footprint = self.robot.base().footprint();
        self.world.clearance(footprint.centre, footprint.radius)
    }

    /// Samples every [`SAMPLE_MS`], from time 0.
    #[must_use]
    pub fn trace(&self) -> &[Sample] {
        &self.trace
    }

    /// What was truly so, beside what a shield assumes.
    #[must_use]
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// The same, for whoever carries the packets to note how long they took.
    pub fn truth_mut(&mut self) -> &mut Truth {
        &mut self.truth
    }

    /// How each contact with a robot that moved came about.
    #[must_use]
    pub fn moving_contacts(&self) -> &[MovingContact] {
        &self.moving_contacts
    }

    /// What became of it so far.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let mut contacts = self.ended.clone();
        for (body, activity) in &self.touching {
            *contacts.entry(*activity).or_default().of(*body) += 1;
        }
        let contacts = |activity| contacts.get(&activity).copied().unwrap_or_default();
        Outcome {
            duration_ms: self.now_ms,
            travelled: self.robot.base().travelled(),
            minimum_clearance_while_driving: self.minimum_clearance,
            contacts_while_driving: contacts(Activity::Driving),
            contacts_while_turning: contacts(Activity::Turning),
            contacts_at_rest: contacts(Activity::Resting),
        }
    }

    fn judge(&mut self) {
        let footprint = self.robot.base().footprint();
        let activity = self.robot.base().activity();
        if activity == Activity::Driving {
            for nearest in [
                self.world.nearest_person(footprint.centre),
                self.world.nearest_obstacle(footprint.centre),
            ]
            .into_iter()
            .flatten()
            {
                let least = self.minimum_clearance.of(nearest.body);
                *least = least.min(nearest.distance - footprint.radius);
            }
        }
        let touched: Vec<Body> = self
            .world
            .touching(footprint.centre, footprint.radius)
            .collect();
        self.touching.retain(|body, worst| {
            let lasts = touched.contains(body);
            if !lasts {
                *self.ended.entry(*worst).or_default().of(*body) += 1;
            }
            lasts
        });
        for body in touched {
            let before = self.touching.get(&body).copied();
            let worst = before.map_or(activity, |before| before.max(activity));
            self.touching.insert(body, worst);
            if activity > Activity::Resting && before.is_none_or(|b| b == Activity::Resting) {
                self.moving_contacts.push(MovingContact {
                    time_ms: self.now_ms,
                    body,
                    activity,
                    bearing: self.bearing(body),
                    speed: self.robot.base().speed(),
                    body_speed: match body {
                        Body::Person(i) => self.world.people().get(i).map_or(0.0, Person::speed),
                        Body::Obstacle(_) => 0.0,
                    },
                    touched_before: before.is_some(),
                });
            }
        }
    }

    /// Direction of `body` from the robot's heading (rad).
    fn bearing(&self, body: Body) -> f64 {
        let pose = self.robot.base().pose();
        let place = match body {
            Body::Person(i) => self.world.people().get(i).and_then(Person::position),
            Body::Obstacle(i) => self.world.nearest_point(i, pose.position),
        };
        place.map_or(0.0, |place| {
            wrap(heading_of(&(place - pose.position)) - pose.heading)
        })
    }

    fn sample(&mut self) {
        let base = self.robot.base();
        let people = self.world.people().iter().enumerate();
        self.trace.push(Sample {
            time_ms: self.now_ms,
            pose: base.pose(),
            speed: base.speed(),
            turn_rate: base.turn_rate(),
            people: people
                .filter_map(|(i, person)| Some((i, person.position()?)))
                .collect(),
            clearance: self.clearance(),
        });
    }
}
