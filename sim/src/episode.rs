//! Situations made up from a seed: short, with people all over the robot from the beginning.
//!
//! Everybody keeps to the speed asked for, and nobody walks through walls or through the robot.
//! Sonars, line and base are as bad as asked for, and no worse.

use core::f64::consts::{FRAC_PI_2, PI};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::base;
use crate::error::{Error, require};
use crate::geometry::{Point, Pose, Vector, direction, heading_of};
use crate::link;
use crate::person::{COURTESY_GAP, Habit, Motion, Person, RADIUS};
use crate::robot;
use crate::scenario::{CRUISE, Scenario};
use crate::simulation::Simulation;
use crate::sonar;
use crate::world::World;

/// What kinds of episodes there are.
pub const KINDS: [&str; 4] = ["open-floor", "corridor-crowd", "edge", "clutter"];

/// Nobody begins nearer to the robot's hull than this (m).
const ROOM: f64 = 0.5;

/// When the robot is about to move, after its host has greeted it (s).
const BEGINNING: f64 = 1.5;

/// A velocity that is reached at once, as far as anyone can tell (m/s²).
const AT_ONCE: f64 = 1000.0;

/// What can be chosen of all episodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Greatest speed of anyone, in (0, 5] (m/s).
    pub person_speed: f64,
    /// Radius of the robot's hull (m).
    pub robot_radius: f64,
    /// Largest share of echoes lost, in [0, 1]: each episode has a share of its own up to this.
    pub dropout: f64,
    /// Largest share of false echoes, in [0, 1]: likewise, in one episode of three.
    pub false_echo: f64,
    /// Standard deviation of the sonars relative to the range, in [0, 1].
    pub noise: f64,
    /// Largest delay of a packet either way (ms): in every second episode.
    pub delay_ms: u64,
    /// How long an episode lasts (ms).
    pub time_limit_ms: u64,
}

impl Default for Options {
    /// People up to 0.8 m/s about a P3-DX, a tenth of the echoes lost, 12 s.
    fn default() -> Self {
        Self {
            person_speed: 0.8,
            robot_radius: base::Parameters::default().radius,
            dropout: 0.1,
            false_echo: 0.02,
            noise: 0.01,
            delay_ms: 20,
            time_limit_ms: 12_000,
        }
    }
}

/// A situation with what is not as it should be about the line and the base.
#[derive(Clone)]
pub struct Episode {
    /// The situation; its name is one of [`KINDS`].
    pub scenario: Scenario,
    /// The line, both ways.
    pub link: link::Faults,
    /// The base.
    pub base: base::Faults,
}

impl Episode {
    /// The episode that `seed` makes up.
    pub fn new(seed: u64, options: &Options) -> Result<Self, Error> {
        let speed = options.person_speed;
        require("episode.person_speed", speed, "> 0, <= 5 m/s", |v| {
            v > 0.0 && v <= 5.0
        })?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(u64::MAX - 2);
        let kind = rng.random_range(0..KINDS.len() as u32) as usize;
        let mut stage = Stage {
            world: World::new(),
            start: Pose::new(0.0, 0.0, 0.0),
            goal: Point::new(5.0, 0.0),
            rng,
            speed,
            robot_radius: options.robot_radius,
        };
        match kind {
            0 => stage.open_floor()?,
            1 => stage.corridor()?,
            2 => stage.edge()?,
            _ => stage.clutter()?,
        }
        let mut robot = robot::Parameters::default();
        robot.base.radius = options.robot_radius;
        robot.sonar.noise = options.noise;
        let rng = &mut stage.rng;
        robot.base.delay_ms = 10 * rng.random_range(2..=5);
        let people = stage.world.people().len();
        let base = base::Faults {
            braking_share: rng.random_range(1.0..=1.5),
            acceleration_share: rng.random_range(0.7..=1.0),
        };
        let link = link::Faults {
            delay_ms: if rng.random_bool(0.5) {
                rng.random_range(0..=options.delay_ms)
            } else {
                0
            },
            ..link::Faults::default()
        };
        let sonar_faults = sonar::Faults {
            dropout: options.dropout * rng.random_range(0.0..=1.0),
            false_echo: if rng.random_range(0..3) == 0 {
                options.false_echo * rng.random_range(0.0..=1.0)
            } else {
                0.0
            },
            ..sonar::Faults::default()
        };
        Ok(Self {
            scenario: Scenario {
                name: KINDS[kind],
                description: format!("episode {seed}, {people} people up to {speed:.2} m/s"),
                world: stage.world,
                start: stage.start,
                goal: stage.goal,
                time_limit_ms: options.time_limit_ms,
                robot,
                sonar_faults,
                seed,
            },
            link,
            base,
        })
    }

    /// The episode at its beginning.
    pub fn simulate(&self) -> Result<Simulation, Error> {
        let mut simulation = self.scenario.simulate()?;
        simulation.robot_mut().base_mut().set_faults(self.base)?;
        Ok(simulation)
    }
}

/// An episode in the making: the robot starts at the origin and is to go along x.
struct Stage {
    world: World,
    start: Pose,
    goal: Point,
    rng: ChaCha8Rng,
    speed: f64,
    robot_radius: f64,
}

impl Stage {
    /// People from everywhere, on an open floor.
    fn open_floor(&mut self) -> Result<(), Error> {
        // Now and then the robot has to turn first.
        if self.rng.random_range(0..4) == 0 {
            self.start.heading = self.rng.random_range(-PI..=PI);
        }
        for _ in 0..self.rng.random_range(1..=4) {
            let distance = self.rng.random_range(1.1..=6.0);
            let bearing = self.rng.random_range(-PI..=PI);
            self.anyone_at(direction(bearing) * distance)?;
        }
        Ok(())
    }

    /// Walls on both sides, and people along them.
    fn corridor(&mut self) -> Result<(), Error> {
        let half = self.rng.random_range(0.6..=1.2);
        for y in [-half, half] {
            self.world
                .add_wall(Point::new(-3.0, y), Point::new(9.0, y))?;
        }
        for _ in 0..self.rng.random_range(0..=2) {
            let ahead = self.rng.random_range(0..3) > 0;
            let x = if ahead {
                self.rng.random_range(1.2..=5.0)
            } else {
                self.rng.random_range(-2.8..=-1.1)
            };
            let aside = (half - RADIUS - 0.05).max(0.0);
            let y = self.rng.random_range(-aside..=aside);
            self.anyone_at(Vector::new(x, y))?;
        }
        Ok(())
    }

    /// A box or a doorway beside the way, with somebody behind the edge who steps out.
    fn edge(&mut self) -> Result<(), Error> {
        let side = self.side();
        let edge_x = self.rng.random_range(0.6..=2.2);
        let lateral = self.robot_radius + self.rng.random_range(0.1..=0.8);
        let hidden = RADIUS + self.rng.random_range(0.02..=0.4);
        let from = if self.rng.random_bool(0.5) {
            // Behind the far end of a box.
            let length = self.rng.random_range(0.4..=2.0);
            let depth = self.rng.random_range(0.6..=1.0);
            let centre = Pose::new(edge_x - length / 2.0, side * (lateral + depth / 2.0), 0.0);
            self.world.add_box(centre, length, depth)?;
            let y = lateral + self.rng.random_range(0.0..=depth);
            Point::new(edge_x + hidden, side * y)
        } else {
            // Beside a doorway in a wall.
            let door = self.rng.random_range(0.7..=1.2);
            let y = side * lateral;
            for (from, to) in [(-3.0, edge_x), (edge_x + door, 9.0)] {
                self.world
                    .add_wall(Point::new(from, y), Point::new(to, y))?;
            }
            Point::new(edge_x + door / 2.0, y + side * hidden)
        };
        let delay = BEGINNING + self.rng.random_range(0.0..=8.0);
        let habit = self.rng.random_range(0..3);
        let motion = if habit == 0 {
            self.walk(from, Habit::Charge, delay)
        } else {
            // Across the way, more or less.
            let aim = Point::new(
                from.x + self.rng.random_range(-1.0..=0.3),
                -side * self.rng.random_range(0.2..=2.0),
            );
            Motion::Path {
                start: from,
                waypoints: vec![Point::new(from.x, side * lateral), aim],
                speed: self.pace(),
                delay,
                patrol: self.rng.random_bool(0.5),
            }
        };
        self.add(motion)?;
        if self.rng.random_bool(0.5) {
            let place = Vector::new(
                self.rng.random_range(-3.0..=5.0),
                -side * self.rng.random_range(1.2..=2.5),
            );
            self.anyone_at(place)?;
        }
        Ok(())
    }

    /// A room full of furniture.
    fn clutter(&mut self) -> Result<(), Error> {
        let low = Point::new(
            -self.rng.random_range(0.8..=2.0),
            -self.rng.random_range(1.0..=2.5),
        );
        let high = Point::new(
            self.rng.random_range(3.5..=5.0),
            self.rng.random_range(1.0..=2.5),
        );
        self.world.add_room(low, high)?;
        self.goal = Point::new(high.x - 0.7, self.rng.random_range(-0.4..=0.4));
        for _ in 0..self.rng.random_range(1..=5) {
            let place = self.somewhere(low, high);
            if (place - self.start.position).norm() < self.robot_radius + 0.9 {
                continue;
            }
            if self.rng.random_bool(0.5) {
                // From a chair's leg to a pillar.
                let radius = if self.rng.random_bool(0.5) {
                    self.rng.random_range(0.01..=0.05)
                } else {
                    self.rng.random_range(0.05..=0.3)
                };
                self.world.add_disc(place, radius)?;
            } else {
                let heading = self.rng.random_range(-PI..=PI);
                let pose = Pose::new(place.x, place.y, heading);
                let [length, width] = [(); 2].map(|()| self.rng.random_range(0.1..=0.8));
                self.world.add_box(pose, length, width)?;
            }
        }
        for _ in 0..self.rng.random_range(1..=3) {
            let place = self.somewhere(low, high);
            self.anyone_at(place.coords)?;
        }
        Ok(())
    }

    fn side(&mut self) -> f64 {
        if self.rng.random_bool(0.5) { 1.0 } else { -1.0 }
    }

    fn somewhere(&mut self, low: Point, high: Point) -> Point {
        Point::new(
            self.rng.random_range(low.x..=high.x),
            self.rng.random_range(low.y..=high.y),
        )
    }

    /// A speed up to the greatest, and that one as often as not (m/s).
    fn pace(&mut self) -> f64 {
        if self.rng.random_bool(0.5) {
            self.speed
        } else {
            self.speed * self.rng.random_range(0.25..=1.0)
        }
    }

    fn walk(&mut self, start: Point, habit: Habit, delay: f64) -> Motion {
        Motion::Walk {
            start,
            speed: self.pace(),
            acceleration: if self.rng.random_bool(0.5) {
                AT_ONCE
            } else {
                self.rng.random_range(0.5..=4.0)
            },
            delay,
            habit,
            seed: self.rng.random(),
        }
    }

    /// Someone with whatever motion at `place` (m), unless somebody or something is there.
    fn anyone_at(&mut self, place: Vector) -> Result<(), Error> {
        let start = Point::from(place);
        let too_near = (start - self.start.position).norm() < self.robot_radius + RADIUS + ROOM;
        let taken = self
            .world
            .nearest(start)
            .is_some_and(|nearest| nearest.distance < RADIUS + 0.01);
        if too_near || taken {
            return Ok(());
        }
        // As likely as not they stand for a while first.
        let delay = if self.rng.random_bool(0.5) {
            0.0
        } else {
            self.rng.random_range(0.0..=6.0)
        };
        let motion = match self.rng.random_range(0..4) {
            0 => self.walk(start, Habit::Wander, delay),
            1 => self.walk(start, Habit::Charge, delay),
            2 => {
                // Straight at where the robot is by then, if nothing holds it up, or beside it.
                let speed = self.pace();
                let miss = self.rng.random_range(-0.6..=0.6);
                let met = self.meeting(start, speed, delay);
                let heading = heading_of(&(met - start));
                let aim = met + direction(heading + FRAC_PI_2) * miss;
                Motion::Line {
                    start,
                    heading: heading_of(&(aim - start)),
                    speed,
                    delay,
                }
            }
            _ => Motion::Path {
                start,
                waypoints: (0..3)
                    .map(|_| self.somewhere(Point::new(-1.0, -1.5), Point::new(3.0, 1.5)))
                    .collect(),
                speed: self.pace(),
                delay,
                patrol: true,
            },
        };
        self.add(motion)
    }

    /// Where someone who walks from `start` (m) at `speed` (m/s) after `delay` (s) meets a robot
    /// that cruises along x.
    fn meeting(&self, start: Point, speed: f64, delay: f64) -> Point {
        let robot = |time: f64| Point::new(CRUISE * (time - BEGINNING).max(0.0), 0.0);
        let mut time = delay;
        while time < 20.0 && (robot(time) - start).norm() > speed * (time - delay) {
            time += 0.1;
        }
        robot(time)
    }

    fn add(&mut self, motion: Motion) -> Result<(), Error> {
        let mut person = Person::new(motion)?.stopped_by_walls();
        if self.rng.random_range(0..4) == 0 {
            person = person.with_radius(self.rng.random_range(0.1..=RADIUS))?;
        }
        if self.rng.random_range(0..4) == 0 {
            person = person.courteous(COURTESY_GAP)?;
        }
        self.world.add_person(person);
        Ok(())
    }
}
