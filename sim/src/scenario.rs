//! Named situations, ready to simulate, and seeded variations of them.

use core::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::{Error, require};
use crate::eth;
use crate::geometry::{Point, Pose, Vector, direction, heading_of};
use crate::person::{COURTESY_GAP, Motion, Person};
use crate::robot::{self, ArcosRobot};
use crate::simulation::{Sample, Simulation};
use crate::sonar;
use crate::world::World;

/// The scenarios that need no data file.
pub const NAMES: [&str; 10] = [
    ENCOUNTERS[0].name,
    ENCOUNTERS[1].name,
    ENCOUNTERS[2].name,
    ENCOUNTERS[3].name,
    LAB,
    CORRIDOR,
    CORRIDOR_WALKER,
    EMPTY_ROOM,
    BLOCKED_WAY,
    APPROACH,
];

/// Someone who walks straight on towards where the robot is going to be.
struct Encounter {
    name: &'static str,
    /// What the person does.
    description: &'static str,
    /// Direction of walking (rad); the robot's is 0.
    heading: f64,
    /// Usual speed (m/s).
    speed: f64,
}

/// S1 Fig. 12, and the fastest person S1 allows for.
const ENCOUNTERS: [Encounter; 4] = [
    Encounter {
        name: "fig12-head-on",
        description: "S1 Fig. 12: a person comes straight at the robot",
        heading: PI,
        speed: 0.4,
    },
    Encounter {
        name: "fig12-crossing",
        description: "S1 Fig. 12: a person crosses at 45° from ahead on the left",
        heading: -0.75 * PI,
        speed: 0.4,
    },
    Encounter {
        name: "fig12-from-side",
        description: "S1 Fig. 12: a person crosses at 90° from the left",
        heading: -FRAC_PI_2,
        speed: 0.4,
    },
    Encounter {
        name: "head-on-80",
        description: "a person comes straight at the robot as fast as S1 allows for",
        heading: PI,
        speed: 0.8,
    },
];

const LAB: &str = "lab";
const CORRIDOR: &str = "corridor";
const CORRIDOR_WALKER: &str = "corridor-walker";
const EMPTY_ROOM: &str = "empty-room";
const BLOCKED_WAY: &str = "blocked-way";
/// What S2's experiment is called.
pub const APPROACH: &str = "approach";

/// The robot's speed on the way to its goal, for which the encounters are timed (m/s): S1 L294.
pub const CRUISE: f64 = 0.2;

/// When the robot, left alone, would meet the person of an encounter (s).
const MEETING: f64 = 7.5;

/// A random encounter begins with at least this much room between hull and person (m).
const INITIAL_CLEARANCE: f64 = 0.6;

/// What can be chosen of every scenario.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knobs {
    /// Seed of all noise and faults.
    pub seed: u64,
    /// Speed of the people, in [0, 5], or that of the scenario (m/s). Recorded people keep theirs.
    pub person_speed: Option<f64>,
    /// Whether people walk round a robot that stands still, which is what S1 assumes of them
    /// (readings ER-S1-22). Recorded people never do.
    pub courteous: bool,
    /// Standard deviation of the sonars relative to the range, in [0, 1].
    pub sonar_noise: f64,
    /// Faults of every sonar.
    pub sonar_faults: sonar::Faults,
}

impl Default for Knobs {
    /// Seed 0, people as the scenario has them and courteous, ordinary noise, no faults.
    fn default() -> Self {
        Self {
            seed: 0,
            person_speed: None,
            courteous: true,
            sonar_noise: sonar::Parameters::default().noise,
            sonar_faults: sonar::Faults::default(),
        }
    }
}

/// A situation: a world, a robot, and what it is to do there.
#[derive(Clone)]
pub struct Scenario {
    /// Its name.
    pub name: &'static str,
    /// What happens, in a sentence.
    pub description: String,
    /// Where it happens.
    pub world: World,
    /// Where the robot starts.
    pub start: Pose,
    /// Where it is to go (m).
    pub goal: Point,
    /// When to give up (ms).
    pub time_limit_ms: u64,
    /// The robot.
    pub robot: robot::Parameters,
    /// Faults of every sonar.
    pub sonar_faults: sonar::Faults,
    /// Seed of all noise and faults.
    pub seed: u64,
}

impl Scenario {
    /// The scenario called `name`, one of [`NAMES`].
    pub fn named(name: &str, knobs: &Knobs) -> Result<Self, Error> {
        match name {
            LAB => return lab(knobs),
            CORRIDOR => return corridor(knobs, false),
            CORRIDOR_WALKER => return corridor(knobs, true),
            EMPTY_ROOM => return empty_room(knobs),
            BLOCKED_WAY => return blocked_way(knobs),
            APPROACH => return approach(knobs),
            _ => {}
        }
        match ENCOUNTERS.iter().find(|encounter| encounter.name == name) {
            Some(encounter) => encounter.scenario(knobs),
            None => Err(Error::UnknownScenario {
                name: name.to_owned(),
                known: &NAMES,
            }),
        }
    }

    /// The robot crosses a pavement among the pedestrians recorded in the file at `path`, in the
    /// form of the ETH data set's *hotel* sequence, from `start_time` (s) of the recording to its
    /// end.
    ///
    /// Recorded people know of no robot: they walk faster than S1's bound and into a robot that
    /// stands.
    pub fn hotel(path: &Path, start_time: f64, knobs: &Knobs) -> Result<Self, Error> {
        let mut world = World::new();
        let mut end: f64 = 0.0;
        for person in eth::read(path)? {
            if let Motion::Track(samples) = person.motion() {
                end = samples.last().map_or(end, |last| end.max(last.time));
            }
            world.add_person(person);
        }
        require(
            "hotel.start_time",
            start_time,
            "within the recording (s)",
            |t| (0.0..end).contains(&t),
        )?;
        Ok(Self {
            name: "hotel",
            description: format!(
                "ETH hotel: across a pavement among recorded pedestrians, from {start_time} s"
            ),
            world: world.starting_at(start_time)?,
            start: Pose::new(-2.5, -3.0, 0.0),
            goal: Point::new(3.8, -3.0),
            time_limit_ms: ((end - start_time) * 1000.0).round() as u64,
            robot: robot_with(knobs),
            sonar_faults: knobs.sonar_faults,
            seed: knobs.seed,
        })
    }

    /// The same situation happening otherwise, as `seed` has it; all noise follows from `seed` too.
    ///
    /// - Someone who walks straight on comes from about the same direction (±20°), at a speed up to
    ///   `speed_limit` in (0, 5] (m/s), and aims within 0.5 m of where the robot would be by then.
    ///   Nobody starts right beside the robot. Someone whom walls stop keeps to their line, and
    ///   changes only the speed.
    /// - Someone who walks from waypoint to waypoint does so at another such speed and after
    ///   another delay, on patrol beginning at any of the waypoints.
    /// - Someone who walks about does so up to `speed_limit`, and otherwise chooses.
    /// - Recorded people stay as they were recorded.
    pub fn randomised(mut self, seed: u64, speed_limit: f64) -> Result<Self, Error> {
        require("scenario.speed_limit", speed_limit, "> 0, <= 5 m/s", |v| {
            v > 0.0 && v <= 5.0
        })?;
        self.seed = seed;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // Streams 0 and up belong to the sonars.
        rng.set_stream(u64::MAX);
        let ahead = self.goal - self.start.position;
        let course = direction(heading_of(&ahead));
        let keep = self.robot.base.radius + INITIAL_CLEARANCE;
        for person in self.world.people_mut() {
            let motion = match person.motion().clone() {
                // Who is to stay between walls stays on the way that leads there.
                Motion::Line {
                    start,
                    heading,
                    delay,
                    ..
                } if person.is_stopped_by_walls() => Motion::Line {
                    start,
                    heading,
                    speed: speed_limit * rng.random_range(0.25..=1.0),
                    delay,
                },
                Motion::Line { heading, .. } => {
                    let speed = speed_limit * rng.random_range(0.25..=1.0);
                    let heading = heading + rng.random_range(-20.0..=20.0_f64).to_radians();
                    let meeting: f64 = rng.random_range(4.0..=10.0);
                    let miss =
                        Vector::new(rng.random_range(-0.5..=0.5), rng.random_range(-0.5..=0.5));
                    let met = self.start.position + course * (CRUISE * meeting) + miss;
                    let walk = direction(heading);
                    let mut start = met - walk * (speed * meeting);
                    // Walking backwards leads away from the robot sooner or later.
                    while (start - self.start.position).norm() < keep + person.radius() {
                        start -= walk * 0.1;
                    }
                    Motion::Line {
                        start,
                        heading,
                        speed,
                        delay: 0.0,
                    }
                }
                Motion::Path {
                    mut start,
                    mut waypoints,
                    patrol,
                    ..
                } => {
                    if patrol && !waypoints.is_empty() {
                        let first = rng.random_range(0..waypoints.len() as u32) as usize;
                        start = waypoints[first];
                        waypoints.rotate_left(first + 1);
                    }
                    Motion::Path {
                        start,
                        waypoints,
                        speed: speed_limit * rng.random_range(0.25..=1.0),
                        delay: rng.random_range(0.0..=5.0),
                        patrol,
                    }
                }
                Motion::Walk {
                    start,
                    acceleration,
                    delay,
                    habit,
                    ..
                } => Motion::Walk {
                    start,
                    speed: speed_limit,
                    acceleration,
                    delay,
                    habit,
                    seed: rng.random(),
                },
                track @ Motion::Track(_) => track,
            };
            *person = person.clone().with_motion(motion)?;
        }
        let time = self.world.time();
        self.world = self.world.starting_at(time)?;
        Ok(self)
    }

    /// When the last of the people left the robot's way (ms): from then on nobody came within
    /// [`FREE`] of the straight line from where the robot was to the goal. Nothing if nobody was ever
    /// in the way, or if somebody was to the end of `trace`.
    #[must_use]
    pub fn way_free_ms(&self, trace: &[Sample]) -> Option<u64> {
        let barred = |sample: &Sample| {
            let robot = sample.pose.position;
            let mut people = sample.people.iter();
            people.any(|(_, place)| from_segment(*place, robot, self.goal) < FREE)
        };
        let last = trace.iter().rposition(barred)?;
        trace.get(last + 1).map(|sample| sample.time_ms)
    }

    /// The situation at its beginning.
    pub fn simulate(&self) -> Result<Simulation, Error> {
        let mut robot = ArcosRobot::new(self.robot.clone(), self.start, self.seed)?;
        robot.ring_mut().set_faults(self.sonar_faults)?;
        Ok(Simulation::new(self.world.clone(), robot))
    }
}

impl Encounter {
    /// A robot that drives 4 m straight ahead over an open floor, and someone who is aimed at where
    /// it would be after [`MEETING`].
    fn scenario(&self, knobs: &Knobs) -> Result<Scenario, Error> {
        let speed = knobs.person_speed.unwrap_or(self.speed);
        let meeting = Point::new(CRUISE * MEETING, 0.0);
        let mut world = World::new();
        world.add_person(someone(
            Motion::Line {
                start: meeting - direction(self.heading) * (speed * MEETING),
                heading: self.heading,
                speed,
                delay: 0.0,
            },
            knobs,
        )?);
        Ok(Scenario {
            name: self.name,
            description: format!("{}, {speed} m/s", self.description),
            world,
            start: Pose::new(0.0, 0.0, 0.0),
            goal: Point::new(4.0, 0.0),
            time_limit_ms: 90_000,
            robot: robot_with(knobs),
            sonar_faults: knobs.sonar_faults,
            seed: knobs.seed,
        })
    }
}

/// S1's laboratory, 5 by 4 m: a chair on the straight way to the goal, a table behind it, and
/// someone who crosses the room between them and out of the way. There is a way past the chair that leaves a P3-DX
/// 0.45 m on both sides.
fn lab(knobs: &Knobs) -> Result<Scenario, Error> {
    let mut world = World::new();
    world.add_room(Point::new(0.0, 0.0), Point::new(5.0, 4.0))?;
    let chair = Pose::new(2.4, 2.0, 20_f64.to_radians());
    world.add_box(chair, 0.45, 0.45)?;
    let table = Pose::new(3.6, 3.6, 0.0);
    world.add_box(table, 1.2, 0.6)?;
    let speed = knobs.person_speed.unwrap_or(0.4);
    let start = Point::new(3.4, 0.4);
    world.add_person(someone(
        Motion::Path {
            start,
            waypoints: vec![Point::new(3.4, 2.9), Point::new(0.5, 3.6)],
            speed,
            delay: 3.0,
            patrol: false,
        },
        knobs,
    )?);
    Ok(Scenario {
        name: LAB,
        description: format!(
            "S1's laboratory: round a chair, with someone crossing the room at {speed} m/s"
        ),
        world,
        start: Pose::new(0.9, 2.0, 0.0),
        goal: Point::new(4.2, 2.0),
        time_limit_ms: 120_000,
        robot: robot_with(knobs),
        sonar_faults: knobs.sonar_faults,
        seed: knobs.seed,
    })
}

/// A straight corridor 1.2 m wide and 10 m long, with open ends, which the robot drives from near
/// one end to near the other; with someone who comes along it the other way, if asked for, from where
/// the seed has it.
fn corridor(knobs: &Knobs, walker: bool) -> Result<Scenario, Error> {
    let mut world = World::new();
    for y in [-0.6, 0.6] {
        world.add_wall(Point::new(0.0, y), Point::new(10.0, y))?;
    }
    let speed = knobs.person_speed.unwrap_or(0.8);
    if walker {
        let mut rng = ChaCha8Rng::seed_from_u64(knobs.seed);
        rng.set_stream(u64::MAX - 1);
        let line = Motion::Line {
            start: Point::new(rng.random_range(5.0..=9.0), rng.random_range(-0.2..=0.2)),
            heading: PI,
            speed,
            delay: 0.0,
        };
        world.add_person(someone(line, knobs)?.stopped_by_walls());
    }
    let (name, description) = if walker {
        let description =
            format!("a 1.2 m wide corridor, and someone coming along it at {speed} m/s");
        (CORRIDOR_WALKER, description)
    } else {
        let description = "10 m along a 1.2 m wide corridor of still walls";
        (CORRIDOR, description.to_owned())
    };
    Ok(Scenario {
        name,
        description,
        world,
        start: Pose::new(0.5, 0.0, 0.0),
        goal: Point::new(9.5, 0.0),
        time_limit_ms: 150_000,
        robot: robot_with(knobs),
        sonar_faults: knobs.sonar_faults,
        seed: knobs.seed,
    })
}

/// A room with nothing within 3 m of the straight way to the goal.
fn empty_room(knobs: &Knobs) -> Result<Scenario, Error> {
    let mut world = World::new();
    world.add_room(Point::new(-3.2, -3.2), Point::new(7.2, 3.2))?;
    Ok(Scenario {
        name: EMPTY_ROOM,
        description: "4 m straight ahead in an empty room".to_owned(),
        world,
        start: Pose::new(0.0, 0.0, 0.0),
        goal: Point::new(4.0, 0.0),
        time_limit_ms: 60_000,
        robot: robot_with(knobs),
        sonar_faults: knobs.sonar_faults,
        seed: knobs.seed,
    })
}

/// S2's experiment (section 4): in a laboratory of 5 by 4 m someone walks straight on in front of the
/// robot and towards it, at 0.15 to 0.3 m/s (its Table 1) as the seed has it.
fn approach(knobs: &Knobs) -> Result<Scenario, Error> {
    let mut rng = ChaCha8Rng::seed_from_u64(knobs.seed);
    rng.set_stream(u64::MAX - 1);
    let mut world = World::new();
    world.add_room(Point::new(0.0, 0.0), Point::new(5.0, 4.0))?;
    let speed = rng.random_range(0.15..=0.3);
    let speed = knobs.person_speed.unwrap_or(speed);
    let line = Motion::Line {
        start: Point::new(rng.random_range(3.6..=4.6), rng.random_range(1.7..=2.3)),
        heading: PI,
        speed,
        delay: rng.random_range(0.0..=3.0),
    };
    world.add_person(someone(line, knobs)?.stopped_by_walls());
    Ok(Scenario {
        name: APPROACH,
        description: format!(
            "S2's laboratory: someone comes straight at the robot at {speed:.2} m/s"
        ),
        world,
        start: Pose::new(0.7, 2.0, 0.0),
        goal: Point::new(4.2, 2.0),
        time_limit_ms: 120_000,
        robot: robot_with(knobs),
        sonar_faults: knobs.sonar_faults,
        seed: knobs.seed,
    })
}

/// How far from the robot's straight way to the goal someone must be for it to be free (m).
pub const FREE: f64 = 1.2;

/// Someone who stands in the robot's way where there is not much room, as the seed has it, and goes
/// away after some seconds: in a passage between two boxes, or beside a wall right before the robot.
/// When they have left is [`Scenario::way_free_ms`].
fn blocked_way(knobs: &Knobs) -> Result<Scenario, Error> {
    let mut rng = ChaCha8Rng::seed_from_u64(knobs.seed);
    rng.set_stream(u64::MAX - 1);
    let mut world = World::new();
    let goal = Point::new(4.0, 0.0);
    let passage = rng.random_bool(0.5);
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let (start, waypoints) = if passage {
        // Wide enough for the robot, not for robot and person side by side.
        let (width, length) = (rng.random_range(1.6..=2.2), rng.random_range(1.0..=2.0));
        for side in [-1.0, 1.0] {
            let middle = Pose::new(2.0, side * (width / 2.0 + 0.3), 0.0);
            world.add_box(middle, length, 0.6)?;
        }
        // On through the passage and away, not back over the robot.
        let stands = Point::new(rng.random_range(1.0..=2.0), rng.random_range(-0.3..=0.3));
        let beyond = Point::new(3.6, 0.0);
        (stands, vec![beyond, Point::new(3.6, side * 6.0)])
    } else {
        let wall = -side * rng.random_range(0.8..=1.4);
        world.add_wall(Point::new(-2.0, wall), Point::new(6.0, wall))?;
        let stands = Point::new(rng.random_range(0.7..=1.6), rng.random_range(-0.3..=0.3));
        (stands, vec![Point::new(stands.x + 0.5, side * 6.0)])
    };
    let speed = knobs
        .person_speed
        .unwrap_or_else(|| rng.random_range(0.3..=0.8));
    let delay = rng.random_range(10.0..=16.0);
    let stands = Motion::Path {
        start,
        waypoints,
        speed,
        delay,
        patrol: false,
    };
    world.add_person(someone(stands, knobs)?.stopped_by_walls());
    let place = if passage {
        "in a passage"
    } else {
        "beside a wall"
    };
    Ok(Scenario {
        name: BLOCKED_WAY,
        description: format!("someone stands in the way {place} for {delay:.0} s, then leaves"),
        world,
        start: Pose::new(0.0, 0.0, 0.0),
        goal,
        time_limit_ms: 60_000,
        robot: robot_with(knobs),
        sonar_faults: knobs.sonar_faults,
        seed: knobs.seed,
    })
}

/// Distance of `place` from the segment between two points (m).
fn from_segment(place: Point, from: Point, to: Point) -> f64 {
    let along = to - from;
    let length = along.norm_squared();
    let part = if length > 0.0 {
        ((place - from).dot(&along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (place - (from + along * part)).norm()
}

fn someone(motion: Motion, knobs: &Knobs) -> Result<Person, Error> {
    let person = Person::new(motion)?;
    if knobs.courteous {
        person.courteous(COURTESY_GAP)
    } else {
        Ok(person)
    }
}

fn robot_with(knobs: &Knobs) -> robot::Parameters {
    let mut robot = robot::Parameters::default();
    robot.sonar.noise = knobs.sonar_noise;
    robot
}
