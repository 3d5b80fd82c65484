//! People: where they walk, and what they do about a robot that stands in their way.

use core::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::{Error, require};
use crate::geometry::{Point, Vector, direction};
use crate::world::{Footprint, Solid, Walls, check_place, check_size};

/// Radius of a person seen from above (m): shoulder breadth and swinging arms.
pub const RADIUS: f64 = 0.25;

/// Distance a courteous person keeps from a robot that stands still, hull to body (m).
pub const COURTESY_GAP: f64 = 0.15;

/// Fastest walk or run that can be asked for (m/s).
const SPEED_LIMIT: f64 = 5.0;

/// Where someone who walks straight ahead for ever is going (m).
const HORIZON: f64 = 1e6;

/// How deep someone who walks into the robot's hull gets (m): far enough to count as touching it.
const PRESS: f64 = 0.002;

/// Farthest from the robot that someone who wanders aims when it is the robot they are drawn to (m).
const INTEREST: f64 = 1.5;

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
    /// Stands at `start`, then after `delay` walks about as `habit` has it, speeding up, slowing
    /// down and turning no harder than `acceleration` allows. Stopped by walls and by the robot's
    /// hull.
    Walk {
        /// Where from (m).
        start: Point,
        /// Greatest speed, in [0, 5] (m/s).
        speed: f64,
        /// Greatest change of the velocity, in (0, 1000] (m/s²).
        acceleration: f64,
        /// Time before the first step (s).
        delay: f64,
        /// What they are after.
        habit: Habit,
        /// Seed of every choice they make.
        seed: u64,
    },
    /// Walks as recorded, in straight lines from sample to sample, and is there only from the first
    /// to the last.
    ///
    /// Nothing makes a recorded person deviate.
    Track(Vec<Sample>),
}

/// When a step ends, and past whom and what it leads.
pub(crate) struct Moment<'a> {
    /// When it ends (s).
    pub time: f64,
    /// How long it takes (s).
    pub dt: f64,
    pub robot: Footprint,
    pub walls: Walls<'a>,
}

/// What someone who walks about is after.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Habit {
    /// One way after the other, each for a while at a random speed: now in a random direction, now
    /// past the robot, now standing.
    Wander,
    /// At the robot, aiming anew at every step, at full speed. Having reached it, or after some
    /// seconds, away from it for a while, and then at it again.
    Charge,
}

/// Where someone who walks about wants to go at the moment.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Leg {
    /// With this velocity (m/s).
    Steady(Vector),
    /// At the robot at this speed (m/s).
    Robot(f64),
    /// Away from the robot at this speed (m/s).
    Away(f64),
}

/// What someone who walks about keeps in mind.
#[derive(Debug, Clone)]
struct Stroll {
    rng: ChaCha8Rng,
    velocity: Vector,
    leg: Leg,
    /// When the leg ends (s).
    until: f64,
}

impl Stroll {
    fn new(seed: u64) -> Self {
        Self {
            rng: ChaCha8Rng::seed_from_u64(seed),
            velocity: Vector::zeros(),
            leg: Leg::Away(0.0),
            until: 0.0,
        }
    }

    /// Chooses what to do from `time` (s) on, `offset` away from the robot (m), up to `speed` (m/s).
    fn choose(&mut self, habit: Habit, time: f64, offset: Vector, speed: f64) {
        let (leg, seconds) = match (habit, self.leg) {
            (Habit::Charge, Leg::Robot(_)) => {
                let speed = speed * self.rng.random_range(0.3..=1.0);
                (Leg::Away(speed), self.rng.random_range(1.0..=3.0))
            }
            (Habit::Charge, _) => (Leg::Robot(speed), self.rng.random_range(2.0..=8.0)),
            (Habit::Wander, _) => {
                let part = self.rng.random_range(0.2..=1.0);
                let anywhere = direction(self.rng.random_range(-PI..=PI));
                let heading = match self.rng.random_range(0..4) {
                    0 => Vector::zeros(),
                    1 => anywhere,
                    _ => {
                        let near = anywhere * self.rng.random_range(0.0..=INTEREST);
                        (near - offset).try_normalize(1e-9).unwrap_or(anywhere)
                    }
                };
                let seconds = self.rng.random_range(0.3..=3.0);
                (Leg::Steady(heading * (speed * part)), seconds)
            }
        };
        self.leg = leg;
        self.until = time + seconds;
    }

    /// The velocity wanted, `offset` away from the robot (m).
    fn wanted(&self, offset: Vector) -> Vector {
        let outward = || offset.try_normalize(1e-9).unwrap_or_else(Vector::x);
        match self.leg {
            Leg::Steady(velocity) => velocity,
            Leg::Robot(speed) => outward() * -speed,
            Leg::Away(speed) => outward() * speed,
        }
    }
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
    /// Whether walls stop this person.
    bodily: bool,
    solid: Solid,
    position: Option<Point>,
    /// Speed in the last step (m/s).
    speed: f64,
    /// Index of the waypoint being walked to.
    next: usize,
    stroll: Option<Stroll>,
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
            bodily: false,
            solid: Solid::disc(RADIUS),
            position: None,
            speed: 0.0,
            next: 0,
            stroll: None,
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

    /// The same person, now one whom walls stop, as they always do someone who walks about: of a
    /// step into a still obstacle only what leads along it is taken.
    #[must_use]
    pub fn stopped_by_walls(mut self) -> Self {
        self.bodily = true;
        self
    }

    /// Whether walls stop this person.
    #[must_use]
    pub fn is_stopped_by_walls(&self) -> bool {
        self.bodily || matches!(self.motion, Motion::Walk { .. })
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

    /// Speed in the last step (m/s).
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    pub(crate) fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Puts the person where they are before the first step, or where they were recorded at `time`
    /// (s).
    pub(crate) fn place_at(&mut self, time: f64) {
        self.next = 0;
        self.speed = 0.0;
        self.stroll = None;
        self.position = match &self.motion {
            Motion::Line { start, .. } | Motion::Path { start, .. } => Some(*start),
            Motion::Walk { start, seed, .. } => {
                self.stroll = Some(Stroll::new(*seed));
                Some(*start)
            }
            Motion::Track(samples) => interpolate(samples, time),
        };
    }

    /// Moves the person on by one step.
    pub(crate) fn step(&mut self, now: &Moment<'_>) {
        let before = self.position;
        match self.motion {
            Motion::Line { speed, delay, .. } | Motion::Path { speed, delay, .. } => {
                self.follow(speed * (now.time - delay).clamp(0.0, now.dt), &now.robot);
                if self.bodily
                    && let (Some(before), Some(after)) = (before, self.position)
                {
                    self.position = Some(before + self.blocked(before, after - before, now));
                }
            }
            Motion::Walk {
                speed,
                acceleration,
                delay,
                habit,
                ..
            } if now.time > delay => self.walk_about(habit, speed, acceleration * now.dt, now),
            Motion::Walk { .. } => {}
            Motion::Track(_) => self.place_at(now.time),
        }
        self.speed = match (before, self.position) {
            (Some(before), Some(after)) => (after - before).norm() / now.dt,
            _ => 0.0,
        };
    }

    /// What walls and the robot leave of `step` (m) to someone whom they stop.
    fn blocked(&self, position: Point, step: Vector, now: &Moment<'_>) -> Vector {
        let slide = |step| now.walls.slide(position, step, self.radius);
        let left = self.keep_off(position, slide(step), &now.robot);
        // Between wall and robot there may be no way at all.
        if slide(left) == left {
            left
        } else {
            Vector::zeros()
        }
    }

    /// What is left of `step` (m) for someone whom the robot's hull stops, or who keeps off it out
    /// of courtesy: nothing leads nearer than that.
    fn keep_off(&self, position: Point, step: Vector, robot: &Footprint) -> Vector {
        let gap = match self.courtesy {
            Some(gap) if robot.still => gap,
            _ => -PRESS,
        };
        let offset = position - robot.centre;
        // Who is nearer than that already comes no nearer.
        let keep = (robot.radius + self.radius + gap).min(offset.norm());
        let after = offset + step;
        if after.norm() >= keep {
            return step;
        }
        let outward = after.try_normalize(1e-9).unwrap_or_else(Vector::x);
        let left = outward * keep - offset;
        left * (step.norm() / left.norm()).min(1.0)
    }

    /// A step of someone who walks about and can change their velocity by no more than `change`
    /// (m/s) in it.
    fn walk_about(&mut self, habit: Habit, speed: f64, change: f64, now: &Moment<'_>) {
        let (Some(position), Some(mut stroll)) = (self.position, self.stroll.take()) else {
            return;
        };
        let offset = position - now.robot.centre;
        let there = matches!(stroll.leg, Leg::Robot(_))
            && offset.norm() <= now.robot.radius + self.radius + self.courtesy.unwrap_or(0.0);
        if now.time > stroll.until || there {
            stroll.choose(habit, now.time, offset, speed);
        }
        // Between two velocities that are both slow enough lie none that are not.
        let difference = stroll.wanted(offset) - stroll.velocity;
        let part = (change / difference.norm().max(change)).min(1.0);
        stroll.velocity += difference * part;
        let step = self.blocked(position, stroll.velocity * now.dt, now);
        stroll.velocity = step / now.dt;
        self.position = Some(position + step);
        self.stroll = Some(stroll);
    }

    /// Walks on by `budget` (m) along a line or a path.
    fn follow(&mut self, budget: f64, robot: &Footprint) {
        let mut budget = budget;
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
            Motion::Line { .. } | Motion::Walk { .. } | Motion::Track(_) => &[],
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
            Motion::Walk { .. } | Motion::Track(_) => None,
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
        Motion::Walk {
            start,
            speed,
            acceleration,
            delay,
            ..
        } => {
            check_walk(start, *speed, *delay)?;
            require(
                "person.acceleration",
                *acceleration,
                "> 0, <= 1000 m/s²",
                |a| a > 0.0 && a <= 1000.0,
            )?;
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
