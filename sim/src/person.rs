//! People: where they walk, and what they do about a robot that stands in their way.

use crate::error::{Error, require};
use crate::geometry::{Point, Vector, direction};
use crate::world::{Footprint, Solid, check_place, check_size};

/// Radius of a person seen from above (m): shoulder breadth and swinging arms.
pub const RADIUS: f64 = 0.25;

/// Distance a courteous person keeps from a robot that stands still, hull to body (m).
pub const COURTESY_GAP: f64 = 0.15;

/// Fastest walk or run that can be asked for (m/s).
const SPEED_LIMIT: f64 = 5.0;

/// Where someone who walks straight ahead for ever is going (m).
const HORIZON: f64 = 1e6;

/// How a person moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Stands at `start`, then after `delay` walks straight ahead for ever.
    Line {
        /// Where from (m).
        start: Point,
        /// Direction of walking (rad).
        heading: f64,
        /// Speed, in [0, 5] (m/s).
        speed: f64,
        /// Time before the first step (s).
        delay: f64,
    },
    /// Stands at `start`, then after `delay` walks from waypoint to waypoint.
    Path {
        /// Where from (m).
        start: Point,
        /// Where to, one after the other (m).
        waypoints: Vec<Point>,
        /// Speed, in [0, 5] (m/s).
        speed: f64,
        /// Time before the first step (s).
        delay: f64,
        /// Whether the first waypoint follows the last; otherwise the person stays at the last.
        patrol: bool,
    },
    /// Walks as recorded, in straight lines from sample to sample, and is there only from the first
    /// to the last.
    ///
    /// Nothing makes a recorded person deviate.
    Track(Vec<Sample>),
}

/// Where a recorded person was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When, on the world's clock (s).
    pub time: f64,
    /// Where (m).
    pub position: Point,
}

/// A person: a disc that moves.
#[derive(Clone)]
pub struct Person {
    motion: Motion,
    radius: f64,
    courtesy: Option<f64>,
    solid: Solid,
    position: Option<Point>,
    /// Index of the waypoint being walked to.
    next: usize,
}

impl Person {
    /// A person of ordinary size who moves as told, whoever stands in the way.
    ///
    /// Times of a track must rise strictly.
    pub fn new(motion: Motion) -> Result<Self, Error> {
        check(&motion)?;
        let mut person = Self {
            motion,
            radius: RADIUS,
            courtesy: None,
            solid: Solid::disc(RADIUS),
            position: None,
            next: 0,
        };
        person.place_at(0.0);
        Ok(person)
    }

    /// The same person with another `radius` (m).
    pub fn with_radius(mut self, radius: f64) -> Result<Self, Error> {
        self.radius = check_size("person.radius", radius)?;
        self.solid = Solid::disc(radius);
        Ok(self)
    }

    /// The same person, now one who does not walk into a robot that stands still (readings
    /// ER-S1-22).
    ///
    /// A step that would bring the person closer than `gap` (m) to the hull of a standing robot is
    /// taken sideways round it instead, at the same speed. A robot that moves is not given way to.
    pub fn courteous(mut self, gap: f64) -> Result<Self, Error> {
        self.courtesy = Some(require("person.gap", gap, ">= 0 m", |g| g >= 0.0)?);
        Ok(self)
    }

    /// How the person moves.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Radius seen from above (m).
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The gap a courteous person keeps (m).
    #[must_use]
    pub fn courtesy(&self) -> Option<f64> {
        self.courtesy
    }

    /// Where the person is now (m), if there at all.
    #[must_use]
    pub fn position(&self) -> Option<Point> {
        self.position
    }

    pub(crate) fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Puts the person where they are before the first step, or where they were recorded at `time`
    /// (s).
    pub(crate) fn place_at(&mut self, time: f64) {
        self.next = 0;
        self.position = match &self.motion {
            Motion::Line { start, .. } | Motion::Path { start, .. } => Some(*start),
            Motion::Track(samples) => interpolate(samples, time),
        };
    }

    /// Moves the person on by `dt` to `time` (s), past a robot at `robot`.
    pub(crate) fn step(&mut self, time: f64, dt: f64, robot: &Footprint) {
        let (Motion::Line { speed, delay, .. } | Motion::Path { speed, delay, .. }) = self.motion
        else {
            self.place_at(time);
            return;
        };
        let mut budget = speed * (time - delay).clamp(0.0, dt);
        let Some(mut position) = self.position else {
            return;
        };
        // Several waypoints may be passed in one step, but each at most once: a path of no length
        // must not hold us.
        for _ in 0..=self.waypoints().len() {
            let Some(way) = self.way_from(position) else {
                break;
            };
            let distance = way.norm();
            let reached = distance <= budget;
            let step = if reached {
                way
            } else {
                way * (budget / distance)
            };
            if let Some(aside) = self.sidestep(position, way, step, robot) {
                position += aside * budget;
                break;
            }
            position += step;
            if !reached {
                break;
            }
            budget -= distance;
            self.next += 1;
        }
        self.position = Some(position);
    }

    /// The same person moving otherwise, back at the start.
    pub(crate) fn with_motion(mut self, motion: Motion) -> Result<Self, Error> {
        check(&motion)?;
        self.motion = motion;
        self.place_at(0.0);
        Ok(self)
    }

    fn waypoints(&self) -> &[Point] {
        match &self.motion {
            Motion::Path { waypoints, .. } => waypoints,
            Motion::Line { .. } | Motion::Track(_) => &[],
        }
    }

    /// From `position` to where the person wants to be (m), if anywhere.
    fn way_from(&self, position: Point) -> Option<Vector> {
        match &self.motion {
            Motion::Line { heading, .. } => Some(direction(*heading) * HORIZON),
            Motion::Path {
                waypoints, patrol, ..
            } => {
                let next = if *patrol {
                    self.next % waypoints.len().max(1)
                } else {
                    self.next
                };
                waypoints.get(next).map(|waypoint| waypoint - position)
            }
            Motion::Track(_) => None,
        }
    }

    /// The direction in which a courteous person walks instead of taking `step` on their `way`:
    /// round the robot if it stands too near the step, nowhere (the zero vector) if it stands where
    /// they want to be.
    fn sidestep(
        &self,
        position: Point,
        way: Vector,
        step: Vector,
        robot: &Footprint,
    ) -> Option<Vector> {
        let keep = self.courtesy? + self.radius + robot.radius;
        let offset = position - robot.centre;
        let after = (offset + step).norm();
        if !robot.still || after >= keep || after >= offset.norm() {
            return None;
        }
        if (offset + way).norm() < keep {
            return Some(Vector::zeros());
        }
        let outward = offset.normalize();
        let along = step - outward * step.dot(&outward);
        // Walking straight at the robot, people keep to their right.
        let right = Vector::new(-outward.y, outward.x);
        Some(along.try_normalize(1e-6 * step.norm()).unwrap_or(right))
    }
}

/// Where a recorded person is at `time`, if there.
fn interpolate(samples: &[Sample], time: f64) -> Option<Point> {
    let after = samples.partition_point(|sample| sample.time <= time);
    let before = samples.get(after.checked_sub(1)?)?;
    match samples.get(after) {
        Some(next) => {
            let part = (time - before.time) / (next.time - before.time);
            Some(before.position + (next.position - before.position) * part)
        }
        None => (time == before.time).then_some(before.position),
    }
}

fn check(motion: &Motion) -> Result<(), Error> {
    match motion {
        Motion::Line {
            start,
            heading,
            speed,
            delay,
        } => {
            check_walk(start, *speed, *delay)?;
            require("person.heading", *heading, "finite rad", |_| true)?;
        }
        Motion::Path {
            start,
            waypoints,
            speed,
            delay,
            ..
        } => {
            check_walk(start, *speed, *delay)?;
            for waypoint in waypoints {
                check_place("person.waypoint", waypoint)?;
            }
        }
        Motion::Track(samples) => {
            let mut last = f64::NEG_INFINITY;
            for Sample { time, position } in samples {
                require(
                    "track.time",
                    *time,
                    "later than the sample before (s)",
                    |t| t > last,
                )?;
                check_place("track.position", position)?;
                last = *time;
            }
        }
    }
    Ok(())
}

fn check_walk(start: &Point, speed: f64, delay: f64) -> Result<(), Error> {
    check_place("person.start", start)?;
    require("person.speed", speed, "0..=5 m/s", |v| {
        (0.0..=SPEED_LIMIT).contains(&v)
    })?;
    require("person.delay", delay, ">= 0 s", |t| t >= 0.0)?;
    Ok(())
}
